"""Levels, delays, reactions and the mask of the protection, changed while it runs."""

from isa_ros.actuator.sheet import actuator_record
from isa_ros.actuator.tunable import changing, PROTECTION
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import ENABLED, FAULT
from isa_ros.errors import ConfigError
import pytest
from tests.actuator.protected import clear, own, protected, ticks
from tests.sheets import actuator_sheet, override, setpoint, smart_actuator

OVERSPEED = f'{PROTECTION}overspeed.'
MASK = f'{PROTECTION}mask'
ALL = float((1 << len(BITS)) - 1)


def fast(**values):
    """Return an actuator that moves at about 0.4 m/s for 100 ms."""
    actuator = protected(**values)
    actuator.accept(setpoint(position=0.09))
    ticks(actuator, 40)
    assert abs(actuator.sample.velocity) > 0.2
    return actuator


def test_every_parameter_of_a_condition_changes_as_if_it_stood_in_the_sheet():
    sheet = actuator_sheet('isa_v5')
    names = [name for name in changing(sheet) if name.startswith(PROTECTION)]
    assert {f'{PROTECTION}overload.{key}' for key in (
        'warning', 'trip', 'delay_ms', 'reaction')} <= set(names)
    for name in names:
        given = changing(sheet)[name]
        if given.words:
            other = next(word for word in ('disable', 'warn', 'hold')
                         if word in given.choices and word != given.shown(given.value))
        else:
            trip = changing(sheet).get(name.replace('.warning', '.trip'), given)
            other = 0.0 if given.value else trip.value or given.bounds['le']
        actuator = smart_actuator('isa_v5', 'mass')
        before = actuator._constants.tobytes()
        try:
            written = override(sheet, name, other)
        except ConfigError:     # end_of_stroke refuses most reactions
            with pytest.raises(ConfigError, match='must be none or warn or limit'):
                actuator.tune({name: other})
            continue
        actuator.tune({name: other})
        assert actuator.parameter(name) == other
        ticks(actuator, 1)
        now = actuator.memory.constants['reu'].tobytes()
        assert now == actuator_record(written, 1)['reu'].tobytes(), name
        number = given.words.index(other) if given.words else other
        assert actuator.applied_parameters == {name: number}
        actuator.tune({name: given.shown(given.value)})
        ticks(actuator, 1)
        assert actuator._constants.tobytes() == before, name


@pytest.mark.parametrize(('values', 'message'), [
    ({'overload.reaction': 'stop'}, "reaction = 'stop', must be one of none, warn, limit, hold"),
    ({'overload.reaction': 7.0}, r'overload.reaction = 7, must be one of 0 \(none\), 1 \(warn\), '
     r'2 \(limit\), 3 \(hold\), 4 \(damp\), 5 \(quick_stop\), 6 \(disable\)$'),
    ({'overload.reaction': 0.5}, 'overload.reaction = 0.5, must be one of 0 '),
    ({'supply_low.reaction': 'limit'}, "supply_low.reaction = 'limit', must be one of none, warn"),
    ({'supply_low.reaction': 2.0}, r'supply_low.reaction = 2, must be one of 0 \(none\), 1 '),
    ({'end_of_stroke.reaction': 'hold'}, 'must be none or warn or limit: an actuator that stops'),
    ({'encoder_jump.reaction': 'quick_stop'}, 'encoder_jump.reaction = quick_stop, must be'),
    ({'overspeed.warning': 2.0}, 'overspeed.warning = 2, must be <= overspeed.trip = 1.1'),
    ({'overspeed.trip': 11.0}, 'overspeed.trip = 11, must be <= 10 '),
    ({'overload.delay_ms': -1.0}, 'overload.delay_ms = -1 ms, must be >= 0 ms'),
    ({'mask': 0.5}, 'mask = 0.5, must be a whole number'),
    ({'mask': ALL + 1.0}, 'mask = 524288, must be <= 524287 '),
    ({'overload.trip': 'high'}, "overload.trip = 'high', must be a number")])
def test_bounds_and_refusals_are_those_of_the_sheet(values, message):
    actuator = protected()
    before = actuator._constants.tobytes()
    with pytest.raises(ConfigError, match=message):
        actuator.tune({f'{PROTECTION}{key}': value for key, value in values.items()})
    ticks(actuator, 1)
    assert actuator._constants.tobytes() == before


