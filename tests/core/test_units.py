"""Units of data sheets: one list, their size in SI, and the suffixes of keys."""

from dataclasses import fields
import math

from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.units import after, in_si, NOT_SI, of_coordinate, quantity, Unit
import pytest
from tests.plant.records import numbers, SUPPLY
from tests.sheets import actuator_sheet

SUFFIXES = {
    '_mpa': 'MPa', '_kpa': 'kPa', '_mm': 'mm', '_um': 'um', '_lpm': 'l/min', '_l': 'l',
    '_ml': 'ml', '_ma': 'mA', '_ms': 'ms', '_us': 'us', '_hz': 'Hz', '_deg': 'deg', '_v': 'V',
    '_per_ma': '/mA', '_percent': '%',
    '_per_k': '/K', '_rad_per_s': 'rad/s', '_lpm_per_mpa': 'l/min/MPa', '_kg': 'kg'}


@pytest.mark.parametrize(('unit', 'si', 'scale'), [
    ('MPa', 'Pa', 1e6), ('l/min', 'm3/s', 1.0 / 60000.0), ('mm', 'm', 0.001),
    ('deg', 'rad', math.pi / 180.0), ('mm/mA', 'm/A', 1.0), ('V/mA', 'V/A', 1000.0),
    ('l/min/MPa', 'm3/s/Pa', 1e-9 / 60.0), ('mm2/s', 'm2/s', 1e-6), ('us', 's', 1e-6),
    ('Hz', 'Hz', 1.0), ('N | Nm', 'N | Nm', 1.0), ('output/measured', 'output/measured', 1.0)])
def test_a_unit_has_its_size_in_si(unit: str, si: str, scale: float) -> None:
    found = in_si(unit)
    assert found.si == si
    assert found.scale == pytest.approx(scale, rel=4e-16, abs=0.0)  # two roundings


def test_the_si_unit_of_a_unit_is_one() -> None:
    for name, unit in NOT_SI.items():
        assert unit.si != name and unit.si not in NOT_SI


@pytest.mark.parametrize('unit', ['', 'bar', 'furlong', 'm |rad', 'mm | deg', 'L/min', 'hz'])
def test_an_unlisted_unit_is_refused_where_it_is_declared(unit: str) -> None:
    with pytest.raises(ValueError, match='is not in isa_ros.core.units'):
        parameter('of something', unit, gt=0.0)


def test_one_unit_is_its_factor_over_its_divisor() -> None:
    assert Unit('Pa', 6.0, 4.0).scale == 1.5


def test_a_coordinate_has_the_unit_of_its_kind_of_actuator() -> None:
    assert [of_coordinate('m/s | rad/s', is_rotary) for is_rotary in (False, True)] == [
        'm/s', 'rad/s']
    assert of_coordinate('Pa', is_rotary=True) == 'Pa'


def _suffix(key: str) -> str | None:
    return max((end for end in SUFFIXES if key.endswith(end)), key=len, default=None)


@pytest.mark.parametrize('model', model_names())
def test_the_end_of_a_key_is_its_unit(model: str) -> None:
    """Of every key of every variant that has one; SI keys have none."""
    sheets: list[Parameters] = [SUPPLY, *(
        actuator_sheet(model, 'default', *([variant] if variant else []))
        for variant in ('', *actuator_model(model, 'test').variants))]
    n = 0
    for sheet in sheets:
        for owner in _owners(sheet):
            for f in fields(owner):
                end, unit = _suffix(f.name), f.metadata.get('unit')
                if unit and end:
                    assert unit.endswith(SUFFIXES[end]), (f.name, unit)
                    n += 1
                elif unit in NOT_SI:
                    assert unit in ('V s/mA', 'V/(mA s)', 'mA/MPa', 'uA/K', 'cc/rad', 'mm2/s',
                                    'mm/s/mA', '%', 'rpm'), (f.name, unit)
    assert n > 100 and len(dict(numbers(sheets[1]))) > 100


def _owners(parameters: Parameters) -> list[Parameters]:
    """Return a set and all sets nested in it."""
    below = [getattr(parameters, f.name) for f in fields(parameters)]
    return [parameters, *(
        each for own in below if isinstance(own, Parameters) for each in _owners(own))]


@pytest.mark.parametrize(('unit', 'words'), [
    ('N', ('2 N', ' in N')), ('1', ('2', '')), ('', ('2', ''))])
def test_what_has_no_dimension_has_no_unit_in_words(unit, words):
    assert (quantity('2', unit), after(' in ', unit)) == words
