"""The account of the energy of an actuator."""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.accounts import accounts_of, ENERGY, SHARES
import numpy as np

CLOSES = 1e-6   # of the throughput: Simpson's rule over the plant steps
IMPACTS = 1e-3  # with relief valves and end stops, whose powers jump within a step


def account(actuator: SmartActuator) -> dict[str, float]:
    """Return entries in J by the field of `SAMPLE`."""
    found = accounts_of(
        [actuator.name], actuator.memory.samples, [], np.zeros(0), actuator.t_ns)
    return {entry.field: found[actuator.name][entry.key] for entry in (ENERGY, *SHARES)}


def remainder(found: dict[str, float]) -> float:
    """Return what is left of the balance over the throughput, the sum of all magnitudes."""
    energy = found['hydraulic_energy']
    parts = [found[entry.field] for entry in SHARES]
    return abs(energy - sum(parts)) / (abs(energy) + sum(map(abs, parts)))
