"""The quadruped's trot on nodes: the same bytes as in Python."""

import isa_ros
import pytest
from tests.ros.bags import sha256
from tests.ros.started import bringup, ROOT

pytestmark = [pytest.mark.ros, pytest.mark.slow]
CONFIG = ROOT / 'config' / 'quadruped.yaml'
SCENARIO = ROOT / 'config' / 'scenarios' / 'quadruped_jolt.yaml'


def test_processes_one_process_and_python_give_the_same_bytes(domain, tmp_path):
    """Twelve actuators and the controller that the scenario brings, with a push at 20 ms."""
    changes = ('scenario.changes[0].t_s=0.02', 'scenario.changes[0].until_s=0.04')
    bags = [tmp_path / name / 'bag' for name in ('several', 'one', 'python')]
    isa_ros.load(CONFIG, SCENARIO, duration=0.06, changes={
        key: float(value) for key, value in (change.split('=') for change in changes)
    }).simulate().save(bags[2])
    for bag, way in zip(bags, ((), ('--in-process',))):
        bag.parent.mkdir()
        options = [word for change in changes for word in ('--set', change)]
        with bringup(bag, '--scenario', str(SCENARIO), '--duration', '0.06', *options, *way,
                     config=CONFIG) as run:
            assert run.exit_code() == 0, run.errors
    assert sha256(bags[0]) == sha256(bags[1]) == sha256(bags[2])
