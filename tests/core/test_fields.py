"""Samples as tables of fields: types, units, one row a field."""

from isa_ros.core.fields import Field, record_type, units_of
from isa_ros.core.signals import SAMPLE, SAMPLE_FIELDS
from isa_ros.core.units import in_si
from isa_ros.surroundings.bodies.leg.port_kernel import LEG_FIELDS
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
import numpy as np
import pytest

FIELDS = (Field('place', 'm | rad', 'where'), Field('axes', 'N', 'three', (3,)))


def test_a_record_has_little_endian_floats_in_order() -> None:
    assert record_type(FIELDS) == np.dtype([('place', '<f8'), ('axes', '<f8', (3,))])


def test_units_are_those_of_a_linear_or_a_rotary_actuator() -> None:
    assert units_of(FIELDS) == {'place': 'm', 'axes': 'N'}
    assert units_of(FIELDS, is_rotary=True) == {'place': 'rad', 'axes': 'N'}


@pytest.mark.parametrize('fields', [SAMPLE_FIELDS, SUPPLY_FIELDS, LEG_FIELDS])
def test_every_field_has_a_unit_and_a_meaning(fields: tuple[Field, ...]) -> None:
    for is_rotary in (False, True):
        assert all(in_si(unit).scale == 1.0 for unit in units_of(fields, is_rotary).values())
    assert all(field.meaning for field in fields)


def test_a_sample_has_units_by_its_kind_of_actuator() -> None:
    """From the encoder to the load cell; the rest is the same for both."""
    linear, rotary = units_of(SAMPLE_FIELDS), units_of(SAMPLE_FIELDS, is_rotary=True)
    differ = [name for name in SAMPLE.names or () if linear[name] != rotary[name]]
    assert differ == ['position', 'velocity', 'force', 'position_reference', 'force_reference']
