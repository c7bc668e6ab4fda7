"""Parameters that may change: found by their mark alone, checked, and without faults."""

from dataclasses import replace

from isa_ros.config.models.catalogue import model_names
from isa_ros.core.changeable import changeables, sound, with_changes
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.errors import ConfigError, ParameterError
import pytest
from tests.sheets import actuator_sheet


@frozen(kw_only=True)
class Channel(Parameters):
    """A sensor as somebody may add it."""

    range_mm: float = parameter('full scale', 'mm', gt=0.0, le=10.0)
    offset_mm: float = parameter('offset', 'mm', changeable=True, ge=-1.0, le=1.0)
    stuck: float = fault('1: its value stays', '1', is_whole=True, ge=0.0, le=1.0)


@frozen(kw_only=True)
class Sheet(Parameters):
    """A sheet with two of them."""

    left: Channel
    right: Channel


LEFT = Channel(range_mm=5.0, offset_mm=0.1)
SHEET = Sheet(left=LEFT, right=Channel(range_mm=2.0, offset_mm=0.0, stuck=1.0))


def test_what_is_marked_is_found_with_value_unit_and_bounds():
    found = changeables(SHEET, 'plant.')
    assert list(found) == ['plant.left.offset_mm', 'plant.left.stuck', 'plant.right.offset_mm',
                           'plant.right.stuck']
    own = found['plant.left.offset_mm']
    assert (own.value, own.unit, own.bounds, own.doc) == (
        0.1, 'mm', {'ge': -1.0, 'le': 1.0}, 'offset')


def test_a_change_leaves_all_others_and_an_equal_value_the_object():
    changed = with_changes(SHEET, changeables(SHEET), {'right.stuck': 0, 'right.offset_mm': 0.5})
    assert changed.right == Channel(range_mm=2.0, offset_mm=0.5)
    assert changed.left is LEFT
    assert with_changes(SHEET, changeables(SHEET), {'left.offset_mm': 0.1}) is SHEET


def test_a_device_without_faults_keeps_what_is_no_fault():
    assert sound(SHEET) == replace(SHEET, right=Channel(range_mm=2.0, offset_mm=0.0))
    assert sound(LEFT) is LEFT


@pytest.mark.parametrize(('key', 'value', 'error', 'message'), [
    ('left.range_mm', 1.0, ConfigError, 'left.range_mm is unknown; did you mean'),
    ('left.offset_mm', 2.0, ParameterError, r'left.offset_mm = 2 mm, must be <= 1 mm \(offset\)'),
    ('left.stuck', 0.5, ParameterError, 'left.stuck = 0.5, must be a whole number')])
def test_what_cannot_change_so_is_refused(key, value, error, message):
    with pytest.raises(error, match=message):
        with_changes(SHEET, changeables(SHEET), {key: value})


@pytest.mark.parametrize('model', model_names())
def test_everything_that_may_change_has_a_unit_a_meaning_and_two_bounds(model):
    """A range of ROS has two ends."""
    found = changeables(actuator_sheet(model))
    assert 'plant.spool.stuck' in found and 'reu.frozen' in found
    for name, own in found.items():
        assert own.unit and own.doc and name.partition('.')[0] in ('plant', 'reu', 'link')
        assert {'ge', 'gt'} & set(own.bounds) and {'le', 'lt'} & set(own.bounds), name
