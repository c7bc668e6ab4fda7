"""
Faults and other changes of a scenario: declared parameters over time.

A fault lies over the value of a parameter. From its end on there is what lies beneath: another
fault that still lasts, the latest first, else what was tuned, before or meanwhile, else the value
of the data sheet. A waveform is added to a value anew at each tick; a ramp leads to it, and an
intermittent fault comes and goes.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from isa_ros.config.models.fault_catalogue import SUPPLY
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.changing_values import OFF, OVER
from isa_ros.core.frozen import frozen
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.scenario.fault_courses import Course
from isa_ros.scenario.waveforms import MOVES, Waveform, WAVEFORMS
from isa_ros.surroundings.emergency_line import EMERGENCY_STOP, line_of

BUS = 'bus'
"""Of an actuator's connection to the bus of `isa bus`, beside `KINDS`."""
BODY = 'body'
"""Of a body, such as a push of a robot."""


@frozen
class Fault:
    """A change of parameters of an actuator, its port on a bus, a supply or a body; or a stop."""

    tick: int
    until: int | None
    """The tick from which on the values are restored; None: never."""
    of: str
    """One of `KINDS`, `BUS`, `BODY` or `EMERGENCY_STOP`."""
    target: str
    """Name of the actuator, supply, body or group."""
    values: Mapping[str, float]
    """By the names that messages have, of `changing`, or by key of the supply or body."""
    wave: Waveform | None = None
    """What is added to the only value, from ``tick`` on."""
    course: Course | None = None
    """A ramp, or on and off; not with a waveform."""

    def at(self, tick: int, step_ns: int) -> Mapping[str, float]:
        """Return the values at a tick at which it lasts; none while it is off."""
        if self.course is not None:
            return self.course.at(tick - self.tick, self.values)
        if self.wave is None:
            return self.values
        added = self.wave.at((tick - self.tick) * step_ns).effort
        return {name: value + added for name, value in self.values.items()}

    def ticks(self) -> Iterable[int]:
        """Return the ticks at which values may change."""
        if self.course is not None:
            length = None if self.until is None else self.until - self.tick
            ends = () if self.until is None else (self.until,)
            return (*(self.tick + k for k in self.course.ticks_of(length)), *ends)
        if self.until is None:
            return (self.tick,)
        return (self.tick, self.until) if self.wave is None else range(self.tick, self.until + 1)

    def extremes(self) -> tuple['Fault', ...]:
        """Return it with its values at two ends; itself alone if it has one set of values."""
        if self.course is not None:
            return tuple(replace(self, course=None, values=values)
                         for values in self.course.extremes(self.values))
        if self.wave is None:
            return (self,)
        return tuple(replace(self, wave=None, values={
            name: value + reached.effort for name, value in self.values.items()})
            for reached in self.wave.reach())

    def tree(self, step_ns: int) -> Tree:
        """Return the fault as a scenario file has it."""
        def seconds(tick: int) -> float:
            return tick * step_ns / NS_PER_SECOND
        tree: Tree = {'t_s': seconds(self.tick), self.of: self.target}
        if self.of != EMERGENCY_STOP:
            tree['set'] = dict(self.values)
        if self.until is not None:
            tree['until_s'] = seconds(self.until)
        if self.course is not None:
            tree |= self.course.tree(step_ns)
        if self.wave is not None:
            kind = next(kind for kind, cls in WAVEFORMS.items() if cls is type(self.wave))
            tree[kind] = {key: value for key, value in self.wave.tree().items() if key != MOVES}
        return tree


class ParameterChanges(NamedTuple):
    """New values of parameters that take effect at one tick."""

    actuators: Mapping[int, Mapping[str, float]]
    """By row, and name of `isa_ros.actuator.tunable.changing`; `OVER` or `OFF` before a name."""
    supplies: Mapping[str, float]
    """By SUPPLY.KEY, BODY.KEY or line of a group, likewise."""
    ports: Mapping[str, Mapping[str, float]] = {}
    """By name of an actuator and of a value of `BusPort`, which is 0 where nothing is wrong."""


_Key = tuple[str, str, str]     # of, target, name


def timetable(faults: Sequence[Fault], run: RunConfig) -> dict[int, ParameterChanges]:
    """Return the changes by tick: what the faults lay over a value, and what ends."""
    table: dict[int, ParameterChanges] = {}
    before: dict[_Key, float] = {}
    for tick in sorted({tick for fault in faults for tick in fault.ticks()}):
        now = {key: value for fault in _lasting(faults, tick)
               for key, value in _keyed(fault, fault.at(tick, run.step_ns))}
        changed = {key: value for key, value in now.items() if before.get(key) != value}
        ended = [key for key in before if key not in now]
        if changed or ended:
            table[tick] = _changes(changed, ended, run)
        before = now
    return table


def _keyed(fault: Fault, values: Mapping[str, float]) -> Iterator[tuple[_Key, float]]:
    for name, value in values.items():
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
    ports: dict[str, dict[str, float]] = {}
    marked = [*((OVER, key, value) for key, value in values.items()),
              *((OFF, key, 0.0) for key in ended)]
    for mark, (of, target, name), value in marked:
        if of in (SUPPLY, BODY):
            supplies[f'{mark}{target}.{name}'] = value
        elif of == BUS:
            ports.setdefault(target, {})[name] = value
        elif of == EMERGENCY_STOP:
            supplies[f'{mark}{line_of(target)}.{name}'] = value
        else:
            actuators.setdefault(run.index(target), {})[f'{mark}{name}'] = value
    return ParameterChanges(actuators, supplies, ports)
