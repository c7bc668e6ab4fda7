"""Hours of trot: heat of the pump, exact steps, and the cooler that is needed."""

import math
from types import SimpleNamespace
from typing import Any, cast

from isa_ros.analysis.studies import power_unit, warm_up
from isa_ros.scripting.result import Result
import numpy as np
import pytest

CAPACITY = 860.0 * 1970.0 * 6e-3 + 3000.0


@pytest.mark.parametrize('cooler', [0.0, 50.0])
def test_it_warms_with_one_time_constant(cooler: float) -> None:
    """T7: 25 celsius + P/G (1 - e^(-G t/C))."""
    g = 4.0 + cooler
    for t in warm_up.MOMENTS:
        expected = 25.0 + 4321.0 / g * (1.0 - math.exp(-g * t / CAPACITY))
        assert warm_up.after(t, 4321.0, cooler) == pytest.approx(expected, rel=1e-9)


def test_the_cooler_holds_what_it_is_for() -> None:
    """60 celsius after days."""
    assert warm_up.after(1e6, 4400.0, warm_up.cooler_for(4400.0)) == pytest.approx(60.0)


def test_the_heat_is_that_of_shaft_and_leakage() -> None:
    """(3600 W + g P^2)/0.9 with 0.02 l/min/MPa, from a time on."""
    run = power_unit.load(power_unit.RUN).configuration
    result: Any = SimpleNamespace(
        scenario=SimpleNamespace(run=run), time=np.array([0.0, 1.0, 2.0]))
    pressures = {'unit/outlet.pressure': np.array([50e6, 10e6, 20e6])}

    class Recorded(SimpleNamespace):
        def __getitem__(self, name: str) -> np.ndarray:
            return pressures[name]
    recorded = cast(Result, Recorded(**vars(result)))
    g = 0.02 * 1e-3 / 60.0 / 1e6
    expected = (3600.0 + g * 0.5 * (10e6 ** 2 + 20e6 ** 2)) / 0.9
    assert warm_up.heat_of(recorded, 'unit', 3600.0, 0.5) == pytest.approx(expected, rel=1e-12)


def test_the_page_says_what_the_table_has() -> None:
    """A row for each cooler, warmer later and with less of it, up to 100 celsius."""
    head, *rows = warm_up.table(4400.0)
    assert [row[0] for row in rows] == ['0', '50', '100', '150', '250']
    assert head[1:] == tuple(f'after {minutes} min' for minutes in (1, 5, 20, 60, 240))
    values = np.array([[float(cell.strip('> ')) for cell in row[1:]] for row in rows])
    assert (np.diff(values, axis=1) >= 0.0).all() and (np.diff(values, axis=0) <= 0.0).all()
    assert rows[0][1:] == ('45', '> 100', '> 100', '> 100', '> 100') and rows[2][-1] == '67'
    before, follows = warm_up.seen(4400.0)
    assert '4.4 kW' in before and '122 W/K' in follows and '20 K' in follows


@pytest.mark.slow
def test_the_heat_is_that_of_the_model_too() -> None:
    """With the tank's heat in the run: what its oil got, within what is stored and moves."""
    tank = {'kind': 'mixed', 'oil_volume_l': 6.0, 'metal_heat_capacity': 3000.0, 'oil': {
        'density': 860.0, 'specific_heat': 1970.0, 'viscosity_at_40_cst': 32.0,
        'viscosity_at_100_cst': 5.4, 'compressibility_per_k': 4.5e-3}}
    parts = f'supplies.{power_unit.UNIT}.parts'
    result = power_unit.load(power_unit.RUN, power_unit.RUN, changes={
        f'{parts}.tank.heat': tank, f'{parts}.pump.efficiency_percent': 90.0}).simulate(4.0)
    found = power_unit.supplied(power_unit.CHOSEN, result)
    heat = result['unit.heat']
    steady = result.time > power_unit.STEADY
    mean = (heat[-1] - heat[steady][0]) / (result.time[-1] - result.time[steady][0])
    # over 1 s of strides of 0.6 s accumulator and robot do not return to where they began
    assert found.heat == pytest.approx(mean, rel=0.1)
