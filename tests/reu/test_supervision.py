"""What a drive supervises: whether it follows, does not swing, and moves as its valve lets it."""

from isa_ros.core.device import IMPEDANCE, POSITION, SPOOL
from isa_ros.core.record import rows_of
from isa_ros.core.signals import MEASURED
from isa_ros.reu import supervision as own
import numpy as np
import pytest
from tests.reu.watched import AREA_A, AREA_B, FLOW_GAIN, off, only, STROKE, SUPPLY, Watched

CONSTANTS = Watched(off()).constants.supervision


def measured(**values):
    row = rows_of(1, MEASURED)[0]
    row.position, row.pressure_a, row.pressure_b = 0.5 * STROKE, 10e6, 10e6
    for name, value in values.items():
        setattr(row, name, value)
    return row


@pytest.mark.parametrize(('name', 'reading', 'part'), [
    ('pressure_a', -0.25 * 25e6, 0.25), ('pressure_b', -0.25 * 25e6, 0.25),
    ('pressure_b', 1.1 * 25e6, 0.1), ('pressure_a', 0.0, 0.0),
    ('force', -1.25e4, 0.25), ('force', 1e4, 0.0), ('current', 15e-3, 0.2),
    ('spool', 3.6e-4, 0.2)])
def test_a_reading_beyond_its_range_is_told_as_a_part_of_it(name, reading, part):
    """A live zero: 0 mA of a 4 to 20 mA sensor reads a quarter of the range below zero."""
    found = own.beyond_range(
        measured(**{'pressure_b': 5e6, name: reading}), SUPPLY, 0.0, CONSTANTS)
    assert found == pytest.approx(part, abs=1e-12)


def test_a_broken_wire_of_the_supply_pressure_is_told():
    """Its transmitter may have any range: above there is none."""
    for pressure, part in ((-0.25 * 25e6, 0.25), (0.0, 0.0), (60e6, 0.0)):
        found = own.beyond_range(measured(), pressure, 0.0, CONSTANTS)
        assert found == pytest.approx(part, abs=1e-12)


def test_a_valve_without_a_spool_sensor_has_no_range_of_it():
    constants = CONSTANTS.copy().view(np.recarray)
    constants.spool_range = 0.0
    assert own.beyond_range(measured(spool=1.0, pressure_a=5e6), SUPPLY, 1.0, constants) == 0.0


@pytest.mark.parametrize(('p_a', 'p_b', 'fed_for', 'part'), [
    (0.0, 0.0, 0.11, 1.0), (0.1e6, 0.0, 0.11, 0.6), (0.0, 0.2e6, 9.0, 0.2),
    (-6.25e6, -6.25e6, 0.11, 1.0),
    (0.25e6, 0.0, 0.11, 0.0), (0.0, 5e6, 0.11, 0.0), (0.0, 0.0, 0.09, 0.0), (0.0, 0.0, 0.0, 0.0)])
def test_both_pressures_at_zero_under_a_supply_are_beyond_a_range(p_a, p_b, fed_for, part):
    """Sensors of 25 MPa: within 1 % of it both, of chambers that had 0.1 s to fill."""
    found = own.beyond_range(
        measured(pressure_a=p_a, pressure_b=p_b), SUPPLY, fed_for, CONSTANTS)
    assert found == pytest.approx(part, abs=1e-12)


@pytest.mark.parametrize('change', [{'supply': 2.5e6}, {'is_open': 0}])
def test_chambers_are_fed_by_a_supply_through_open_lines_without_a_break(change):
    """Sensors of 25 MPa: a supply of 10 % of it. Each break begins the time anew."""
    watched = Watched(only('sensor_range', trip=0.05, delay_ms=2.0, reaction='disable'))
    state, begun = watched.state, 1000 + 19     # 0.1 s, and the delay
    state.measured.pressure_a = state.measured.pressure_b = 0.0
    fed = {'supply': 2.6e6, 'is_open': 1}
    for values, n, trips in ((fed, begun, False), (fed | change, 1, False), (fed, begun, False),
                             (fed, 3, True), (fed | change, 1, True)):
        watched.supply, state.status.is_open = values['supply'], values['is_open']
        watched.convert(n)
        assert watched.has('sensor_range')[1] == trips


