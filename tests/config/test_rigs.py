"""The shipped scenarios of both rigs show what the paper's figures show."""

import math

from isa_ros.scripting.run import load
import numpy as np
import pytest

GRAVITY = 9.80665
PULL = 5.0 * GRAVITY * 0.2   # weight on the rim, Nm
STALL = 170.0                # paper Table 2, Nm
TAUT_S = 0.1 + (2.0 * 0.16 / GRAVITY) ** 0.5  # released at 0.1 s, through the slack
LAST = slice(-200, None)     # the last 0.2 s


@pytest.fixture(scope='module')
def drops():
    """Return (t, deflection, torque) of the three drops by their stiffness in Nm/rad."""
    found = {}
    for stiffness, name in ((150.0, 'weight_soft'), (300.0, 'weight'), (600.0, 'weight_stiff')):
        result = load('rig_rotary', name).simulate()
        position = result['rotor.position']
        found[stiffness] = result.time, position[0] - position, result['rotor.force']
    return found


@pytest.mark.parametrize('stiffness', [150.0, 300.0, 600.0])
def test_weight_ends_where_the_impedance_carries_it(drops, stiffness):
    """Deflection m g R / stiffness, 32.7 mrad at 300 Nm/rad, +-5 %; torque m g R."""
    _, turned, torque = drops[stiffness]
    assert turned[LAST].mean() == pytest.approx(PULL / stiffness, rel=0.05)
    assert torque[LAST].mean() == pytest.approx(PULL, rel=0.05)


def test_weight_settles_within_0_6_s(drops):
    """At 300/20, within 5 % of the final deflection, counted from the instant the rope is taut."""
    t, turned, _ = drops[300.0]
    final = turned[LAST].mean()
    last_outside = np.flatnonzero(np.abs(turned - final) > 0.05 * final)[-1]
    assert t[last_outside + 1] - TAUT_S < 0.6


def test_stiffer_gains_bear_higher_peaks(drops):
    """Paper Fig 18: 150/10 below 300/20 below 600/30, all below the stall torque."""
    soft, middle, stiff = (drops[k][2].max() for k in (150.0, 300.0, 600.0))
    assert PULL < soft < middle < stiff < STALL


def test_nothing_is_felt_before_the_rope_is_taut(drops):
    """While held and in free fall the torque is within a sensor code, 200 Nm over 2048."""
    t, _, torque = drops[300.0]
    assert np.abs(torque[t < TAUT_S]).max() <= 200.0 / 2048.0


def test_pure_position_control_bears_the_weight_worse(drops):
    """Paper Fig 17: without a torque loop twice the torque, and it takes longer to settle."""
    result = load('rig_rotary_position', 'weight').simulate()
    assert not result['rotor.force_reference'].any()
    assert result['rotor.force'].max() > 2.0 * drops[300.0][2].max()
    position = result['rotor.position']
    turned = position[0] - position[result.time > TAUT_S + 0.6]
    assert np.abs(turned - turned[LAST].mean()).max() > 0.05 * turned[LAST].mean()


def test_impacts_stay_below_the_stall_torque():
    """Paper Fig 15: the wheel hits both stops repeatedly, below 170 Nm, with spikes."""
    result = load('rig_rotary', 'impact').simulate()
    position, reference = result['rotor.position'], result['rotor.force_reference']
    assert np.abs(result['rotor.force']).max() < STALL
    for beyond in (position < 0.0873, position > 1.6577):
        assert np.count_nonzero(np.diff(beyond.astype(int)) == 1) >= 3
    # The stop absorbs at least 1 rad/s, times 20 Nms/rad; half of that in one period.
    assert np.abs(np.diff(reference[result.time > 2.2])).max() > 10.0


@pytest.mark.parametrize(('name', 'base', 'step'), [
    ('force_step_low', 200.0, 500.0), ('force_step_high', 1000.0, 3000.0)])
def test_knee_s_force_follows_its_step_with_the_foot_on_the_pallet(name, base, step):
    """
    Paper Fig 14: steady within 10 N before, during and after the step; the foot stands.

    The foot begins in contact and carries load from the first reference on. Under the
    step its force is, by virtual work, the knee's torque over its distance from the knee.
    Neglected are the shank's weight (below 2 Nm) and friction at the foot, below a fifth of the
    load, at the knee's height of 0.3 m, against 0.24 m of distance.
    """
    result = load('rig_knee', name).simulate()
    t, normal = result.time, result['body.foot_force'][:, 2]
    for until, level in ((0.3, base), (0.7, step), (1.0, base)):
        steady = (t > until - 0.05) & (t < until)
        assert result['kfe.force'][steady].mean() == pytest.approx(level, abs=10.0)
    assert normal[t > 0.02].min() > 0.0
    at = np.searchsorted(t, 0.69)
    _, hfe, kfe = result['body.position'][at]
    reach = 0.38 * math.sin(-hfe - kfe)
    assert normal[at] == pytest.approx(result['body.torque'][at, 2] / reach, rel=0.25)


def test_knee_follows_its_sine_in_the_air():
    """Paper Fig 19: the piston within 5 % of the amplitude rms; the foot touches nothing."""
    result = load('rig_knee', 'knee_sine').simulate()
    position, late = result['kfe.position'], result.time > 1.1
    error = (position - result['kfe.position_reference'])[late]
    assert np.sqrt(np.mean(error * error)) < 0.05 * 0.01
    assert np.ptp(position[late]) == pytest.approx(0.02, rel=0.05)
    assert not result['body.foot_force'].any()


def test_knee_rig_bears_the_drop():
    """Paper Fig 20: 10 cm onto wood, knee peak above 2 kN and below its 7500 N; it stands."""
    result = load('rig_knee', 'drop').simulate()
    normal = result['body.foot_force'][:, 2]
    assert 2000.0 < result['kfe.force'].max() < 7500.0
    # A whole period of its decaying swing, 2 Hz: the mean is the weight except for the decay.
    assert normal[-500:].mean() == pytest.approx(15.2 * GRAVITY, rel=0.1)


def test_leg_of_hyq_lands_and_stands():
    """A drop of 10 cm on two ISA v2: below their 4000 N, then the weight of 11.449 kg."""
    result = load('hyq_leg', 'drop').simulate()
    normal = result['body.foot_force'][:, 2]
    for name in ('hfe', 'kfe'):
        assert 500.0 < np.abs(result[f'{name}.force']).max() < 4000.0
    assert normal[LAST].mean() == pytest.approx(11.449 * GRAVITY, rel=0.01)
