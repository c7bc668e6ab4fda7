"""
Reader of run files: strict YAML in data-sheet units to a `RunConfig`.

Every error is one line with file, key, value, unit and bound.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from pathlib import Path

from isa_ros.actuator.setpoint_range import BEYOND_RANGE
from isa_ros.actuator.sheet import ActuatorSheet, refuse_wiring
from isa_ros.actuator.tunable import refuse_unusable
from isa_ros.config.catalogue import actuator_model, leg_section, material_section, Model
from isa_ros.config.changes import changed, Values
from isa_ros.config.leg_config import ImuConfig, LegConfig, LegStart
from isa_ros.config.links import LINK, link_of, read_link
from isa_ros.config.names import NAME_RULE, refuse_bad_name
from isa_ros.config.own_load import load_section, refuse_beyond_stops
from isa_ros.config.recording import read_record
from isa_ros.config.run_config import ActuatorConfig, COORDINATOR, RunConfig, Times
from isa_ros.config.scaling import scaled_sheet
from isa_ros.config.schema import Plain
from isa_ros.config.sections import (
    build, build_one_of, Entry, merge, names_at, Place, refuse_unknown, Section, section_at,
    written)
from isa_ros.config.supplies import read_supplies, SUPPLY, SupplyConfig
from isa_ros.config.wires import refuse_overfull
from isa_ros.config.yaml_text import read, Tree
from isa_ros.core.noise import seed_of
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import FORCE_WINDOWS, PLANT_STEP_NS
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.loads.sheets import linearised, LocalLoad
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import LoadSide, refuse_too_fast
from isa_ros.surroundings.leg.inertial import Imu
from isa_ros.surroundings.leg.sheet import JOINTS, LegSheet

__all__ = [
    'ActuatorConfig', 'LegConfig', 'LegStart', 'load_run', 'Origins', 'read_run', 'RunConfig']

_TICK_GRID_NS = FORCE_WINDOWS * PLANT_STEP_NS


@dataclass(frozen=True)
class ActuatorOrigin:
    """The layered sections an actuator was built from."""

    sheet: Section
    load: Section


@dataclass(frozen=True)
class Origins:
    """The layered sections a run was built from, for lists of values with their sources."""

    actuators: Mapping[str, ActuatorOrigin]
    leg: Section | None


def load_run(path: Path | str, changes: Values | None = None) -> RunConfig:
    """
    Return the resolved configuration of a run file, with some values changed.

    Raises
    ------
    ConfigError
        The file cannot be read, or its content cannot be run.

    """
    path = Path(path)
    return run_of(changed(read(path), changes or {}, path.name), Place(path.name))[0]


def read_run(path: Path | str) -> tuple[RunConfig, Origins]:
    """Return a run and the sections it was built from; as `load_run`."""
    path = Path(path)
    return run_of(read(path), Place(path.name))


def run_of(tree: Tree, place: Place) -> tuple[RunConfig, Origins]:
    """Return the run of a file's tree and what it was built from; as `load_run`."""
    refuse_unknown(tree, (
        'name', 'step_ms', 'controller_offset_ms', 'tick_timeout_s', 'seed', SUPPLY, 'supplies',
        'record', LINK, 'actuators', 'controllers', 'leg', 'body'), place)
    times = build(Times, written(
        {f: tree[f] for f in Times.__dataclass_fields__ if f in tree}, place), place)
    step_ns, offset_ns = _grid(times, place)
    leg, leg_origin = _body(tree, place, step_ns)
    supplies = read_supplies(tree, list(_section(tree, 'actuators', place)), place)
    actuators, origins = _actuators(tree, place, leg, supplies, step_ns)
    refuse_overfull({own.name: own.sheet.link for own in actuators}, place)
    run = RunConfig(
        name=name_of(tree, 'name', place),
        step_ns=step_ns, controller_offset_ns=offset_ns, tick_timeout_s=times.tick_timeout_s,
        supplies=supplies, actuators=actuators, body=leg, source=place.file,
        record=read_record(tree.get('record', {}), place / 'record'),
        seed=seed_of(tree.get('seed', 0), str(place / 'seed')))
    controllers = names_at(tree.get('controllers', []), place / 'controllers')
    return run.with_controllers(controllers), Origins(origins, leg_origin)


def ticks_in(seconds: float, step_ns: int, where: str) -> int:
    """
    Return a time in ticks; ``where`` is its name in messages.

    Raises
    ------
    ConfigError
        The time is not a whole number of macro steps; the message has both.

    """
    ticks = round(seconds * 1e9 / step_ns)
    if abs(ticks * step_ns - seconds * 1e9) > 1.0:  # 1 ns, far above a double's rounding
        raise ConfigError(
            f'{where} = {seconds:g} s, must be a multiple of step_ms = {step_ns / 1e6:g} ms')
    return ticks


