"""Inertial units of a robot in a run file, in the axes of a link of its URDF."""

from collections.abc import Sequence

from isa_ros.config.robots.frames import frame_named, in_link
from isa_ros.config.robots.tree import RobotTree
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import FLAG, Key, ParameterSet, TEXT
from isa_ros.config.text.sections import Place
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import RobotUnit, vector
from isa_ros.surroundings.inertial_unit import InertialUnitSheet, UnitErrors


@frozen
class UnitConfig:
    """An inertial measurement unit of a robot, in the axes of a link of the URDF."""

    name: str
    link: str
    sheet: InertialUnitSheet
    can_fail: bool = False
    """Whether its errors are among the values that change during a run."""


UNIT = KeyTable((
    Key('link', TEXT, 'link of the URDF; its axes are those of the unit'),
    Key('can_fail', FLAG, 'whether its errors may change during a run', None,
        of=lambda own: own.can_fail or None)),
    rest=Key('sheet', ParameterSet(InertialUnitSheet), 'the unit'))


def refuse_units(units: Sequence[UnitConfig], tree: RobotTree, step_ns: int, place: Place) -> None:
    """
    Refuse units on a link that the tree does not have, or with a period beside the ticks.

    Raises
    ------
    ConfigError
        Names the unit at fault.

    """
    links = [frame.name for frame in tree.frames]
    for own in units:
        if own.link not in links:
            raise ConfigError(f'{place / own.name / "link"} = {own.link!r} is not a link of '
                              f'the URDF; {alternatives(own.link, links)}')
        own.sheet.period_ns(step_ns, str(place / own.name))


def robot_unit(own: UnitConfig, tree: RobotTree, step_ns: int, key: int) -> RobotUnit:
    """Return a unit of the sheet of a robot, SI, with its key of the noise."""
    frame, sheet = frame_named(tree, own.link), own.sheet
    link, at = in_link(frame, [MILLI * one for one in (sheet.x_mm, sheet.y_mm, sheet.z_mm)])
    return RobotUnit(
        own.name, link, vector(at), frame.rotation, sheet.accelerometer_sigma,
        sheet.accelerometer_bias, sheet.gyro_sigma, sheet.gyro_bias,
        sheet.period_ns(step_ns, own.name), key, errors_of(own))


def errors_of(own: UnitConfig) -> UnitErrors | None:
    """Return the errors of a unit as they are at its start; None: it cannot fail."""
    if not own.can_fail:
        return None
    sheet = own.sheet
    return UnitErrors(
        accelerometer_sigma=sheet.accelerometer_sigma, gyro_sigma=sheet.gyro_sigma,
        accelerometer_bias=sheet.accelerometer_bias, gyro_bias=sheet.gyro_bias, scale=1.0)
