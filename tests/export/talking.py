"""A kernel whose module says something when it is imported, and holds those that are to wait."""

import os
import time

from isa_ros.core.kernel import kernel

print('imported')
if 'HELD' in os.environ:
    with open(os.environ['HELD'], 'w') as file:
        file.write(str(os.getpid()))
    time.sleep(600.0)


@kernel
def talk(own):
    """Return 3."""
    return 3
