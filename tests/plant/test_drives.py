"""The areas of cylinders with one and two rods."""

import math

from isa_ros.errors import ParameterError
from isa_ros.plant.drives import Cylinder
import pytest

SIZE = {'bore_mm': 40.0, 'rod_mm': 25.0, 'stroke_mm': 200.0, 'rated_pressure_mpa': 14.0}


def test_each_rod_takes_its_area():
    """A data sheet of 40/25: 12.57 and 7.66 cm2; through both ends 7.66 each."""
    single = Cylinder(**SIZE, cap_rod_mm=0.0)
    assert [round(area * 1e4, 2) for area in single.areas] == [12.57, 7.66]
    assert Cylinder(**SIZE, cap_rod_mm=25.0).areas == pytest.approx(
        [single.areas[1]] * 2, rel=1e-14, abs=0.0)
    other = Cylinder(**SIZE, cap_rod_mm=18.0)
    assert other.areas[0] == pytest.approx(
        math.pi / 4.0 * (0.040**2 - 0.018**2), rel=1e-14, abs=0.0)
    assert other.areas[1] == single.areas[1]


@pytest.mark.parametrize('name', ['rod_mm', 'cap_rod_mm'])
def test_a_rod_as_thick_as_the_piston_is_refused(name):
    with pytest.raises(ParameterError, match=f'{name} = 40 mm, must be < bore_mm = 40 mm'):
        Cylinder(**{**SIZE, 'cap_rod_mm': 0.0, name: 40.0})
