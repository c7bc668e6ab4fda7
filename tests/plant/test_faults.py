"""Faults of the plant: each equation against an independent one."""

from dataclasses import replace
import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.parameter import fault, Parameters
from isa_ros.errors import ParameterError
from isa_ros.plant import cavitation, chambers, coil, plant, spool
import numpy as np
import pytest
from tests.sheets import actuator_sheet, override, plant_row, setpoint, smart_actuator

SHEET = actuator_sheet('isa_v5')
R, L = SHEET.plant.coil.coil_resistance, SHEET.plant.coil.coil_inductance


def coils(wired: str, **faults: float) -> coil.CoilCircuit:
    return coil.circuit(replace(SHEET.plant.coil, coils=wired, **faults))


def oil(**values: float) -> np.record:
    return chambers.chambers_record(SHEET.plant.drive, replace(SHEET.plant.oil, **values))


def test_a_fault_is_0_in_a_sound_device_and_a_whole_number_where_it_counts():
    class Own(Parameters):
        pass
    declared = fault('coils', '1', is_whole=True, ge=0.0, le=2.0)
    assert declared.default == 0.0 == declared.metadata['absent']
    with pytest.raises(ParameterError, match=r'open_coils = 0.5, must be a whole number'):
        replace(SHEET.plant.coil, open_coils=0.5)


@pytest.mark.parametrize('share', [0.0, 0.25, 0.5, 0.95])
@pytest.mark.parametrize('wired', ['parallel', 'series'])
def test_ampere_turns_are_those_of_kirchhoffs_laws(wired, share):
    """V19: U = R_1 i_1 = R_2 i_2 and i = i_1 + i_2, or one current through both in series."""
    turns, own = np.array([1.0, 1.0 - share]), coils(wired, shorted_turns=share)
    if wired == 'series':
        currents, resistance = np.ones(2), R * turns.sum()
    else:
        currents = np.linalg.solve([[turns[0], -turns[1]], [1.0, 1.0]], [0.0, 1.0])
        resistance = R * turns[0] * currents[0]
    # the series scale is the current through two sound coils in row
    ampere_turns = (turns * currents).sum() / 2.0
    assert 1.0 / own.per_series == pytest.approx(ampere_turns, rel=1e-14, abs=0.0)
    assert own.resistance == pytest.approx(resistance, rel=1e-14, abs=0.0)


def test_one_open_coil_of_two_in_parallel_is_the_wiring_one_open():
    assert coils('parallel', open_coils=1.0) == coils('one_open')


@pytest.mark.parametrize(('wired', 'n_open'), [
    ('parallel', 2.0), ('series', 1.0), ('series', 2.0), ('one_open', 1.0)])
def test_without_a_closed_circuit_the_current_decays_with_l_over_r(wired, n_open):
    """di/dt = -R/L i whatever is commanded, of the circuit that is left."""
    sheet = replace(SHEET.plant.coil, coils=wired, open_coils=n_open)
    assert not coil.circuit(sheet).is_closed
    row = coil.coil_record(sheet)
    own = coil.circuit(sheet)
    for reference in (-0.01, 0.0, 0.01):
        assert coil.current_rate(4e-3, reference, row) == pytest.approx(
            -own.resistance / own.inductance * 4e-3, rel=1e-14, abs=0.0)


def test_with_one_coil_the_amplifiers_voltage_gives_half_the_current():
    """
    U/R instead of U/(R/2), whatever is commanded: the force loop cannot open the valve.

    Without the protection, which disables an actuator whose spool does not follow.
    """
    held = []
    for n_open in (0.0, 1.0):
        actuator = smart_actuator(
            'isa_v5', 'blocked', sheet=override(SHEET, 'reu.protection.switch', 'off'))
        actuator.tune({'plant.coil.open_coils': n_open, 'plant.coil.supply_voltage': 4.0})
        actuator.accept(setpoint(position=0.05, effort=1e5))
        # 20 time constants L/R of the slower circuit
        for _ in range(round(20.0 * L / R / 1e-4)):
            actuator.tick()
        held.append(actuator.sample.current)
    step = SHEET.plant.sensors.current_range_ma * 1e-3 * 2.0 / 4096
    assert held == pytest.approx([4.0 / (0.5 * R), 4.0 / R], abs=step, rel=0.0)


