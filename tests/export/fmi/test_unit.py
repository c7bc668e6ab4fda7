"""The life of a unit: phases, ranges, steps, states, several instances; as fmpy sees it."""

from isa_ros.export.fmi.description import Version
import numpy as np
import pytest

fmpy = pytest.importorskip('fmpy')
from tests.export.fmi.importing import DISCARD, ERROR, STEP, Unit, WARNING  # noqa: E402
from tests.export.fmi.runs import inputs_of, SAMPLED  # noqa: E402
from tests.export.libraries import sealed  # noqa: E402

pytestmark = pytest.mark.slow
HEAD = 33    # bytes of a state before its inputs: the token
NAN = np.float64('nan').tobytes()


@pytest.fixture(scope='module', params=Version)
def version(request):
    return request.param


@pytest.fixture(scope='module')
def case(cases):
    return cases('moving')


@pytest.fixture
def make(case, version, tmp_path):
    """Return what makes instances of one unit; all are ended."""
    units = []

    def one(*arguments, **options):
        units.append(Unit(case.paths[version], tmp_path / 'unit', *arguments, **options))
        return units[-1]
    yield one
    for unit in units:
        unit.slave.freeInstance()


def refused(unit, status, text, call, *arguments):
    """Assert that a call is refused with a message that has a text."""
    unit.messages.clear()
    with pytest.raises(Exception, match='failed with status'):
        call(*arguments)
    assert len(unit.messages) == 1, unit.messages
    own, message = unit.messages[0]
    assert own == status and text in message, unit.messages


def warned(unit, text, call, *arguments):
    """Assert that a call warns with a text."""
    unit.messages.clear()
    call(*arguments)
    assert [status for status, _ in unit.messages] == [WARNING], unit.messages
    assert text in unit.messages[0][1]


def ran(unit, ticks):
    """Make the steps of ticks; return all samples."""
    found = []
    for tick in ticks:
        unit.set(dict(inputs_of(tick, False)))
        unit.step()
        found.append(unit.numbers([*SAMPLED]))
    return np.array(found)


def test_fmpy_finds_no_problem(case, version):
    from fmpy.validation import validate_fmu
    assert validate_fmu(str(case.paths[version])) == []


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


def test_a_step_that_is_no_multiple_of_the_tick_is_not_made(make):
    unit = make()
    unit.set({'setpoint.position': 0.06})
    unit.step(30)
    before = unit.state()
    for size in (0.0015, 0.0, -0.001, 0.0009999, 1e-9, float('nan'), float('inf'), 1e12):
        refused(unit, ERROR, ', must be a multiple of the tick, 0.001 s', unit.slave.doStep,
                unit.t, size)
    assert unit.state() == before
    unit.slave.doStep(unit.t, 0.002 + 1e-12)    # as sums of times have it
    assert unit.reached == pytest.approx(0.032)


def test_a_step_from_another_time_is_not_made(make):
    unit = make()
    unit.step(3)
    refused(unit, ERROR, 'a step from t = 0.01 s, must be from 0.003 s', unit.slave.doStep,
            0.01, STEP)
    refused(unit, ERROR, 'a step from t = 0.002 s, must be from 0.003 s', unit.slave.doStep,
            0.002, STEP)
    assert unit.reached == 0.003


def test_a_step_of_many_ticks_is_as_many_steps(make):
    unit, other = make(), make()
    for own, sizes in ((unit, [1] * 40), (other, [7, 1, 30, 2])):
        own.set({'setpoint.position': 0.07, 'setpoint.stiffness': 1e5})
        for size in sizes:
            own.step(size)
    assert unit.state() == other.state()
    assert unit.get('position') == other.get('position') != 0.05


def test_time_begins_where_the_importer_says(make):
    unit = make(begin=2.5)
    assert unit.reached == 2.5
    unit.step(10)
    assert unit.reached == 2.51
    found = unit.slave.doStep(2.51, 4 * STEP)
    assert found == ((False, False, False, 2.514) if unit.is_3 else None)


def test_equal_instances_do_not_know_each_other(make, case):
    ticks = case.ticks[:150]
    alone = ran(make(), ticks)
    one, other = make(), make({'start.position': 0.02})
    found = []
    for tick in ticks:
        found.append(ran(one, [tick])[0])
        other.step()
    assert np.array(found).tobytes() == alone.tobytes()


def test_a_state_goes_on_with_the_same_bytes(make, case):
    unit, other = make(), make({'start.position': 0.02})
    ran(unit, case.ticks[:120])
    state = unit.state()
    after = ran(unit, case.ticks[120:200])
    other.step(5)
    for own in (unit, other):
        own.restore(state)
        own.n_steps = 120
        assert own.state() == state
        assert own.reached == 0.12
        assert ran(own, case.ticks[120:200]).tobytes() == after.tobytes()


