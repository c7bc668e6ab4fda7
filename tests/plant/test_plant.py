"""The composed plant: energy, order of convergence, oil spring, relief pressure."""

import math

from hypothesis import given, strategies as st
from isa_ros.actuator import integration as kernels
from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.signals import LOAD_PORT, SUPPLY_PORT
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.plant import chambers, servo_valve
from isa_ros.plant.energy import no_powers
from isa_ros.plant.plant import plant_record, PLANT_STATE
from isa_ros.plant.rates import plant_rates
from isa_ros.plant.rest_oil import rest_pressures
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override, plant_row

SUPPLY = 20.7e6  # Pa


class Body:
    """One actuator's continuous states with a constant current reference."""

    def __init__(self, sheet: ActuatorSheet, position: float, current: float = 0.0) -> None:
        self.constants = actuator_record(sheet, 0)
        self.port = np.zeros(1, LOAD_PORT)
        self.own = kernels.integrated(
            self.port[0], np.zeros(1, SUPPLY_PORT)[0], self.constants[0])
        self.row = row_record(self.own.continuous)
        self.port['supply_pressure'] = self.row.supply.pressure = SUPPLY
        self.current = current
        self.row.plant.mechanics.position = self.row.load.position = position
        plant = row_record(self.constants).plant
        self.row.plant.chambers.p_a, self.row.plant.chambers.p_b = rest_pressures(
            plant, SUPPLY, 0.0, 0.0)

    def run(self, duration: float, h: float = PLANT_STEP) -> None:
        """Advance by ``duration`` (s)."""
        kernels.rk4_steps(round(duration / h), h, self.current, self.own)

    @property
    def states(self) -> np.ndarray:
        """Return all states, scaled to order one."""
        chamber = self.row.plant.chambers
        return np.array([
            chamber.p_a / 1e7, chamber.p_b / 1e7, self.row.plant.spool.position / 1e-4,
            self.row.plant.mechanics.position, self.row.load.velocity])


def lossless(model: str) -> ActuatorSheet:
    """Return the sheet without leakage, friction and sensor damping."""
    sheet = actuator_sheet(model)
    for path, value in (
            ('plant.valve.null_leakage_lpm', 0.0), ('plant.oil.cross_port_leakage', 0.0),
            ('plant.friction.coulomb', 1e-12), ('plant.friction.stiction', 1e-12),
            ('plant.friction.bristle_stiffness', 1e-9), ('plant.friction.bristle_damping', 0.0),
            ('plant.friction.viscous', 0.0), ('plant.mechanics.sensor_damping', 0.0)):
        sheet = override(sheet, path, value)
    return sheet


def compression_energy(volume: float, start: float, p_start: float, beta: float) -> float:
    """Return the work stored in trapped oil, -int P dV with P = P_0 - beta ln(V/V_0)."""
    swing = volume * math.log(volume / start) - volume + start
    return -p_start * (volume - start) + beta * swing


@pytest.mark.parametrize('model', ['smart_manifold', 'isa_v5'])
def test_trapped_oil_conserves_energy(model):
    """C2, C3, M2, M4: a shut valve and no friction keep kinetic plus stored energy."""
    body = Body(lossless(model), 0.4 * plant_row(model).chambers.stroke)
    plant, oil = row_record(body.constants).plant, plant_row(model).chambers
    load_inertia = 100.0 * plant.mechanics.inertia
    body.port['inverse_mass'] = 1.0 / load_inertia
    start = chambers.volumes(body.row.plant.mechanics.position, oil)
    pressures = (body.row.plant.chambers.p_a, body.row.plant.chambers.p_b)
    body.row.load.velocity = body.row.plant.mechanics.velocity = 1e-3 * oil.stroke

    def energy() -> float:
        moving, load = body.row.plant.mechanics, body.row.load
        volumes = chambers.volumes(moving.position, oil)
        stored = sum(compression_energy(v, v_0, p, oil.beta)
                     for v, v_0, p in zip(volumes, start, pressures))
        stretch = moving.position - load.position
        return (stored + 0.5 * plant.mechanics.inertia * moving.velocity ** 2
                + 0.5 * load_inertia * load.velocity ** 2
                + 0.5 * plant.mechanics.k_s * stretch ** 2)

    before = energy()
    body.run(0.05)
    # RK4 loses (w h)^6/72 of a mode's energy per step; the stiff sensor mode (10 krad/s,
    # 1e-4 of the energy) loses it all, the slow modes 1e-9 in 2500 steps
    assert energy() == pytest.approx(before, rel=2e-3)


