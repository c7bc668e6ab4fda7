"""The law of a stop, R16, piece by piece; tests/actuator/test_stops.py has whole stops."""

from collections.abc import Callable
import math

from isa_ros.core.record import row_record, rows_of
from isa_ros.reu import flow_stop as own
import numpy as np
import pytest
from scripts.measure_stops import memory_of, rig, simulation_of

SUPPLY = 20.7e6


@pytest.fixture(scope='module')
def setup() -> np.recarray:
    """Return the `FLOW_STOP` record of an ISA v5; tests change copies of it."""
    rules = memory_of(simulation_of(rig()), 'ram').constants['reu']['rules']
    return row_record(rules['flow'].copy())


def begun(setup: np.recarray, position: float = 0.05, velocity: float = 0.0,
          force: float = 0.0) -> np.recarray:
    """Return the state of a stop that has begun."""
    state = rows_of(1, own.FLOW_STOP_STATE)[0]
    own.begin_flow_stop(position, velocity, force, setup, state)
    return state


def periods(setup: np.recarray, seconds: float) -> int:
    return round(seconds / setup.period)


def test_a_load_that_the_ramp_has_left_behind_is_held_once_it_turns(setup: np.recarray) -> None:
    """Before, the loop would pull back to a place that it is leaving; 0.1 s at most."""
    state = begun(setup)
    slow = 0.9 * setup.deceleration * setup.lag
    for velocity, rests in ((2.0 * slow, False), (-2.0 * slow, False), (slow, True)):
        own.holding_speed(0.05, velocity, setup, state)
        assert (state.rest > 0.0) == rests
    state = begun(setup)
    state.since_ramp = periods(setup, own.TURNING) - 1
    own.holding_speed(0.05, 1.0, setup, state)
    assert state.rest == 0.0
    state.since_ramp += 1
    own.holding_speed(0.05, 1.0, setup, state)
    assert state.rest == setup.period
    own.holding_speed(0.05, 1.0, setup, state)      # it does not begin to wait again
    assert state.rest == pytest.approx(2.0 * setup.period)


def test_the_held_place_is_the_mean_after_the_load_has_settled(setup: np.recarray) -> None:
    """Of 20 ms that begin 10 ms after the ramp; before that what it does is not looked at."""
    state = begun(setup)
    settling, averaging = periods(setup, own.SETTLING), periods(setup, own.AVERAGING)
    for _ in range(settling):
        assert own.holding_speed(0.09, 0.0, setup, state) == 0.0
    for k in range(averaging):
        assert own.holding_speed(0.05 + 1e-4 * (-1)**k, 0.0, setup, state) == 0.0
    assert state.is_held == 0
    own.holding_speed(0.05, 0.0, setup, state)
    assert state.is_held == 1 and state.place == pytest.approx(0.05, abs=2e-6)


def held(setup: np.recarray, error: float, n: int) -> tuple[np.recarray, list[float]]:
    """Return the state and the speeds of a place that is held, with a constant error in m."""
    state = begun(setup)
    state.rest, state.place = 1.0, 0.05
    return state, [own.holding_speed(0.05 - error, 0.0, setup, state) for _ in range(n)]


def test_the_position_loop_is_proportional_and_integral_and_bounded(setup: np.recarray) -> None:
    """K e + K_i e t with K a quarter of D/T and K_i = K^2/8; at most the speed about null."""
    k = own.HOLD_SHARE * own.DAMPING / setup.lag
    n, error = 4000, 1e-5
    _, speeds = held(setup, error, n)
    lag = setup.lag / own.DAMPING    # of the error's low-pass, which delays the integral as well
    expected = k * error + k * k / 8.0 * error * (n * setup.period - lag)
    assert speeds[-1] == pytest.approx(expected, rel=2e-3)
    for sign in (1.0, -1.0):
        state, speeds = held(setup, sign * 0.02, n)
        assert speeds[-1] == sign * setup.largest
        assert state.integral == sign * setup.largest


