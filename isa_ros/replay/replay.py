"""
Replay: simulate a recorded run again from the bag alone, and compare every message.

Inputs are the configuration stored in the bag and the applied setpoints and parameters recorded
in it, each at the tick at which it took effect; the scenario is provenance only. ROS is not
needed.
"""

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
import math
from typing import NamedTuple

from isa_ros.bag.provenance import versions_of
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.changing_values import RECORDED
from isa_ros.core.frozen import frozen
from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import Records
from isa_ros.errors import BagError, ConfigError, SetpointError
from isa_ros.replay.compare import Comparer
from isa_ros.replay.difference import RunDifference
from isa_ros.replay.installation import (
    differences, obstacles, refuse_obstacles, topic_differences)
from isa_ros.replay.releases import release_that_replays
from isa_ros.replay.tolerances import Tolerances
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.local_run import LocalRun
from isa_ros.run.recorders import Recorder
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.surroundings.kept_ports import (
    FORMAT, GivenBody, LOAD_PORT_TOPIC, port_of_message)
from isa_ros.surroundings.mechanism import Mounting
from isa_ros.tick.source import ScheduledSource
from msg_adapters import diagnostics, event, joint_state
from msg_adapters.applied_parameters import tuned_values
from msg_adapters.cdr import CdrError
from msg_adapters.coordinator_messages import APPLIED_PARAMETERS, NODE
from msg_adapters.setpoint import applied_to_command, sent_to_command
import numpy as np

APPLIED = 'applied_setpoint'
SENT = 'sent_setpoint'
TUNED = 'applied_parameters'


@frozen
class ReplayReport:
    """The comparison of a replay with its bag."""

    report: RunDifference
    is_whole: bool
    changes: Sequence[str]
    """Differences from the installation that recorded the bag, one line each."""
    unconfirmed: Sequence[str]
    """Topics of the bag that this version does not record, or with another type."""
    release: str = ''
    """Which release replays it, and how to get it; '' if this one should."""

    @property
    def is_equal(self) -> bool:
        """Return whether the replay reproduced the whole bag within the tolerances."""
        return self.report.is_equal and not self.unconfirmed

    def __str__(self) -> str:
        """Return the verdict, with a remark for a bag that was cut short."""
        verdict = str(self.report)
        if self.report.is_equal and self.unconfirmed:
            verdict = f'not confirmed: {", ".join(self.unconfirmed)}; the rest is {verdict}'
        if not self.is_equal and self.release:
            verdict = f'{verdict}\n{self.release}'
        return verdict if self.is_whole else f'{verdict}\nthe bag was cut short there'


def replay(
        bag: Bag, tolerances: Tolerances | None = None,
        print_line: Callable[[str], None] = lambda line: None) -> ReplayReport:
    """
    Simulate a bag again and compare, up to the first difference.

    ``print_line`` is called with each difference between this installation and the bag's before
    the simulation starts, of those that make it impossible with these only.

    Raises
    ------
    BagError
        The bag is damaged, has nothing to simulate, or cannot be simulated by this version.
    ConfigError
        The bag's configuration is out of range.

    """
    if bag.number is not None:
        raise BagError(f'{bag.path}: is file {bag.number} of a split bag, replay its directory')
    found = differences(bag)
    impossible = obstacles(found)
    changes = [difference.text for difference in found]
    for line in impossible or changes:
        print_line(line)
    refuse_obstacles(bag, impossible)
    again = Rerun(bag)
    for line in again.external_bodies:
        print_line(line)
    topics = topic_differences(bag, again.topics)
    for line in topics.lines:
        print_line(line)
    comparer = Comparer(
        bag, [topic.name for topic in again.topics], tolerances,
        lambda topic, sequence, t_ns: topic in topics.compared, is_exact=True)
    again.simulate(comparer, lambda: comparer.difference is not None)
    return ReplayReport(
        comparer.finish(), bag.is_whole, [*changes, *topics.lines], topics.unconfirmed,
        release_that_replays(bag.path, versions_of(bag.provenance_records[1])))


class Rerun:
    """
    A bag's run, ready to be simulated anew; ``topics`` are the topics it records, in order.

    Raises as `replay`.
    """

    def __init__(self, bag: Bag) -> None:
        self._run = run_of_text(
            bag.provenance.configuration, f'{bag.path.name}: configuration.yaml')
        self._inputs = recorded_inputs(bag, self._run)
        self._commanded = sorted(self._inputs.commands)
        self._source = ScheduledSource(
            self._fill, _changes(self._inputs, self._run), recorded_events(bag),
            self._next_command)
        self._state = _recorded_state(bag, self._run)
        self.external_bodies = [_not_simulated(body, bag.provenance.bodies)
                                for body in self._run.bodies if body.is_given]
        """A line for each body that is not simulated again."""
        self._local = LocalRun(self._run, {
            body: partial(_given, bag, ports) for body, ports in self._inputs.ports.items()})
        self.topics = self._local.topics

    def simulate(
            self, recorder: Recorder, should_stop: Callable[[], bool] = lambda: False) -> None:
        """Hand every sample to ``recorder`` until the end of the bag or ``should_stop``."""
        try:
            self._local.simulate(
                self._inputs.n_ticks, self._source, recorder, should_stop, self._state,
                has_end=self._inputs.has_end)
        except Interrupted:
            pass  # should_stop was true before the end

    def _next_command(self, tick: int) -> float:
        k = bisect_left(self._commanded, tick)
        return self._commanded[k] if k < len(self._commanded) else math.inf

    def _fill(self, tick: int, rows: Records) -> None:
        for row, command in self._inputs.commands.get(tick, ()):
            rows[row] = command


