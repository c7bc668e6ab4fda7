"""The load of an actuator that moves a body with others: its effective mass at the start pose."""

from typing import NamedTuple

from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.signals import LOAD_PORT
import numpy as np

_LIGHTEST = 1e-9    # 1/kg | 1/(kg m2); below, at a dead centre, the force moves nothing


class BodyLoad(NamedTuple):
    """The load that a body is at one of its actuators, all others at rest as at t = 0."""

    body: str
    inertia: float
    """Effective mass m_eff of the load port (L1), kg | kg m2."""
    force: float
    """On the load; that of the actuator at t = 0 holds it, N | Nm."""


def body_load(run: RunConfig, actuator: str) -> BodyLoad | None:
    """
    Return the load of an actuator that moves a body; None: of an external body, or a dead centre.

    Raises as `surroundings_of`.
    """
    own = run.body_of(actuator)
    if own is None or any(body.is_given for body in run.bodies):
        return None
    surroundings, row = surroundings_of(run), run.index(actuator)
    ports = np.zeros(len(run.actuators), LOAD_PORT)
    surroundings.ports(ports)
    inverse_mass = float(ports['inverse_mass'][row])
    if inverse_mass <= _LIGHTEST:
        return None
    force = float(surroundings.starts()['force'][row])
    return BodyLoad(own.name, 1.0 / inverse_mass, -force)
