"""Actuators on a warm tank: one ODE by scipy, the balance of heat, saved states, mechanisms."""

import math
from pathlib import Path

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import read
from isa_ros.core.oil_properties import thickness
from isa_ros.errors import ConfigError
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import load, Run
from isa_ros.simulation import Simulation
from isa_ros.surroundings.supply_sample import SUPPLY_STATE
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.replay.replayed import content, replayed, result_of

LPM = 1e-3 / 60.0
NULL = {'current_ma': 0.0, 'supply_ma_per_mpa': 0.0, 'return_ma_per_mpa': 0.0,
        'temperature_ua_per_k': 0.0}
HELD = {'name': 'held', 'duration_s': 3.0, 'tracks': {'leak': [
    {'t_s': 0.0, 'position': 'hold', 'effort': 0.0}]}}
HEAT = {'kind': 'mixed', 'oil_volume_l': 1.5, 'start_celsius': 70.0, 'air_celsius': 12.0,
        'walls_w_per_k': 9.0, 'oil': {
            'density': 850.0, 'specific_heat': 1900.0, 'viscosity_at_40_cst': 46.0,
            'viscosity_at_100_cst': 6.8, 'compressibility_per_k': 4.5e-3}}
CAPACITY = 850.0 * 1900.0 * 1.5e-3
THERMAL = {'start_celsius': 18.0, 'ambient_celsius': 11.0, 'oil_to_body': 1.5}


def stand(thermal: dict[str, float], variants: tuple[str, ...] = ('thermal',)) -> Run:
    """Return an ISA v2 whose valve stays at null on a small warm power unit."""
    return load({
        'name': 'null', 'step_ms': 1.0, 'controller_offset_ms': 0.12, 'supplies': {'unit': {
            'kind': 'circuit', 'feeds': {'main': ['leak']},
            'oil': {'bulk_modulus': 1.2e9, 'density': 850.0, 'viscosity_mm2_s': 46.0},
            'parts': {
                'tank': {'kind': 'tank', 'heat': HEAT},
                'pump': {'kind': 'pump', 'inlet': 'tank', 'outlet': 'main', 'pressure_mpa': 20.7,
                         'displacement_ml': 8.0, 'speed_rpm': 1500.0, 'efficiency_percent': 90.0},
                'main': {'kind': 'manifold', 'oil_volume_l': 0.3}}}},
        'actuators': {'leak': {
            'model': 'isa_v2', 'variants': ['valve_amplifier', *variants],
            'load': {'kind': 'blocked'}, 'parameters': {'plant': {
                'spool': {'null_bias': NULL}, 'oil': {'cross_port_leakage': 0.0},
                **({'thermal': thermal} if thermal else {})}}}}}, HELD)


def simulated(run: Run, n_ticks: int) -> tuple[Simulation, np.ndarray]:
    """Return a run after its ticks, and the oil of tank and actuator after each, (n_ticks, 2)."""
    simulation = Simulation(run.scenario)
    found = np.empty((n_ticks, 2))
    for k in range(n_ticks):
        simulation.step()
        found[k] = (simulation.surroundings.supplies[1]['oil_temperature'],
                    simulation.group._memory.thermals[0]['oil'])
    return simulation, found