def test_the_force_is_compared_with_what_the_valve_can_reach():
    """At rest the stall forces; extending at v less by (A_A^3 + A_B^3) v^2 / K^2 (R17)."""
    stall = AREA_A * SUPPLY
    assert own.force_target(1e5, 0.0, SUPPLY, CONSTANTS) == pytest.approx(stall)
    assert own.force_target(-1e5, 0.0, SUPPLY, CONSTANTS) == pytest.approx(-AREA_B * SUPPLY)
    v = 0.5
    lost = (AREA_A**3 + AREA_B**3) * (v / FLOW_GAIN)**2
    assert own.force_target(1e5, v, SUPPLY, CONSTANTS) == pytest.approx(stall - lost)
    assert own.force_target(1e5, -v, SUPPLY, CONSTANTS) == pytest.approx(stall)
    assert own.force_target(-1e5, -v, SUPPLY, CONSTANTS) == pytest.approx(lost - AREA_B * SUPPLY)
    assert own.force_target(123.0, v, SUPPLY, CONSTANTS) == 123.0


def test_a_motor_cannot_give_what_its_friction_takes():
    """C + D v less where it drives, C on both sides at rest, all where it brakes (R17)."""
    motor = CONSTANTS.copy().view(np.recarray)
    motor.coulomb, motor.viscous = 40.0, 6.0
    for v, above, below in ((0.0, 40.0, 40.0), (0.5, 43.0, 0.0), (-0.5, 0.0, 43.0)):
        for asked, less in ((1e5, -above), (-1e5, below)):
            without = own.force_target(asked, v, SUPPLY, CONSTANTS)
            # a difference of some 8e3 N, rounded to 1e-12
            assert own.force_target(asked, v, SUPPLY, motor) - without == pytest.approx(
                less, abs=1e-9)
    assert own.force_target(123.0, 0.5, SUPPLY, motor) == 123.0


@pytest.mark.parametrize(('velocity', 'distance'), [
    (0.0, 0.03), (0.01, 0.03), (0.1, 0.0), (-0.1, 0.03)])
def test_on_its_way_to_the_reference_a_position_has_no_error(velocity, distance):
    for reference, sign in ((0.05, 1.0), (0.02, -1.0)):
        found = own.position_error(reference, 0.07 - reference, sign * velocity, CONSTANTS)
        assert found == pytest.approx(distance, abs=1e-12)


def swing(force, reference, hertz=80.0, seconds=0.4):
    """Return the last oscillation of a force and a reference of these amplitudes."""
    state = rows_of(1, own.SUPERVISION_STATE)[0]
    for k in range(round(seconds / 1e-4)):
        sine = np.sin(2.0 * np.pi * hertz * k * 1e-4)
        found = own.oscillation(force * sine + 500.0, reference * sine, CONSTANTS, state)
    return found


def test_a_force_that_swings_without_its_reference_oscillates():
    """The mean of a sine is 2/pi of its amplitude; a high-pass of 25 Hz leaves 95 % at 80 Hz."""
    assert swing(1000.0, 0.0) == pytest.approx(0.95 * 1000.0 * 2.0 / np.pi, rel=0.05)
    assert swing(1000.0, 700.0) == 0.0, 'it follows a fast reference'
    assert swing(1000.0, 0.0, hertz=2.0) < 0.15 * 1000.0, 'a slow motion is no oscillation'


@pytest.mark.parametrize(('spool', 'velocity', 'pressures', 'speed'), [
    (1e-4, -0.2, (10e6, 10e6), 0.2), (-1e-4, 0.2, (10e6, 10e6), 0.2),
    (1e-4, 0.2, (10e6, 10e6), 0.0), (-1e-4, -0.2, (10e6, 10e6), 0.0),
    (1e-5, -0.2, (10e6, 10e6), 0.0),                # hardly open
    (1e-4, -0.2, (21e6, 10e6), 0.0),                # pushed back: oil flows to the supply
    (1e-4, -0.2, (10e6, 1e6), 0.0),                 # chamber B is filled from elsewhere
    (-1e-4, 0.2, (10e6, 21e6), 0.0), (-1e-4, 0.2, (1e6, 10e6), 0.0)])
