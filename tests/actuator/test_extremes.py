"""An actuator at the ends of its physics: fast bristles, stiff oil, relief valves, boiling oil."""

import isa_ros
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.units import LPM, MPA
from isa_ros.loads.sheets import Mass
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override, setpoint, smart_actuator

TICK = 1e-4     # s
VAPOUR = 1e3 - ATMOSPHERE
BETA = 'plant.oil.effective_bulk_modulus'


def chambers(actuator: SmartActuator) -> np.void:
    """Return the `CHAMBERS_STATE`."""
    state: np.void = actuator.memory.continuous[0]['plant']['chambers']
    return state


def run(actuator: SmartActuator, duration: float) -> np.ndarray:
    """Return position, P_A, P_B and force at the end of each tick, (n, 4)."""
    rows = []
    for _ in range(round(duration / TICK)):
        actuator.tick()
        state = chambers(actuator)
        rows.append((float(actuator.reply.position), float(state['p_a']), float(state['p_b']),
                     float(actuator.reply.force)))
    return np.array(rows)


def test_friction_of_3_newtons_follows_a_fast_sine():
    """F4: bristles a hundred times faster than the step, reversing at 20 mm and 2 Hz."""
    sheet = actuator_sheet('isa_v5')
    for name in ('stiction', 'coulomb'):
        sheet = override(sheet, f'plant.friction.{name}', 3.0)
    actuator = smart_actuator('isa_v5', Mass(inertia=50.0, force=0.0), sheet=sheet)
    omega, peak = 4.0 * np.pi, 0.0
    for k in range(10000):
        actuator.accept(setpoint(
            position=0.05 + 0.02 * np.sin(omega * k * TICK),
            velocity=0.02 * omega * np.cos(omega * k * TICK)))
        actuator.tick()
        bristle = float(actuator.memory.continuous[0]['plant']['friction']['bristle'])
        peak = max(peak, abs(bristle))
    # at steady sliding sigma_0 z is the force, 3 N
    assert 0.9 < peak * sheet.plant.friction.bristle_stiffness / 3.0 < 1.001


def test_a_pull_of_8_kilonewtons_ends_at_the_vapour_pressure():
    """C11: the cap side is torn open, no pressure is below that of the vapour."""
    actuator = smart_actuator('isa_v5', Mass(inertia=50.0, force=8000.0))
    trace = run(actuator, 0.2)
    assert trace[:, 1].min() == VAPOUR
    assert trace[:, 2].min() >= VAPOUR
    assert trace[-1, 0] > 0.095      # pulled out to its stop


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('beta', [5e8, 1.4e9, 2e9])
def test_relief_valves_hold_any_oil(model, beta):
    """
    C6, C10: pushed in with 32 MPa over its piston, the oil leaves through the relief valve.

    The pressure is that at which the valve takes what the piston sweeps; 2 % of the speed for
    the valve's leakage and for what the oil stores between two ticks.
    """
    sheet = override(actuator_sheet(model), 'plant.oil.effective_bulk_modulus', beta)
    area = sheet.plant.drive.areas[0]
    inertia = {'smart_manifold': 0.6}.get(model, 50.0)
    actuator = smart_actuator(
        model, Mass(inertia=inertia, force=-32.0 * MPA * area), sheet=sheet)
    trace = run(actuator, 0.05)
    swept = np.abs(np.gradient(trace[:, 0], TICK)).max() * area
    slope = sheet.plant.relief.slope_lpm_per_mpa * LPM / MPA
    assert trace[:, 1].max() > 22.0 * MPA
    assert trace[:, 1].max() <= 22.0 * MPA + 1.02 * swept / slope


def oil(run: isa_ros.Run, beta: float) -> dict[str, float]:
    """Return the values that give all actuators an oil."""
    return {f'actuators.{name}.parameters.{BETA}': beta for name in run.actuators}


def gains_for(run: isa_ros.Run, beta: float) -> dict[str, float]:
    """Return the gains of the force loops for an oil, in inverse proportion to its modulus."""
    sheets = {name: run.configuration.actuator(name).sheet for name in run.actuators}
    return {f'actuators.{name}.parameters.reu.force.{gain}':
            getattr(sheet.reu.force, gain) * sheet.plant.oil.effective_bulk_modulus / beta
            for name, sheet in sheets.items() for gain in ('kp', 'ki')}


@pytest.mark.slow
@pytest.mark.parametrize('config', ['leg', 'hyq_leg'])
def test_an_oil_that_is_too_stiff_for_the_gains_is_seen(config):
    run = isa_ros.load(config, scenario='drop')
    with pytest.warns(isa_ros.TripWarning, match='kfe: oscillation tripped'):
        run.replace(oil(run, 2e9)).simulate(0.6)


@pytest.mark.slow
@pytest.mark.parametrize('config', ['leg', 'hyq_leg'])
@pytest.mark.parametrize('beta', [5e8, 1.4e9, 2e9])
def test_a_leg_rests_quietly_after_its_drop_on_any_oil(config, beta):
    """
    The gains do not hunt: in the last of 1.2 s no force ripples by more than 10 N rms.

    Hunting is hundreds of newtons; a parabola takes away what still settles. Gains do not follow
    the oil: force per volume of flow grows with the modulus, so they are divided by it.
    """
    run = isa_ros.load(config, scenario='drop')
    result = run.replace(oil(run, beta) | gains_for(run, beta)).simulate(1.2)
    assert not result.trips
    late = result.time > 1.0
    for name in run.actuators:
        t, force = result.time[late], result[f'{name}.force'][late]
        assert np.std(force - np.polyval(np.polyfit(t, force, 2), t)) < 10.0