def one_ode(run: Run, n_ticks: int) -> np.ndarray:
    """
    Return the temperatures of tank and oil by V6 to V9, C2, C45, C47, T4, T5, T7, (n_ticks, 2).

    The chambers begin at the pressures of the run: where the piston of a blocked load rests.
    """
    plant = plant_record(run.configuration.actuator('leak').sheet.plant)[0]
    own, valve, oil = plant.thermal, plant.valve, plant.chambers
    first = Simulation(run.scenario).group._memory.continuous[0]['plant']
    half = 0.5 * oil.stroke
    volume_a, volume_b = oil.dead_volume + oil.area_a * half, oil.dead_volume + oil.area_b * half

    def rates(t: float, x: np.ndarray) -> list[float]:
        tank, warm, body, p, given, p_a, p_b = x
        land = valve.q_0 * valve.per_root_drop / thickness(warm, own.oil)
        pa, at, pb, bt = (land * f * math.sqrt(drop) for f, drop in (
            (valve.f_pa, p - p_a), (valve.f_at, p_a), (valve.f_pb, p - p_b), (valve.f_bt, p_b)))
        tare = valve.c_tare * math.sqrt(p)
        q, beta = pa + pb + tare, oil.beta / (1.0 + 4.5e-3 * (warm - 40.0))
        lost = p * q - p_a * (pa - at) - p_b * (pb - bt)
        carried = own.per_volume * q * (warm - tank)
        return [((1.0 / 0.9 - 1.0) * p * given + carried - 9.0 * (tank - 12.0)) / CAPACITY,
                (lost - carried + 1.5 * (body - warm)) / own.oil_capacity,
                (1.5 * (warm - body) + own.body_to_air * (11.0 - body)) / own.body_capacity,
                (given - q) * 1.2e9 / (1.0 + 4.5e-3 * (tank - 40.0)) / 0.3e-3,
                (min(1.0, (20.7e6 - p) / 0.5e6) * 8e-6 * 25.0 - given) / 0.03,
                beta / volume_a * (pa - at), beta / volume_b * (pb - bt)]
    times = 1e-3 * np.arange(1, n_ticks + 1)
    found = solve_ivp(
        rates, (0.0, times[-1]), [70.0, 18.0, 18.0, 20.7e6, 0.0, first['chambers']['p_a'],
                                  first['chambers']['p_b']],
        t_eval=times, rtol=1e-8, atol=[1e-9, 1e-9, 1e-9, 1e-2, 1e-12, 1e-2, 1e-2])
    return np.asarray(found.y[:2].T)


def test_oil_that_warms_by_20_k_is_that_of_one_ode() -> None:
    """
    Tank, pump, valve at null and both heat capacities of its actuator, within 0.01 K of 53 K.

    The coupled run has the viscosity and the tank's oil of a tick's start; the ODE leaves out that
    the piston moves by what force sensor and load give way.
    """
    run = stand(THERMAL)
    _, found = simulated(run, 3000)
    expected = one_ode(run, 3000)
    assert expected[-1, 1] - expected[0, 1] > 20.0 and expected[0, 0] - expected[-1, 0] > 0.5
    assert np.abs(found - expected).max() < 0.01


def kept(simulation: Simulation) -> float:
    """Return the heat that an actuator's oil and body have stored since 18 celsius, J."""
    own, constants = (rows[0] for rows in (
        simulation.group._memory.thermals, simulation.group._memory.constants))
    thermal = constants['plant']['thermal']
    return float(thermal['oil_capacity'] * (own['oil'] - 18.0)
                 + thermal['body_capacity'] * (own['body'] - 18.0))


def test_all_heat_of_tank_and_actuator_is_somewhere() -> None:
    """
    What the shaft gave is in both oils, the body, the air and the pressure: T5, T7 and T10.

    The actuator does no work, and what it stores is in its account.
    """
    simulation, _ = simulated(stand(THERMAL), 400)
    whole, tank = simulation.surroundings.supplies[:2]
    own = simulation.group._memory.thermals[0]
    sample = simulation.group.samples[0]
    shaft = float(whole['pump_energy']) / 0.9
    # the account of the circuit: what stays in its oil, and what holding pressures has moved
    stored = float(whole['stored_energy'] - whole['held_energy'])
    in_tank = CAPACITY * (float(whole['oil_temperature']) - 70.0)
    mechanical = float(sample['stored_energy'] + sample['work'])
    missing = shaft - (in_tank + float(tank['heat']) + kept(simulation) + float(own['to_air'])
                       + stored + mechanical)
    assert abs(own['to_oil']) > 100.0 and abs(own['heat']) > 20.0
    assert missing == pytest.approx(0.0, abs=2e-6 * abs(float(own['to_oil'])))
    assert float(whole['heat']) == pytest.approx(
        shaft - float(whole['pump_energy']) + float(whole['relief_energy'])
        + float(whole['return_energy']) + float(own['to_oil']), rel=1e-6)