def test_the_ramp_takes_off_its_deceleration_and_ends_with_a_constant_jerk(
        setup: np.recarray) -> None:
    """Near rest a is that far from it times sqrt(v / rounding): v is a parabola of time."""
    state = begun(setup, velocity=0.5)
    for sign in (1.0, -1.0):
        after = own.stopping_speed(sign * 0.5, sign * 0.5, setup, state)
        assert after == pytest.approx(sign * (0.5 - setup.deceleration * setup.period))
        near = sign * 0.25 * setup.rounding
        after = own.stopping_speed(near, near, setup, state)
        assert near - after == pytest.approx(
            sign * 0.5 * setup.deceleration * setup.period)
    speed, n = setup.rounding, 0
    while speed > 0.0:
        speed, n = own.stopping_speed(speed, speed, setup, state), n + 1
    assert n * setup.period == pytest.approx(2.0 * setup.rounding / setup.deceleration, rel=0.02)


def test_the_ramp_does_not_drive_what_is_slower_than_it_was_estimated(
        setup: np.recarray) -> None:
    most = own.SPEED_MARGIN * setup.deceleration * setup.lag
    state = begun(setup, velocity=0.5)
    for sign in (1.0, -1.0):
        assert own.stopping_speed(sign * 0.5, sign * 0.1, setup, state) == pytest.approx(
            sign * (0.1 + most))
        assert own.stopping_speed(sign * 0.5, -sign * 0.1, setup, state) == pytest.approx(
            sign * most)


@pytest.mark.parametrize(('position', 'velocity', 'room'), [
    (0.09, 0.6, 0.01), (0.01, -0.6, 0.01), (0.09, -0.6, 0.09), (0.01, 0.6, 0.09)])
def test_in_front_of_an_end_the_deceleration_is_that_of_the_room(
        setup: np.recarray, position: float, velocity: float, room: float) -> None:
    """v^2 / 2 (room - 2 % of the stroke - v T), never less than the declared one."""
    found = own.stop_deceleration(position, velocity, setup)
    left = room - 0.02 * setup.model.stroke - 0.6 * setup.lag
    assert found == pytest.approx(max(setup.deceleration, 0.18 / left))


def test_without_room_it_stops_within_a_period(setup: np.recarray) -> None:
    assert own.stop_deceleration(0.0985, 0.3, setup) == pytest.approx(0.3 / setup.period)


def drops(speed: float, model: np.recarray) -> float:
    """Return the force that the lands take from the piston at a speed, N (V7 at rest)."""
    a, b = model.area_a, model.area_b
    if speed > 0.0:
        return a**3 / model.f_pa**2 + b**3 / model.f_bt**2
    return a**3 / model.f_at**2 + b**3 / model.f_pb**2


@pytest.mark.parametrize('speed', [0.2, -0.2])
def test_the_opening_for_a_speed_follows_from_the_drops_at_both_lands(
        setup: np.recarray, speed: float) -> None:
    """A force against the motion opens as the root of the drop that is left, up to sqrt(2)."""
    stall = SUPPLY * (setup.model.area_a if speed > 0.0 else setup.model.area_b)
    against = math.copysign(1.0, speed)
    free = own.opening_for_speed(speed, 0.0, SUPPLY, setup)
    assert math.copysign(1.0, free) == against
    spool: Callable[[float, float], float] = lambda v, drop: own.opening_of(
        abs(v) * math.sqrt(drops(v, setup.model) / drop) / setup.model.per_root_drop,
        setup.model) * setup.model.output_per_spool
    assert abs(free) == pytest.approx(spool(speed, stall))
    for share in (0.3, -0.3):
        loaded = own.opening_for_speed(speed, against * share * stall, SUPPLY, setup)
        assert abs(loaded) == pytest.approx(spool(speed, (1.0 - share) * stall))
    for share in (0.5, 0.9, 2.0):
        loaded = own.opening_for_speed(speed, against * share * stall, SUPPLY, setup)
        assert abs(loaded) == pytest.approx(spool(speed, 0.5 * stall))
    assert own.opening_for_speed(0.0, 1e3, SUPPLY, setup) == 0.0


