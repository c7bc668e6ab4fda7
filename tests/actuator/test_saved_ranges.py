"""Whole numbers of a saved state beyond their range: refused by name."""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.saved_ranges import LARGEST
from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError
from isa_ros.reu.cascade import REU_STATE
import pytest
from tests.sheets import smart_actuator

OF_COMMAND = {name for name in LARGEST if name in (COMMAND.names or ())}


@pytest.fixture(scope='module')
def actuator() -> SmartActuator:
    actuator = smart_actuator('isa_v5', 'blocked')
    for _ in range(3):
        actuator.tick()
    return actuator


def altered(actuator: SmartActuator, field: str, value: int) -> bytes:
    """Return a snapshot with another number in its `REU_STATE`, or in its pending command."""
    rows = (actuator.memory.pending if field in OF_COMMAND else actuator.memory.reu)
    kept = rows.copy()
    *path, last = field.split('.')
    section = rows
    for name in path:
        section = section[name]
    section[last] = value
    try:
        return actuator.snapshot()
    finally:
        rows[:] = kept


@pytest.mark.parametrize('field', LARGEST)
def test_a_number_beyond_its_range_is_refused_by_name(field, actuator):
    whole = actuator.snapshot()
    for value in (-1, LARGEST[field] + 1, 2**31 - 1):
        value = value % 2**32 if field in ('kinds', 'is_enabled') else value
        with pytest.raises(ConfigError) as error:
            actuator.restore(altered(actuator, field, value))
        assert str(error.value).endswith(
            f'saved state has {field} = {value}, must be 0 to {LARGEST[field]}')
        assert actuator.snapshot() == whole
    actuator.restore(altered(actuator, field, LARGEST[field]))
    actuator.restore(whole)


def test_every_place_and_bit_of_the_reu_has_a_range():
    """What is left are plant steps, and counts of conversions."""
    def names(record, prefix=''):
        for name in record.names:
            below = record[name].base
            if below.names:
                yield from names(below, f'{prefix}{name}.')
            elif below.kind in 'iu':
                yield f'{prefix}{name}'
    left = {name.split('.')[-1] for name in set(names(REU_STATE)) - set(LARGEST)}
    assert left == {
        'since_step', 'setpoint_age', 'warning_count', 'trip_count', 'warning_since',
        'refused_requests', 'unused_setpoints',
        'trip_since', 'link_lost_step', 'switched'}
