"""
Record the golden bags of tests/replay again; say in the commit which equation changed.

    python scripts/record_golden.py
"""

from pathlib import Path

from isa_ros.paths import CONFIG, find
from isa_ros.run import bringup, Request

GOLDEN = Path(__file__).parent.parent / 'tests' / 'replay'
RUNS = {'leg_touchdown': 'leg.yaml', 'rotor_step': 'rig_rotary.yaml'}


def main() -> None:
    """Record every golden bag, in one process."""
    for name, config in RUNS.items():
        bag = bringup(Request(
            config=find(config, CONFIG), scenario=GOLDEN / f'{name}.yaml',
            out=GOLDEN / name, overwrite=True, in_process=True))
        print(bag)


if __name__ == '__main__':
    main()