def test_a_motion_against_the_flow_runs_away(spool, velocity, pressures, speed):
    row = measured(spool=spool, pressure_a=pressures[0], pressure_b=pressures[1])
    assert own.runaway(row, velocity, SUPPLY, CONSTANTS) == speed


def test_without_a_spool_sensor_the_current_tells_the_opening():
    constants = CONSTANTS.copy().view(np.recarray)
    constants.spool_range = 0.0
    row = measured(spool=-1.0, current=5e-3)
    assert own.runaway(row, -0.2, SUPPLY, constants) == 0.2
    row.current = 1e-3
    assert own.runaway(row, -0.2, SUPPLY, constants) == 0.0


@pytest.mark.parametrize(('position', 'error'), [
    (0.0004, 0.0), (0.0006, 1000.0), (STROKE - 0.0004, 0.0), (STROKE - 0.0006, 1000.0)])
def test_at_an_end_of_the_stroke_the_stop_takes_the_force(position, error):
    watched = Watched(off())
    state = watched.state
    state.status.acting, state.status.is_on = IMPEDANCE, 1
    state.measured.position, state.force_reference, state.measured.force = position, 1500.0, 500.0
    found = own.supervise(SUPPLY, CONSTANTS, state, watched.own.supervision)
    assert found[1] == pytest.approx(error, abs=1e-9)


@pytest.mark.parametrize(('acting', 'is_on', 'expected'), [
    (POSITION, 1, (0.03, 1000.0)), (IMPEDANCE, 1, (0.0, 1000.0)), (SPOOL, 1, (0.0, 0.0)),
    (POSITION, 0, (0.0, 0.0))])
def test_a_block_that_does_not_act_has_no_error(acting, is_on, expected):
    watched = Watched(off())
    state = watched.state
    state.status.acting, state.status.is_on = acting, is_on
    state.setpoint.position = state.measured.position + 0.03
    state.force_reference, state.measured.force = 1500.0, 500.0
    found = own.supervise(SUPPLY, CONSTANTS, state, watched.own.supervision)
    assert found[:2] == pytest.approx(expected, abs=1e-9)


def test_without_a_force_block_there_is_no_force_error():
    constants = CONSTANTS.copy().view(np.recarray)
    constants.follows_force = 0
    watched = Watched(off())
    state = watched.state
    state.status.acting = POSITION
    state.force_reference, state.measured.force = 1500.0, 500.0
    assert own.supervise(SUPPLY, constants, state, watched.own.supervision)[1] == 0.0


def test_outputs_that_are_off_do_not_let_the_force_oscillate():
    """What pushes the piston of a disabled actuator to and fro is no loop of it."""
    watched = Watched(off())
    state, supervised = watched.state, watched.own.supervision
    for is_on, swings in ((1, True), (0, False)):
        supervised.force_activity, state.status.is_on = 2000.0, is_on
        assert (own.supervise(SUPPLY, CONSTANTS, state, supervised)[2] > 1500.0) == swings


def test_a_stop_has_a_position_error_only_once_it_holds_a_place():
    """Its place is 0 before, and the piston at mid stroke."""
    watched = Watched(off())
    state = watched.state
    state.status.is_on = state.status.is_stopping = 1
    state.status.acting = SPOOL
    assert own.supervise(SUPPLY, CONSTANTS, state, watched.own.supervision)[0] == 0.0
    state.status.flow.is_held, state.status.flow.place = 1, state.measured.position - 2e-3
    found = own.supervise(SUPPLY, CONSTANTS, state, watched.own.supervision)[0]
    assert found == pytest.approx(2e-3, abs=1e-12)
