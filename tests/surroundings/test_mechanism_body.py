"""Ports of a mechanism by probing, against its equations."""

import isa_ros
from isa_ros.core.signals import LOAD_PORT, START
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.mechanism_body import holding_forces, MechanismBody
import numpy as np
import pytest
from tests.surroundings.mass_body import mounting, moving_body, N, replies_of, ROWS, STEP
from tests.surroundings.mass_on_spring import (
    DAMPING, LEVERS, MASS, MassOnSpring, OFFSETS, STIFFNESS, WEIGHT)


def state_of(body: MechanismBody) -> np.ndarray:
    return np.frombuffer(body.snapshot()[-16:])


def test_the_smallest_forces_hold_the_load_at_rest() -> None:
    """J^T f = W, f = J W / J^T J; piston or rotor of each is then where the run file puts it."""
    body = MechanismBody(MassOnSpring(), mounting())
    starts = np.zeros(N, START)
    body.starts(starts)
    assert starts['position'][ROWS] == pytest.approx(OFFSETS, rel=1e-15, abs=0.0)
    assert starts['force'][ROWS] == pytest.approx(LEVERS * WEIGHT / (LEVERS @ LEVERS), rel=1e-9)
    assert not starts['position'][[0, 2, 4]].any()
    assert body.sample['out_force'] == starts['force'][3]
    assert body.units == {
        'out_position': 'm', 'out_velocity': 'm/s', 'out_force': 'N',
        'back_position': 'rad', 'back_velocity': 'rad/s', 'back_force': 'Nm'}


def test_at_rest_its_forces_are_assumed_to_stay() -> None:
    """The means before t = 0 are those at rest: under the same force no slope  (L16)."""
    body = MechanismBody(MassOnSpring(), mounting())
    rest = LEVERS * WEIGHT / (LEVERS @ LEVERS)
    for _ in range(3):
        body.advance(replies_of(np.tile(rest[:, np.newaxis], 5)))
        assert body._kept[0]['slope'] == pytest.approx([0.0, 0.0], abs=1e-6)
        assert body._kept[0]['force'] == pytest.approx(rest, rel=1e-9)


def test_the_forces_of_a_tick_are_continued_into_the_next() -> None:
    """Means on a line of 3 N and -5 N a window: its slope, and its value at the end  (L16)."""
    body = moving_body(False)
    slope = np.array([3.0, -5.0]) * 5 / STEP
    assert body._kept[0]['slope'] == pytest.approx(slope, rel=1e-9)
    assert body._kept[0]['force'] == pytest.approx(
        np.array([500.0 + 270.0 + 6.0, 200.0 - 10.0]) + 0.5 * STEP * slope, rel=1e-9)


def test_forces_at_rest_are_found_where_forces_do_not_add_up() -> None:
    """A load that gives way as F + 1e-4 F^2: one round of probes from 0 leaves 0.3 m/s2."""
    class Yielding(MassOnSpring):
        """Its first actuator has more than its force."""

        def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
            """Return it."""
            return super().motion(state, forces + [1e-4 * forces[0] ** 2, 0.0])
    forces = holding_forces(Yielding(), 2)
    assert LEVERS @ (forces + [1e-4 * forces[0] ** 2, 0.0]) == pytest.approx(WEIGHT, rel=1e-6)


def test_a_load_that_no_actuator_holds_is_refused() -> None:
    class Free(MassOnSpring):
        """Its second actuator has no lever, and falls."""

        def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
            """Return it."""
            own = super().motion(state, forces)
            return own._replace(acceleration=np.array([own.acceleration[0], -9.8]))
    with pytest.raises(ConfigError, match=r'no forces .* accelerate by .*, -9.8 m/s2 \| rad/s2'):
        holding_forces(Free(), 2)


@pytest.mark.parametrize('has_response', [False, True])
def test_ports_are_those_of_the_equation(has_response: bool) -> None:
    """
    1/m_eff = J_i^2/m, k = k/m, d = c/m along the motion of each actuator; rest is 0.

    Probes of 1 N are exact but for rounding; those of 1e-7 m and 1e-5 m/s leave 1e-8 and 1e-10.
    """
    body = moving_body(has_response)
    ports = np.full(N, -1.0, LOAD_PORT)
    body.ports(ports)
    own, (q, v) = ports[ROWS], state_of(body)
    assert own['x0'] == pytest.approx(OFFSETS + LEVERS * q, rel=1e-14, abs=0.0)
    assert own['v0'] == pytest.approx(LEVERS * v, rel=1e-14, abs=0.0)
    assert own['inverse_mass'] == pytest.approx(LEVERS ** 2 / MASS, rel=1e-9)
    assert own['stiffness'] == pytest.approx(
        [STIFFNESS / MASS * has_response] * 2, rel=1e-6, abs=1e-12)
    assert own['damping'] == pytest.approx(
        [DAMPING / MASS * has_response] * 2, rel=1e-6, abs=1e-12)
    assert (ports[[0, 2, 4]] == np.full(3, -1.0, LOAD_PORT)).all()


