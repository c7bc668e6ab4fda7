"""Where a unit starts: positions that were not set are those of the actuator at rest."""

import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import Unit  # noqa: E402

pytestmark = pytest.mark.slow
JOLT = 10.0    # N: the oil leaks 5 N in a tick, a load at the piston's place is 25 N off


@pytest.fixture
def on_port(cases, version, tmp_path):
    """Return what makes instances of a unit whose load is the importer's, with parameters."""
    return lambda start: Unit(cases('port').paths[version], tmp_path / 'on_port', start)


@pytest.fixture
def loaded(cases, version, tmp_path):
    """Return what makes instances of a unit with a load of its own."""
    return lambda start: Unit(cases('moving').paths[version], tmp_path / 'loaded', start)


def test_until_they_are_set_positions_are_those_of_the_start(on_port, cases):
    """The load is at x = s - F/K_s, with the start's force, -31 N, or another."""
    stiffness = cases('port').chosen.config.sheet.plant.mechanics.sensor_stiffness
    usual = on_port({})
    where, force = usual.get('start.position'), usual.get('start.force')
    assert force < -20.0
    assert usual.get('port.position') == where - force / stiffness
    moved = on_port({'start.position': 0.03, 'start.force': 900.0})
    assert moved.get('port.position') == 0.03 - 900.0 / stiffness != 0.03
    assert moved.get('setpoint.position') == 0.03
    given = on_port({'port.position': 0.04, 'setpoint.position': 0.045, 'start.position': 0.03})
    assert given.get('port.position') == 0.04
    assert given.get('setpoint.position') == 0.045


def test_the_description_has_the_place_of_the_load(on_port):
    """An importer that writes every start value changes nothing."""
    unit = on_port({})
    for name in ('port.position', 'setpoint.position'):
        assert float(unit.variables[name].start) == unit.get(name)
    assert unit.get('port.position') != unit.get('setpoint.position')


@pytest.mark.parametrize('start', [
    {}, {'start.position': 0.03}, {'start.position': 0.07, 'start.force': 1500.0}])
def test_nothing_jolts_at_the_start_on_a_port(on_port, start):
    unit = on_port(start)
    force = unit.get('start.force')
    unit.step()
    assert unit.get('port.force') == pytest.approx(force, abs=JOLT)
    unit.step(20)
    assert unit.get('device_state') == 2 and unit.get('trips') == 0


def test_a_start_that_is_set_in_the_initialization_moves_the_positions(on_port):
    unit = on_port({})
    unit.slave.reset()
    if unit.is_3:
        unit.slave.enterInitializationMode(startTime=0.0)
    else:
        unit.slave.setupExperiment(startTime=0.0)
        unit.slave.enterInitializationMode()
    before = unit.get('port.position')
    unit.set({'start.position': 0.03})
    assert unit.get('port.position') == pytest.approx(0.03, abs=1e-4) != before
    assert unit.get('setpoint.position') == 0.03


def test_one_number_of_a_setpoint_brings_the_place_of_the_start(loaded):
    unit = loaded({'start.position': 0.03})
    unit.set({'setpoint.velocity': 0.0})
    unit.step(100)
    assert unit.get('rod.position') == pytest.approx(0.03, abs=5e-4)


def test_a_reset_forgets_positions_that_were_set(loaded):
    unit = loaded({'setpoint.position': 0.06})
    unit.step()
    unit.slave.reset()
    unit.initialise({'start.position': 0.03})
    assert unit.get('setpoint.position') == 0.03
