"""
Record the golden bags of tests/golden again; name the changed equation in the commit.

    python scripts/record_golden.py [NAME ...]

They are compressed, so that their bytes depend on the version of zstd. Their messages do not;
the tests compare the messages.
"""

from pathlib import Path
import sys

from isa_ros.config.paths import CONFIG, find
from isa_ros.nodes.bringup import bringup
from isa_ros.run.options import Request

GOLDEN = Path(__file__).parent.parent / 'tests' / 'golden'
RUNS = {
    'leg_touchdown': 'leg.yaml', 'rotor_step': 'rig_rotary.yaml', 'knee_push': 'rig_knee.yaml'}


def main() -> None:
    """Record the golden bags given as arguments, or all, in one process."""
    for name in sys.argv[1:] or RUNS:
        bag = bringup(Request(
            config=find(RUNS[name], CONFIG), scenario=GOLDEN / f'{name}.yaml',
            out=GOLDEN / name, overwrite=True, in_process=True, compression='zstd'))
        print(bag)


if __name__ == '__main__':
    main()
