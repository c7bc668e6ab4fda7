"""
The load port against leg and actuators as one ODE: the specified accuracy.

Measured with sensors of 24 bits and 1 nm. With the shipped 12 bits the system itself tells
two starts 1 nm apart by more than the exchange does
(`test_shipped_sensors_hide_the_exchange`), so they are tested against the bars of the drop
only.
"""

from functools import cache

from isa_ros.actuator.sheet import ActuatorSheet
import numpy as np
import pytest
from tests.oracle.measure import compare, Errors
from tests.oracle.rig import hanging, Rig
from tests.sheets import actuator_sheet, override

MS = 1_000_000
NEVER = 1_000_000 * MS
RELEASE = 20 * MS
DROP = 300 * MS
STEPS = (MS // 2, MS, 2 * MS)
HAA, HFE, KFE = 0, 1, 2
FALL = 0.1  # m; the foot arrives with 1.4 m/s
# Impact times a quarter of a millisecond apart: any alignment of impact and tick.
ALIGNMENTS = tuple(FALL + k * 0.25e-3 * 1.4 for k in range(4))
VARIANTS = {  # damping ratio of the force sensors, moving mass of the cylinders (kg)
    'shipped': (None, None), 'light_damping': (0.01, None), 'heavy_piston': (None, 1.6),
    'both': (0.01, 1.6)}


def sheet(model: str, damping_ratio: float | None, mass: float | None,
          is_fine: bool) -> ActuatorSheet:
    """Return a shipped sheet with other mechanics and, if asked, ideal sensors."""
    found = actuator_sheet(model)
    if mass is not None and not found.is_rotary:
        found = override(found, 'plant.mechanics.inertia', mass)
    if damping_ratio is not None:
        mechanics = found.plant.mechanics
        critical = 2.0 * np.sqrt(mechanics.sensor_stiffness * mechanics.inertia)
        found = override(found, 'plant.mechanics.sensor_damping', damping_ratio * critical)
    if is_fine:
        found = override(found, 'plant.sensors.adc_bits', 24.0)
        found = override(found, 'plant.sensors.encoder_resolution', 1e-9)
    return found


def rig(variant: str, foot_height: float = FALL, is_fine: bool = True) -> Rig:
    """Return one of `VARIANTS`."""
    return Rig(hanging(foot_height), sheets=tuple(
        sheet(model, *VARIANTS[variant], is_fine)
        for model in ('smart_manifold', 'isa_v5', 'isa_v5')))


@cache
def drop(variant: str, is_fine: bool = True) -> dict[int, Errors]:
    """Return the worst errors of the drop over all alignments, by macro step."""
    worst: dict[int, Errors] = {}
    for foot_height in ALIGNMENTS:
        found = rig(variant, foot_height, is_fine)
        for step_ns, errors in compare(
                found, found.hold(DROP), DROP, RELEASE, STEPS).items():
            worst[step_ns] = errors.worst(worst.get(step_ns, errors))
    return worst


def swing_commands(found: Rig, duration_ns: int) -> np.ndarray:
    """Return a swing of thigh and knee by 30 mm of stroke at 1.7 Hz, slider held."""
    commands = found.hold(duration_ns)
    w = 2.0 * np.pi * 1.7
    t = np.arange(len(commands)) * found.command_ns * 1e-9
    for joint, amplitude in ((HFE, 0.015), (KFE, -0.015)):
        commands[:, joint, 0] += amplitude * (1.0 - np.cos(w * t))
        commands[:, joint, 1] = amplitude * w * np.sin(w * t)
    return commands


def force_commands(found: Rig, duration_ns: int) -> np.ndarray:
    """Return a step of 500 N in the knee's feed-forward after 20 ms, slider held."""
    commands = found.hold(duration_ns)
    commands[20 * MS // found.command_ns:, KFE, 2] = 500.0
    return commands


@pytest.mark.parametrize('is_fine', [True, False])
@pytest.mark.parametrize('variant', list(VARIANTS))
def test_drop_at_1_ms(variant, is_fine):
    """Knee and ground peak 4 %, RMS knee 4 %, hip 6 %, knee angle 0.03 deg, energy 0.5 %."""
    errors = drop(variant, is_fine)[MS]
    assert errors.rms[KFE] < 0.04 and errors.rms[:KFE].max() < 0.06
    assert errors.peak[KFE] < 0.04 and errors.ground[0] < 0.04
    assert errors.angle[KFE] < 0.03
    assert errors.energy.max() < 0.005


@pytest.mark.parametrize('variant', list(VARIANTS))
def test_drop_at_half_a_millisecond(variant):
    """1 % on all forces, and at least three times better than at 1 ms."""
    half, full = drop(variant)[MS // 2], drop(variant)[MS]
    assert half.rms.max() < 0.01 and half.peak.max() < 0.01 and half.ground[0] < 0.01
    assert half.angle.max() < 0.03 and half.energy.max() < 0.005
    assert (3.0 * half.rms < full.rms).all()


@pytest.mark.parametrize(('variant', 'rms', 'thigh_peak'), [
    # measured: 0.068 and 0.04; 0.149 and 0.43; 0.095 and 0.30; 0.181 and 0.69
    ('shipped', 0.07, 0.05), ('light_damping', 0.16, 0.45), ('heavy_piston', 0.10, 0.32),
    ('both', 0.19, 0.72)])
def test_drop_at_2_ms_stays_bounded(variant, rms, thigh_peak):
    """
    Beyond the usable step the leg still lands, with the errors measured, a tenth for rounding up.

    The thigh's peak is the worst. The impact is 14 ms long, 7 ticks; at the end of each the port's
    straight line in time is wrong, which strikes the thigh's cell. The oracle's hardly rings, but
    damped by 1 % behind 1.6 kg (895 Hz) it takes 18 ms to fade, so that the strokes add up: 940 N
    on a force of 1216 N, a peak 69 % too large. It is the error of the step, not an instability:
    in ticks of 1.5, 1 and 0.5 ms it is 250, 62 and 6 N, and after the impact it fades. 0.6 kg
    (1456 Hz) need 11 ms; the shipped damping ends a stroke within a tick, in 0.6 or 0.2 ms.
    """
    errors, full = drop(variant)[2 * MS], drop(variant)[MS]
    assert errors.rms.max() < rms and errors.ground[0] < 0.01
    assert errors.peak[[HAA, KFE]].max() < 0.02
    assert errors.peak[HFE] < thigh_peak
    assert errors.angle.max() < 0.25
    assert 4.0 * full.rms[HFE] < errors.rms[HFE]    # of second order at least


@pytest.mark.parametrize('variant', list(VARIANTS))
def test_swing_at_1_ms(variant):
    """RMS of hip and knee 0.5 %, also with a load cell that rings near the tick rate."""
    found = rig(variant)
    duration = 600 * MS
    errors = compare(found, swing_commands(found, duration), duration, NEVER, (MS,))[MS]
    assert errors.rms.max() < 0.005


@pytest.mark.parametrize('variant', ['shipped', 'light_damping', 'heavy_piston'])
def test_force_step_at_1_ms(variant):
    """RMS of all three forces 0.5 %."""
    found = rig(variant)
    errors = compare(found, force_commands(found, DROP), DROP, NEVER, (MS,))[MS]
    assert errors.rms.max() < 0.005


def test_a_nanometre_stays_small_with_and_without_the_sensors_rounding():
    """
    Two one-ODE runs started 1 nm apart differ by less than the bound of the exchange, 0.5 %.

    With 24 bits by less than 0.01 %: the leg is not chaotic, and the converters' rounding hides
    no error of the exchange.
    """
    differences = {}
    for is_fine in (True, False):
        found = rig('shipped', is_fine=is_fine)
        commands = force_commands(found, DROP)
        runs = [found.one_ode(commands, DROP, NEVER, aside=aside)['mean'][:, KFE]
                for aside in (0.0, 1e-9)]
        differences[is_fine] = np.sqrt(
            ((runs[1] - runs[0]) ** 2).mean() / (runs[0] ** 2).mean())
    assert differences[False] < 0.005
    assert differences[True] < 1e-4


def test_knee_peak_of_the_drop_is_that_of_the_paper():
    """Section 5.2 and figure 20: considerable, but below the maximum of 7500 N."""
    found = rig('shipped', is_fine=False)
    trace = found.one_ode(found.hold(DROP), DROP, RELEASE)
    assert 2000.0 < np.abs(trace['mean'][:, KFE]).max() < 7500.0
