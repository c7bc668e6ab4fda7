"""Motions: velocity as the derivative of the position, phase as the integral of the frequency."""

import math

from hypothesis import given, strategies as st
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.scenario.waveforms import Chirp, Pulse, SetpointMotion, Sine, Way
import pytest
from scipy.integrate import quad

MS = 1_000_000  # ns
STEP = 1000     # ns, of the central differences


def chirp(sweep: str, moves: str = 'position') -> Chirp:
    """Return 2 to 50 Hz in 3 s."""
    return Chirp(moves=moves, amplitude=0.1, start_hz=2.0, end_hz=50.0, duration_s=3.0,
                 sweep=sweep)


SINE = Sine(moves='position', amplitude=0.35, frequency_hz=1.7)


@given(motion=st.sampled_from([SINE, chirp('linear'), chirp('exponential')]),
       t_ns=st.integers(STEP, 5_000_000_000))
def test_the_velocity_is_the_derivative_of_the_position(motion: SetpointMotion, t_ns: int) -> None:
    """
    Central difference over 1 us, across the end of the sweep too.

    Truncation (1e-6)^2/6 A omega^3 with A = 0.1, omega = 2 pi 50: 5e-7; rounding of a phase
    of 1000 rad, 0.1 1000 2.2e-16/1e-6: 2e-8; at the end of the sweep the frequency's slope
    (below 2 pi 60 rad/s2) jumps, 1e-6/4 of it times A: 1e-5.
    """
    before, after = motion.at(t_ns - STEP).position, motion.at(t_ns + STEP).position
    slope = (after - before) / (2e-9 * STEP)
    assert motion.at(t_ns).velocity == pytest.approx(slope, abs=2e-5)


@pytest.mark.parametrize('sweep', ['linear', 'exponential'])
@pytest.mark.parametrize('t', [0.0, 0.4, 1.7, 3.0, 4.2])
def test_the_phase_of_a_chirp_is_the_integral_of_its_frequency(sweep: str, t: float) -> None:
    """2 pi times the integral of f(t), by adaptive quadrature to 1e-10 of some 1000 rad."""
    def frequency(at: float) -> float:
        part = min(at / 3.0, 1.0)
        return 2.0 + 48.0 * part if sweep == 'linear' else 2.0 * 25.0 ** part

    phase, rate = chirp(sweep).phase(t)
    points = [3.0] if t > 3.0 else None
    assert phase == pytest.approx(
        2.0 * math.pi * quad(frequency, 0.0, t, points=points, epsabs=1e-12)[0],
        rel=1e-10, abs=1e-12)
    # exp and log of another order: a few units of 2.2e-16.
    assert rate == pytest.approx(2.0 * math.pi * frequency(t), rel=1e-14, abs=0.0)


@pytest.mark.parametrize('motion', [
    Sine(moves='effort', amplitude=17.0, frequency_hz=10.0), chirp('linear', 'effort')])
def test_a_motion_of_the_effort_moves_nothing_else(motion: Sine | Chirp) -> None:
    for t_ns in (0, 7 * MS, 31 * MS):
        added = motion.at(t_ns)
        assert added.position == added.velocity == 0.0
    twin = type(motion)(**{**motion.tree(), 'moves': 'position', 'amplitude': 1.0})
    assert added.effort == motion.amplitude * twin.at(t_ns).position != 0.0


def test_a_ramp_goes_at_one_rate_and_stays() -> None:
    """0.3 m in 2 s, and back as far: positions of both signs, and as an effort."""
    for amplitude in (0.3, -0.3):
        way = Way(moves='position', amplitude=amplitude, duration_s=2.0)
        assert way.at(0) == (0.0, 0.5 * amplitude, 0.0)
        assert way.at(500 * MS) == (0.25 * amplitude, 0.5 * amplitude, 0.0)
        assert way.at(2000 * MS) == way.at(10**13) == (amplitude, 0.0, 0.0)
        low, high = sorted((0.0, amplitude))
        assert [end.position for end in way.reach()] == [low, high]
        assert [end.velocity for end in way.reach()] == [0.5 * low, 0.5 * high]
    force = Way(moves='effort', amplitude=40.0, duration_s=4.0)
    assert force.at(3000 * MS) == (0.0, 0.0, 30.0)
    with pytest.raises(ConfigError, match='ramp.duration_s = 4 s, must be '):
        force.refuse_step(3 * MS, 'ramp')


@pytest.mark.parametrize('amplitude', [0.3, -0.3])
@pytest.mark.parametrize('frequencies', [{'frequency_hz': 4.0}, (1.0, 4.0), (4.0, 0.5)])
def test_a_wave_is_at_most_as_fast_as_at_its_highest_frequency(
        amplitude: float, frequencies: dict[str, float] | tuple[float, float]) -> None:
    """No instant is faster, and one is as fast; of an effort no speed is commanded."""
    def wave(moves: str) -> Sine | Chirp:
        if isinstance(frequencies, dict):
            return Sine(moves=moves, amplitude=amplitude, **frequencies)
        start, end = frequencies
        return Chirp(moves=moves, amplitude=amplitude, start_hz=start, end_hz=end, duration_s=3.0,
                     sweep='linear')
    low, high = wave('position').reach()
    assert (low.position, high.position) == (-0.3, 0.3)
    assert (low.velocity, high.velocity) == pytest.approx((-0.3 * 25.1327, 0.3 * 25.1327), 1e-5)
    speeds = [wave('position').at(k * MS).velocity for k in range(4000)]
    assert low.velocity <= min(speeds) and max(speeds) <= high.velocity
    assert max(map(abs, speeds)) > 0.99 * high.velocity
    assert [own[:2] for own in wave('effort').reach()] == [(0.0, 0.0)] * 2


def test_a_pulse_is_up_for_its_width_in_every_period() -> None:
    """Whole ns: after 1e5 periods of 0.1 s the edges are still at their tick."""
    train = Pulse(moves='effort', amplitude=17.0, period_s=0.1, width_s=0.03)
    for start in (0, 100_000 * 100 * MS):
        ups = [train.at(start + k * MS).effort for k in range(100)]
        assert ups == [17.0] * 30 + [0.0] * 70


@pytest.mark.parametrize('make, expected', [
    (lambda: Sine(moves='effort', amplitude=2e8, frequency_hz=1.0), 'must be <= 1e+08'),
    (lambda: Chirp(moves='effort', amplitude=1.0, start_hz=2.0, end_hz=2.0, duration_s=1.0,
                   sweep='linear'), 'Chirp.end_hz = 2 Hz, must differ from start_hz'),
    (lambda: Chirp(moves='effort', amplitude=1.0, start_hz=2.0, end_hz=3.0, duration_s=1.0,
                   sweep='log'), "sweep = 'log', must be one of linear, exponential"),
    (lambda: Pulse(moves='effort', amplitude=1.0, period_s=0.1, width_s=0.1),
     'Pulse.width_s = 0.1 s, must be < period_s = 0.1 s'),
])
def test_a_motion_outside_its_range_is_refused(make, expected: str) -> None:
    with pytest.raises(ParameterError) as caught:
        make()
    assert expected in str(caught.value)


def test_what_the_setpoints_cannot_show_is_refused() -> None:
    """Half the rate of the setpoints is the highest frequency they can carry."""
    SINE.refuse_step(MS, 'sine')
    chirp('linear').refuse_step(10 * MS, 'chirp')
    with pytest.raises(ConfigError, match=r'chirp.end_hz = 50 Hz, must be <= 25 Hz'):
        chirp('linear').refuse_step(20 * MS, 'chirp')
