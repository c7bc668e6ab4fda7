"""Weight on a rope: free fall, energy, the blocked wheel's torque, release on the grid."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ParameterError
from isa_ros.loads import drop_rig
from isa_ros.loads.drop_rig import rope_record, WEIGHT_STATE
import numpy as np
import pytest
from tests.sheets import own_load, setpoint, smart_actuator

SHEET = own_load('smart_manifold', 'drop_rig')
WEIGHT_N = SHEET.weight_kg * STANDARD_GRAVITY
TAUT_SPEED = math.sqrt(2.0 * STANDARD_GRAVITY * SHEET.slack)  # at the end of the slack


def weight(fall=0.0, velocity=0.0, is_released=1.0):
    """Return one `WEIGHT_STATE`."""
    return record(WEIGHT_STATE, fall=fall, velocity=velocity, is_released=is_released)


def fallen(duration, sheet=SHEET, inertia=math.inf):
    """
    Return (t, turn, wheel speed, fall, speed, torque) of a release at t = 0 onto a free wheel.

    Classical Runge-Kutta with the plant's step; a blocked wheel has an infinite inertia.
    """
    row, state, rates = rope_record(sheet), weight(), weight()

    def slope(y):
        state.fall, state.velocity = y[2], y[3]
        torque = drop_rig.weight_rates(y[0], y[1], state, row, rates)
        return np.array([y[1], torque / inertia, rates.fall, rates.velocity]), torque
    y, h, rows = np.zeros(4), PLANT_STEP, []
    for k in range(round(duration / h)):
        k1, torque = slope(y)
        rows.append((k * h, *y, torque))
        k2, _ = slope(y + 0.5 * h * k1)
        k3, _ = slope(y + 0.5 * h * k2)
        k4, _ = slope(y + h * k3)
        y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return np.array(rows).T


def test_slack_rope_lets_the_weight_fall_freely():
    """L17, L19: w = g t^2/2 until the slack is gone; RK4 is exact for a parabola."""
    t, _, _, fall, _, torque = fallen(0.15)
    assert (torque == 0.0).all()
    assert fall == pytest.approx(0.5 * STANDARD_GRAVITY * t * t, abs=1e-14)
    assert fall[-1] < SHEET.slack


def test_blocked_wheel_sees_more_than_the_paper_s_250_nm():
    """
    Section 5.1 of the paper; without damping R (m g + sqrt((m g)^2 + k m v^2)).

    The damping reduces the swing by less than exp(-zeta phi), phi = pi/2 + asin(m g/swing)
    its angle from rope taut to the deepest point.
    """
    peak = -fallen(0.25)[5].min()
    swing = math.sqrt(WEIGHT_N * WEIGHT_N + SHEET.rope_stiffness * SHEET.weight_kg
                      * TAUT_SPEED * TAUT_SPEED)
    zeta = 0.5 * SHEET.rope_damping / math.sqrt(SHEET.rope_stiffness * SHEET.weight_kg)
    assert peak > 250.0
    assert peak < SHEET.radius * (WEIGHT_N + swing)
    angle = 0.5 * math.pi + math.asin(WEIGHT_N / swing)
    assert peak > SHEET.radius * (WEIGHT_N + swing * math.exp(-zeta * angle))


def test_energy_is_kept_by_a_rope_without_damping():
    """
    Weight, wheel and stretched rope exchange their energy, fallen height counted negative.

    At the step in which the rope gets taut or slack the force's slope changes by k v: the
    error is below k v h^2/m in speed and k v^2 h^2 = 1.3e-4 J in energy; six such steps.
    """
    sheet = replace(SHEET, rope_damping=0.0)
    _, turn, spin, fall, speed, _ = fallen(0.6, sheet, SHEET.inertia)
    stretch = np.maximum(0.0, fall + SHEET.radius * turn - SHEET.slack)
    energy = (0.5 * SHEET.inertia * spin * spin + 0.5 * SHEET.weight_kg * speed * speed
              - WEIGHT_N * fall + 0.5 * SHEET.rope_stiffness * stretch * stretch)
    passes = np.count_nonzero(np.diff((stretch > 0.0).astype(int)))
    assert 1 <= passes <= 6
    assert np.abs(energy).max() < passes * 1.3e-4
    assert (0.5 * SHEET.inertia * spin * spin).max() > 1.0


def test_damped_rope_brings_the_weight_to_rest():
    """
    L18: on a blocked wheel the weight comes to rest at w = slack + m g/k.

    zeta = 0.5 gives 0.16 of the speed back at each bounce: the fourth lasts 1.5 ms. From 0.3 s
    on the swing at 141 rad/s falls to exp(-0.5 * 141 * 0.5 s) = 5e-16.
    """
    damping = math.sqrt(SHEET.rope_stiffness * SHEET.weight_kg)
    _, _, _, fall, speed, torque = fallen(0.8, replace(SHEET, rope_damping=damping))
    assert torque[-1] == pytest.approx(-SHEET.radius * WEIGHT_N, rel=1e-6)
    assert fall[-1] == pytest.approx(SHEET.slack + WEIGHT_N / SHEET.rope_stiffness, abs=1e-9)
    assert abs(speed[-1]) < 1e-6


@given(turn=st.floats(-0.8, 0.8), speed=st.floats(-10.0, 10.0), fall=st.floats(-0.1, 0.5),
       velocity=st.floats(-5.0, 5.0), is_released=st.sampled_from([0.0, 1.0]))
def test_rope_pulls_and_never_pushes(turn, speed, fall, velocity, is_released):
    """L18, L20: T >= 0, the rope pulls the wheel towards smaller angles only; jit == Python."""
    row, state, rates = rope_record(SHEET), weight(fall, velocity, is_released), weight()
    torque = drop_rig.weight_rates(turn, speed, state, row, rates)
    assert torque <= 0.0
    assert torque == 0.0 or fall + SHEET.radius * turn > SHEET.slack
    assert rates.velocity <= STANDARD_GRAVITY
    if not is_released:
        assert rates.velocity == 0.0
    for name in ('rope_tension', 'rope_stretch'):
        kernel = getattr(drop_rig, name)
        arguments = (turn, fall, row) if name == 'rope_stretch' else (turn, speed, state, row)
        assert kernel(*arguments) == kernel.py_func(*arguments)
    before = (torque, rates.fall, rates.velocity)
    assert drop_rig.weight_rates.py_func(turn, speed, state, row, rates) == before[0]
    assert (rates.fall, rates.velocity) == before[1:]


def test_weight_waits_in_the_hand_for_its_plant_step():
    """The release comes at release_s to the step: 3 steps later it has fallen g (3 h)^2 / 2."""
    actuator = smart_actuator(
        'smart_manifold', replace(SHEET, release_s=0.00202))  # 101 plant steps
    for _ in range(20):
        actuator.tick()
    assert actuator._body.load.weight.fall == 0.0
    actuator.tick()  # to 105 plant steps
    assert actuator._body.load.weight.fall == pytest.approx(
        0.5 * STANDARD_GRAVITY * (4.0 * PLANT_STEP) ** 2, rel=1e-12, abs=0.0)


def test_restored_rig_continues_byte_for_byte():
    """A snapshot holds the falling weight."""
    rig, twin = (smart_actuator('smart_manifold', replace(SHEET, release_s=0.01))
                 for _ in range(2))
    rig.accept(setpoint(position=0.8725, stiffness=300.0, damping=20.0))
    for _ in range(2000):  # 0.2 s: the rope is taut from 0.19 s on
        rig.tick()
    assert rig.reply.force > 1.0
    twin.restore(rig.snapshot())
    for _ in range(100):
        rig.tick()
        twin.tick()
    assert rig.snapshot() == twin.snapshot()


@pytest.mark.parametrize(('name', 'value', 'message'), [
    ('release_s', 0.10001, r'DropRig\.release_s = 0\.10001 s, must be a multiple .* 0\.02 ms'),
    ('release_s', -0.1, r'release_s = -0\.1 s, must be >= 0 s'),
    ('slack', -0.1, r'slack = -0\.1 m, must be >= 0 m'),
    ('weight_kg', 0.0, r'weight_kg = 0 kg, must be >= 0\.01 kg'),
    ('radius', 0.0, r'radius = 0 m/m \| m/rad, must be > 0 ')])
def test_a_value_outside_its_range_is_refused(name, value, message):
    """The message has name, value, unit and bound."""
    with pytest.raises(ParameterError, match=message):
        replace(SHEET, **{name: value})
