"""
Record the golden bags and the digests of all messages anew.

    python -m tests.golden.record

Only a commit that changes an equation or a message does so, and says why. Bags of releases stay as
they are; that of a version without release is recorded anew too.
"""

from pathlib import Path

from isa_ros.config.paths import CONFIG, shipped
from isa_ros.core.version import RELEASES, VERSION
import isa_ros.scripting.run as scripting
from scripts import release
from tests.golden import message_digests

HERE = Path(__file__).parent
CONFIGURATIONS = {
    'leg_touchdown': 'leg.yaml', 'rotor_step': 'rig_rotary.yaml', 'knee_push': 'rig_knee.yaml'}
"""Run file of each golden bag; the scenario beside the bag has its name."""


def main() -> None:
    """Write every golden bag, compressed, and the digests."""
    paths = shipped(CONFIG)
    for name, config in CONFIGURATIONS.items():
        run = scripting.load(paths[config], HERE / f'{name}.yaml', compression='zstd')
        run.simulate().save(HERE / name, overwrite=True)
    if VERSION not in RELEASES:
        release.record(VERSION, release.ROOT)
    message_digests.main()


if __name__ == '__main__':
    main()