def name_of(tree: Tree, key: str, place: Place) -> str:
    """Return a name that ROS can use; small letters, digits and single underscores."""
    if key not in tree:
        raise ConfigError(place.has(f'lacks {key}'))
    value = tree[key]
    if not isinstance(value, str):
        raise ConfigError(f'{place / key} = {value!r}, {NAME_RULE}')
    refuse_bad_name(value, str(place / key))
    return value


def _grid(times: Times, place: Place) -> tuple[int, int]:
    step_ns = round(times.step_ms * 1e6)
    if step_ns % _TICK_GRID_NS or abs(step_ns - times.step_ms * 1e6) > 1e-3:
        raise ConfigError(
            f'{place}: step_ms = {times.step_ms:g} ms, must be a multiple of '
            f'{_TICK_GRID_NS / 1e6:g} ms ({FORCE_WINDOWS} windows of plant steps of '
            f'{PLANT_STEP_NS / 1e6:g} ms)')
    offset_ns = round(times.controller_offset_ms * 1e6)
    if offset_ns % PLANT_STEP_NS or abs(offset_ns - times.controller_offset_ms * 1e6) > 1e-3:
        raise ConfigError(
            f'{place}: controller_offset_ms = {times.controller_offset_ms:g} ms, must be a '
            f'multiple of the plant step {PLANT_STEP_NS / 1e6:g} ms')
    if offset_ns >= step_ns:
        raise ConfigError(
            f'{place}: controller_offset_ms = {times.controller_offset_ms:g} ms, must be < '
            f'step_ms = {times.step_ms:g} ms')
    return step_ns, offset_ns


def _section(tree: Tree, key: str, place: Place) -> Tree:
    if key not in tree:
        raise ConfigError(place.has(f'lacks {key}'))
    return section_at(tree[key], place / key)


def _body(tree: Tree, place: Place, step_ns: int) -> tuple[LegConfig | None, Section | None]:
    """Return the body that the actuators move, and the sections it was built from."""
    if 'leg' in tree and 'body' in tree:
        raise ConfigError(place.has('has leg and body, must have one; leg is a body of that kind'))
    if 'leg' in tree:
        return _leg(_section(tree, 'leg', place), place / 'leg', step_ns)
    if 'body' not in tree:
        return None, None
    rest = dict(_section(tree, 'body', place))
    kind = rest.pop('kind', None)
    if kind != 'leg':
        raise ConfigError(f"{place / 'body' / 'kind'} = {kind!r}, must be one of leg")
    return _leg(rest, place / 'body', step_ns)


def _leg(leg: Tree, below: Place, step_ns: int) -> tuple[LegConfig, Section]:
    refuse_unknown(leg, ('model', 'joints', 'ground', 'start', 'imus', 'parameters'), below)
    model = leg.get('model')
    section, model_place = leg_section(model, f'{below}.model')  # type: ignore[arg-type]
    if 'ground' in leg:
        ground, _ = material_section(leg['ground'], f'{below}.ground')
        section = merge(section, {'ground': ground})
    section = merge(section, _parameters(leg, below))
    sheet = build(LegSheet, section, model_place)
    start = leg_start(section_at(leg.get('start'), below / 'start'), below / 'start')
    refuse_start(start, sheet, step_ns, below / 'start')
    joints = _section(leg, 'joints', below)
    refuse_unknown(joints, JOINTS, below / 'joints')
    config = LegConfig(
        str(model), sheet,
        tuple((joint, name_of(joints, joint, below / 'joints')) for joint in JOINTS), start,
        _imus(section_at(leg.get('imus', {}), below / 'imus'), below / 'imus', step_ns))
    return config, section


def _imus(tree: Tree, place: Place, step_ns: int) -> tuple[ImuConfig, ...]:
    units = []
    for name in tree:
        name_of({name: name}, name, place)
        if name == COORDINATOR:
            raise ConfigError(f'{place / name}: the name is reserved for the coordinator')
        own = section_at(tree[name], place / name)
        units.append(ImuConfig(name, build(Imu, written(own, place / name), place / name)))
        units[-1].sheet.period_ns(step_ns, str(place / name))
    return tuple(units)


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


def _actuators(
        tree: Tree, place: Place, leg: LegConfig | None, supplies: Sequence[SupplyConfig],
        step_ns: int) -> tuple[tuple[ActuatorConfig, ...], dict[str, ActuatorOrigin]]:
    below, shared_link = place / 'actuators', read_link(tree, place)
    section = _section(tree, 'actuators', place)
    joint_of: dict[str, str] = {}
    for joint, name in leg.joints if leg else ():
        if name not in section:
            raise ConfigError(
                f'{place}: leg.joints.{joint} = {name!r} is not an actuator; '
                f'{alternatives(name, section)}')
        if name in joint_of:
            raise ConfigError(
                f'{place}: leg.joints.{joint} = {name!r} already moves {joint_of[name]}')
        joint_of[name] = joint
    if not section:
        raise ConfigError(f'{below} is empty, must name at least one actuator')
    span_of = {name: supply.span for supply in supplies for name in supply.feeds}
    configs, origins = [], {}
    for name in section:
        name_of({name: name}, name, below)
        if name == COORDINATOR:
            raise ConfigError(f'{below / name}: the name is reserved for the coordinator')
        own = section_at(section[name], below / name)
        link = link_of(shared_link, read_link(own, below / name), step_ns, below / name)
        config, origins[name] = _actuator(
            name, own, below / name, leg, joint_of.get(name), span_of[name], link)
        configs.append(config)
    return tuple(configs), origins


