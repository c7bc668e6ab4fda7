"""
What the bus interface of one actuator knows of it: scales, ranges, modes, and its last sample.

Positions are counted in micrometres or microradians and velocities in these per second; forces in
per mille of the rated force or torque. Extending and pushing out are positive.
"""

from isa_ros.actuator.ratings import ratings_of
from isa_ros.actuator.setpoint_range import reference_bounds, setpoint_bounds
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.changeable import sound
from isa_ros.core.device import (
    DISABLED, ENABLED, FAULT, FORCE, INITIALISING, QUICK_STOP, SPOOL)
from isa_ros.core.signals import SAMPLE
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MICRO, MILLI, MPA, of_coordinate
from isa_ros.plant.plant import plant_record
from isa_ros.reu.cascade import initial_gains
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.wiring import first_mode, possible_modes
import numpy as np

PER_MILLE = 1e-3
INCREMENT = MICRO
"""m or rad of a count of position; m/s or rad/s of one of velocity."""
COUNTS = 1e6
"""Counts per m or rad: a quotient by it is the decimal number, unlike a product by `INCREMENT`."""
FULL_SCALE = 16384
"""Counts of 100 % of spool or pressure in CiA 408."""

FIELDS = {name: place for place, name in enumerate(SAMPLE.names or ())}
_POSITION, _VELOCITY, _STATE = (
    FIELDS[name] for name in ('position', 'velocity', 'device_state'))


class Axis:
    """One actuator of a run, with the sample that the bus shows."""

    def __init__(self, config: ActuatorConfig, step_ns: int) -> None:
        sheet = config.sheet
        position = sheet.reu.position
        self.name, self.model, self.sheet = config.name, config.model, sheet
        self.step_ns = step_ns
        self.step = step_ns / NS_PER_SECOND
        """Length of a tick, s."""
        self.modes = possible_modes(sheet.reu)
        """Modes that the wiring has, of `isa_ros.core.device`."""
        first = first_mode(sheet.reu)
        self.position_mode = first if first > FORCE else 0
        """Mode with the position block; 0: there is none."""
        self.stroke: float = sheet.plant.drive.stroke
        self.force_out = self.force_in = float(sheet.plant.sensors.force_range)
        if isinstance(position, Impedance):
            self.force_out, self.force_in = position.force_out, position.force_in
        self.rated_force = max(self.force_out, self.force_in)
        """N or Nm: that of the impedance; without one the range of the force sensor."""
        self.rated_speed = ratings_of(plant_record(sound(sheet.plant))[0]).speed
        """m/s or rad/s, that of `isa_ros.reu.protection.Ratings`."""
        self.gains = initial_gains(sheet.reu)
        bounds = setpoint_bounds(sheet)
        self.largest_gains = tuple(
            bounds[gain].high if gain in bounds else 0.0 for gain in ('stiffness', 'damping'))
        """Largest stiffness and damping of a setpoint, SI."""
        self.references = reference_bounds(sheet)
        """Ranges of the references of the inner modes."""
        self.pressure_range: float = sheet.plant.sensors.pressure_range_mpa * MPA
        self.spool_stop = self.references[SPOOL].high
        self.rated_current: float = sheet.plant.sensors.current_range_ma * MILLI
        self.sample: tuple[float, ...] = (0.0,) * len(FIELDS)
        """The last `SAMPLE`; its places are `FIELDS`."""
        self.position, self.velocity = config.initial_position, 0.0
        self.state = INITIALISING
        """State of the REU's device."""
        self.has_emergency_stop = False
        """Whether the line of its emergency stop is open."""

    def unit(self, unit: str) -> str:
        """Return the unit of this kind of actuator: of ``linear | rotary``."""
        return of_coordinate(unit, self.sheet.is_rotary)

    def take_sample(self, sample: np.void) -> None:
        """Keep a copy of a sample."""
        own = self.sample = tuple(sample.item())
        self.position, self.velocity = own[_POSITION], own[_VELOCITY]
        self.state = int(own[_STATE])

    @property
    def is_on(self) -> bool:
        """Return whether the REU's outputs are on, or about to be switched off."""
        return self.state in (ENABLED, QUICK_STOP)

    @property
    def is_disabled(self) -> bool:
        """Return whether the REU can be enabled."""
        return self.state == DISABLED

    @property
    def is_off(self) -> bool:
        """Return whether the REU's outputs are off and stay so."""
        return self.state in (INITIALISING, DISABLED, FAULT)

    def field(self, name: str) -> float:
        """Return a field of the sample."""
        return self.sample[FIELDS[name]]
