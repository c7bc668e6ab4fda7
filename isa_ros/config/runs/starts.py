"""Where a run begins: the pose of its leg, and the positions of its actuators."""

import math

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.runs.leg_config import LegConfig, LegStart
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Entry, Place, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.parameter import check
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet


def leg_start(tree: Tree, place: Place, base: LegStart | None = None) -> LegStart:
    """Return the start of a leg; keys missing in the section are as in ``base``."""
    section = written(tree, place)
    if base is not None:
        section = {f: Entry(getattr(base, f), str(place / f), '')
                   for f in LegStart.__dataclass_fields__} | section
    return build(LegStart, section, place)


def refuse_start(start: LegStart, sheet: LegSheet, step_ns: int, place: Place) -> None:
    """Refuse joint angles outside the joints' ranges and a release between two ticks."""
    for joint in JOINTS:
        angle, limits = getattr(start, f'{joint}_deg'), getattr(sheet, joint)
        if not limits.low_deg <= angle <= limits.high_deg:
            raise ConfigError(
                f'{place}.{joint}_deg = {angle:g} deg, must be within its range '
                f'{limits.low_deg:g} to {limits.high_deg:g} deg')
    ticks_in(start.release_s, step_ns, f'{place}.release_s')


def refuse_reach(leg: LegConfig, joint: str, sheet: ActuatorSheet, where: str) -> None:
    """Refuse a start of the leg that is outside the stroke of a joint's actuator."""
    position, stroke = leg.position_of(joint), sheet.plant.drive.stroke
    if not 0.0 <= position <= stroke:
        scale, unit = (math.degrees(1.0), 'deg') if sheet.is_rotary else (1.0 / MILLI, 'mm')
        raise ConfigError(
            f'{where}: the start of the leg, {joint} = {math.degrees(leg.start.angle(joint)):g} '
            f'deg, puts it at {position * scale:.4g} {unit}, must be within its 0 to '
            f'{stroke * scale:.4g} {unit}')


def joint_position(
        tree: Tree, place: Place, leg: LegConfig, joint: str, sheet: ActuatorSheet) -> float:
    """
    Return where an actuator starts that moves a joint of the leg, m or rad.

    Raises
    ------
    ConfigError
        It has a load or a start of its own, or the leg's start is outside its stroke.

    """
    for key in ('load', 'initial_position_mm', 'initial_position_deg'):
        if key in tree:
            raise ConfigError(
                f'{place / key} is not used: the actuator moves {joint} of the leg, '
                f'which gives its load and start')
    refuse_reach(leg, joint, sheet, str(place))
    return leg.position_of(joint)


def initial_position(tree: Tree, place: Place, sheet: ActuatorSheet) -> float:
    """
    Return where an actuator on its own load starts, m or rad; by default at mid stroke.

    Raises
    ------
    ConfigError
        The key has the other kind's unit, or the value is outside the stroke.

    """
    key, other, scale = (
        ('initial_position_deg', 'initial_position_mm', math.radians(1.0)) if sheet.is_rotary
        else ('initial_position_mm', 'initial_position_deg', MILLI))
    kind = 'rotary' if sheet.is_rotary else 'linear'
    if other in tree:
        raise ConfigError(f'{place / other} is unknown: the actuator is {kind}, the key is {key}')
    stroke = sheet.plant.drive.stroke
    if key not in tree:
        return 0.5 * stroke
    bounds = {'ge': 0.0, 'le': stroke / scale}
    unit = key.rpartition('_')[2]
    check(f'{place / key}', tree[key], {
        'doc': 'within the stroke', 'unit': unit, 'bounds': bounds})
    return float(tree[key]) * scale  # type: ignore[arg-type]