def rates_at(
        plant: np.record, supply: float = SUPPLY, **chamber: float
        ) -> tuple[np.record, tuple[float, float, float]]:
    """Return the rates of a plant at rest at mid stroke, and its sensor force and flows."""
    y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
    y.mechanics.position = x = 0.5 * plant.chambers.stroke
    for name, value in chamber.items():
        setattr(y.chambers, name, value)
    return rates, plant_rates(y, x, 0.0, 0.0, supply, 0.0, plant, False, rates, False, no_powers())


@pytest.mark.parametrize(('p_a', 'p_b'), [(9e6, 12e6), (23e6, 5e6), (5e6, 23e6)])
@pytest.mark.parametrize('model', MODELS)
def test_what_the_supply_gives_and_the_return_lacks_is_in_the_chambers(model, p_a, p_b):
    """V9, C2, C6: q_p - q_t compresses the oil, also with either relief valve open."""
    plant = plant_row(model)
    rates, (_, q_p, q_t) = rates_at(plant, p_a=p_a, p_b=p_b)
    v_a, v_b = chambers.volumes(0.5 * plant.chambers.stroke, plant.chambers)
    stored = (v_a * rates.chambers.p_a + v_b * rates.chambers.p_b) / plant.chambers.beta
    assert q_p - q_t == pytest.approx(stored, abs=1e-12 * (abs(q_p) + abs(q_t)))


@pytest.mark.parametrize('force', [-500.0, 0.0, 800.0])
@pytest.mark.parametrize('model', MODELS)
def test_rest_pressures_hold_the_force(model, force):
    """C3: without a force both chambers have the pressures divided by the leaking lands."""
    plant = plant_row(model)
    force *= 0.05 if model == 'smart_manifold' else 1.0
    p_a, p_b = rest_pressures(plant, SUPPLY, 0.3e6, force)
    assert chambers.hydraulic_force(p_a, p_b, plant.chambers) == pytest.approx(force, abs=1e-8)
    assert 0.3e6 < min(p_a, p_b) and max(p_a, p_b) < SUPPLY


def test_a_null_bias_drives_the_spool_its_own_way():
    """V12: more supply than at the reference conditions extends the manifold."""
    plant = plant_row('smart_manifold')
    more, _ = rates_at(plant, supply=SUPPLY + 7e6, p_a=1e7, p_b=1e7)
    less, _ = rates_at(plant, supply=SUPPLY - 7e6, p_a=1e7, p_b=1e7)
    assert more.spool.acceleration > 0.0 > less.spool.acceleration


def test_a_record_is_the_callers_own():
    """Who changes one changes no other of the same sheet."""
    sheet = actuator_sheet('isa_v5').plant
    first = plant_record(sheet)
    stiffness = float(first[0].mechanics.k_s)
    first[0].mechanics.k_s = 2.0 * stiffness
    assert plant_record(sheet)[0].mechanics.k_s == stiffness > 0.0


def test_the_valve_feels_the_resonance_of_its_coil():
    """V11, V13: the spool is driven by the current with its mode, on the series scale."""
    sheet = actuator_sheet('isa_v5', 'default', 'explicit')
    plant = plant_record(sheet.plant)[0]
    y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
    y.coil.mode = 1e-3
    plant_rates(y, 0.0, 0.0, 0.0, SUPPLY, 0.0, plant, False, rates, False, no_powers())
    series = plant.coil.mode_share * 1e-3 / 2.0
    w_n = plant.spool.w_n
    assert rates.spool.acceleration == pytest.approx(w_n * w_n * plant.spool.k_pilot * series)


@given(x=st.floats(-178e-6, 178e-6), p_a=st.floats(0.0, 22e6), p_b=st.floats(0.0, 22e6),
       v=st.floats(-1.0, 1.0), fraction=st.floats(0.0, 1.0))
def test_hydraulic_power_is_work_storage_and_leakage(x, p_a, p_b, v, fraction):
    """P_A Q_A + P_B Q_B = f_h v + sum(V/beta P dP/dt) + C_li (P_A - P_B)^2, exactly."""
    plant = plant_row('isa_v5')
    oil, s = plant.chambers, fraction * plant.chambers.stroke
    q_a, q_b, _, _ = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, plant.valve)
    rates = chambers.pressure_rates(q_a, q_b, p_a, p_b, s, v, oil)
    volumes = chambers.volumes(s, oil)
    work = chambers.hydraulic_force(p_a, p_b, oil) * v
    stored = sum(vol / oil.beta * p * rate for vol, p, rate in zip(volumes, (p_a, p_b), rates))
    leaked = oil.c_li * (p_a - p_b) ** 2
    scale = 22e6 * (abs(q_a) + abs(q_b) + (oil.area_a + oil.area_b) * abs(v)) + leaked
    assert p_a * q_a + p_b * q_b == pytest.approx(work + stored + leaked, abs=1e-14 * scale)


