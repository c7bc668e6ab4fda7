"""
One controller twice, in memory and as a node: `python -m isa_ros.examples.same_bytes`.

Both bags hold the same bytes; they go to a new directory, or to the one named as argument.
"""

from collections.abc import Sequence
import hashlib
from pathlib import Path
import subprocess
import sys
import tempfile

import isa_ros
from isa_ros.examples.sway import Sway

DURATION = 0.3  # s


def in_memory(bag: Path) -> Path:
    """Simulate the leg under `Sway` without ROS and save the bag."""
    return isa_ros.load('leg', duration=DURATION).simulate(controllers=[Sway()]).save(bag)


def on_nodes(bag: Path) -> Path:
    """Bring up the leg with `Sway` as a node that takes part in every tick."""
    sway = subprocess.Popen([sys.executable, '-m', 'isa_ros.examples.sway'])
    try:
        subprocess.run(
            [sys.executable, '-m', 'isa_ros', 'bringup', 'leg', '--controller', 'sway',
             '--duration', str(DURATION), '--out', str(bag)], check=True)
    finally:
        sway.terminate()
        sway.wait()
    return bag


def digest(bag: Path) -> str:
    """Return the sha256 of the messages' file of a bag."""
    file, = bag.glob('*.mcap')
    return hashlib.sha256(file.read_bytes()).hexdigest()


def main(arguments: Sequence[str]) -> None:
    """Run both and compare."""
    directory = Path(arguments[0] if arguments else tempfile.mkdtemp(prefix='isa_ros_'))
    first, second = in_memory(directory / 'in_memory'), on_nodes(directory / 'on_nodes')
    print(digest(first), first)
    print(digest(second), second)
    if digest(first) != digest(second):
        raise SystemExit(1)


if __name__ == '__main__':
    main(sys.argv[1:])