def test_a_supply_of_nothing_still_has_an_opening(setup: np.recarray) -> None:
    """It is that of 1 bar: a number, whatever has become of the supply."""
    for pressure in (0.0, -1e5):
        found = own.opening_for_speed(0.1, 0.0, pressure, setup)
        assert found == own.opening_for_speed(0.1, 0.0, own.LEAST_SUPPLY, setup) > 0.0


def test_a_fast_force_is_damped_and_a_slow_one_is_borne(setup: np.recarray) -> None:
    """A force that jumps takes C F off the speed at once, and nothing later."""
    state = begun(setup)
    first = own.flow_stop_step(0.0, 0.05, 1.0, 1000.0, SUPPLY, setup, state)
    assert first < 0.0      # it gives way to a force that pushes out
    gain = setup.damping * setup.schedule[(own.POINTS - 1) // 2]    # at mid stroke
    assert first == pytest.approx(own.opening_for_speed(
        -gain * (1000.0 - state.slow_force), state.force, SUPPLY, setup))
    assert abs(state.force) < 0.05 * 1000.0     # which is not the one that damps
    for _ in range(periods(setup, 0.5)):
        last = own.flow_stop_step(0.0, 0.05, 1.0, 1000.0, SUPPLY, setup, state)
        state.rest = 0.0
    assert abs(last) < 0.02 * abs(first)


def watched(setup: np.recarray, positions: list[float]) -> np.recarray:
    state = begun(setup, positions[0])
    for position in positions:
        own.watch_rest(position, setup, state)
    return state


def test_it_stands_that_has_stayed_within_its_span_for_20_ms(setup: np.recarray) -> None:
    """A span moves with what leaves it; what keeps moving is waited for by a second."""
    n = periods(setup, own.REST_TIME)
    assert not own.stands(setup, watched(setup, [0.05] * (n - 1)))
    assert own.stands(setup, watched(setup, [0.05] * n))
    swinging = [0.05 + 0.49 * setup.span * (-1)**k for k in range(n)]
    assert own.stands(setup, watched(setup, swinging))
    leaving = [0.05] * n + [0.05 + 1.01 * setup.span]
    assert not own.stands(setup, watched(setup, leaving))
    assert own.stands(setup, watched(setup, leaving + leaving[-1:] * n))
    for way in (1.0, -1.0):
        creeping = [0.05 + way * 0.2 * setup.span * k for k in range(4 * n)]
        assert not own.stands(setup, watched(setup, creeping))
    state = watched(setup, [0.05, 0.06])
    state.since_ramp = periods(setup, own.LONGEST) + n - 1
    assert not own.stands(setup, state)
    state.since_ramp += 1
    assert own.stands(setup, state)


def test_the_record_follows_from_the_lag_and_the_softest_oil(setup: np.recarray) -> None:
    stiffness = np.linspace(2e7, 5e7, own.POINTS)
    found = own.flow_stop_record(setup.model, stiffness, 3e-3, 0.02, 1e-4, 10.0, 1e-6)
    crossover = 0.15 / 3e-3
    assert found['damping'] == pytest.approx(crossover / 2e7)
    assert list(found['schedule']) == pytest.approx(list(2e7 / stiffness))
    assert found['hold'] == pytest.approx(crossover / 4.0)
    assert found['integral'] == pytest.approx(crossover**2 / 128.0)
    assert found['rounding'] == pytest.approx(0.8 * 10.0 / crossover)
    assert (found['turning'], found['window'], found['longest']) == (1000.0, 200.0, 10000.0)
    assert found['span'] == pytest.approx(1e-3 * setup.model.stroke)
    coarse = own.flow_stop_record(setup.model, stiffness, 3e-3, 0.02, 1e-4, 10.0, 1e-3)
    assert coarse['span'] == 2e-3