@pytest.mark.parametrize('air', [1e-3, 0.05, 0.2])
@pytest.mark.parametrize('p', [0.0, 1e5, 2e6, 20.7e6])
def test_the_modulus_of_oil_with_air_is_that_of_its_volume(p, air):
    """C12: -V dP/dV of V = a (p_0/p)^(1/kappa) + (1 - a) exp(-(p - p_0)/beta), by differences."""
    beta = oil().beta

    def volume(at: float) -> float:
        bubbles = (ATMOSPHERE / (at + ATMOSPHERE)) ** (1.0 / 1.4)
        return air * bubbles + (1.0 - air) * math.exp(-at / beta)
    h = 1e-4 * (p + ATMOSPHERE)
    expected = -volume(p) * 2.0 * h / (volume(p + h) - volume(p - h))
    # the differences are right to (h/p)^2
    assert cavitation.modulus(p, oil(entrained_air=air)) == pytest.approx(
        expected, rel=1e-7, abs=0.0)


def test_without_air_the_modulus_has_the_same_bits():
    for p in (-1e5, -10.0, 0.0, 3e6):
        assert cavitation.modulus(p, oil()) == cavitation.stiffening(p, oil())


def test_air_softens_the_oil_most_at_low_pressure_and_never_stiffens_it():
    airy, sound = oil(entrained_air=0.05), oil()
    shares = [cavitation.modulus(p, airy) / cavitation.modulus(p, sound)
              for p in (0.0, 1e6, 5e6, 20e6)]
    assert shares == sorted(shares) and 0.0 < shares[0] < 0.01 and shares[-1] < 1.0


def test_oil_with_air_at_no_pressure_is_soft_and_finite():
    """The guard: at vapour pressure 0 the air would fill everything."""
    airy = oil(entrained_air=0.2, vapour_pressure_kpa=0.0)
    assert 0.0 < cavitation.modulus(-ATMOSPHERE, airy) < 1e4


def test_a_chamber_leaks_empty_as_an_exponential():
    """C13 alone: V/beta dP/dt = -C_le P, so P = P_0 exp(-beta C_le t/V)."""
    row = oil(external_leakage_a=2e-12, cross_port_leakage=0.0)
    s, h, steps, p = 0.05, 1e-4, 2000, 15e6
    v_a, _ = chambers.volumes(s, row)

    def rate(at: float) -> float:
        return float(chambers.pressure_rates(0.0, 0.0, at, 0.0, s, 0.0, row)[0])
    for _ in range(steps):
        k_1 = rate(p)
        k_2 = rate(p + 0.5 * h * k_1)
        k_3 = rate(p + 0.5 * h * k_2)
        p += h / 6.0 * (k_1 + 2.0 * (k_2 + k_3) + rate(p + h * k_3))
    x = row.beta * 2e-12 * h / v_a
    # error of RK4: x^5/120 a step
    assert p == pytest.approx(
        15e6 * math.exp(-steps * x), rel=steps * x**5 / 120.0 + steps * 1e-15, abs=0.0)


def test_nothing_leaks_in_from_the_outside():
    assert chambers.external_leakage(-5e4, 1e-11) == 0.0


