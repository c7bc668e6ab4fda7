"""What an offset of the load cell triggers, and that noise gives no alarm."""

from typing import Any

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.record import row_record
from isa_ros.reu.reactions import protect
import numpy as np
import pytest
from tests.actuator.protected import CONVERSION_STEPS, own, protected, ticks
from tests.sheets import actuator_sheet, FINE, override, setpoint, smart_actuator, TICK


class Shadow:
    """A second protection of a moving actuator, with readings of other sensors."""

    def __init__(self, actuator: SmartActuator) -> None:
        self.state = row_record(actuator.memory.reu.copy())
        self.constants = row_record(actuator.memory.constants).reu.protection
        self.warned = self.tripped = 0

    def convert(self, actuator: SmartActuator, **added: float) -> None:
        """Take the conversion of the last tick, with something added to its readings."""
        reu = row_record(actuator.memory.reu)
        self.state.measured, self.state.speed = reu.measured, reu.speed
        self.state.current_reference = reu.current_reference
        for field, error in added.items():
            setattr(self.state.measured, field, getattr(reu.measured, field) + error)
        step = actuator.t_ns // 20_000 - CONVERSION_STEPS + 1
        protect(step, 20.7e6, 40.0, self.constants, self.state)
        self.warned |= int(self.state.protection.warnings)
        self.tripped |= int(self.state.protection.trips)


def sweep(actuator: SmartActuator, n: int) -> Any:
    """Yield after each of ``n`` conversions of a motion of 20 mm at 4 Hz."""
    for k in range(n):
        if k % 10 == 0:
            actuator.accept(setpoint(position=0.05 + 0.02 * np.sin(8 * np.pi * k * 1e-4)))
        actuator.tick()
        yield k


@pytest.mark.parametrize('part', [-0.15, -0.08, 0.08, 0.15])
def test_an_offset_of_the_load_cell_is_detected(part: float) -> None:
    """
    Of 15 % of its range as a trip, of 8 % as a warning, both while the piston moves.

    Levels are 10 and 5 %; friction of at most 1.3 % is allowed for and may add or hide as much.
    """
    actuator = protected(timing=FINE)
    shadow, begins = Shadow(actuator), 500
    offset = part * float(actuator.memory.constants['plant']['sensors']['force_range'][0])
    for k in sweep(actuator, 4000):
        shadow.convert(actuator, force=offset if k >= begins else 0.0)
        if k < begins + 500:
            assert (shadow.warned, shadow.tripped) == (0, 0)
    bit = 1 << BITS['load_cell_implausible']
    assert (shadow.warned, shadow.tripped) == (bit, bit if abs(part) > 0.1 else 0)
    if abs(part) > 0.1:
        step = int(shadow.state.protection.trip_since[BITS['load_cell_implausible']])
        first = begins * CONVERSION_STEPS + 1
        assert step == first + 500 * CONVERSION_STEPS  # its delay of 50 ms


@pytest.mark.parametrize('part', [-0.15, 0.15])
def test_an_actuator_with_an_offset_disables_itself(part: float) -> None:
    """Through its own sensors: 50 ms after the first conversion, of which the cause is kept."""
    sheet = actuator_sheet('isa_v5')
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=override(
        sheet, 'plant.sensors.force.bias', part * sheet.plant.sensors.force_range))
    ticks(actuator, 50)
    assert actuator.sample.trips == 0.0
    ticks(actuator, 1)
    assert conditions(actuator.sample.trips) == ['load_cell_implausible']
    assert own(actuator).trip_since[BITS['load_cell_implausible']] == 1 + 500 * CONVERSION_STEPS
    assert actuator.sample.current_reference == 0.0


def noisy(sheet: Any) -> Any:
    """Return a sheet with noise of 0.5 % of each range and of two counts of the encoder."""
    sensors = sheet.plant.sensors
    for channel, sigma in (
            ('force', 5e-3 * sensors.force_range), ('current', 5e-6 * sensors.current_range_ma),
            ('pressure_a', 5e3 * sensors.pressure_range_mpa),
            ('pressure_b', 5e3 * sensors.pressure_range_mpa),
            ('position', 2.0 * sensors.encoder_resolution)):
        sheet = override(sheet, f'plant.sensors.{channel}.sigma', sigma)
    return sheet


@pytest.mark.parametrize('sheet', [
    actuator_sheet('isa_v5', 'default', 'data_sheet_sensors'), noisy(actuator_sheet('isa_v5'))],
    ids=['data sheet', 'half a percent'])
def test_noise_gives_no_alarm(sheet: Any) -> None:
    """
    Over 20 000 conversions of a moving actuator no bit is set, not even between two samples.

    With 0.5 % the force that pressures do not explain has 75 N of noise; its warning is at 500 N.
    """
    actuator = smart_actuator('isa_v5', 'mass', sheet=sheet, timing=TICK)
    for k in range(2000):
        actuator.accept(setpoint(position=0.05 + 0.02 * np.sin(8 * np.pi * k * 1e-3)))
        actuator.tick()
    assert not own(actuator).warning_since.any() and not own(actuator).trip_since.any()
    assert actuator.sample.warnings == 0.0
