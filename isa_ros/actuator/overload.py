"""
The largest force on a load that an actuator holds, or its end stop before a chamber is gone.

A chamber holds p_r A, with the pressure that opens its relief valve. Beyond that the load falls
over the stroke L, and the end stop takes its work within the depth of the dead volume, V_p/A:

    F_most = p_r A + k_stop (V_p/A)^2 / (2 L)

Neglected: what the supply adds; a mass of grams behind a valve that is a hundred times too large
may bounce between both ends until the simulation diverges.
"""

from isa_ros.core.units import MILLILITRE, MPA
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad, Mass
from isa_ros.plant.plant import LinearPlant, MotorPlant, Plant, RotaryPlant


def most_force(plant: LinearPlant | RotaryPlant, area: float) -> float:
    """Return F_most of the module towards the chamber of an area, m2 or m3/rad, in N or Nm."""
    depth = plant.oil.dead_volume_ml * MILLILITRE / area
    stops = 0.5 * plant.mechanics.stop_stiffness * depth * depth / plant.drive.stroke
    return float(plant.relief.opening_pressure_mpa * MPA * area + stops)


def force_bounds(plant: Plant, load: LocalLoad | None) -> tuple[float, float] | None:
    """
    Return the least and the largest force that may stay on a load, in N or Nm.

    None: this load or actuator has no such bound.
    """
    if not isinstance(load, Mass) or isinstance(plant, MotorPlant):
        return None
    area_a, area_b = plant.drive.areas
    return -most_force(plant, area_a), most_force(plant, area_b)


def refuse_overload(plant: Plant, load: LocalLoad | None) -> None:
    """
    Refuse a constant force on a load that drives the piston through its end stop.

    Raises
    ------
    ConfigError
        It is beyond `most_force`, where a chamber would have no volume.

    """
    bounds = force_bounds(plant, load)
    if bounds is None or not isinstance(load, Mass):
        return
    unit, larger = ('N', 'bore') if isinstance(plant, LinearPlant) else ('Nm', 'displacement')
    least, most = bounds
    if not least <= load.force <= most:
        raise ConfigError(
            f'load.force = {load.force:g} {unit}, must be {least:.4g} to {most:.4g} {unit}: '
            'beyond it the load falls past relief valve and end stop until a chamber has no '
            f'volume; a larger {larger} carries it')
