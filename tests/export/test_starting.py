"""The start of an actuator as a kernel: the same bytes as `SmartActuator.start`."""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.requests import start_mode
from isa_ros.config.assembly import timing_of
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.bound import Bound
from isa_ros.core.signals import START
from isa_ros.export.starting import start_actuator, Started
from isa_ros.reu.cascade import initial_gains
import numpy as np
import pytest

FILES = shipped(CONFIG)


@pytest.mark.slow
@pytest.mark.parametrize('name', FILES)
def test_every_shipped_actuator_starts_the_same(name):
    run = load_run(FILES[name])
    for config in run.actuators:
        start = np.zeros(1, START)
        mode = start_mode(config.name, config.mode, config.sheet.reu)
        start[0] = config.initial_position + 1e-4, 123.0, 2e7, 1e5
        expected, own = (SmartActuator(config, timing_of(run)) for _ in range(2))
        expected.start(*start[0].item())
        own.clear(float(start['position'][0]))
        assert own.memory.continuous['plant']['mechanics']['position'][0] == 0.0
        assert Bound(start_actuator, Started(
            start, np.array(initial_gains(config.sheet.reu)),
            np.array([mode, int(config.auto_enable)]), own.memory)).run() == 0
        for field, one, other in zip(own.memory._fields, own.memory, expected.memory):
            assert one.tobytes() == other.tobytes(), (config.name, field)
        assert own.snapshot() == expected.snapshot()
