"""A tick of a library takes commands, ports and feeds within their ranges, and refuses others."""

from isa_ros.core.device import MODES
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, LOAD_PORT)
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
import numpy as np
import pytest
from tests.export.calls import (
    BEYOND_RANGE, command, NOT_FINITE, port, UNKNOWN_KIND, UNKNOWN_MODE, WRONG_MODE)
from tests.export.libraries import Instance, Loaded, written

pytestmark = pytest.mark.slow


@pytest.fixture(scope='module')
def limiting(tmp_path_factory):
    """Return the functions of one whose setpoints are limited to their range."""
    own = exported(choose('isa_v5', {'beyond_range': 'limit'}), name='limiting')
    return Loaded(written(own, tmp_path_factory.mktemp('limiting')), 'limiting')


@pytest.mark.parametrize('given, code', [
    (command(128), UNKNOWN_KIND), (command(1 << 31), UNKNOWN_KIND),
    (command(HAS_ENABLE, is_enabled=2), UNKNOWN_KIND),
    (command(HAS_MODE, mode=0), UNKNOWN_MODE), (command(HAS_MODE, mode=7), UNKNOWN_MODE),
    (command(HAS_MODE, mode=-1), UNKNOWN_MODE), (command(HAS_MODE, mode=1 << 40), UNKNOWN_MODE),
    (command(HAS_MODE, mode=MODES.index('position')), UNKNOWN_MODE),
    (command(HAS_REFERENCE, mode=MODES.index('current'), reference=1e-3), WRONG_MODE),
    (command(HAS_REFERENCE, mode=MODES.index('impedance')), WRONG_MODE),
    (command(HAS_MODE | HAS_REFERENCE, mode=MODES.index('force')), WRONG_MODE),
    (command(HAS_MODE | HAS_REFERENCE, mode=MODES.index('current'), reference=0.0101),
     BEYOND_RANGE),
    (command(HAS_MODE | HAS_REFERENCE, mode=MODES.index('current'), reference=np.nan),
     NOT_FINITE),
    (command(HAS_SETPOINT, position=np.nan), NOT_FINITE),
    (command(HAS_SETPOINT, velocity=np.nan), NOT_FINITE),
    (command(HAS_SETPOINT, effort=np.nan), NOT_FINITE),
    (command(HAS_SETPOINT, effort=-np.inf), NOT_FINITE),
    (command(HAS_SETPOINT, position=0.1001), BEYOND_RANGE),
    (command(HAS_SETPOINT, position=-1e-6), BEYOND_RANGE),
    (command(HAS_SETPOINT, velocity=1.7), BEYOND_RANGE),
    (command(HAS_SETPOINT, effort=7501.0), BEYOND_RANGE),
    (command(HAS_SETPOINT, stiffness=-1.0), BEYOND_RANGE),
    (command(HAS_GAINS, damping=3e7), BEYOND_RANGE),      # a stiffness may be 5e7
    (command(HAS_GAINS, stiffness=np.inf), NOT_FINITE),
    (command(HAS_SETPOINT | HAS_MODE, mode=MODES.index('force'), effort=np.nan), NOT_FINITE),
])
def test_commands_that_are_refused(loaded, given, code):
    instance = Instance(loaded)
    for _ in range(3):
        instance.tick(port())
    before = bytes(instance.memory)
    assert instance.tick(port(), given) == code
    assert bytes(instance.memory) == before


def test_before_the_first_tick_the_command_is_that_of_the_start(loaded):
    instance = Instance(loaded)
    applied = instance.applied
    assert applied['kinds'] == HAS_SETPOINT | HAS_ENABLE
    assert applied['position'] == instance.sample['position'] and applied['is_enabled'] == 1
    assert instance.tick(port()) == 0 and instance.applied['kinds'] == 0