def _actuator(
        name: str, tree: Tree, place: Place, leg: LegConfig | None, joint: str | None,
        supply: float, link: Section) -> tuple[ActuatorConfig, ActuatorOrigin]:
    refuse_unknown(tree, (
        'model', 'preset', 'variants', 'parameters', 'load', 'initial_position_mm',
        'initial_position_deg', 'beyond_range', LINK),
        place)
    model = actuator_model(tree.get('model'), f'{place}.model')  # type: ignore[arg-type]
    preset = Plain(str).read(tree.get('preset', 'default'), place / 'preset')
    variants = names_at(tree.get('variants', []), place / 'variants')
    of_model = model.with_variants(
        model.with_preset(preset, f'{place}.preset'),
        variants, f'{place}.variants') | {LINK: link}
    sheet, section = scaled_sheet(
        merge(of_model, _parameters(tree, place)), of_model, model.place, place / 'parameters',
        supply)
    if joint is not None and leg is not None:
        position = _joint_position(tree, place, leg, joint, sheet)
        load, load_layers = None, {}
        _refuse_sheet(sheet, LoadSide(), place)
    else:
        position = _initial_position(tree, place, sheet)
        load_layers = _own_load(tree, place, model, sheet, supply)
        load = build_one_of(LocalLoad, load_layers, place / 'load')
        refuse_beyond_stops(load, position, str(place))
        _refuse_sheet(sheet, LoadSide(*linearised(load)), place)
    label = ' + '.join([preset, *variants])
    return (ActuatorConfig(
        name, model.name, label, sheet, load, position, _beyond_range(tree, place)),
            ActuatorOrigin(section, load_layers))


def _beyond_range(tree: Tree, place: Place) -> str | None:
    """Return the treatment of setpoints beyond the range; None: the default one."""
    default = BEYOND_RANGE[0]
    beyond = tree.get('beyond_range', default)
    check(str(place / 'beyond_range'), beyond, {'names': BEYOND_RANGE})
    return None if beyond == default else str(beyond)


def _parameters(tree: Tree, place: Place) -> Section:
    if 'parameters' not in tree:
        return {}
    below = place / 'parameters'
    return written(section_at(tree['parameters'], below), below)


def _refuse_sheet(sheet: ActuatorSheet, load: LoadSide, place: Place) -> None:
    """Refuse blocks that do not fit, unusable gains, and a plant too fast for its step."""
    try:
        refuse_wiring(sheet)
        refuse_unusable(sheet)
        refuse_too_fast(plant_record(sheet.plant)[0], sheet.plant, load)
    except (ConfigError, ParameterError) as error:
        raise ConfigError(f'{place}: {error}') from error


def _joint_position(
        tree: Tree, place: Place, leg: LegConfig, joint: str, sheet: ActuatorSheet) -> float:
    for key in ('load', 'initial_position_mm', 'initial_position_deg'):
        if key in tree:
            raise ConfigError(
                f'{place / key} is not used: the actuator moves {joint} of the leg, '
                f'which gives its load and start')
    refuse_reach(leg, joint, sheet, str(place))
    return leg.position_of(joint)


def refuse_reach(leg: LegConfig, joint: str, sheet: ActuatorSheet, where: str) -> None:
    """Refuse a start of the leg that is outside the stroke of a joint's actuator."""
    position, stroke = leg.position_of(joint), sheet.plant.drive.stroke
    if not 0.0 <= position <= stroke:
        scale, unit = (math.degrees(1.0), 'deg') if sheet.is_rotary else (1.0 / MILLI, 'mm')
        raise ConfigError(
            f'{where}: the start of the leg, {joint} = {math.degrees(leg.start.angle(joint)):g} '
            f'deg, puts it at {position * scale:.4g} {unit}, must be within its 0 to '
            f'{stroke * scale:.4g} {unit}')


def _initial_position(tree: Tree, place: Place, sheet: ActuatorSheet) -> float:
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


def _own_load(
        tree: Tree, place: Place, model: Model, sheet: ActuatorSheet, supply: float) -> Section:
    if 'load' not in tree:
        raise ConfigError(
            f'{place} has no load and moves no joint of the leg; valid kinds of '
            f'load: {", ".join(model.loads)}')
    return load_section(
        section_at(tree['load'], place / 'load'), place / 'load', model, sheet, supply)