def _not_simulated(body: BodyConfig, bodies: Mapping[str, str]) -> str:
    said = ', '.join(f'{key.partition(".")[2]} {value}' for key, value in bodies.items()
                     if key.startswith(f'{body.name}.'))
    return (f'{body.called}{said and f" ({said})"}: its load ports are inputs of this replay, it '
            'is not simulated again')


def _given(bag: Bag, ports: Mapping[int, Records], mounting: Mounting) -> GivenBody:
    """Return a body with the ports of a bag; a run that continued has no start of its own."""
    first = min(ports)

    def of_sample(number: int) -> Records:
        if number not in ports and number:
            raise BagError(f'{bag.path}: has no load ports of tick {number - 1}')
        return ports[number or first]
    return GivenBody(mounting.rows, of_sample)


def _changes(inputs: 'Inputs', run: RunConfig) -> dict[int, ParameterChanges]:
    """
    Return the recorded changes of parameters by tick.

    They are what was in force, so they lie over all else, also over what a saved state has, and
    travel over no link.
    """
    def over(values: Mapping[str, float]) -> dict[str, float]:
        return {f'{RECORDED}{name}': value for name, value in values.items()}
    return {
        tick: ParameterChanges(
            {run.index(name): over(by_tick[tick]) for name, by_tick in inputs.tuned.items()
             if tick in by_tick}, over(inputs.tuned_supplies.get(tick, {})))
        for tick in {*inputs.tuned_supplies, *chain.from_iterable(inputs.tuned.values())}}


def _recorded_state(bag: Bag, run: RunConfig) -> RunState | None:
    """Return the saved state that the run continued from, without its controllers."""
    text = bag.provenance.state
    if text is None:
        return None
    state = RunState.from_json(text, run.digest, f'{bag.path.name}: state.json')
    if state.tick > next(bag.messages()).sequence:
        raise BagError(f'{bag.path}: begins before tick {state.tick}, that of its state.json')
    return replace(state, participants=state.participants[:len(run.actuators)])


def recorded_events(bag: Bag) -> dict[int, list[str]]:
    """
    Return the texts of the run's events, by the tick before which they happened.

    Raises
    ------
    BagError
        A message is not an event.

    """
    events: dict[int, list[str]] = {}
    for message in bag.messages():
        if message.topic == event.TOPIC[0]:
            try:
                text = event.text(message.data)
            except CdrError as error:
                raise BagError(f'{bag.place_of(message)}: {error}') from error
            events.setdefault(message.sequence, []).append(text)
    return events


class Inputs(NamedTuple):
    """The recorded inputs of a run."""

    commands: dict[int, list[tuple[int, np.void]]]
    """Tick -> (row, `COMMAND`) of every setpoint that was applied, or sent over a link."""
    tuned: dict[str, dict[int, dict[str, float]]]
    """Actuator -> tick -> applied parameters by name."""
    tuned_supplies: dict[int, dict[str, float]]
    """Tick -> applied parameters of the supplies by SUPPLY.KEY."""
    ports: dict[str, dict[int, Records]]
    """External body -> number of a sample -> load ports of its actuators, `FORMAT` rows (k,)."""
    n_ticks: int
    has_end: bool
    """Whether the last sample has diagnostics, as that of a run that came to its end."""


def recorded_inputs(bag: Bag, run: RunConfig) -> Inputs:
    """
    Return the applied setpoints and parameters of a bag by their ticks; behind a link the sent.

    Sample k + 1 holds the inputs that took effect at tick k; that of t = 0 is the start. Load
    ports of external bodies are inputs too.

    Raises
    ------
    BagError
        The bag has no samples, or a message is not an input of its actuator.

    """
    setpoints = {
        f'/{a.name}/{SENT}' if a.name in run.linked else f'/{a.name}/{APPLIED}': (k, a.name)
        for k, a in enumerate(run.actuators)}
    parameters = {f'/{a.name}/{TUNED}': a.name for a in run.actuators}
    external = [body for body in run.bodies if body.is_given]
    ports = {f'/{name}/{LOAD_PORT_TOPIC}': (body.name, j, len(body.joints))
             for body in external for j, (_, name) in enumerate(body.joints)}
    inputs = Inputs({}, {}, {}, {body.name: {} for body in external}, -1, False)
    last = diagnosed = -1
    for message in bag.messages():
        last = message.sequence
        tick, topic = last - 1, message.topic
        try:
            if topic in setpoints and last:
                row, name = setpoints[topic]
                read = sent_to_command if name in run.linked else applied_to_command
                inputs.commands.setdefault(tick, []).append((row, read(message.data, name)))
            elif topic in parameters:
                name = parameters[topic]
                inputs.tuned.setdefault(name, {})[tick] = tuned_values(message.data, name)
            elif topic in ports:
                name, j, k = ports[topic]
                inputs.ports[name].setdefault(last, np.zeros(k, FORMAT))[j] = port_of_message(
                    joint_state.arrays_of(message.data))
            elif topic == APPLIED_PARAMETERS[0]:
                inputs.tuned_supplies[tick] = tuned_values(message.data, NODE)
            elif topic == diagnostics.TOPIC[0]:
                diagnosed = last
        except (ConfigError, SetpointError, CdrError) as error:
            raise BagError(f'{bag.place_of(message)}: {error}') from error
    if last < 0:
        raise BagError(f'{bag.path}: has no samples, so there is nothing to replay')
    for body in external:
        if not inputs.ports[body.name]:
            raise BagError(f'{bag.path}: has no load ports of {body.called}')
    return inputs._replace(n_ticks=last, has_end=diagnosed == last)
