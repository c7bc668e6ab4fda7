"""Random commands at an exported actuator: taken, limited and refused as in Python."""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.assembly import timing_of
from isa_ros.core.device import CURRENT, MODES, PRESSURE
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, LOAD_PORT)
from isa_ros.errors import SetpointError
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
import numpy as np
import pytest
from tests.export.libraries import BEHIND, Instance, Loaded, written

pytestmark = pytest.mark.slow

TICKS = 600
ACTUATORS = {
    'impedance': choose('isa_v5'),
    'limited': choose('isa_v5', {'beyond_range': 'limit'}),
    'position': choose('isa_v5', variants=['position_control']),
    'rotary': choose('smart_manifold'),
    'off_at_first': choose('rig_linear', {'actuators.ram.auto_enable': False})}


@pytest.fixture(scope='module', params=ACTUATORS)
def both(request, tmp_path_factory):
    """Return the actuator in Python, and an instance of its library."""
    own = exported(ACTUATORS[request.param])
    actuator = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    actuator.start(*own.start[0].item())
    path = written(own, tmp_path_factory.mktemp(request.param))
    return actuator, Instance(Loaded(path, own.word))


def drawn(random, actuator):
    """Return a `COMMAND`: around its range, sometimes with a number that is missing."""
    row = np.zeros(1, COMMAND)[0]
    row['kinds'] = random.choice([
        0, HAS_SETPOINT, random.integers(0, EVERY_KIND + 1), HAS_MODE, HAS_MODE | HAS_REFERENCE])
    row['is_enabled'] = random.random() < 0.9
    stroke = actuator.sheet.plant.drive.stroke
    row['position'] = stroke * random.uniform(-0.02, 1.02)
    row['velocity'], row['effort'] = random.normal(0.0, 0.4), random.normal(0.0, 60.0)
    row['stiffness'], row['damping'] = random.normal(2e3, 1e3), random.normal(200.0, 80.0)
    for name in ('position', 'velocity', 'effort', 'stiffness', 'damping'):
        if random.random() < 0.15:
            row[name] = np.nan
    row['mode'] = random.integers(CURRENT, len(MODES))
    row['reference'] = random.normal(0.0, 1.0) * {1: 4e-3, 2: 8e-5, 3: 1.2e7}.get(
        int(row['mode']), 1.0)
    if not CURRENT <= row['mode'] <= PRESSURE:      # a reference of no mode is refused in C only
        row['kinds'] &= ~np.uint32(HAS_REFERENCE)
    return row


def test_commands_as_in_python(both):
    actuator, instance = both
    random = np.random.default_rng(7)
    port = np.zeros(1, LOAD_PORT)[0]
    port['supply_pressure'] = 20.7e6
    position = actuator.sample.position
    refused = limited = 0
    for k in range(TICKS):
        command = drawn(random, actuator)
        port['x0'] = position + 1e-4 * np.sin(0.1 * k)
        given = command.copy()
        try:
            limited += actuator.admit(command) != ''
            is_taken = True
        except SetpointError:
            is_taken = False
        code = instance.tick(port, given)
        assert (code == 0) == is_taken, (k, given, code)
        if not is_taken:
            refused += 1
            assert instance.tick(port) == 0
        actuator.tick(port)
        assert instance.applied.tobytes() == actuator.memory.applied.tobytes(), (k, given)
        assert instance.sample.tobytes() == actuator.sample.tobytes(), (k, given)
    assert instance.save().tobytes()[:-BEHIND] == actuator.snapshot()
    assert 50 < refused < TICKS - 50
    assert (limited > 0) == actuator.setpoint_range.limits
