"""
Read the lists ``faults`` and ``changes`` of a scenario.

    faults:
    - {t_s: 0.5, actuator: kfe, set: {plant.spool.stuck: 1}, until_s: 0.8}
    - {t_s: 0.6, supply: supply, fault: pump_trip}
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
from dataclasses import replace
from typing import Any

from isa_ros.actuator.tunable import changed_together, changing, named, refuse_load
from isa_ros.actuator.usable import refuse_timeout
from isa_ros.config.assembly import surroundings_in_form
from isa_ros.config.models.bus_port import SOUND_PORT
from isa_ros.config.models.fault_catalogue import ACTUATOR, KINDS, named_fault, SUPPLY, values_at
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.parameter_sets import build, kind_of
from isa_ros.config.text.sections import Place, refuse_unknown, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.changeable import Changeable, changeables, with_changes
from isa_ros.core.changing_values import bare, OFF
from isa_ros.core.noise import seed_of
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.fault_courses import INTERMITTENT, Intermittent, RAMP, Ramp
from isa_ros.scenario.faults import BODY, BUS, Fault, timetable
from isa_ros.scenario.setpoints import MAX_DURATION
from isa_ros.scenario.waveforms import EFFORT, MOVES, Waveform, WAVEFORMS
from isa_ros.surroundings.supply import SupplySheet
from isa_ros.surroundings.surroundings import EMERGENCY_STOP, OPEN

LINK = 'link'
"""Of an actuator: ``link: kfe, set: {loss: 0.1}`` is ``actuator: kfe, set: {link.loss: 0.1}``."""
_OF_LINK = f'{LINK}.'
TARGETS = (*KINDS, LINK, BUS, BODY, EMERGENCY_STOP)
_KEYS = ('t_s', *TARGETS, 'fault', 'set', 'until_s', RAMP, INTERMITTENT, *WAVEFORMS)
_COURSE = {'period_s': ('time from one begin to the next', 's', {'gt': 0.0, 'le': MAX_DURATION}),
           'duty': ('part of the time in which it is on', '1', {'gt': 0.0, 'lt': 1.0})}


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
        fault = _fault(section_at(one, below), below, run)
        _refuse_after_end(fault, below, run.step_ns, n_ticks)
        faults.append(fault)
    try:
        refuse_changes(faults, run)
    except ConfigError as error:
        raise ConfigError(f'{place}: {error}') from error
    return tuple(faults)


def _fault(tree: Tree, place: Place, run: RunConfig) -> Fault:
    refuse_unknown(tree, _KEYS, place)
    of, target = _target(tree, place)
    tick = _tick(tree, 't_s', place, run.step_ns)
    until = _tick(tree, 'until_s', place, run.step_ns) if 'until_s' in tree else None
    if until is not None and until <= tick:
        raise ConfigError(
            f'{place}.until_s = {tree["until_s"]:g} s, must be > t_s = {tree["t_s"]:g} s')
    if of == EMERGENCY_STOP:
        return _emergency_stop(tree, target, tick, until, place, run)
    values = _values(tree, of, place)
    where = f'{place}.{"fault" if "fault" in tree else "set"}'
    try:
        if of == SUPPLY:
            sheet = _supply(run, target)
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
    return _changing(Fault(tick, until, kind, target, values), tree, known, run.step_ns, place)


def _changing(
        fault: Fault, tree: Tree, known: Mapping[str, Changeable], step_ns: int, place: Place
        ) -> Fault:
    """Return the fault with its waveform, its ramp, or its times on and off."""
    given = [key for key in (RAMP, INTERMITTENT, *WAVEFORMS) if key in tree]
    if len(given) > 1:
        raise ConfigError(place.has(f'has {" and ".join(given)}, must have one of them'))
    between = [key for key in given if key != INTERMITTENT]
    whole = [name for name in fault.values if 'is_whole' in known[name].declared]
    if between and whole:
        raise ConfigError(f'{place / between[0]} is not used: {known[whole[0]].key} takes whole '
                          'numbers only')
    if RAMP in tree:
        ticks = _tick(tree, RAMP, place, step_ns)
        if ticks == 0:
            raise ConfigError(f'{place}.{RAMP} = 0 s, must be > 0 s; without it values jump')
        first = {name: known[name].value for name in fault.values}
        return replace(fault, course=Ramp(ticks, first))
    if INTERMITTENT in tree:
        return replace(fault, course=_intermittent(tree, fault, step_ns, place))
    return replace(fault, wave=_wave(tree, fault.values, step_ns, place))


def _intermittent(tree: Tree, fault: Fault, step_ns: int, place: Place) -> Intermittent:
    if fault.until is None:
        raise ConfigError(place.has(f'has {INTERMITTENT}: needs until_s'))
    below = place / INTERMITTENT
    section = section_at(tree[INTERMITTENT], below)
    refuse_unknown(section, (*_COURSE, 'seed'), below)
    for key, (doc, unit, bounds) in _COURSE.items():
        if key not in section:
            raise ConfigError(below.has(f'lacks {key}'))
        check(f'{below}.{key}', section[key], {'doc': doc, 'unit': unit, 'bounds': bounds})
    period, duty = _tick(section, 'period_s', below, step_ns), float(
        section['duty'])    # type: ignore[arg-type]
    if 'seed' in section:
        seed = seed_of(section['seed'], f'{below}.seed')
        return Intermittent(period, duty, seed, fault.target)
    if not 0 < round(duty * period) < period:
        raise ConfigError(
            f'{below}.duty = {duty:g}, must be at least one tick of the {period} ticks of '
            'period_s, and leave one')
    return Intermittent(period, duty, None, fault.target)


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
    for key in ('fault', 'set', RAMP, INTERMITTENT, *WAVEFORMS):
        if key in tree:
            raise ConfigError(f'{place / key} is not used: an emergency stop has no values')
    return Fault(tick, until, EMERGENCY_STOP, group, {OPEN: 1.0})


def _wave(
        tree: Tree, values: Mapping[str, float], step_ns: int, place: Place) -> Waveform | None:
    """Return the waveform of a fault, in the unit of messages; None: it has none."""
    given = [kind for kind in WAVEFORMS if kind in tree]
    if not given:
        return None
    if len(values) != 1 or 'until_s' not in tree:
        raise ConfigError(place.has(
            f'has {given[0]}: needs one value in set, and until_s'))
    kind, below = given[0], place / given[0]
    section = section_at(tree[kind], below)
    if MOVES in section:
        raise ConfigError(f'{below / MOVES} is not used: it is added to {next(iter(values))}')
    wave = build(WAVEFORMS[kind], written(section | {MOVES: EFFORT}, below), below)
    wave.refuse_step(step_ns, str(below))
    return wave


def _target(tree: Tree, place: Place) -> tuple[str, str]:
    given = [name for name in TARGETS if name in tree]
    if len(given) != 1:
        raise ConfigError(place.has(
            f'has {" and ".join(given) or "no target"}, must have one of {", ".join(TARGETS)}'))
    return given[0], str(tree[given[0]])


def _tick(tree: Tree, key: str, place: Place, step_ns: int) -> int:
    if key not in tree:
        raise ConfigError(place.has(f'lacks {key}'))
    check(f'{place}.{key}', tree[key], {
        'doc': 'time', 'unit': 's', 'bounds': {'ge': 0.0, 'le': MAX_DURATION}})
    return ticks_in(float(tree[key]), step_ns, f'{place}.{key}')  # type: ignore[arg-type]


def _values(tree: Tree, of: str, place: Place) -> dict[str, Any]:
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
    if 'set' in tree:
        values |= values_at(tree['set'], place / 'set')
    return values


def _supply(run: RunConfig, name: str) -> SupplySheet:
    by_name = {supply.name: supply for supply in run.supplies}
    if name not in by_name:
        raise ConfigError(f'{name!r} is not a supply; {alternatives(name, by_name)}')
    return by_name[name].sheet


def _of_body(run: RunConfig, name: str) -> Mapping[str, Changeable]:
    """Return what may change of a body, by key."""
    known = {body.name: body.changing for body in run.bodies if body.changing is not None}
    if name not in known:
        raise ConfigError(
            f'{name!r} is not a body that may be pushed; {alternatives(name, known)}')
    return changeables(known[name])


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


def refuse_changes(faults: Sequence[Fault], run: RunConfig) -> None:
    """
    Refuse values that are each in range but not together, at the time of each change.

    Waves and ramps are taken at one end of their values, and then at the other.

    Raises
    ------
    ConfigError
        Values do not fit together; the message has the time.

    """
    for end in (0, -1) if any(len(fault.extremes()) > 1 for fault in faults) else (0,):
        _refuse_steps([fault.extremes()[end] for fault in faults], run)


def _refuse_steps(faults: Sequence[Fault], run: RunConfig) -> None:
    if not faults:
        return
    surroundings = surroundings_in_form(run)
    in_force: dict[int, dict[str, float]] = {}
    for tick, changes in sorted(timetable(faults, run).items()):
        try:
            surroundings.tune(changes.supplies)
            for row, values in changes.actuators.items():
                now = in_force.setdefault(row, {})
                for name, value in values.items():
                    now.pop(bare(name), None)
                    if not name.startswith(OFF):
                        now[bare(name)] = value
                own = run.actuators[row]
                changed_together(own.sheet, own.load, now, changing(own.sheet, own.load))
        except ConfigError as error:
            raise ConfigError(
                f'at {tick * run.step_ns / NS_PER_SECOND:g} s, {error}') from error
