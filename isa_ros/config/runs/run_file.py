"""
Reader of run files: strict YAML in data-sheet units to a `RunConfig`.

Every error is one line with file, key, value, unit and bound.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from isa_ros.actuator.setpoint_range import BEYOND_RANGE
from isa_ros.actuator.sheet import ActuatorSheet, refuse_wiring
from isa_ros.actuator.tunable import refuse_unusable
from isa_ros.config.models.catalogue import actuator_model, leg_section, material_section, Model
from isa_ros.config.models.links import LINK, link_of, read_link
from isa_ros.config.models.own_load import load_section, refuse_beyond_stops
from isa_ros.config.models.scaling import scaled_sheet
from isa_ros.config.models.wires import refuse_overfull
from isa_ros.config.runs.leg_config import ImuConfig, LegConfig, LegStart
from isa_ros.config.runs.recording import read_record
from isa_ros.config.runs.run_config import ActuatorConfig, COORDINATOR, RunConfig, Times
from isa_ros.config.runs.starts import initial_position, joint_position, leg_start, refuse_start
from isa_ros.config.runs.supplies import read_supplies, SUPPLY, SupplyConfig
from isa_ros.config.runs.tick_grid import on_grid
from isa_ros.config.text.changes import changed, Values
from isa_ros.config.text.names import name_of
from isa_ros.config.text.parameter_sets import build, build_one_of
from isa_ros.config.text.schema import Plain
from isa_ros.config.text.sections import (
    merge, names_at, Place, refuse_unknown, Section, section_at, written)
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.noise import seed_of
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.loads.sheets import linearised, LocalLoad
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import LoadSide, refuse_too_fast
from isa_ros.reu.wiring import mode_of
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet

__all__ = [
    'ActuatorConfig', 'LegConfig', 'LegStart', 'load_run', 'Origins', 'read_run', 'RunConfig']


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
    step_ns, offset_ns = on_grid(times, place)
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
        'initial_position_deg', 'beyond_range', 'auto_enable', 'mode', LINK),
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
        position = joint_position(tree, place, leg, joint, sheet)
        load, load_layers = None, {}
        _refuse_sheet(sheet, LoadSide(), place)
    else:
        position = initial_position(tree, place, sheet)
        load_layers = _own_load(tree, place, model, sheet, supply)
        load = build_one_of(LocalLoad, load_layers, place / 'load')
        refuse_beyond_stops(load, position, str(place))
        _refuse_sheet(sheet, LoadSide(*linearised(load)), place)
    label = ' + '.join([preset, *variants])
    return (ActuatorConfig(
        name, model.name, label, sheet, load, position, _beyond_range(tree, place),
        Plain(bool).read(tree.get('auto_enable', True), place / 'auto_enable'),
        _mode(tree, place, sheet)),
            ActuatorOrigin(section, load_layers))


def _beyond_range(tree: Tree, place: Place) -> str | None:
    """Return the treatment of setpoints beyond the range; None: the default one."""
    default = BEYOND_RANGE[0]
    beyond = tree.get('beyond_range', default)
    check(str(place / 'beyond_range'), beyond, {'names': BEYOND_RANGE})
    return None if beyond == default else str(beyond)


def _mode(tree: Tree, place: Place, sheet: ActuatorSheet) -> str | None:
    """Return the mode at t = 0; None: the one with every block that is on."""
    mode = tree.get('mode')
    if mode is not None:
        mode_of(str(mode), sheet.reu, str(place / 'mode'))
        return str(mode)
    return None


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


def _own_load(
        tree: Tree, place: Place, model: Model, sheet: ActuatorSheet, supply: float) -> Section:
    if 'load' not in tree:
        raise ConfigError(
            f'{place} has no load and moves no joint of the leg; valid kinds of '
            f'load: {", ".join(model.loads)}')
    return load_section(
        section_at(tree['load'], place / 'load'), place / 'load', model, sheet, supply)
