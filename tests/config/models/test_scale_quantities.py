"""Quantities that values of a model scale with: known, finite, and of a section of the file."""

from isa_ros.actuator.scales import keys_of, SCALES
from isa_ros.config.models.catalogue import model_names
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.config.text.sections import merge, Place, sourced, SourcedValue
from isa_ros.errors import ConfigError
import pytest


def test_every_quantity_is_finite_and_positive_for_every_model_that_has_it() -> None:
    for name in model_names():
        sheet = default_actuator(name, name).sheet
        for quantity in SCALES.values():
            try:
                assert 0.0 < quantity(sheet) < 1e18
            except ConfigError as error:
                assert 'two straight lines' in str(error)


@pytest.mark.parametrize(('values', 'message'), [
    ({'scales_with': 'stall'}, 'm.yaml: gain.scales_with.stall is unknown; did you mean stall_'),
    ({'scales_with': {}}, 'm.yaml: gain.scales_with.{} is unknown; valid: '),
    ({'scales_with': None}, 'm.yaml: gain.scales_with.None is unknown; '),
    ({'scales': 'stall_out'}, 'm.yaml: gain.scales is unknown; did you mean scales_with'),
])
def test_an_unknown_quantity_is_refused(values: dict[str, str], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        sourced({'gain': {'value': 1.0, 'source': 'assumed', **values}}, Place('m.yaml'))


def test_a_replaced_value_does_not_scale() -> None:
    """A later layer replaces the value with its quantity."""
    old = SourcedValue(1.0, 'm.yaml: a', 'assumed', 'stroke')
    new = SourcedValue(2.0, 'r.yaml: a', 'r.yaml')
    assert merge({'a': old}, {'a': new}) == {'a': new}


@pytest.mark.parametrize(('scale', 'keys'), [
    ('stall_in', 'plant.drive'), ('valve_lag', 'plant.spool'), ('full_flow', 'plant.valve'),
    ('force_gain', 'plant.valve and plant.drive')])
def test_a_quantity_names_the_section_of_a_file_that_it_follows_from(
        scale: str, keys: str) -> None:
    assert keys_of(scale) == keys
