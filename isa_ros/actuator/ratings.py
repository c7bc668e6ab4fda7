"""The ratings that an actuator's protection compares with, from its own data sheet."""

import math

from isa_ros.core.record import record
from isa_ros.plant.servo_valve import flow_curve
from isa_ros.reu.plausibility import EVIDENCE
from isa_ros.reu.protection import Ratings
import numpy as np


def ratings_of(plant: np.record) -> Ratings:
    """Return the ratings of a `PLANT` record."""
    oil, valve, sensors = plant.chambers, plant.valve, plant.sensors
    flow = flow_curve(valve.x_max, valve) * valve.per_root_drop * math.sqrt(plant.relief.p_open)
    return Ratings(
        stroke=float(oil.stroke), speed=float(flow / min(oil.area_a, oil.area_b)),
        force_range=float(sensors.force_range), pressure_range=float(sensors.pressure_range),
        current_range=float(sensors.current_range),
        opening_pressure=float(plant.relief.p_open))


def evidence_of(
        plant: np.record, speed_rate: float, speed_steps: int, offset_steps: int) -> np.record:
    """Return the `EVIDENCE` record of a `PLANT` record and its REU's speed estimate."""
    return record(
        EVIDENCE, area_a=plant.chambers.area_a, area_b=plant.chambers.area_b,
        force_range=plant.sensors.force_range, stiction=plant.friction.stiction,
        viscous=plant.friction.sigma2, inertia=plant.mechanics.inertia, speed_rate=speed_rate,
        speed_steps=speed_steps, offset_steps=offset_steps)