def test_a_state_has_what_was_written_since_the_last_step(make):
    unit, other = make(), make()
    for own in (unit, other):
        own.step(3)
    unit.set({'setpoint.position': 0.08, 'quick_stop': True})
    other.restore(unit.state())
    for own in (unit, other):
        own.step(30)
    assert unit.state() == other.state()
    assert unit.get('device_event') == other.get('device_event') != 1


def with_checksum(state):
    """Return a state with the checksum of what it has now."""
    return sealed(np.frombuffer(state, np.uint8)).tobytes()


def test_bytes_that_are_no_state_are_refused(make):
    unit, other = make(), make()
    unit.step(20)
    state, before = unit.state(), other.state()
    assert with_checksum(state) == state
    pressure = np.float64(unit.get('supply.pressure')).tobytes()
    assert HEAD < state.index(pressure) < len(state) // 4    # of the supply, before the actuator
    middle = len(state) // 2
    for text, broken in (
            (f'a state of {len(state) - 1} bytes, must be', state[:-1]),
            ('a state of 0 bytes, must be', b''),
            ('not a state of this unit', with_checksum(b'x' + state[1:])),
            ('not a state of this unit', with_checksum(state.replace(pressure, NAN, 1))),
            ('not a state of this unit', with_checksum(state[:HEAD] + NAN + state[HEAD + 8:])),
            ('', with_checksum(state[:middle] + b'\xff' * 400 + state[middle + 400:]))):
        refused(other, ERROR, text, other.restore, broken)
    assert other.state() == before


def test_any_damage_of_a_state_is_refused(make):
    """Also where the number would be a possible one: an input, the supply, the time."""
    unit, other = make(), make()
    unit.step(20)
    state, before = unit.state(), other.state()
    places = (0, HEAD + 1, HEAD + 8 * 5, len(state) // 5, len(state) // 2, len(state) - 9,
              len(state) - 1)
    for place in places:
        damaged = bytearray(state)
        damaged[place] ^= 1
        refused(other, ERROR, 'not a state of this unit', other.restore, bytes(damaged))
    assert other.state() == before
    other.restore(state)
    assert other.state() == state


def test_reset_is_a_new_instance(make):
    unit, new = make({'start.position': 0.02}), make()
    unit.set({'setpoint.position': 0.06})
    unit.step(30)
    unit.slave.reset()
    unit.initialise()
    unit.n_steps = 0
    assert unit.state() == new.state()
    assert unit.get('start.position') == 0.05


def test_phases_are_in_their_order(make):
    unit = make(waits=True)
    refused(unit, ERROR, 'a step is not possible before its initialization', unit.slave.doStep,
            0.0, STEP)
    refused(unit, ERROR, 'to end the initialization is not possible before its initialization',
            unit.slave.exitInitializationMode)
    unit.initialise()
    refused(unit, ERROR, 'after its initialization', unit.slave.enterInitializationMode)
    unit.step()
    unit.slave.terminate()
    refused(unit, ERROR, 'a step is not possible when it has ended', unit.slave.doStep, unit.t,
            STEP)
    assert unit.reached == 0.001


def test_the_token_of_another_unit_is_refused(case, version, tmp_path):
    with pytest.raises(Exception, match='[Ii]nstantiate'):
        own = Unit(case.paths[version], tmp_path / 'unit', waits=True).slave
        own.guid = f'{own.guid[:-1]}_'
        own.instantiate()


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


def test_types_and_references_are_checked(make):
    unit = make()
    real, whole = unit.variables['position'], unit.variables['trips']
    getter = unit.slave.getInt32 if unit.is_3 else unit.slave.getInteger
    read = unit.slave.getFloat64 if unit.is_3 else unit.slave.getReal
    refused(unit, ERROR, 'position is a number, must be a whole number', getter,
            [real.valueReference])
    refused(unit, ERROR, 'trips is a whole number, must be a number', read,
            [whole.valueReference])
    most = max(own.valueReference for own in unit.variables.values()) + 1 + (not unit.is_3)
    for beyond in (most, 9999):
        refused(unit, ERROR, f'value reference {beyond}, must be < {most}', read, [beyond])
    write = unit.slave.setFloat64 if unit.is_3 else unit.slave.setReal
    for name in ('position', 'supply.pressure', 'plant.drive.bore_mm'):
        refused(unit, ERROR, f'{name} is computed or constant, it cannot be set', write,
                [unit.variables[name].valueReference], [0.02])


def test_constants_are_those_of_the_listing(make, case):
    unit = make()
    for row, value in case.chosen.parameters():
        assert unit.get(row.parameter) in (
            value, value.encode() if isinstance(value, str) else value), row.parameter
    assert unit.get('supply.gas_volume_l') == 0.2
    assert unit.get('plant.drive.bore_mm') > 1.0


@pytest.fixture
def on_port(cases, version, tmp_path):
    """Return what makes instances of a unit whose load is the importer's."""
    return lambda: Unit(cases('port').paths[version], tmp_path / 'on_port')


def test_what_has_diverged_says_so_and_ends(on_port):
    unit = on_port()
    unit.step(3)
    unit.set({'port.position': 1e300})
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