@pytest.mark.parametrize('model', ['smart_manifold', 'isa_v5'])
def test_runge_kutta_converges_with_fourth_order(model):
    """Halving the step divides the error of a smooth segment by about 2^4."""
    def solve(h: float) -> np.ndarray:
        body = Body(actuator_sheet(model), 0.5 * plant_row(model).chambers.stroke, current=4e-4)
        inertia = float(body.constants['plant']['mechanics']['inertia'][0])
        body.port['inverse_mass'] = 0.02 / inertia
        body.run(4e-3, h)
        return body.states
    exact = solve(1.25e-6)
    errors = [np.abs(solve(h) - exact).max() for h in (40e-6, 20e-6)]
    assert 12.0 < errors[0] / errors[1] < 22.0
    assert errors[1] < 1e-7


@pytest.mark.parametrize('model', ['smart_manifold', 'isa_v5'])
def test_oil_spring_sets_the_natural_frequency(model):
    """C4: against a fixed sensor the rotor swings at sqrt((k_oil + K_s)/I)."""
    body = Body(lossless(model), 0.5 * plant_row(model).chambers.stroke)
    plant = row_record(body.constants).plant
    moving = body.row.plant.mechanics
    rest = moving.position
    stiffness = chambers.oil_stiffness(rest, plant.chambers) + plant.mechanics.k_s
    expected = math.sqrt(stiffness / plant.mechanics.inertia)
    moving.velocity = 1e-4
    crossings, before, t = [], 0.0, 0.0
    while len(crossings) < 9:
        body.run(PLANT_STEP)
        t += PLANT_STEP
        now = moving.position - rest
        if before * now < 0.0:
            crossings.append(t - PLANT_STEP * now / (now - before))
        before = now
    measured = math.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    # straight-line crossings err by (w h)^2/8 of a step each, RK4's phase by (w h)^4/120
    assert measured == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(('model', 'speed'), [('smart_manifold', 8.0), ('isa_v5', 0.4)])
def test_relief_holds_22_to_22_5_mpa(model, speed):
    """Section 2.7: driven in at up to the relief's flow, the cap side stays at 22 MPa."""
    body = Body(actuator_sheet(model), 0.8 * plant_row(model).chambers.stroke)
    body.row.load.velocity = -speed  # inverse mass 0: a load of constant speed
    body.row.plant.mechanics.velocity = -speed
    stroke = plant_row(model).chambers.stroke
    peak = 0.0
    while body.row.plant.mechanics.position > 0.3 * stroke:
        body.run(1e-3)
        peak = max(peak, body.row.plant.chambers.p_a)
        assert body.row.plant.chambers.p_b > -0.1e6, 'the refill stays above vacuum'
    assert 22.0e6 <= peak <= 22.5e6


def test_the_spool_stays_within_its_stops():
    """A current beyond the range ends at the stop, at rest."""
    body = Body(actuator_sheet('isa_v5'), 0.05, current=0.0108)
    body.run(0.1)
    assert body.row.plant.spool.position <= 178e-6
    assert body.row.plant.spool.position == pytest.approx(178e-6, rel=0.01)


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('force', [1e6, -1e6])
def test_rest_pressures_stay_between_return_and_supply(model, force):
    """Under a load beyond stall the oil starts at supply and return pressure, not in tension."""
    p_a, p_b = rest_pressures(plant_row(model), SUPPLY, 0.2e6, force)
    assert (p_a, p_b) == ((SUPPLY, 0.2e6) if force > 0.0 else (0.2e6, SUPPLY))


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('share', [0.5, 0.98, -0.98])
def test_rest_pressures_hold_up_to_stall(model, share):
    """C3: up to stall either way, exact except for a rounding of the pressures' force."""
    plant = plant_row(model)
    oil = plant.chambers
    force = share * SUPPLY * (oil.area_a if share > 0.0 else oil.area_b)
    p_a, p_b = rest_pressures(plant, SUPPLY, 0.0, force)
    assert chambers.hydraulic_force(p_a, p_b, plant.chambers) == pytest.approx(force, rel=1e-12)