@pytest.mark.parametrize('has_response', [False, True])
def test_a_copy_ends_the_tick_where_the_mechanism_does(has_response: bool) -> None:
    """
    Under the assumed forces, F + F' t (L16), both give the same place and speed  (L15).

    The copy is integrated here in 2000 steps (RK4: below 1e-12 m), the mechanism exactly, with
    five constant forces for the line: equal means, so 1e-8 m at 5 mm/ms, 1e-6 m/s at 1 m/s.
    """
    body = moving_body(has_response)
    ports = np.zeros(N, LOAD_PORT)
    body.ports(ports)
    kept = body._kept[0]
    later = body._mechanism.stepped(
        state_of(body), kept['force'][:, None].T + np.outer(
            (np.arange(5) + 0.5) * STEP / 5, kept['slope']), STEP)
    end = body._mechanism.motion(later, kept['force'])
    for j, row in enumerate(ROWS):
        port, y, h = ports[row], np.array([ports[row]['x0'], ports[row]['v0']]), STEP / 2000

        def rate(t: float, y: np.ndarray) -> np.ndarray:
            e = y - [port['x0'] + t * (port['v0'] + 0.5 * t * port['a0']),  # noqa: B023
                     port['v0'] + t * port['a0']]  # noqa: B023
            force = kept['force'][j] + t * kept['slope'][j]  # noqa: B023
            return np.array([y[1], port['a_bias'] + t * port['jerk']  # noqa: B023
                             + port['inverse_mass'] * force  # noqa: B023
                             - port['stiffness'] * e[0] - port['damping'] * e[1]])  # noqa: B023
        for n in range(2000):
            t = n * h
            k_1 = rate(t, y)
            k_2 = rate(t + h / 2, y + h / 2 * k_1)
            k_3 = rate(t + h / 2, y + h / 2 * k_2)
            y = y + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + rate(t + h, y + h * k_3))
        assert y[0] == pytest.approx(end.position[j], rel=0.0, abs=1e-8)
        assert y[1] == pytest.approx(end.velocity[j], rel=0.0, abs=1e-6)


@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_at_a_dead_centre_the_port_stays_bounded(sign: float) -> None:
    """A lever of 1e-7: k and d per its metre are without bounds, and cut to those of a tick."""
    class DeadCentre(MassOnSpring):
        """Its first actuator hardly moves the cart, and its lever changes with the place."""

        def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
            """Return it."""
            own, (q, v) = super().motion(state, forces), state
            lever = 1e-7 + sign * 0.5 * q
            return own._replace(
                position=np.array([own.position[0], own.position[1]]),
                acceleration=np.array([lever * own.generalised[0] - sign * (40.0 * q + 9e3 * v),
                                       own.acceleration[1]]))
    mechanism = DeadCentre()
    mechanism.state = np.array([0.0, 0.1])
    body = MechanismBody.__new__(MechanismBody)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr('isa_ros.surroundings.mechanism_body.holding_forces',
                      lambda mechanism, k: np.zeros(k))
        body.__init__(mechanism, mounting(), has_response=True)  # type: ignore[misc]
    ports = np.zeros(N, LOAD_PORT)
    body.ports(ports)
    first = ports[ROWS[0]]
    assert first['stiffness'] == pytest.approx(sign * np.pi ** 2 / STEP ** 2, rel=1e-12)
    assert first['damping'] == pytest.approx(sign / STEP, rel=1e-12)
    assert abs(ports[ROWS[1]]['stiffness']) < 1e5


def test_where_a_force_moves_nothing_the_port_has_no_response() -> None:
    """At the dead centre itself: 1/m = 0, and no direction to probe along."""
    class Blocked(MassOnSpring):
        """Its first actuator has no lever, and another motion."""

        def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
            """Return it."""
            own = super().motion(state, np.array([0.0, forces[1]]))
            return own._replace(acceleration=np.array([-5.0 * state[0], own.acceleration[1]]))
    body = MechanismBody(Blocked(), mounting(), has_response=True)
    ports = np.zeros(N, LOAD_PORT)
    body.ports(ports)
    first, second = ports[ROWS]
    assert [first['inverse_mass'], first['stiffness'], first['damping']] == [0.0, 0.0, 0.0]
    assert second['stiffness'] == pytest.approx(STIFFNESS / MASS, rel=1e-6)


def test_it_advances_by_its_own_step_and_goes_on_from_a_snapshot() -> None:
    body, twin = moving_body(False), moving_body(False)
    kept = body.snapshot()
    means = np.array([[900.0] * 5, [-100.0] * 5])
    before = state_of(body).copy()
    body.advance(replies_of(means))
    assert state_of(body).tolist() == MassOnSpring().stepped(before, means.T, STEP).tolist()
    assert body.sample['out_force'] == 900.0 and body.sample['back_force'] == -100.0
    after = body.snapshot()
    body.restore(kept)
    assert body.snapshot() == kept != after
    assert body.sample == twin.sample
    body.advance(replies_of(means))
    assert body.snapshot() == after
    ports = np.zeros((2, N), LOAD_PORT)
    twin.advance(replies_of(means))
    body.ports(ports[0])
    twin.ports(ports[1])
    assert ports[0].tobytes() == ports[1].tobytes()


def test_a_state_that_is_not_finite_ends_the_run() -> None:
    body = moving_body(False)
    with pytest.raises(SimulationDiverged, match=r'MassOnSpring: state\[0\] = nan') as caught:
        body.advance(replies_of(np.full((2, 5), np.nan)))
    assert caught.value.t_ns == 5_000_000


def test_a_look_ahead_that_is_not_finite_ends_the_run() -> None:
    """At the start of the tick for which it is made; a state at t = 0 likewise."""
    body = moving_body(False)
    own = MassOnSpring.stepped
    body._mechanism.stepped = lambda *given: np.array([own(body._mechanism, *given)[0], np.inf])
    with pytest.raises(SimulationDiverged, match=r'MassOnSpring: state\[1\] = inf') as caught:
        body.ports(np.zeros(N, LOAD_PORT))
    assert caught.value.t_ns == 4_000_000
    mechanism = MassOnSpring()
    mechanism.state = np.array([0.0, np.nan])
    with pytest.raises(SimulationDiverged, match=r'state\[1\] = nan at t = 0.000000 s'):
        MechanismBody(mechanism, mounting())
