"""
Sensors of the REU: 12-bit converters and the encoder, each behind its channel.

All measurements that the controller uses and that are published pass through them, once per
period of the converters.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters, section
from isa_ros.core.record import record
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ParameterError
from isa_ros.plant import channels
from isa_ros.plant.coil import coil_current
from isa_ros.plant.mechanics import sensor_force
from isa_ros.plant.service_lines import sensed_pressures
from isa_ros.plant.temperature_sensor import (
    TEMPERATURE_SENSOR, temperature_sensor_record, TemperatureSensor)
import numpy as np


@frozen(kw_only=True)
class Sensors(Parameters):
    """Ranges, resolutions, and the errors of the channels."""

    adc_bits: float = parameter('resolution of the converters', 'bit', ge=4, le=24)
    encoder_resolution: float = parameter('position resolution', 'm | rad', gt=0.0, le=0.01)
    force_range: float = parameter('force sensor, +-', 'N | Nm', gt=0.0, le=2e7)
    pressure_range_mpa: float = parameter('pressure sensors, 0 to', 'MPa', gt=0.0, le=100.0)
    spool_range_mm: float = parameter('spool sensor, +-', 'mm', gt=0.0, le=2.0)
    current_range_ma: float = parameter('current sensor, +-', 'mA', gt=0.0, le=200.0)

    position: channels.PositionChannel = section(channels.PositionChannel)
    force: channels.ForceChannel = section(channels.ForceChannel)
    pressure_a: channels.PressureChannel = section(channels.PressureChannel)
    pressure_b: channels.PressureChannel = section(channels.PressureChannel)
    spool: channels.SpoolChannel = section(channels.SpoolChannel)
    current: channels.CurrentChannel = section(channels.CurrentChannel)
    supply: channels.PressureChannel = section(channels.PressureChannel)
    temperature: TemperatureSensor = section(TemperatureSensor)

    def __post_init__(self) -> None:
        """Refuse a resolution that is not a whole number of bits."""
        super().__post_init__()
        if self.adc_bits != int(self.adc_bits):
            raise ParameterError(f'adc_bits = {self.adc_bits:g} bit, must be a whole number')

    @property
    def channels(self) -> dict[str, channels.Channel]:
        """Return the channels by name, in the order of `channels.NAMES`."""
        return {name: getattr(self, name) for name in channels.NAMES}


SENSORS = np.dtype([
    ('encoder', 'f8'),
    ('force_range', 'f8'), ('force_step', 'f8'),
    ('pressure_range', 'f8'), ('pressure_step', 'f8'),
    ('spool_range', 'f8'), ('spool_step', 'f8'),
    ('current_range', 'f8'), ('current_step', 'f8'),
    ('errors', channels.CHANNEL_ERRORS),
    ('temperature', TEMPERATURE_SENSOR)])


def sensors_record(sheet: Sensors) -> np.record:
    """Return the `SENSORS` record: a range and a step of one least significant bit each."""
    codes = float(1 << int(sheet.adc_bits))
    pressure = sheet.pressure_range_mpa * MPA
    spool, current = sheet.spool_range_mm * MILLI, sheet.current_range_ma * MILLI
    return record(
        SENSORS, encoder=sheet.encoder_resolution,
        force_range=sheet.force_range, force_step=2.0 * sheet.force_range / codes,
        pressure_range=pressure, pressure_step=pressure / codes,
        spool_range=spool, spool_step=2.0 * spool / codes,
        current_range=current, current_step=2.0 * current / codes,
        errors=channels.channel_errors(sheet.channels),
        temperature=temperature_sensor_record(sheet.temperature))


@kernel
def encode(position, resolution):
    """
    Return the position rounded to whole encoder counts  (S1).

    One that has diverged stays what it is: `math.floor` of it raises in plain Python.
    """
    return np.floor(position / resolution + 0.5) * resolution


@kernel
def convert(value, lowest, highest, step):
    """Return the nearest code of a converter with full scale ``lowest`` to ``highest``  (S2)."""
    clipped = max(lowest, min(highest - step, value))
    return lowest + np.floor((clipped - lowest) / step + 0.5) * step


@kernel
def sense(step, period, y, x_load, v_load, supply_pressure, plant, key, state, measured):
    """
    Convert every channel once, at plant step ``step``  (S1-S3); return the read supply pressure.

    ``y`` is a `PLANT_STATE`; ``x_load`` and ``v_load`` are the load's side of the force sensor,
    ``supply_pressure`` the exact one in Pa, ``period`` that of the converters in plant steps,
    ``key`` of the noise, ``state`` a `channels.CHANNELS_STATE`, ``measured`` a `MEASURED`.
    """
    own, at = plant.sensors, y.mechanics
    measured.position = at.position
    measured.force = sensor_force(at.position, at.velocity, x_load, v_load, plant.mechanics)
    measured.pressure_a, measured.pressure_b = sensed_pressures(y, plant)
    measured.spool = y.spool.position
    measured.current = coil_current(y.coil, plant.coil)
    if not own.errors.are_ideal:
        supply_pressure = disturb(
            step, period, supply_pressure, own.errors, key, state, measured)
    read(own, measured)
    if not own.errors.are_ideal:
        lose(own, measured)
        if own.errors.is_lost[channels.SUPPLY] == 1:
            supply_pressure = -channels.DEAD * own.pressure_range
    return supply_pressure


@kernel
def lose(own, measured):
    """Replace the readings of channels whose wire is broken: below the range, by `DEAD` of it."""
    lost = own.errors.is_lost
    if lost[1] == 1:
        measured.force = -(1.0 + channels.DEAD) * own.force_range
    if lost[2] == 1:
        measured.pressure_a = -channels.DEAD * own.pressure_range
    if lost[3] == 1:
        measured.pressure_b = -channels.DEAD * own.pressure_range
    if lost[4] == 1:
        measured.spool = -(1.0 + channels.DEAD) * own.spool_range
    if lost[5] == 1:
        measured.current = -(1.0 + channels.DEAD) * own.current_range


@kernel
def disturb(step, period, supply_pressure, errors, key, state, measured):
    """
    Replace exact values by what their channels show the converters  (S3).

    Returns what that of the supply shows, Pa.
    """
    exact = channels.enter(step, period, state)
    exact[0], exact[1] = measured.position, measured.force
    exact[2], exact[3] = measured.pressure_a, measured.pressure_b
    exact[4], exact[5] = measured.spool, measured.current
    exact[channels.SUPPLY] = supply_pressure
    channels.disturb(step, period, key, errors, state)
    shown = state.shown
    measured.position, measured.force = shown[0], shown[1]
    measured.pressure_a, measured.pressure_b = shown[2], shown[3]
    measured.spool, measured.current = shown[4], shown[5]
    return shown[channels.SUPPLY]


@kernel
def read(own, measured):
    """Replace values by the readings of encoder and converters  (S1, S2)."""
    measured.position = encode(measured.position, own.encoder)
    measured.force = convert(
        measured.force, -own.force_range, own.force_range, own.force_step)
    measured.pressure_a = convert(
        measured.pressure_a, 0.0, own.pressure_range, own.pressure_step)
    measured.pressure_b = convert(
        measured.pressure_b, 0.0, own.pressure_range, own.pressure_step)
    measured.spool = convert(
        measured.spool, -own.spool_range, own.spool_range, own.spool_step)
    measured.current = convert(
        measured.current, -own.current_range, own.current_range, own.current_step)
