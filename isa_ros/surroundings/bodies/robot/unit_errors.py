"""
What may change of a robot during a run: pushes on a free root, errors of its inertial units.

A unit that can fail has its errors among the values of its robot, as `imus.NAME.KEY`.
"""

from collections.abc import Mapping

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import Parameters, set_by_name
from isa_ros.surroundings.bodies.robot.sheet import Push
from isa_ros.surroundings.inertial_unit import UnitErrors
import numpy as np

NEVER = np.iinfo(np.int64).max
"""A period that no run reaches, ns: a unit that is stuck reads no more."""


@frozen(kw_only=True)
class FailingUnits(Parameters):
    """What may change of a robot with a fixed root: a set of `UnitErrors` a unit."""

    imus: Parameters


@frozen(kw_only=True)
class PushAndUnits(Push):
    """What may change of a robot with a free root and units that can fail."""

    imus: Parameters


def changing_values(is_free: bool, errors: Mapping[str, UnitErrors]) -> Parameters | None:
    """Return what may change of a robot whose units have ``errors`` by name; None: nothing."""
    if not errors:
        return Push() if is_free else None
    units = set_by_name(errors, UnitErrors)
    return PushAndUnits(imus=units) if is_free else FailingUnits(imus=units)


def write_errors(errors: UnitErrors, axes: np.ndarray, period_ns: int, unit: np.record,
                 periods: np.ndarray) -> None:
    """
    Write errors into the `UNIT` row of a unit and its period, ns, shape (1,).

    ``axes`` (9,) are those of the sheet: readings are along the axes of the row, of length
    ``scale``; of a unit that is lost they have none.
    """
    is_there = 1.0 - errors.lost
    unit['rotation'] = axes * (errors.scale * is_there)
    for field, values in (
            ('sigma', (errors.accelerometer_sigma, errors.gyro_sigma)),
            ('bias', (errors.accelerometer_bias, errors.gyro_bias))):
        unit[field] = np.repeat(np.array(values) * is_there, 3)
    periods[0] = NEVER if errors.stuck else period_ns
