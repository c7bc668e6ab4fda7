"""
Loads of a single actuator, integrated in its node with the plant's step.

Each is a constant load port (equation L1), an inertia with or without a spring to ground,
plus the forces of `isa_ros.loads.forces`. Generalised units: N, m, kg or Nm, rad, kg m2. Its
inertia, the force from outside and the place of a support may change during a run, at a tick.
"""

from typing import Any

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.signals import LOAD_PORT
from isa_ros.loads.drop_rig import DropRig, external_force, rope_record, Wheel
from isa_ros.loads.forces import OWN_LOAD, PAD, STOPS
import numpy as np


def _moving_mass() -> Any:
    return parameter(
        'moving mass; a small one is refused where the plant step cannot follow it', 'kg | kg m2',
        changeable=True, gt=0.0, le=1e5)


@frozen(kw_only=True)
class Blocked(Parameters):
    """The output held by a stiff support: a fixture on a spring to ground."""

    inertia: float = parameter(
        'moving part of the fixture', 'kg | kg m2', changeable=True, gt=0.0, le=1e5)
    stiffness: float = parameter('support', 'N/m | Nm/rad', gt=0.0, le=1e11)
    damping: float = parameter('support', 'Ns/m | Nms/rad', ge=0.0, le=1e8)
    force: float = external_force()
    displacement: float = fault(
        'of the support, from its place at t = 0; a new one is reached within a tick', 'm | rad',
        ge=-10.0, le=10.0)


@frozen(kw_only=True)
class Mass(Parameters):
    """A free mass or inertia, with a force on it."""

    inertia: float = _moving_mass()
    force: float = parameter(
        'force on it, e.g. weight; > 0 pushes out', 'N | Nm', changeable=True, ge=-2e7, le=2e7)


@frozen(kw_only=True)
class Pad(Parameters):
    """A free mass that meets a pad of a given material while it extends."""

    inertia: float = _moving_mass()
    gap: float = parameter('free travel from the start to the pad', 'm | rad', ge=0.0, le=10.0)
    radius: float = parameter(
        '1, or the radius at which a wheel meets the pad', 'm/m | m/rad', gt=0.0, le=10.0)
    stiffness: float = parameter('k of k d^1.5', 'N/m^1.5', gt=0.0, le=1e9)
    damping: float = parameter(
        "c of the factor 1 + c d' of Hunt and Crossley", 's/m', ge=0.0, le=100.0)
    force: float = external_force()


LocalLoad = Blocked | Wheel | Mass | Pad | DropRig


def local_port(load: LocalLoad, rest: float) -> np.ndarray:
    """Return the `LOAD_PORT` of a load at rest at ``rest`` (m or rad), shape (1,)."""
    port = np.zeros(1, LOAD_PORT)
    port['x0'] = rest
    write_port(load, port)
    return port


def write_port(load: LocalLoad, port: np.ndarray) -> None:
    """Write inertia, force and support of a load into its `LOAD_PORT`, shape (1,)  (L1)."""
    port['inverse_mass'] = 1.0 / load.inertia
    port['a_bias'] = load.force / load.inertia
    if isinstance(load, Blocked):
        port['stiffness'] = load.stiffness / load.inertia
        port['damping'] = load.damping / load.inertia


def move_support(rest: float, before: float, now: float, tick: float, port: np.ndarray) -> None:
    """
    Write the motion of a support during a tick of ``tick`` s into a `LOAD_PORT`, shape (1,).

    It moves at constant speed from its displacement ``before`` to that of ``now``, m or rad from
    its place at ``rest``.
    """
    port['x0'] = rest + before
    port['v0'] = (now - before) / tick


def own_record(load: LocalLoad | None) -> np.ndarray:
    """Return the load's `OWN_LOAD`, shape (1,); zeros for a load without such forces."""
    own = np.zeros(1, OWN_LOAD)
    if isinstance(load, Wheel):
        own['stops'] = record(
            STOPS, low=load.stop_low, high=load.stop_high, stiffness=load.stop_stiffness,
            damping=load.stop_damping)
    if isinstance(load, DropRig):
        own['rope'] = rope_record(load)
    elif isinstance(load, Pad):
        own['pad'] = record(
            PAD, gap=load.gap, radius=load.radius, stiffness=load.stiffness,
            damping=load.damping)
    return own


def linearised(load: LocalLoad) -> tuple[float, float, float, tuple[str, str, str]]:
    """
    Return inertia, stiffness and damping of a load in contact, and their names in its sheet.

    To ground, in units of the actuator.
    """
    if isinstance(load, Blocked):
        return load.inertia, load.stiffness, load.damping, ('inertia', 'stiffness', 'damping')
    if isinstance(load, Wheel):
        return (load.inertia, load.stop_stiffness, load.stop_damping,
                ('inertia', 'stop_stiffness', 'stop_damping'))
    return load.inertia, 0.0, 0.0, ('inertia', 'stiffness', 'damping')


def static_force(load: LocalLoad | None) -> float:
    """Return the sensor force that holds the load at rest, in N or Nm."""
    return -load.force if isinstance(load, Mass) else 0.0
