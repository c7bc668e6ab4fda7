"""What a unit is set to: starts, setpoints, modes and the port of a load."""

import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.asserted import refused, warned  # noqa: E402
from tests.export.fmi.importing import DISCARD, ERROR, STEP, Unit  # noqa: E402
from tests.export.fmi.runs import SAMPLED  # noqa: E402

pytestmark = pytest.mark.slow


def test_it_starts_where_the_parameter_says(make):
    unit = make({'start.position': 0.03})
    assert unit.get('position') == pytest.approx(0.03, abs=1e-6)    # of the encoder
    assert unit.get('rod.position') == 0.03
    assert unit.get('start.position') == 0.03
    unit.step()
    assert unit.get('rod.position') == pytest.approx(0.03, abs=1e-6)


def test_the_force_at_the_start_is_in_the_chambers(make):
    at_rest, pushing = make(), make({'start.force': 2000.0})
    difference = [unit.get('chamber_pressure_a') - unit.get('chamber_pressure_b')
                  for unit in (at_rest, pushing)]
    assert difference[1] > difference[0] + 1e6
    assert pushing.get('port.force') == pytest.approx(2000.0, rel=1e-6)


def test_a_parameter_set_in_the_initialization_starts_again(make):
    unit = make(waits=True)
    own = unit.slave
    if unit.is_3:
        own.enterInitializationMode(startTime=0.0)
    else:
        own.setupExperiment(startTime=0.0)
        own.enterInitializationMode()
    assert unit.get('rod.position') == 0.05
    unit.set({'start.position': 0.02})
    assert unit.get('rod.position') == 0.02
    own.exitInitializationMode()
    refused(unit, ERROR, 'start.position is not possible after its initialization', unit.set,
            {'start.position': 0.04})
    assert unit.get('start.position') == 0.02


@pytest.mark.parametrize(('name', 'value', 'text'), [
    ('start.position', 0.11, 'start.position = 0.11 m, must be 0 to 0.1 m'),
    ('start.position', -0.01, 'start.position = -0.01 m, must be 0 to 0.1 m'),
    ('start.force', 1e6, 'start.force = 1e+06 N, must be')])
def test_a_start_beyond_its_range_is_refused(make, name, value, text):
    unit = make(waits=True)
    before = unit.get(name)
    refused(unit, ERROR, text, unit.set, {name: value})
    assert unit.get(name) == before


def test_a_setpoint_beyond_its_range_is_left_out(make):
    unit, other = make(), make()
    for own in (unit, other):
        own.set({'setpoint.position': 0.06})
        own.step()
    warned(unit, 'setpoint.position = 0.2 m, must be 0 to 0.1 m; the value before stays',
           unit.set, {'setpoint.position': 0.2})
    assert unit.get('setpoint.position') == 0.06
    for own in (unit, other):
        own.step(20)
    assert unit.get('position') == other.get('position') > 0.0505


def test_numbers_that_are_not_finite_are_refused(make):
    unit = make()
    refused(unit, DISCARD, 'setpoint.velocity = nan m/s, must be finite', unit.set,
            {'setpoint.velocity': float('nan')})
    assert unit.get('setpoint.velocity') == 0.0


def test_enable_is_a_request_when_it_changes(make):
    unit = make()
    unit.step(5)
    unit.set({'enable': True})
    unit.step(5)
    assert unit.get('device_state') == 2 and unit.get('refused_requests') == 0
    unit.set({'enable': False})
    unit.step(200)
    assert unit.get('device_state') == 1
    unit.set({'enable': True})
    unit.step(200)
    assert unit.get('device_state') == 2 and unit.get('refused_requests') == 0


def test_a_rising_edge_stops(make):
    unit = make()
    unit.step(5)
    unit.set({'quick_stop': True})
    unit.step(300)
    assert unit.get('device_state') in (1, 3)
    stopped = unit.get('state_since')
    unit.set({'quick_stop': True})
    unit.step(10)
    assert unit.get('state_since') == stopped


def test_a_mode_is_chosen_by_its_number_and_takes_its_reference(make):
    unit = make()
    unit.step(5)
    unit.set({'mode': 2, 'reference': 2e-5})
    unit.step(30)
    assert unit.get('device_mode') == 2
    assert unit.get('spool') == pytest.approx(2e-5, rel=0.05)


def test_a_reference_beyond_its_range_is_left_out_with_a_message(make):
    unit = make()
    unit.set({'mode': 2, 'reference': 1.0})
    warned(unit, 't = 0 s: the command is refused: ', unit.step)
    assert unit.get('device_mode') == 6


@pytest.fixture
def on_port(cases, version, tmp_path):
    """Return what makes instances of a unit whose load is the importer's."""
    return lambda: Unit(cases('port').paths[version], tmp_path / 'on_port')


def test_what_has_diverged_says_so_and_ends(on_port):
    unit = on_port()
    unit.step(3)
    unit.set({'port.velocity': 1e300})
    refused(unit, ERROR, 'is not finite', unit.step)
    assert unit.messages[0][1].startswith('t = 0.00')
    unit.n_steps = round(unit.reached / STEP)
    refused(unit, ERROR, 'after its state has diverged', unit.step)
    unit.slave.reset()
    unit.initialise()
    unit.n_steps = 0
    unit.step()
    assert unit.get('device_state') == 2


def test_within_a_step_the_load_goes_on_as_it_moves(on_port):
    """x0 + t v0 + t^2 a0/2 with v0 + t a0, bias + t jerk at the ticks of the step."""
    many, single = on_port(), on_port()
    x, v, a, bias, jerk = many.get('port.position'), 0.05, -3.0, 0.7, 4.0
    constant = {'port.acceleration': a, 'port.stiffness': 100.0, 'port.damping': 3.0,
                'port.jerk': jerk}
    many.set({'port.position': x, 'port.velocity': v, 'port.bias': bias, **constant})
    many.step(4)
    for k in range(4):
        t = k * STEP
        single.set({'port.position': x + t * (v + 0.5 * t * a), 'port.velocity': v + t * a,
                    'port.bias': bias + t * jerk, **constant})
        single.step()
    assert many.numbers([*SAMPLED]).tobytes() == single.numbers([*SAMPLED]).tobytes()
    assert many.get('velocity') != 0.0


def test_only_a_load_of_the_importer_has_a_port(make, on_port):
    assert not any(name.startswith('port.') and own.causality == 'input'
                   for name, own in make().variables.items())
    unit = on_port()
    assert sum(name.startswith('port.') and own.causality == 'input'
               for name, own in unit.variables.items()) == 8
    assert 'load.inertia' not in unit.variables