def test_an_actuator_without_a_temperature_gives_its_energy() -> None:
    """As `actuators_percent` has it; its leakage stays that of its sheet."""
    simulation = Simulation(stand({}, ()).scenario)
    for _ in range(100):
        simulation.step()
    whole = simulation.surroundings.supplies[0]
    assert float(whole['heat']) == pytest.approx(
        float(whole['pump_energy']) * (1.0 / 0.9 - 1.0) + float(whole['relief_energy'])
        + float(whole['return_energy']) + float(whole['energy']), rel=1e-9)
    assert simulation.group.fed['heat'][0] == 0.0
    assert simulation.group._memory.thermals[0]['oil'] == 40.0


SHIPPED = load('warm_stand', 'warm_stand', duration=0.4)


def test_the_shipped_stand_warms_both_cylinders() -> None:
    """The moved one draws more of the warm oil, and gets what it was asked to do done."""
    simulation = Simulation(SHIPPED.scenario)
    for _ in range(400):
        simulation.step()
    moved, held = simulation.group._memory.thermals['oil']
    assert 16.5 < held < moved < 60.0
    feeds = simulation.group.feeds
    assert feeds['is_warm'].tolist() == [1.0, 1.0]
    assert 58.0 < feeds['celsius'][0] == feeds['celsius'][1] < 60.0
    # the heat of the last tick is what both took along, negative: they are colder
    assert (simulation.group.fed['heat'] < 0.0).all()


def test_a_run_replays_and_a_saved_one_goes_on_byte_for_byte(tmp_path: Path) -> None:
    result = result_of(SHIPPED.scenario)
    bag = result.save(tmp_path / 'bag')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    first, second = Simulation(SHIPPED.scenario), Simulation(SHIPPED.scenario)
    for _ in range(170):
        first.step()
    second.restore(first.snapshot())
    for _ in range(230):
        second.step()
    assert second.surroundings.supplies.tobytes() == result.log.supplies[-1].tobytes()
    assert second.group.samples.tobytes() == result.log.samples[-1].tobytes()


def test_a_saved_answer_that_is_not_finite_is_refused_by_name() -> None:
    """Of each actuator there are three numbers: the heat is used up in its tick."""
    own = Simulation(SHIPPED.scenario).surroundings
    saved, rows = own.snapshot(), len(own.supplies)
    for k, name in enumerate(('flow', 'conductance', 'paid', 'flow')):
        numbers = np.frombuffer(saved).copy()
        numbers[rows * SUPPLY_STATE.itemsize // 8 + k] = np.nan
        with pytest.raises(ConfigError, match=rf'supply ports: saved state has .*{name}.* = nan'):
            own.restore(numbers.tobytes())
    own.restore(saved)


def test_cylinders_of_a_mechanism_get_the_oil_of_the_tank() -> None:
    """Their load is the body's; they stood at 40 celsius, and take heat of the oil."""
    tree = read(find('crane', CONFIG))
    del tree['supply']
    station = read(find('warm_stand', CONFIG))['supplies']['station']
    station['parts']['gallery']['oil_volume_l'] = 5.0
    tree['supplies'] = {'station': station | {'feeds': {'gallery': ['lift', 'tilt']}}}
    for actuator in tree['actuators'].values():
        actuator['variants'] = ['thermal']
    simulation = load(tree).simulation()
    simulation.step()
    feeds = simulation.group.feeds
    assert feeds['is_warm'].tolist() == [1.0, 1.0] and feeds['celsius'].tolist() == [60.0, 60.0]
    assert (simulation.group.fed['heat'] < 0.0).all()


def test_without_a_warm_tank_an_actuator_gives_no_heat() -> None:
    """Its constant supply takes the heat of its oil, but its reply has none."""
    simulation = Simulation(load('rig_temperature', 'temperature', duration=0.1).scenario)
    for _ in range(5):
        simulation.step()
    assert (simulation.group._memory.thermals['to_oil'] != 0.0).all()
    assert not simulation.group.feeds['is_warm'].any() and not simulation.group.fed['heat'].any()
