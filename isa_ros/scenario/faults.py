"""
Faults of a scenario: changes of declared parameters over time.

    faults:
    - {t_s: 0.5, actuator: kfe, set: {plant.spool.stuck: 1}, until_s: 0.8}
    - {t_s: 0.6, supply: supply, fault: pump_trip}

Keys and units are those of `isa params`. A fault lies over the value of a parameter. From
``until_s`` on there is what lies beneath: another fault that still lasts, the latest first, else
what was tuned, before or meanwhile, else the value of the data sheet.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from isa_ros.actuator.tunable import changing, named, with_changed
from isa_ros.config.assembly import surroundings_of
from isa_ros.config.models.fault_catalogue import ACTUATOR, KINDS, named_fault, numbers_at, SUPPLY
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.changeable import Changeable, changeables
from isa_ros.core.changing_values import bare, OFF, OVER
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.setpoints import MAX_DURATION

LINK = 'link'
"""Of an actuator: ``link: kfe, set: {loss: 0.1}`` is ``actuator: kfe, set: {link.loss: 0.1}``."""
_KEYS = ('t_s', *KINDS, LINK, 'fault', 'set', 'until_s')


@dataclass(frozen=True)
class Fault:
    """A change of parameters of one actuator or supply."""

    tick: int
    until: int | None
    """The tick from which on the values are restored; None: never."""
    of: str
    """One of `KINDS`."""
    target: str
    """Name of the actuator or supply."""
    values: Mapping[str, float]
    """By the names that messages have, of `changing`, or by key of the supply."""

    def tree(self, step_ns: int) -> Tree:
        """Return the fault as a scenario file has it."""
        def seconds(tick: int) -> float:
            return tick * step_ns / NS_PER_SECOND
        tree: Tree = {'t_s': seconds(self.tick), self.of: self.target, 'set': dict(self.values)}
        if self.until is not None:
            tree['until_s'] = seconds(self.until)
        return tree


class ParameterChanges(NamedTuple):
    """New values of parameters that take effect at one tick."""

    actuators: Mapping[int, Mapping[str, float]]
    """By row, and name of `isa_ros.actuator.tunable.changing`; `OVER` or `OFF` before a name."""
    supplies: Mapping[str, float]
    """By SUPPLY.KEY, likewise."""


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
        _refuse_changes(faults, run)
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
    values = _values(tree, of, place)
    where = f'{place}.{"fault" if "fault" in tree else "set"}'
    try:
        if of == SUPPLY:
            _refuse_keys(values, _supply_keys(run, target), where)
            return Fault(tick, until, SUPPLY, target, values)
        prefix = f'{LINK}.' if of == LINK else ''
        sheet = run.actuator(target).sheet
        known = changing(sheet)
        values = named(known, {f'{prefix}{key}': value for key, value in values.items()})
        _refuse_keys(values, known, where)
        with_changed(sheet, values, known)
    except ConfigError as error:
        if str(error).startswith(where):
            raise
        raise ConfigError(f'{where}: {error}') from error
    return Fault(tick, until, ACTUATOR, target, values)


def _target(tree: Tree, place: Place) -> tuple[str, str]:
    given = [name for name in (*KINDS, LINK) if name in tree]
    if len(given) != 1:
        raise ConfigError(place.has(
            f'has {" and ".join(given) or "no target"}, must have one of actuator, supply, link'))
    return given[0], str(tree[given[0]])


def _tick(tree: Tree, key: str, place: Place, step_ns: int) -> int:
    check(f'{place}.{key}', tree.get(key), {
        'doc': 'time', 'unit': 's', 'bounds': {'ge': 0.0, 'le': MAX_DURATION}})
    return ticks_in(float(tree[key]), step_ns, f'{place}.{key}')  # type: ignore[arg-type]


def _values(tree: Tree, of: str, place: Place) -> dict[str, float]:
    """Return the values of a named fault, with those of ``set`` in their place or beside them."""
    if 'fault' not in tree and 'set' not in tree:
        raise ConfigError(place.has('needs set, or fault with the name of one'))
    values: dict[str, float] = {}
    if 'fault' in tree:
        named = named_fault(str(tree['fault']), place / 'fault')
        if named.of != of:
            raise ConfigError(
                f'{place}.fault = {named.name!r} is a fault of the {named.of}, must be one of '
                f'the {of}')
        values = dict(named.values)
    if 'set' in tree:
        values |= numbers_at(tree['set'], place / 'set')
    return values


def _supply_keys(run: RunConfig, name: str) -> Mapping[str, Changeable]:
    by_name = {supply.name: supply for supply in run.supplies}
    if name not in by_name:
        raise ConfigError(f'{name!r} is not a supply; {alternatives(name, by_name)}')
    return changeables(by_name[name].sheet)


def _refuse_keys(values: Mapping[str, float], known: Mapping[str, Changeable], where: str) -> None:
    for key in values:
        if key not in known:
            raise ConfigError(
                f'{where}: {key} is unknown or does not change during a run; '
                f'{alternatives(key, [own.key for own in known.values()])}')


def _refuse_after_end(fault: Fault, place: Place, step_ns: int, n_ticks: int | None) -> None:
    if n_ticks is not None and fault.tick >= n_ticks:
        raise ConfigError(
            f'{place}.t_s = {fault.tick * step_ns / NS_PER_SECOND:g} s, must be < '
            f'duration_s = {n_ticks * step_ns / NS_PER_SECOND:g} s')


def _refuse_changes(faults: Sequence[Fault], run: RunConfig) -> None:
    """Refuse values that are each in range but not together, at the time of each change."""
    if not faults:
        return
    surroundings = surroundings_of(run)
    sheets = [actuator.sheet for actuator in run.actuators]
    in_force: dict[int, dict[str, float]] = {}
    for tick, changes in sorted(timetable(faults, run).items()):
        try:
            surroundings.tune(changes.supplies)
            for row, values in changes.actuators.items():
                own = in_force.setdefault(row, {})
                for name, value in values.items():
                    own.pop(bare(name), None)
                    if not name.startswith(OFF):
                        own[bare(name)] = value
                with_changed(sheets[row], own)
        except ConfigError as error:
            raise ConfigError(
                f'at {tick * run.step_ns / NS_PER_SECOND:g} s, {error}') from error


_Key = tuple[str, str, str]     # of, target, name


def timetable(faults: Sequence[Fault], run: RunConfig) -> dict[int, ParameterChanges]:
    """Return the changes by tick: what the faults lay over a value, and what ends."""
    ticks = {*(fault.tick for fault in faults),
             *(fault.until for fault in faults if fault.until is not None)}
    table: dict[int, ParameterChanges] = {}
    before: dict[_Key, float] = {}
    for tick in sorted(ticks):
        now = {key: value for fault in _lasting(faults, tick) for key, value in _keyed(fault)}
        changed = {key: value for key, value in now.items() if before.get(key) != value}
        ended = [key for key in before if key not in now]
        if changed or ended:
            table[tick] = _changes(changed, ended, run)
        before = now
    return table


def _keyed(fault: Fault) -> Iterator[tuple[_Key, float]]:
    for name, value in fault.values.items():
        yield (fault.of, fault.target, name), value


def _lasting(faults: Sequence[Fault], tick: int) -> list[Fault]:
    """Return the faults in force at a tick, the latest last."""
    began: Callable[[Fault], int] = lambda fault: fault.tick
    return sorted((fault for fault in faults if fault.tick <= tick
                   and (fault.until is None or tick < fault.until)), key=began)


def _changes(
        values: Mapping[_Key, float], ended: Sequence[_Key], run: RunConfig) -> ParameterChanges:
    actuators: dict[int, dict[str, float]] = {}
    supplies = {}
    marked = [*((OVER, key, value) for key, value in values.items()),
              *((OFF, key, 0.0) for key in ended)]
    for mark, (of, target, name), value in marked:
        if of == SUPPLY:
            supplies[f'{mark}{target}.{name}'] = value
        else:
            actuators.setdefault(run.index(target), {})[f'{mark}{name}'] = value
    return ParameterChanges(actuators, supplies)
