"""What a unit takes: the ranges of its inputs are those of Python, and refused when set."""

from isa_ros.actuator.setpoint_range import reference_bounds
from isa_ros.config.runs.external_config import held_forces
from isa_ros.export.chosen import choose
from isa_ros.export.fmi.inputs import inputs
from isa_ros.export.fmi.unit import parts_of
import numpy as np
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import ERROR, Unit, WARNING  # noqa: E402

pytestmark = pytest.mark.slow


@pytest.fixture
def unit(cases, version, tmp_path):
    """Return a unit whose load is the importer's, before its initialization."""
    return Unit(cases('port').paths[version], tmp_path / 'unit', waits=True)


def test_forces_of_the_start_are_those_of_python(unit, cases):
    own = unit.variables['start.force']
    low, high = held_forces(cases('port').chosen.config)
    assert (float(own.min), float(own.max)) == (low, high)
    unit.initialise({'start.force': high})
    assert unit.get('start.force') == high and unit.messages == []
    unit.slave.reset()
    for force, beyond in ((low, -np.inf), (high, np.inf)):
        with pytest.raises(Exception, match='status 3'):
            unit.set({'start.force': float(np.nextafter(force, beyond))})
    assert [status for status, _ in unit.messages] == [ERROR] * 2
    assert f'must be {low:g} to {high:g} N; the value before stays' in unit.messages[0][1]


def test_the_force_of_a_run_file_is_in_the_range():
    """A mass may hang on an actuator with its relief valves open."""
    chosen = choose('isa_v5')
    start = parts_of(chosen).own.start[0]
    for force in (8100.0, -5600.0):
        start['force'] = force
        found = {own.name: own for own in inputs(chosen.config, start)}['start.force']
        low, high = held_forces(chosen.config)
        assert (found.low, found.start, found.high) == (min(low, force), force, max(high, force))


@pytest.mark.parametrize('mode', [0, 3, 5, 7, 99, -1])
def test_a_mode_that_the_actuator_does_not_have_is_refused_when_it_is_set(unit, mode):
    unit.initialise()
    unit.set({'mode': mode})
    (status, text), = unit.messages
    assert status == WARNING
    assert text == (f'mode = {mode}, must be 1 current, 2 spool, 4 force, 6 impedance; '
                    'the value before stays')
    assert unit.get('mode') == 6
    unit.step()
    assert len(unit.messages) == 1 and unit.get('device_mode') == 6


def test_its_modes_are_in_the_description(unit):
    own = unit.variables['mode']
    assert own.description == 'mode of the device: 1 current, 2 spool, 4 force, 6 impedance'
    assert (int(own.min), int(own.max)) == (1, 6)
    unit.initialise()
    for mode in (1, 2, 4):
        unit.set({'mode': mode})
        unit.step()
        assert unit.get('device_mode') == mode
    assert unit.messages == []


def test_units_and_ranges_of_references_are_in_the_description(unit, cases):
    bounds = reference_bounds(cases('port').chosen.config.sheet)
    (current, spool), text = (bounds[1], bounds[2]), unit.variables['reference'].description
    assert text == (
        f'setpoint of a mode: current, {-current.high:g} to {current.high:g} A; '
        f'spool, {-spool.high:g} to {spool.high:g} m; not used in the others')


def test_a_load_far_beyond_the_stroke_is_left_out(unit):
    """By more than half of 0.1 m, as the description says; within it the load is taken."""
    own = unit.variables['port.position']
    assert (float(own.min), float(own.max)) == (-0.05, 0.15000000000000002)
    unit.initialise()
    before = unit.get('port.position')
    for beyond in (-0.0501, 0.1501, 50.0):
        unit.set({'port.position': beyond})
    texts = [text for _, text in unit.messages]
    assert len(texts) == 3 and texts[2].startswith('port.position = 50 m, must be ')
    unit.step()
    assert unit.get('port.position') == before != 0.06
    unit.set({'port.position': 0.06})
    assert unit.get('port.position') == 0.06 and len(unit.messages) == 3


def test_a_negative_inverse_mass_is_left_out(unit):
    unit.initialise({'port.inverse_mass': 0.02})
    unit.set({'port.inverse_mass': -1e-6})
    (status, text), = unit.messages
    assert status == WARNING
    assert text == 'port.inverse_mass = -1e-06 1/kg, must be >= 0 1/kg; the value before stays'
    unit.step()
    assert unit.get('port.inverse_mass') == 0.02 and unit.get('device_state') == 2
