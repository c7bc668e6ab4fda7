"""Inertial units on the leg: rest, free fall, rotation, finite differences, rates and noise."""

from dataclasses import replace
import math

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.noise import noise_key
from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_REPLY
from isa_ros.errors import ParameterError
from isa_ros.surroundings.bodies.leg import inertial
from isa_ros.surroundings.bodies.leg.inertial import carried, Imu, link_motion, LINKS
from isa_ros.surroundings.bodies.leg.leg import InertialUnit, Leg, LegPose
from isa_ros.surroundings.bodies.leg.motion import ContinuousState, Coordinates
from isa_ros.surroundings.bodies.leg.sheet import body_record
import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation
from tests.legs import leg_sheet

MS = 1_000_000
SHEET = leg_sheet()
BODY = body_record(SHEET.body)[0]
POSE = LegPose(haa=math.radians(13.0), hfe=math.radians(48.0), kfe=math.radians(-95.0),
               foot_height=0.3)
PLACE = {'x_mm': 100.0, 'y_mm': -20.0, 'z_mm': 30.0}


def unit(link: str, rate_hz: float = 1000.0, **values: float) -> InertialUnit:
    """Return a unit named after its link."""
    sheet = Imu(**{'x_mm': 0.0, 'y_mm': 0.0, 'z_mm': 0.0, 'accelerometer_sigma': 0.0,
                   'accelerometer_bias': 0.0, 'gyro_sigma': 0.0, 'gyro_bias': 0.0}
                | values, link=link, rate_hz=rate_hz)
    return InertialUnit(link, sheet, sheet.period_ns(MS, link), noise_key(0, link))


def leg(*units: InertialUnit) -> Leg:
    """Return the shipped leg with some units."""
    return Leg(SHEET, POSE, MS, units=units)


