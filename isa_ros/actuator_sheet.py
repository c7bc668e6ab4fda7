"""The data sheet of one actuator, and the SI records the kernels read."""

from dataclasses import dataclass

from isa_ros.actuator_kernel import ACTUATOR
from isa_ros.parameter import choice, Parameters
from isa_ros.plant.chambers import oil_stiffness
from isa_ros.plant.plant import LinearPlant, plant_record, RotaryPlant
from isa_ros.reu.cascade import Reu, reu_record
from isa_ros.reu.schedule import POINTS
import numpy as np


@dataclass(frozen=True, kw_only=True)
class ActuatorSheet(Parameters):
    """Everything that makes one actuator: plant, REU and how the two are wired."""

    spool_feedback: str = choice(
        'electric: the force loop commands the spool; mechanic: it commands the current',
        'electric', 'mechanic')
    plant: LinearPlant | RotaryPlant
    reu: Reu

    @property
    def is_rotary(self) -> bool:
        """Return whether the generalised units are rad and Nm."""
        return isinstance(self.plant, RotaryPlant)


def gain_schedule(plant: np.record, name: str) -> np.ndarray:
    """
    Return the factor on the force gains at `POINTS` equal distances, shape (POINTS,)  (R6).

    ``oil_stiffness`` divides by the stiffness the loop works against, the trapped oil in
    series with the force sensor, relative to its least over the stroke: the gain of the force
    plant is proportional to it.
    """
    if name == 'constant':
        return np.ones(POINTS)
    k_s = plant.mechanics.k_s
    stiffness = np.array([
        1.0 / (1.0 / oil_stiffness(s, plant.chambers) + 1.0 / k_s)
        for s in np.linspace(0.0, plant.chambers.stroke, POINTS)])
    schedule: np.ndarray = stiffness.min() / stiffness
    return schedule


def actuator_record(sheet: ActuatorSheet, offset_steps: int) -> np.ndarray:
    """Return the `ACTUATOR` record of a sheet without load stops, shape (1,)."""
    plant = plant_record(sheet.plant)
    valve, coil = plant[0].valve, plant[0].coil
    is_electric = sheet.spool_feedback == 'electric'
    reu = reu_record(
        sheet.reu, offset_steps, plant[0].chambers.stroke,
        gain_schedule(plant[0], sheet.reu.force.gain_schedule),
        spool_per_output=1.0 if is_electric else valve.k_spool,
        current_per_spool=coil.parallel / valve.k_spool)
    record = np.zeros(1, ACTUATOR)
    record['plant'], record['reu'] = plant, reu
    return record
