"""Two heat capacities: energy, the exact step, and what the oil's temperature changes."""

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st
from isa_ros.core.record import rows_of
from isa_ros.plant.plant import plant_record
from isa_ros.plant.thermal import heat, THERMAL_STATE, warm
import numpy as np
import pytest
from scipy.linalg import expm
from tests.sheets import actuator_sheet, MODELS

REMAINDER = 1e-9    # of the heat: what the balance may lack


def thermal_plant(model: str = 'isa_v5', **changed: float) -> np.record:
    """Return the `PLANT` record of a model with its variant `thermal`."""
    sheet = actuator_sheet(model, 'default', 'thermal').plant
    return plant_record(replace(sheet, thermal=replace(sheet.thermal, **changed)))[0]


def state_at(oil: float, body: float) -> np.record:
    state: np.record = rows_of(1, THERMAL_STATE)[0]
    state.oil, state.body = oil, body
    return state


def stored(thermal: np.record, state: np.record) -> float:
    """Return the heat above 0 celsius, J."""
    return float(thermal.oil_capacity * state.oil + thermal.body_capacity * state.body)


def size(thermal: np.record, state: np.record) -> float:
    """Return the sum of the sizes of both heats, J: their rounding is relative to it."""
    return float(thermal.oil_capacity * abs(state.oil) + thermal.body_capacity * abs(state.body))


LOSSES = st.floats(-1.0, 1e3)
VOLUMES = st.just(0.0) | st.floats(1e-12, 1e-4)


@settings(max_examples=200, deadline=None)
@given(h=st.sampled_from([1e-4, 1e-3, 0.1]), oil_heat=LOSSES, body_heat=LOSSES, inflow=VOLUMES,
       oil=st.floats(-30.0, 120.0), body=st.floats(-30.0, 120.0),
       inner=st.floats(1e-3, 1e5), outer=st.just(0.0) | st.floats(1e-9, 1e5))
def test_heat_of_the_losses_is_stored_or_carried_away(
        h: float, oil_heat: float, body_heat: float, inflow: float, oil: float, body: float,
        inner: float, outer: float) -> None:
    """
    In one step, within 1e-9 of the largest heat that moved and the rounding of the stored heat.

    Oil and body exchange heat at G_ob/C_o <= 1700/s, so that a step of 0.1 s begins with rates
    that are 170 times the temperatures: some roundings of them are 1e-13 of the heat.
    """
    own = thermal_plant(oil_to_body=inner, body_to_air=outer).thermal
    state = state_at(oil, body)
    before, sizes = stored(own, state), [size(own, state)]
    heat(h, oil_heat, body_heat, inflow, own.supply, own, state)
    gained = stored(own, state) - before
    sizes.append(size(own, state))
    assert state.heat == oil_heat + body_heat
    moved = max(abs(state.heat), abs(state.to_oil), abs(state.to_air))
    assert abs(state.heat - gained - state.to_oil - state.to_air) <= (
        REMAINDER * moved + 1e-13 * max(sizes))


@pytest.mark.parametrize(('h', 'inflow', 'outer'), [
    (1e-3, 3e-9, 0.6), (0.1, 1e-5, 0.6), (0.1, 0.0, 0.0), (1e-3, 0.0, 0.6), (0.1, 1e-3, 1e3)])
def test_a_step_is_the_matrix_exponential(h: float, inflow: float, outer: float) -> None:
    """
    And 1e-12 of 100 K is some hundred roundings of both computations.

    The last row decays within a thousandth of the step: no step is too long.
    """
    own, state = thermal_plant(body_to_air=outer).thermal, state_at(30.0, 80.0)
    through = own.per_volume * inflow / h
    matrix = np.array([
        [-(through + own.oil_to_body) / own.oil_capacity, own.oil_to_body / own.oil_capacity,
         (3.0 / h + through * own.supply) / own.oil_capacity],
        [own.oil_to_body / own.body_capacity, -(own.oil_to_body + outer) / own.body_capacity,
         (2.0 / h + outer * own.ambient) / own.body_capacity],
        [0.0, 0.0, 0.0]])
    expected = expm(h * matrix) @ [30.0, 80.0, 1.0]
    heat(h, 3.0, 2.0, inflow, own.supply, own, state)
    assert (state.oil, state.body) == pytest.approx(tuple(expected[:2]), rel=1e-12, abs=0.0)


def test_steps_of_any_length_reach_the_same_temperatures() -> None:
    """A hundred steps or one: the roundings of a hundred steps are 1e-14 of 40 celsius."""
    own, one, many = thermal_plant().thermal, state_at(40.0, 40.0), state_at(40.0, 40.0)
    heat(0.1, 50.0, 5.0, 1e-6, own.supply, own, one)
    for _ in range(100):
        heat(1e-3, 0.5, 0.05, 1e-8, own.supply, own, many)
    assert (many.oil, many.body) == pytest.approx((one.oil, one.body), rel=1e-12, abs=0.0)
    assert (many.to_oil, many.to_air) == pytest.approx((one.to_oil, one.to_air), rel=1e-9)