@pytest.mark.parametrize('chamber', ['a', 'b'])
def test_the_oil_that_is_drawn_and_not_returned_leaks_or_is_stored(chamber):
    """C13 over time; the oil of a chamber is V P/beta, and V itself where the piston moves."""
    actuator = smart_actuator('isa_v5', 'blocked')
    actuator.tune({f'plant.oil.external_leakage_{chamber}': 2e-12})
    actuator.accept(setpoint(position=0.05, effort=0.0))
    row, plant_state = actuator._constants.plant.chambers, actuator._body.plant

    def pressure() -> float:
        return float(plant_state.chambers[f'p_{chamber}'])

    def stored() -> float:
        v_a, v_b = chambers.volumes(plant_state.mechanics.position, row)
        return float(v_a + v_b + (v_a * plant_state.chambers.p_a
                                  + v_b * plant_state.chambers.p_b) / row.beta)
    for _ in range(3000):
        actuator.tick()
    before, lost, leaked, largest = stored(), 0.0, 0.0, 0.0
    for _ in range(1000):
        last = pressure()
        actuator.tick()
        lost += actuator.reply.supply_volume - actuator.reply.return_volume
        leaked += 2e-12 * 0.5 * (last + pressure()) * 1e-4
        largest = max(largest, abs(pressure() - last))
    assert leaked > 1e-7
    # trapezes miss at most the change within a tick; stored counts the oil of p dV twice, p/beta
    # of what the piston sweeps
    swept = abs(stored() - before)
    assert lost == pytest.approx(leaked + stored() - before, rel=0.0, abs=(
        1000 * 2e-12 * largest * 1e-4 + swept * 20.7e6 / row.beta))


def test_a_blocked_spool_stays_exactly_where_it_is_and_leaves_at_once():
    """V20: while it sticks the sample has one bit pattern and no speed."""
    actuator = smart_actuator('isa_v5', 'mass')
    actuator.accept(setpoint(position=0.055))
    for _ in range(20):
        actuator.tick()
    assert actuator.sample.spool_velocity != 0.0
    actuator.tune({'plant.spool.stuck': 1.0})
    at = actuator._body.plant.spool.position
    for _ in range(50):
        actuator.tick()
        own = actuator._body.plant.spool
        assert (own.position, own.velocity, own.acceleration) == (at, 0.0, 0.0)
    actuator.tune({'plant.spool.stuck': 0.0})
    for _ in range(5):
        actuator.tick()
    assert actuator._body.plant.spool.position != at


def test_a_shifted_null_moves_the_spool_by_its_current():
    """V2, V12: K_spool times the shift, with no current of the amplifier."""
    shifted = override(SHEET, 'plant.spool.null_bias.current_ma', 0.5).plant
    row = plant.plant_record(shifted)[0]
    own = plant_row('isa_v5')
    moved = own.valve.k_spool * (
        spool.null_bias(20.7e6, 0.0, row.spool) - spool.null_bias(20.7e6, 0.0, own.spool))
    change = 0.5 - SHEET.plant.spool.null_bias.current_ma
    # the sum i_0 + b_S dP is rounded three times
    assert moved == pytest.approx(
        SHEET.plant.valve.spool_gain_mm_per_ma * change * 1e-3, rel=1e-14, abs=0.0)


def test_a_broken_relief_spring_holds_the_pressure_where_its_flow_is_the_valves():
    """C6, C10: at rest the land's flow into the chamber is slope (P - P_open)."""
    actuator = smart_actuator('isa_v5', 'blocked')
    actuator.tune({'plant.relief.opening_pressure_mpa': 1.0})
    actuator.accept(setpoint(position=0.05, effort=5000.0))
    for _ in range(3000):
        actuator.tick()
    body, row = actuator._body.plant, actuator._constants.plant
    slope = SHEET.plant.relief.slope_lpm_per_mpa / 6e4 / 1e6
    from isa_ros.plant.servo_valve import port_flows
    q_a, *_ = port_flows(
        body.spool.position, body.chambers.p_a, body.chambers.p_b, 20.7e6, 0.0, row.valve)
    leak = row.chambers.c_li * (body.chambers.p_a - body.chambers.p_b)
    assert body.chambers.p_a == pytest.approx(
        1e6 + (q_a - leak) / slope, rel=1e-6, abs=0.0)


@pytest.mark.parametrize(('function', 'arguments'), [
    (chambers.external_leakage, (2e6, 1e-12)),
    (cavitation.modulus, (-3e4, oil(entrained_air=0.01)))])
def test_compiled_equals_python(function, arguments):
    assert function(*arguments) == function.py_func(*arguments)
