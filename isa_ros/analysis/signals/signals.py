"""
The signals of a run by name, whether it was simulated in memory or is read from a bag.

Names, units and gauge pressures are those of `isa_ros.scripting.result.Result`: rotor.force.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from isa_ros.analysis.signals.traces import Column, read_traces, seconds
from isa_ros.bag.provenance import CONFIGURATION
from isa_ros.bag.reader import Bag
from isa_ros.config.recorded_run import recorded_run
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.fields import units_of
from isa_ros.core.signals import SAMPLE_FIELDS
from isa_ros.errors import BagError, ConfigError
from isa_ros.run.body_messages import by_field
from isa_ros.scripting.result import Result
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
from msg_adapters.coordinator_messages import supply_topic
import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

_ACTUATOR = {
    'position': ('joint_states', 'position[0]'), 'velocity': ('joint_states', 'velocity[0]'),
    'force': ('joint_states', 'effort[0]'),
    'pressure_a': ('pressure_a', 'fluid_pressure'), 'pressure_b': ('pressure_b', 'fluid_pressure'),
    'spool': ('valve', 'position[0]'), 'spool_velocity': ('valve', 'velocity[0]'),
    'current': ('valve', 'effort[0]'), 'supply_volume': ('valve', 'position[1]'),
    'supply_flow': ('valve', 'velocity[1]'),
    'position_reference': ('references', 'position[0]'),
    'force_reference': ('references', 'position[1]'),
    'spool_reference': ('references', 'position[2]'),
    'current_reference': ('references', 'position[3]'),
    'cushion_pressure': ('cushion_pressure', 'fluid_pressure'),
    'temperature': ('temperature', 'temperature')}
"""(suffix of the topic, field) by field of a `SAMPLE`."""
AT_EVERY_TICK = tuple(
    field for field in _ACTUATOR if field not in ('cushion_pressure', 'temperature'))
"""Fields of a `SAMPLE` that every bag has at every tick."""
_SUPPLY = {'pressure': 'fluid_pressure', 'return_pressure': 'fluid_pressure',
           'gas_temperature': 'temperature', 'oil_temperature': 'temperature'}
"""Field of the message by field of a `SUPPLY_SAMPLE`."""
_CLOCK = '/clock'
LARGEST = 1e30
"""Greatest magnitude of a sample that a report shows, SI; a model has diverged long before."""


class Signal(NamedTuple):
    """One signal: times in s, (n,), and as many values or rows of values."""

    t: Values
    values: Values


class Signals(Mapping[str, Values]):
    """
    Arrays by name: ``signals['rotor.force']``, (n,), or (n, k) for the k axes of a body.

    A bag may hold some signals at fewer ticks than others: `over_time` gives the times too.
    ``source`` is the name for messages.
    """

    def __init__(
            self, run: RunConfig, signals: Mapping[str, Signal], time: Values,
            source: str, problem: str = '', impossible: Sequence[str] = ()) -> None:
        self.run = run
        self.impossible = tuple(impossible)
        """The signals of which `possible` has left samples out."""
        self.problem = problem
        """As `RecordedRun.problem`: if there is one, ``run`` has names and kinds only."""
        self.time = time
        """Every tick, s."""
        self._signals = signals
        self._source = source

    def over_time(self, name: str) -> Signal:
        """
        Return the times and the values of a signal.

        Raises
        ------
        BagError
            The signal was not recorded.

        """
        if name not in self._signals:
            raise BagError(f'{self._source}: {name} is missing, was its topic left out?')
        return self._signals[name]

    def drawn(self, name: str) -> Signal:
        """Return a signal as `over_time`; without values if it was not recorded."""
        return self._signals.get(name, Signal(np.zeros(0), np.zeros(0)))

    def possible(self) -> 'Signals':
        """Return the signals with NaN for numbers beyond `LARGEST`, which cannot be drawn."""
        impossible = []
        signals = dict(self._signals)
        for name, (t, values) in self._signals.items():
            beyond = np.abs(values) > LARGEST
            if beyond.any():
                impossible.append(name)
                signals[name] = Signal(t, np.where(beyond, np.nan, values))
        return Signals(self.run, signals, self.time, self._source, self.problem, impossible)

    def supply_of(self, actuator: str) -> str:
        """Return the name of the pressure of the supply that feeds an actuator."""
        supply = next(own for own in self.run.supplies if actuator in own.feeds)
        return f'{supply.sampled_at(actuator)}.pressure'

    def supply_pressure(self, actuator: str) -> Signal:
        """Return the pressure of the supply that feeds an actuator; as `over_time`."""
        return self.over_time(self.supply_of(actuator))

    def unit(self, name: str) -> str:
        """Return the unit of a signal."""
        source, _, field = name.partition('.')
        body = self.run.body(source)
        if body is not None:
            return units_of(body.fields)[field]
        if any(own.name == source for own in self.run.sampled_supplies):
            return units_of(SUPPLY_FIELDS)[field]
        return units_of(SAMPLE_FIELDS, self.run.actuator(source).sheet.is_rotary)[field]

    def __getitem__(self, name: str) -> Values:
        return self.over_time(name).values

    def __contains__(self, name: object) -> bool:
        return name in self._signals

    def __iter__(self) -> Iterator[str]:
        return iter(self._signals)

    def __len__(self) -> int:
        return len(self._signals)


def signals_of(result: Result) -> Signals:
    """Return the signals of a run in memory, over the times that its bag has, bit for bit."""
    run = result.scenario.run
    time = seconds(np.arange(len(result.time)) * run.step_ns)
    return Signals(
        run, {name: Signal(time, result[name]) for name in result}, time, result.scenario.name)


def read_signals(bag: Bag | Path, *, needs_values: bool = True) -> Signals:
    """
    Return the signals of a bag; without ``needs_values`` also where only names can be read.

    Raises
    ------
    BagError
        It is no bag, is damaged, or has no samples; the messages of a topic change their layout.
    ConfigError
        Another version wrote the configuration, and its values are needed.

    """
    bag = bag if isinstance(bag, Bag) else Bag(bag)
    run, problem = recorded_run(
        bag.provenance.configuration, f'{bag.path}: {CONFIGURATION}')
    if problem and needs_values:
        raise ConfigError(problem)
    if not bag.counts[_CLOCK]:
        raise BagError(
            f'{bag.path}: has no samples, or {_CLOCK}, which has their time, was left out')
    traces = read_traces(bag, _topics(run))
    clock = traces[_CLOCK].times
    time = seconds(clock - run.start_ns)
    found: dict[str, Signal] = {}
    for trace in traces.values():
        t = (time if np.array_equal(trace.times, clock)
             else seconds(trace.times - run.start_ns))
        found |= {name: Signal(t, values) for name, values in trace.values.items()}
    return Signals(run, found, time, str(bag.path), problem)


def _topics(run: RunConfig) -> dict[str, list[Column]]:
    """Return the topics of the signals of a run with their columns."""
    found: dict[str, list[Column]] = {_CLOCK: []}
    for actuator in run.actuators:
        for name, (suffix, path) in _ACTUATOR.items():
            found.setdefault(f'/{actuator.name}/{suffix}', []).append(
                _single(f'{actuator.name}.{name}', path))
    for supply in run.sampled_supplies:
        for name, path in _SUPPLY.items():
            found.setdefault(supply_topic(supply.name, name), []).append(
                _single(f'{supply.name}.{name}', path))
    for body in run.bodies:
        fields = {field.name: field for field in body.fields}
        for message in body.messages(run.step_ns):
            found.setdefault(message.topic, []).extend(
                Column(f'{body.name}.{name}', tuple(paths), bool(fields[name].shape))
                for name, paths in by_field(message))
    return found


def _single(name: str, path: str) -> Column:
    """Return a column of one number; absolute pressures as gauge ones."""
    return Column(name, (path,), offset=-ATMOSPHERE if path == 'fluid_pressure' else 0.0)