def test_levels_that_fit_together_are_taken_together():
    """Each alone would be refused beside the other's old value, in either order."""
    for order in (1, -1):
        actuator = protected()
        actuator.tune(dict([(f'{OVERSPEED}warning', 2.0), (f'{OVERSPEED}trip', 3.0)][::order]))
        ticks(actuator, 1)
        warning, trip = (own_level / ratio for own_level, ratio in (
            (actuator._constants.reu.protection.warning[2], 2.0),
            (actuator._constants.reu.protection.trip[2], 3.0)))
        assert warning == pytest.approx(trip, rel=1e-12) and warning > 0.0


def test_with_the_switch_off_nothing_can_be_armed():
    actuator = protected(switch='off')
    with pytest.raises(ConfigError, match='mask is not used: reu.protection.switch = off'):
        actuator.tune({MASK: 1.0})


def test_an_actuator_in_fault_is_cleared_once_its_condition_is_masked():
    """The mask does not hide what has stopped it; afterwards the same speed is no trip."""
    actuator = fast()
    actuator.tune({f'{OVERSPEED}reaction': 'disable', f'{OVERSPEED}trip': 0.05,
                   f'{OVERSPEED}warning': 0.0, f'{OVERSPEED}delay_ms': 0.0})
    ticks(actuator, 1)
    assert conditions(actuator.sample.trips) == ['overspeed']
    assert actuator.sample.device_state == FAULT
    actuator.tune({MASK: float(1 << BITS['overspeed'])})
    ticks(actuator, 2)
    assert conditions(actuator.sample.trips) == ['overspeed']
    clear(actuator)
    ticks(actuator, 2)
    assert (actuator.sample.trips, actuator.sample.device_state) == (0.0, ENABLED)
    actuator.accept(setpoint(position=0.02))
    ticks(actuator, 40)
    assert abs(actuator.sample.velocity) > 0.2 and actuator.sample.trips == 0.0
    actuator.tune({MASK: 0.0})      # armed again
    ticks(actuator, 1)
    assert conditions(actuator.sample.trips) == ['overspeed']
    assert actuator.sample.device_state == FAULT


def test_a_hold_ends_when_its_condition_is_masked():
    """The setpoint that it held against is followed again, with the speed of a return."""
    actuator = protected(setpoint_timeout_ms=20.0)
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 100)
    assert actuator.sample.trips == 1.0
    held = float(actuator.sample.position)
    actuator.tune({MASK: 1.0})
    ticks(actuator, 2)
    assert (actuator.sample.trips, actuator._reu.status.is_stopping) == (0.0, 0)
    ticks(actuator, 200)
    # a stiction of 100 N leaves at most 1 mm at 1e5 N/m
    assert actuator.sample.position == pytest.approx(0.06, abs=1e-3) and held < 0.058
    actuator.tune({MASK: 0.0})      # the last setpoint is long ago
    ticks(actuator, 1)
    assert actuator.sample.trips == 1.0


def test_a_change_of_levels_fades_nothing_in_the_loops():
    """The outputs are those of an actuator that nothing was changed of."""
    changed, untouched = fast(), fast()
    changed.tune({f'{OVERSPEED}trip': 2.0, MASK: 4.0})
    changed.latch_tuning()
    assert changed._reu.status.fade.begins == 0
    for actuator in (changed, untouched):
        ticks(actuator, 5)
    assert changed.sample.tobytes() == untouched.sample.tobytes()
    assert changed.memory.constants.tobytes() != untouched.memory.constants.tobytes()


def test_a_saved_state_keeps_what_was_changed_and_what_was_kept():
    actuator = fast()
    values = {f'{OVERSPEED}reaction': 'disable', f'{OVERSPEED}trip': 0.05,
              f'{OVERSPEED}warning': 0.0, f'{OVERSPEED}delay_ms': 0.0}
    actuator.tune(values)
    ticks(actuator, 1)
    actuator.tune({f'{OVERSPEED}reaction': 'warn', MASK: 4.0})
    twin = protected()
    twin.restore(actuator.snapshot())
    assert own(twin).kept == 1 << BITS['overspeed']
    for each in (actuator, twin):
        ticks(each, 3)
    assert twin.snapshot() == actuator.snapshot()
    assert twin._constants.tobytes() == actuator._constants.tobytes()
    assert twin.parameter(f'{OVERSPEED}reaction') == 'warn' and twin.parameter(MASK) == 4.0
    assert conditions(twin.sample.trips) == ['overspeed']