def test_what_a_mode_does_not_use_may_be_missing(loaded):
    instance = Instance(loaded)
    held = instance.sample['position']
    force = command(HAS_SETPOINT | HAS_MODE, mode=MODES.index('force'), effort=123.0,
                    position=np.nan, velocity=np.nan)
    assert instance.tick(port(), force) == 0
    applied = instance.applied
    assert (applied['position'], applied['velocity'], applied['effort']) == (held, 0.0, 123.0)


def test_setpoints_beyond_their_range_are_limited(limiting):
    instance = Instance(limiting)
    assert instance.tick(port(), command(
        HAS_SETPOINT, position=0.2, velocity=-9.0, effort=8000.0, stiffness=-5.0,
        damping=3000.0)) == 0
    applied = instance.applied
    assert (applied['position'], applied['effort']) == (0.1, 7500.0)
    assert (applied['stiffness'], applied['damping']) == (0.0, 3000.0)
    assert -1.7 < applied['velocity'] < -1.6
    assert instance.tick(port(), command(HAS_SETPOINT, position=np.inf)) == NOT_FINITE


def test_the_ends_of_a_range_are_in_it(loaded):
    instance = Instance(loaded)
    for position in (0.1, 0.0):
        assert instance.tick(port(), command(HAS_SETPOINT, position=position)) == 0
        assert instance.applied['position'] == position


@pytest.mark.parametrize('field', LOAD_PORT.names)
def test_ports_are_finite(loaded, field):
    instance = Instance(loaded)
    before = bytes(instance.memory)
    assert instance.tick(port(**{field: np.nan})) == NOT_FINITE
    assert instance.tick(port(**{field: -np.inf})) == NOT_FINITE
    assert bytes(instance.memory) == before
    assert instance.tick(port()) == 0


@pytest.mark.parametrize('given', [
    {'inverse_mass': -1e-9}, {'supply_pressure': -101326.0}, {'return_pressure': -1e6},
    {'x0': -0.05001}, {'x0': 0.15001}, {'x0': 50.0}])     # of 0.1 m: half of it beyond its ends
def test_ports_that_no_load_or_supply_has(loaded, given):
    instance = Instance(loaded)
    before = bytes(instance.memory)
    assert instance.tick(port(**given)) == BEYOND_RANGE
    assert bytes(instance.memory) == before
    assert instance.tick(port(inverse_mass=0.02, return_pressure=-101325.0)) == 0
    for x0 in (-0.0499, 0.1499):
        assert instance.tick(port(x0=x0)) != BEYOND_RANGE


def test_feeds_are_finite(loaded):
    instance = Instance(loaded)
    assert instance.tick(port(), feed=(1e9, 0.0, 0.0, 0.0, np.nan, 0.0, 0.0, 0.0)) == NOT_FINITE
    assert instance.tick(port(), feed=(1e9, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)) == 0
    fed = instance.fed.tobytes()
    assert any(fed) and instance.tick(port()) == 0
    assert instance.fed.tobytes() == fed
    assert instance.tick(port(), feed=(1e9, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)) == 0
    assert instance.fed.tobytes() != fed


def test_oil_that_flows_in_is_not_below_absolute_zero(loaded):
    """Only where the feed has a temperature."""
    instance = Instance(loaded)
    before = bytes(instance.memory)
    feed = 1e9, 0.0, 0.0, 0.0, 1.0, 0.0
    assert instance.tick(port(), feed=(*feed, 1.0, -273.2)) == BEYOND_RANGE
    assert bytes(instance.memory) == before
    assert instance.tick(port(), feed=(*feed, 1.0, -273.1)) == 0
    assert instance.tick(port(), feed=(*feed, 0.0, -300.0)) == 0


def test_a_clear_request_is_merged(loaded):
    instance = Instance(loaded)
    assert instance.tick(port(), command(HAS_CLEAR_FAULT)) == 0
    assert instance.applied['kinds'] == HAS_CLEAR_FAULT
    assert instance.tick(port()) == 0 and instance.applied['kinds'] == 0
    assert instance.sample['refused_requests'] == 1.0