def replies(forces: tuple[float, ...] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Return replies of actuators that push with constant forces."""
    rows = rows_of(3, LOAD_REPLY)
    rows['mean_forces'] = np.array(forces)[:, None]
    rows['force'] = forces
    return rows


def reading(own: Leg, link: str) -> tuple[np.ndarray, np.ndarray]:
    """Return specific force and angular velocity in the sample of a leg."""
    sample = own.sample[0]
    return sample[f'{link}_specific_force'], sample[f'{link}_angular_velocity']


def frames(z: float, angles: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return rotation and origin of each link, written from the URDF's joints."""
    fixed = [Rotation.from_euler('xyz', rpy).as_matrix() for rpy in (
        (math.pi, math.pi / 2, 0.0), (math.pi / 2, 0.0, 0.0), (0.0, 0.0, 0.0))]
    origins = [(0.0, 0.0, 0.0), (BODY.d_hip, -BODY.l_hip, 0.0), (BODY.l_thigh, 0.0, 0.0)]
    turn, place = np.eye(3), np.array([0.0, 0.0, z])
    found = [(turn, place)]
    for joint, origin, angle in zip(fixed, origins, angles):
        place = place + turn @ np.array(origin)
        turn = turn @ joint @ Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()
        found.append((turn, place))
    return found


@pytest.mark.parametrize('link', LINKS)
def test_at_rest_it_reads_g_upwards_in_its_own_axes(link):
    """The held leg is carried by its actuators: f = -R^T g, w = 0."""
    own = leg(unit(link, **PLACE))
    force, turning = reading(own, link)
    turn, _ = frames(0.0, np.array(POSE.joints))[LINKS.index(link)]
    # 1e-9: the joints' forces hold the leg to the rounding of the mass matrix' solution
    assert force == pytest.approx(turn.T @ [0.0, 0.0, STANDARD_GRAVITY], abs=1e-9)
    assert (turning == 0.0).all()


@pytest.mark.parametrize('link', LINKS)
def test_in_free_fall_it_reads_nothing(link):
    """Without forces every link falls with g, and none turns."""
    own = leg(unit(link, **PLACE))
    own.release()
    for _ in range(20):
        own.advance(replies())
    force, turning = reading(own, link)
    assert force == pytest.approx(np.zeros(3), abs=1e-9)
    assert turning == pytest.approx(np.zeros(3), abs=1e-9)


def test_a_turning_joint_adds_the_centripetal_term():
    """HFE alone at w: at r from the axis w^2 r towards it, besides g."""
    w, r = 7.0, 0.25
    y = ContinuousState(z=1.0, q_haa=0.0, q_hfe=0.0, q_kfe=0.0, v_z=0.0, v_haa=0.0, v_hfe=w,
                        v_kfe=0.0, shear_x=0.0, shear_y=0.0)
    force, turning, rate = link_motion(
        LINKS.index('thigh'), y, Coordinates(z=0.0, haa=0.0, hfe=0.0, kfe=0.0), BODY)
    at_r = carried(force, turning, rate, (r, 0.0, 0.0))
    assert at_r == pytest.approx((-STANDARD_GRAVITY - w * w * r, 0.0, 0.0), abs=1e-12)
    assert turning == (0.0, 0.0, w)


@pytest.mark.parametrize('link', range(len(LINKS)), ids=LINKS)
def test_it_reads_the_second_differences_of_its_place(link):
    """The specific force R^T (x'' - g) and w of R^T R', with x and R of the URDF's joints."""
    draw = np.random.default_rng(link)
    h = 1e-4
    for _ in range(20):
        q, v, a = draw.uniform(-1, 1, 4), draw.uniform(-8, 8, 4), draw.uniform(-60, 60, 4)
        place = draw.uniform(-0.3, 0.3, 3)

        def at(t):
            moved = q + v * t + 0.5 * a * t * t
            turn, origin = frames(moved[0], moved[1:])[link]
            return turn, origin + turn @ place

        (before, x_0), (turn, x_1), (after, x_2) = at(-h), at(0.0), at(h)
        f, w, w_rate = link_motion(link, ContinuousState(*q, *v, 0.0, 0.0), Coordinates(*a), BODY)
        # Truncation h^2/12 of the fourth derivative, of the order 8^4 m/s4; roundings eps/h^2.
        expected = turn.T @ ((x_2 - 2.0 * x_1 + x_0) / h**2 + [0.0, 0.0, STANDARD_GRAVITY])
        assert carried(f, w, w_rate, tuple(place)) == pytest.approx(expected, abs=1e-4)
        spin = turn.T @ (after - before) / (2.0 * h)
        assert w == pytest.approx((spin[2, 1], spin[0, 2], spin[1, 0]), abs=1e-4)


def test_a_reading_of_a_moving_leg_is_that_of_its_path():
    """The heights of the slider over ticks of a released leg under its actuators' forces."""
    own = leg(unit('slider_link'))
    own.release()
    pushing = replies(tuple(1.5 * force for force in own.actuator_forces))
    heights, forces = [], []
    for _ in range(40):
        own.advance(pushing)
        heights.append(own.sample['height'][0])
        forces.append(reading(own, 'slider_link')[0][2])
    curved = np.diff(heights, 2) / 1e-6 + STANDARD_GRAVITY
    # A second difference departs by H^2/12 of the fourth derivative of a smooth path, which is
    # below 1e4 m/s4 here: 1e-3 m/s2.
    assert forces[1:-1] == pytest.approx(curved, abs=1e-3)
    assert np.ptp(forces) > 0.1


def test_a_reading_stays_until_the_next_one():
    own = leg(unit('slider_link', rate_hz=100.0, gyro_sigma=1.0))
    seen = []
    for _ in range(30):
        own.advance(replies())
        seen.append(reading(own, 'slider_link')[1][0])
    assert seen[8] != seen[9] == seen[18] != seen[19] == seen[28] != seen[29]


def test_a_rate_that_does_not_divide_into_ticks_is_refused():
    with pytest.raises(ParameterError, match=(
            r'trunk\.rate_hz = 300 Hz, its period must be a multiple of step_ms = 1 ms')):
        replace(unit('hip').sheet, rate_hz=300.0).period_ns(MS, 'trunk')


def test_noise_and_bias_of_every_axis_are_as_configured():
    """At rest; bounds of the mean and the variance of normal numbers, 1e-6 in total."""
    n, sigmas, biases = 4000, (0.03, 6e-4), (0.5, -0.01)
    own = leg(unit('calf', accelerometer_sigma=sigmas[0], accelerometer_bias=biases[0],
                   gyro_sigma=sigmas[1], gyro_bias=biases[1]))
    exact = leg(unit('calf'))
    readings = np.empty((n, 2, 3))
    for k in range(n):
        own._clock['t_ns'] += MS     # a held leg at rest: only time passes
        own._show.run()
        readings[k] = reading(own, 'calf')
    noise = readings - np.array(reading(exact, 'calf'))
    bound = stats.norm.isf(1e-6 / 2 / 12)
    low, high = stats.chi2.ppf([1e-6 / 24, 1 - 1e-6 / 24], n - 1) / (n - 1)
    for axis, (sigma, bias) in enumerate(zip(sigmas, biases)):
        mean, variance = noise[:, axis].mean(axis=0), noise[:, axis].var(axis=0, ddof=1)
        assert np.abs(mean - bias).max() < bound * sigma / math.sqrt(n)
        assert (low < variance / sigma**2).all() and (variance / sigma**2 < high).all()


def test_snapshots_continue_the_readings():
    own, other = (leg(unit('thigh', 100.0, gyro_sigma=0.1)) for _ in range(2))
    for _ in range(17):
        own.advance(replies())
    other.restore(own.snapshot())
    assert other.snapshot() == own.snapshot()
    for _ in range(17):
        own.advance(replies())
        other.advance(replies())
    assert other.snapshot() == own.snapshot()


def test_compiled_readings_equal_their_python_source(monkeypatch):
    y = ContinuousState(0.6, 0.2, 0.7, -1.5, 0.3, 1.0, -4.0, 6.0, 0.0, 0.0)
    a = Coordinates(z=3.0, haa=-20.0, hfe=50.0, kfe=-70.0)
    compiled = [link_motion(link, y, a, BODY) for link in range(4)]
    for name in ('hinged', 'about_z', 'cross', 'carried', 'in_hip_axes', 'in_thigh_axes'):
        monkeypatch.setattr(inertial, name, getattr(inertial, name).py_func)
    assert [link_motion.py_func(link, y, a, BODY) for link in range(4)] == compiled


def test_gyro_and_accelerometer_have_noise_of_their_own():
    """Correlations of six axes, fifteen pairs: of independent ones normal, 1/sqrt(n) wide."""
    n = 4000
    own = leg(unit('calf', accelerometer_sigma=0.03, gyro_sigma=6e-4))
    readings = np.empty((n, 6))
    for k in range(n):
        own._clock['t_ns'] += MS
        own._show.run()
        readings[k] = np.concatenate(reading(own, 'calf'))
    pairs = np.corrcoef(readings.T)[np.triu_indices(6, 1)]
    assert np.abs(pairs).max() < stats.norm.isf(1e-6 / 2 / 15) / math.sqrt(n)