def test_at_rest_the_oil_is_warmer_by_the_losses_over_the_flow() -> None:
    """Without heat to the air, P = rho c Q (theta - theta_S)."""
    own, state = thermal_plant(body_to_air=0.0).thermal, state_at(40.0, 40.0)
    pressure, volume = 20.7e6, 1e-5
    for _ in range(3):      # the body needs minutes: a step is exact whatever its length
        heat(1e5, 1e6 * pressure * volume, 0.0, 1e6 * volume, own.supply, own, state)
    warmer = pressure / own.per_volume
    assert warmer == pytest.approx(12.2, abs=0.05)  # 20.7 MPa over 860 kg/m3 times 1970 J/(kg K)
    assert (state.oil - own.supply, state.body - own.supply) == pytest.approx(
        (warmer, warmer), rel=1e-9)


@pytest.mark.parametrize('model', [*MODELS, 'cylinder'])
def test_at_the_temperature_of_the_sheet_nothing_changes(model: str) -> None:
    plant = thermal_plant(model)
    before = plant.tobytes()
    warm(40.0, plant)
    assert plant.tobytes() == before


@pytest.mark.parametrize('model', MODELS)
def test_without_the_model_the_plant_is_that_of_the_sheet(model: str) -> None:
    """Only its own constants differ."""
    without, plant = plant_record(actuator_sheet(model).plant)[0], thermal_plant(model)
    assert without.thermal.is_on == 0.0 and plant.thermal.is_on == 1.0
    for name in plant.dtype.names or ():
        if name != 'thermal':
            assert plant[name].tobytes() == without[name].tobytes()


def test_warm_oil_leaks_more_rubs_less_and_is_softer() -> None:
    """By the viscosity of VG 46, 72 at 30 and 20 mm2/s at 60 celsius, and 4.5e-3/K."""
    cold, hot = thermal_plant('smart_manifold'), thermal_plant('smart_manifold')
    own_leakage = hot.valve.q_0
    warm(30.0, cold)
    warm(60.0, hot)
    thinner = cold.friction.sigma2 / hot.friction.sigma2
    assert thinner == pytest.approx(3.6, abs=0.1)
    assert hot.chambers.c_li / cold.chambers.c_li == pytest.approx(thinner, rel=1e-12, abs=0.0)
    assert hot.valve.leak_factor / cold.valve.leak_factor == pytest.approx(
        thinner, rel=1e-12, abs=0.0)
    assert hot.valve.q_0 == own_leakage * hot.valve.leak_factor
    assert hot.chambers.beta / cold.chambers.beta == pytest.approx(
        (1.0 - 10.0 * 4.5e-3) / (1.0 + 20.0 * 4.5e-3), rel=1e-12, abs=0.0)
    assert hot.spool.bias - cold.spool.bias == pytest.approx(30.0 * 2.6e-6, rel=1e-12, abs=0.0)


def test_only_the_laminar_share_of_the_leakage_follows_the_viscosity() -> None:
    plant = thermal_plant(laminar_share=0.25)
    warm(60.0, plant)
    laminar = thermal_plant()
    warm(60.0, laminar)
    assert plant.valve.leak_factor - 1.0 == pytest.approx(
        0.25 * (laminar.valve.leak_factor - 1.0), rel=1e-12, abs=0.0)
    assert plant.chambers.c_li == laminar.chambers.c_li


def test_compiled_equals_python() -> None:
    own = thermal_plant().thermal
    compiled, python = state_at(30.0, 80.0), state_at(30.0, 80.0)
    heat(1e-3, 0.5, 0.1, 3e-9, own.supply, own, compiled)
    heat.py_func(1e-3, 0.5, 0.1, 3e-9, own.supply, own, python)
    assert compiled.tobytes() == python.tobytes()
    plants = thermal_plant(), thermal_plant()
    warm(63.0, plants[0])
    warm.py_func(63.0, plants[1])
    assert plants[0].tobytes() == plants[1].tobytes()


def test_oil_flows_in_with_the_temperature_that_is_given() -> None:
    """T4 as with a sheet of 71 celsius; a step returns rho c V (theta - 71) of its mean."""
    own, other = (thermal_plant(supply_celsius=celsius).thermal for celsius in (23.0, 71.0))
    found, expected = state_at(40.0, 35.0), state_at(40.0, 35.0)
    found.to_oil = 500.0
    carried = heat(0.1, 12.0, 3.0, 4e-6, 71.0, own, found)
    assert carried == heat(0.1, 12.0, 3.0, 4e-6, other.supply, other, expected)
    assert (found.oil, found.body) == (expected.oil, expected.body)
    assert found.to_oil == 500.0 + carried
    assert 40.0 < carried / (own.per_volume * 4e-6) + 71.0 < found.oil
