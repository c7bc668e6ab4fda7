"""
Read the lists ``faults`` and ``changes`` of a scenario.

    faults:
    - {t_s: 0.5, actuator: kfe, set: {plant.spool.stuck: 1}, until_s: 0.8}
    - {t_s: 0.6, supply: supply, fault: pump_trip}
    - {t_s: 0.6, supply: station, part: buffer, fault: accumulator_empty}
    - {t_s: 0.6, bus: hfe, set: {pulled: 1}, until_s: 0.7}
    - {t_s: 0.7, emergency_stop: all, until_s: 0.9}
    changes:
    - {t_s: 0.2, actuator: ram, set: {load.force: -500}, until_s: 0.7}
    - {t_s: 0.2, body: body, set: {push_y: 500}, until_s: 0.3}
    - {t_s: 0.2, actuator: ram, set: {load.force: 0}, sine: {amplitude: 200, frequency_hz: 2},
       until_s: 1.2}
    faults:
    - {t_s: 0.5, actuator: kfe, set: {plant.sensors.force.bias: 500}, ramp_s: 2.0}
    - {t_s: 0.5, actuator: kfe, fault: load_cell_stuck, until_s: 1.5,
       intermittent: {period_s: 0.02, duty: 0.3, seed: 1}}

Keys and units are those of `isa params`; both lists have the same form.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from isa_ros.actuator.tunable import changed_together, changing, named, refuse_load
from isa_ros.actuator.usable import refuse_timeout
from isa_ros.config.models.bus_port import SOUND_PORT
from isa_ros.config.models.fault_catalogue import (
    ACTUATOR, fault_catalogue, KINDS, named_fault, SUPPLY, values_at)
from isa_ros.config.runs.emergency_stops import ALL
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.parameter_sets import kind_of
from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.changeable import Changeable, changeables, with_changes
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.changes_together import refuse_changes
from isa_ros.scenario.course_reading import COURSES, tick_at, with_course
from isa_ros.scenario.fault_courses import RAMP
from isa_ros.scenario.faults import BODY, BUS, Fault
from isa_ros.scenario.keys import FAULT
from isa_ros.scenario.part_faults import PART, part_prefix, supply_values
from isa_ros.scenario.waveforms import WAVEFORMS
from isa_ros.surroundings.emergency_line import EMERGENCY_STOP, OPEN
from isa_ros.surroundings.supply import SupplySheet

LINK = 'link'
"""Of an actuator: ``link: kfe, set: {loss: 0.1}`` is ``actuator: kfe, set: {link.loss: 0.1}``."""
_OF_LINK = f'{LINK}.'
TARGETS = (*KINDS, LINK, BUS, BODY, EMERGENCY_STOP)


def read_faults(
        value: Any, place: Place, run: RunConfig, n_ticks: int | None) -> tuple[Fault, ...]:
    """
    Return the faults of a list; ``n_ticks`` is the length of the run, None: without end.

    Raises
    ------
    ConfigError
        A fault is malformed, not on a tick or after the end, its target or a key is unknown, or
        a value is refused at the time at which it takes effect.

    """
    if not isinstance(value, (list, tuple)):
        raise ConfigError(f'{place} = {value!r}, must be a list of faults')
    faults = []
    for k, one in enumerate(value):
        below = Place(place.file, f'{place.key}[{k}]')
        for each in _of_groups(section_at(one, below), run):
            fault = _fault(each, below, run)
            _refuse_after_end(fault, below, run.step_ns, n_ticks)
            faults.append(fault)
    try:
        refuse_changes(faults, run)
    except ConfigError as error:
        raise ConfigError(f'{place}: {error}') from error
    return tuple(faults)


def _fault(tree: Tree, place: Place, run: RunConfig) -> Fault:
    refuse_unknown(tree, FAULT, place)
    of, target = _target(tree, place)
    tick = tick_at(tree, 't_s', place, run.step_ns)
    until = tick_at(tree, 'until_s', place, run.step_ns) if 'until_s' in tree else None
    if until is not None and until <= tick:
        raise ConfigError(
            f'{place}.until_s = {tree["until_s"]:g} s, must be > t_s = {tree["t_s"]:g} s')
    if of == EMERGENCY_STOP:
        return _emergency_stop(tree, target, tick, until, place, run)
    if PART in tree and of != SUPPLY:
        raise ConfigError(f'{place / PART} is not used: only a supply that is a circuit has parts')
    values = _values(tree, of, place, _supply(run, target, place) if of == SUPPLY else None)
    where = f'{place}.{"fault" if "fault" in tree else "set"}'
    try:
        if of == SUPPLY:
            sheet = _supply(run, target, place)
            known: Mapping[str, Changeable] = changeables(sheet)
            _refuse_keys(values, known, where,
                         f'of {target}, a supply of kind {kind_of(sheet, SupplySheet)}, ')
        elif of == BODY:
            known = _of_body(run, target)
            _refuse_keys(values, known, where, f'of {target} ')
        elif of == BUS:
            known = changeables(SOUND_PORT)
            run.actuator(target)    # refuses another name
            _refuse_port(values, known, tree, where)
        else:
            prefix = _OF_LINK if of == LINK else ''
            actuator = run.actuator(target)
            known = changing(actuator.sheet, actuator.load)
            _refuse_lacking(tree, known, target, where)
            values = named(known, {f'{prefix}{key}': value for key, value in values.items()})
            refuse_load(values, actuator.load)
            _refuse_keys(values, known, where)
            changed, _ = changed_together(actuator.sheet, actuator.load, values, known)
            if changed.reu.protection is not actuator.sheet.reu.protection:
                refuse_timeout(changed, run.step_ns / NS_PER_SECOND)
    except ConfigError as error:
        if str(error).startswith(where):
            raise
        raise ConfigError(f'{where}: {error}') from error
    kind = of if of in (SUPPLY, BUS, BODY) else ACTUATOR
    return with_course(Fault(tick, until, kind, target, values), tree, known, run.step_ns, place)


def _of_groups(tree: Tree, run: RunConfig) -> Sequence[Tree]:
    """Return a fault; an emergency stop of all as one of each group of the run."""
    names = [own.name for own in run.stop_groups]
    if tree.get(EMERGENCY_STOP) != ALL or ALL in names:
        return (tree,)
    return [tree | {EMERGENCY_STOP: name} for name in names]


def _refuse_port(values: Mapping[str, float], known: Mapping[str, Changeable], tree: Tree,
                 where: str) -> None:
    """Refuse what is no fault of a connection to a bus, or anything between on and off."""
    _refuse_keys(values, known, where)
    with_changes(SOUND_PORT, known, values)
    for key in (RAMP, *WAVEFORMS):
        if key in tree:
            raise ConfigError(f'{key} is not used with a bus')


def _emergency_stop(
        tree: Tree, group: str, tick: int, until: int | None, place: Place,
        run: RunConfig) -> Fault:
    """Return the emergency stop of a group, which `until` releases."""
    names = [own.name for own in run.stop_groups]
    if group not in names:
        raise ConfigError(
            f'{place / EMERGENCY_STOP} = {group!r} is not a group; {alternatives(group, names)}')
    for key in ('fault', PART, 'set', *COURSES):
        if key in tree:
            raise ConfigError(f'{place / key} is not used: an emergency stop has no values')
    return Fault(tick, until, EMERGENCY_STOP, group, {OPEN: 1.0})


def _target(tree: Tree, place: Place) -> tuple[str, str]:
    given = [name for name in TARGETS if name in tree]
    if len(given) != 1:
        raise ConfigError(place.has(
            f'has {" and ".join(given) or "no target"}, must have one of {", ".join(TARGETS)}'))
    return given[0], str(tree[given[0]])


def _values(
        tree: Tree, of: str, place: Place, supply: SupplySheet | None) -> dict[str, Any]:
    """Return the values of a named fault, with those of ``set`` in their place or beside them."""
    if 'fault' not in tree and 'set' not in tree:
        raise ConfigError(place.has('needs set, or fault with the name of one'))
    values: dict[str, Any] = {}
    if 'fault' in tree:
        named = named_fault(str(tree['fault']), place / 'fault')
        is_of_link = all(key.startswith(_OF_LINK) for key in named.values)
        if not (is_of_link if of == LINK else named.of == of):
            raise ConfigError(
                f'{place}.fault = {named.name!r} is a fault of the {named.of}, must be one of '
                f'the {of}')
        values = dict(named.values)
        if of == LINK:
            values = {key.removeprefix(_OF_LINK): value for key, value in values.items()}
        elif supply is not None:
            values = supply_values(named, supply, tree, place)
    if 'set' in tree:
        prefix = part_prefix(supply, tree, place)
        values |= {f'{prefix}{key}': value
                   for key, value in values_at(tree['set'], place / 'set').items()}
    return values


def _supply(run: RunConfig, name: str, place: Place) -> SupplySheet:
    by_name = {supply.name: supply for supply in run.supplies}
    if name not in by_name:
        raise ConfigError(
            f'{place / SUPPLY} = {name!r} is not a supply; {alternatives(name, by_name)}')
    return by_name[name].sheet


def _of_body(run: RunConfig, name: str) -> Mapping[str, Changeable]:
    """Return what may change of a body, by key."""
    known = {body.name: body.changing for body in run.bodies if body.changing is not None}
    if name not in known:
        raise ConfigError(
            f'{name!r} is not a body that may be pushed; {alternatives(name, known)}')
    return changeables(known[name])


def _refuse_lacking(
        tree: Tree, known: Mapping[str, Changeable], actuator: str, where: str) -> None:
    """Refuse a named fault of a part that an actuator does not have."""
    if 'fault' not in tree:
        return
    fault = fault_catalogue()[str(tree['fault'])]
    missing = sorted(fault.values.keys() - {own.key for own in known.values()})
    if missing and fault.rig:
        raise ConfigError(f'{where} = {fault.name!r} sets {missing[0]}, must be a fault of what '
                          f'{actuator} has')


def _refuse_keys(values: Mapping[str, float], known: Mapping[str, Changeable], where: str,
                 of: str = '') -> None:
    """Refuse keys that are not ``known``; ``of`` says what has those."""
    for key in values:
        if key not in known:
            raise ConfigError(
                f'{where}: {key} {of}is unknown or does not change during a run; '
                f'{alternatives(key, [own.key for own in known.values()])}')


def _refuse_after_end(fault: Fault, place: Place, step_ns: int, n_ticks: int | None) -> None:
    if n_ticks is not None and fault.tick >= n_ticks:
        raise ConfigError(
            f'{place}.t_s = {fault.tick * step_ns / NS_PER_SECOND:g} s, must be < '
            f'duration_s = {n_ticks * step_ns / NS_PER_SECOND:g} s')
