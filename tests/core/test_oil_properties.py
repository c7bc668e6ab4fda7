"""Viscosity and compressibility of the oil over its temperature."""

import math

from isa_ros.core.oil_properties import (
    MineralOil, properties_record, softness, thickness, viscosity)
from isa_ros.errors import ParameterError
import numpy as np
import pytest

VG_46 = {'density': 860.0, 'specific_heat': 1970.0, 'viscosity_at_40_cst': 46.0,
         'viscosity_at_100_cst': 6.8, 'compressibility_per_k': 4.5e-3}
TEMPERATURES = (-30.0, 0.0, 30.0, 40.0, 60.0, 80.0, 120.0)


def oil(**changed: float) -> MineralOil:
    return MineralOil(**(VG_46 | changed))


@pytest.mark.parametrize(('at_40', 'at_100'), [(46.0, 6.8), (32.0, 5.4), (15.0, 3.4)])
def test_viscosity_is_straight_in_the_chart_of_astm_d341(at_40: float, at_100: float) -> None:
    """
    log10 log10 (nu + 0.7) over log10 of the absolute temperature, as the standard draws it.

    The rounding of the viscosity, some ten ulp, is less than 1e-14 of the ordinate.
    """
    own = properties_record(oil(viscosity_at_40_cst=at_40, viscosity_at_100_cst=at_100), 40.0)
    ends = np.log10([313.15, 373.15]), np.log10(np.log10([at_40 + 0.7, at_100 + 0.7]))
    slope = (ends[1][1] - ends[1][0]) / (ends[0][1] - ends[0][0])
    for celsius in TEMPERATURES:
        ordinate = math.log10(math.log10(viscosity(celsius, own) + 0.7))
        line = ends[1][0] + slope * (math.log10(celsius + 273.15) - ends[0][0])
        assert ordinate == pytest.approx(line, abs=1e-13)


def test_viscosity_passes_through_both_points_of_the_data_sheet() -> None:
    """Within the rounding of exp(exp()), whose argument is 1.3: some ten ulp."""
    own = properties_record(oil(), 40.0)
    assert viscosity(40.0, own) == pytest.approx(46.0, rel=1e-14, abs=0.0)
    assert viscosity(100.0, own) == pytest.approx(6.8, rel=1e-14, abs=0.0)


@pytest.mark.parametrize('at_sheet', TEMPERATURES[:-1])
def test_factors_at_the_temperature_of_the_sheet_are_exactly_1(at_sheet: float) -> None:
    own = properties_record(oil(), at_sheet)
    assert thickness(at_sheet, own) == 1.0
    assert softness(at_sheet, own) == 1.0


def test_warm_oil_is_thinner_and_softer() -> None:
    own = properties_record(oil(), 40.0)
    thick = [thickness(celsius, own) for celsius in TEMPERATURES]
    soft = [softness(celsius, own) for celsius in TEMPERATURES]
    assert thick == sorted(thick, reverse=True) and thick[-1] > 0.0
    assert soft == sorted(soft) and soft[0] > 0.0


@pytest.mark.parametrize(('fahrenheit', 'factor'), [(60.0, 1.10), (160.0, 0.86)])
def test_bulk_modulus_is_that_of_its_source(fahrenheit: float, factor: float) -> None:
    """
    The Lee Company, bulk modulus (actual): factors of two examples, in two digits.

    They are those of oil at 100 degF; half of their last digit and the rounding of the slope to
    two digits make 0.012.
    """
    celsius = (fahrenheit - 32.0) / 1.8
    own = properties_record(oil(), (100.0 - 32.0) / 1.8)
    assert 1.0 / softness(celsius, own) == pytest.approx(factor, abs=0.012)


def test_compiled_equals_python() -> None:
    own = properties_record(oil(), 40.0)
    for celsius in TEMPERATURES:
        for law in (viscosity, thickness, softness):
            assert law(celsius, own) == law.py_func(celsius, own)


def test_an_oil_that_gets_thicker_is_refused() -> None:
    with pytest.raises(ParameterError) as refused:
        oil(viscosity_at_100_cst=46.0)
    assert str(refused.value) == (
        'viscosity_at_100_cst = 46 mm2/s, must be < viscosity_at_40_cst = 46 mm2/s')
