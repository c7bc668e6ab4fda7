"""The protection compares the spool with where its reference puts it, on every kind of valve."""

import math

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import FAULT
from isa_ros.core.signals import COMMAND, HAS_MODE, HAS_REFERENCE
import numpy as np
import pytest
from tests.sheets import actuator_sheet, FINE, override, setpoint, smart_actuator

BIT = BITS['spool_deviation']
DELAY = 500     # conversions, one a tick of `FINE`
VALVES = [('isa_v5',), ('isa_v2',), ('isa_v5', 'explicit'), ('cylinder',)]
"""A closed spool loop, one of the REU, and a data sheet's response."""


def sheet_of(model: str, *variants: str) -> ActuatorSheet:
    return actuator_sheet(model, 'default', *variants)


def moved(actuator: SmartActuator, n: int, k: int = 0) -> float:
    """Move 30 % of the stroke at 2 Hz for ``n`` ticks; return the largest deviation, by stops."""
    largest = 0.0
    stroke = actuator.sheet.plant.drive.stroke
    state = actuator.memory.reu['protection']
    stop = actuator.memory.constants['plant']['valve']['x_max'][0]
    for k in range(k, k + n):
        if k % 10 == 0:
            actuator.accept(setpoint(position=stroke * (
                0.5 + 0.3 * math.sin(4.0 * math.pi * k * 1e-4))))
        actuator.tick()
        largest = max(largest, float(state['values'][0, BIT]) / stop)
    return largest


@pytest.mark.parametrize('model', VALVES, ids='-'.join)
def test_a_sound_spool_is_where_its_reference_puts_it(model: tuple[str, ...]) -> None:
    """Within the 5 % of the warning, for all but the first moments of a step."""
    actuator = smart_actuator(model[0], 'mass', sheet=sheet_of(*model))
    assert 0.0 < moved(actuator, 5000) < 0.05
    assert not actuator.memory.reu['protection']['warning_since'].any()


@pytest.mark.parametrize('model', VALVES, ids='-'.join)
@pytest.mark.parametrize(('fault', 'value'), [
    ('plant.spool.stuck', 1.0), ('plant.sensors.spool.stuck', 1.0), ('plant.coil.open_coils', 2.0),
    ('plant.coil.supply_voltage', 1.0)])
def test_a_spool_that_does_not_follow_trips(
        model: tuple[str, ...], fault: str, value: float) -> None:
    """
    50 ms after it is 15 % of its stop away, and stops the actuator.

    A spool loop around a sensor that is stuck drives the piston away: that is seen sooner.

    A piloted spool at 1 V moves at 10 mm/s: it is late, but there within 18 ms.
    """
    actuator = smart_actuator(model[0], 'mass', sheet=sheet_of(*model))
    moved(actuator, 1000)
    actuator.tune({fault: value})
    moved(actuator, 3000, 1000)
    is_late = (model, fault) == (('isa_v5', 'explicit'), 'plant.coil.supply_voltage')
    runs_away = (model, fault) == (('isa_v5', 'explicit'), 'plant.sensors.spool.stuck')
    expected = [] if is_late else ['runaway' if runs_away else 'spool_deviation']
    assert conditions(actuator.sample.trips)[-1:] == expected
    assert (int(actuator.sample.device_state) == FAULT) != is_late


def test_it_trips_after_its_delay() -> None:
    """Counted from the first conversion at which it is too far, of which the time is known."""
    actuator = smart_actuator('isa_v5', 'mass')
    state = actuator.memory.reu['protection']
    moved(actuator, 1000)
    actuator.tune({'plant.spool.stuck': 1.0})
    k = 1000
    while moved(actuator, 1, k) <= 0.15:
        k += 1
    first = actuator.t_ns // 20_000
    while not actuator.sample.trips:
        k += 1
        moved(actuator, 1, k)
    assert actuator.t_ns // 20_000 - first == DELAY * 5
    assert first - 5 < int(state['trip_since'][0, BIT]) - DELAY * 5 < first


def test_a_shifted_null_is_warned_of() -> None:
    """A tenth of the rated current puts the spool a tenth of its stop beside its reference."""
    actuator = smart_actuator('isa_v5', 'mass')
    moved(actuator, 500)
    actuator.tune({'plant.spool.null_bias.current_ma': 0.5})
    assert moved(actuator, 2000, 500) > 0.1
    assert conditions(actuator.sample.warnings) == ['spool_deviation']
    assert conditions(actuator.sample.trips) == []


def test_a_current_is_a_reference_too_but_of_a_piloted_spool() -> None:
    """In the mode of the current a valve with its own loop is watched; an open loop is not."""
    found = {}
    for variants in ((), ('explicit',)):
        actuator = smart_actuator('isa_v5', 'mass', sheet=sheet_of('isa_v5', *variants))
        command = np.zeros(1, COMMAND)[0]
        command['kinds'], command['mode'], command['reference'] = HAS_MODE | HAS_REFERENCE, 1, 5e-3
        actuator.accept(command)
        actuator.tune({'plant.spool.stuck': 1.0})
        for _ in range(600):
            actuator.tick()
        found[variants] = conditions(actuator.sample.trips)
    assert found == {(): ['spool_deviation'], ('explicit',): []}


def test_a_mechanical_feedback_has_no_sensor_to_compare() -> None:
    rows = actuator_record(actuator_sheet('smart_manifold'), 0)
    assert rows['reu']['protection']['evidence']['valve']['is_watched'][0] == 0
    assert rows['reu']['protection']['warning'][0, BIT] == math.inf
    actuator = smart_actuator('smart_manifold', 'mass')
    actuator.tune({'plant.spool.stuck': 1.0})
    assert moved(actuator, 1000) == 0.0


def test_a_piloted_spool_without_its_gain_is_not_watched() -> None:
    """Its loop would not hold the spool anywhere."""
    sheet = override(sheet_of('isa_v5', 'explicit'), 'reu.spool.kp', 0.0)
    rows = actuator_record(sheet, 0)
    assert rows['reu']['protection']['evidence']['valve']['is_watched'][0] == 0


def test_its_rate_is_that_of_the_converters() -> None:
    """Eq 8 at low frequency: 1/540 s, and the current's 1/2000 s, at 10 kHz."""
    valve = actuator_record(actuator_sheet('isa_v5'), 0)['reu']['protection']['evidence']['valve']
    assert FINE.step_ns == 100_000
    assert valve['share'][0] == pytest.approx(1e-4 / (1.0 / 540.0 + 1.0 / 2000.0 + 1e-4), rel=1e-9)
