"""`python -m tests.ros.frozen ...` is `isa ...` and prints the objects frozen in a run."""

import gc
import sys
from typing import Any

from isa_ros.cli.main import main
from isa_ros.nodes.coordinator import runs as session


def said(coordinate: Any) -> Any:
    """Return the function that also prints the number of frozen objects when it is called."""
    def wrapped(*arguments: Any) -> None:
        print(f'{gc.get_freeze_count()} objects frozen', file=sys.stderr)
        coordinate(*arguments)
    return wrapped


if __name__ == '__main__':
    session._record = said(session._record)
    sys.exit(main())
