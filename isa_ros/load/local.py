"""
Loads of one actuator alone, integrated in its node with the plant's step.

Each is a constant load port (equation L1): an inertia, a spring to ground, end stops.
Generalised units: N, m, kg or Nm, rad, kg m2.
"""

from dataclasses import dataclass

from isa_ros.load.port import LOAD_STOPS
from isa_ros.parameter import parameter, Parameters
from isa_ros.signals import LOAD_PORT
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Blocked(Parameters):
    """The output held by a stiff support: a fixture on a spring to ground."""

    inertia: float = parameter('moving part of the fixture', 'kg | kg m2', gt=0.0, le=1e4)
    stiffness: float = parameter('support', 'N/m | Nm/rad', gt=0.0, le=1e9)
    damping: float = parameter('support', 'Ns/m | Nms/rad', ge=0.0, le=1e6)


@dataclass(frozen=True, kw_only=True)
class Wheel(Parameters):
    """The paper's load wheel with the rig's two end stops."""

    inertia: float = parameter('wheel', 'kg | kg m2', gt=0.0, le=1e4)
    stop_low: float = parameter('lower end stop of the rig', 'm | rad')
    stop_high: float = parameter('upper end stop of the rig', 'm | rad')
    stop_stiffness: float = parameter('end stops', 'N/m | Nm/rad', gt=0.0, le=1e9)
    stop_damping: float = parameter('end stops', 'Ns/m | Nms/rad', ge=0.0, le=1e6)


@dataclass(frozen=True, kw_only=True)
class Mass(Parameters):
    """A free mass or inertia, with a constant force on it."""

    inertia: float = parameter('moving mass', 'kg | kg m2', gt=0.0, le=1e4)
    force: float = parameter('constant force on it, e.g. weight', 'N | Nm', ge=-1e6, le=1e6)


LocalLoad = Blocked | Wheel | Mass


def local_port(load: LocalLoad, rest: float) -> np.ndarray:
    """Return the constant `LOAD_PORT` of a load at rest at ``rest`` (m or rad), shape (1,)."""
    port = np.zeros(1, LOAD_PORT)
    port['x0'] = rest
    port['inverse_mass'] = 1.0 / load.inertia
    if isinstance(load, Blocked):
        port['stiffness'] = load.stiffness / load.inertia
        port['damping'] = load.damping / load.inertia
    elif isinstance(load, Mass):
        port['a_bias'] = load.force / load.inertia
    return port


def local_stops(load: LocalLoad | None) -> np.ndarray:
    """Return the load's `LOAD_STOPS`, shape (1,); zero where it has none."""
    stops = np.zeros(1, LOAD_STOPS)
    if isinstance(load, Wheel):
        stops[0] = (load.stop_low, load.stop_high, load.stop_stiffness, load.stop_damping)
    return stops


def static_force(load: LocalLoad | None) -> float:
    """Return the sensor force that holds the load at rest, in N or Nm."""
    return -load.force if isinstance(load, Mass) else 0.0
