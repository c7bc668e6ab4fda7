"""A whole run in this process, without ROS: what replay and experiments simulate with."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from isa_ros.actuator.actuator import SmartActuator, Timing
from isa_ros.config.run_config import RunConfig
from isa_ros.run.coordinator import Coordinator, Plan, Requests
from isa_ros.run.exchange import Messages, Recorder, Records, Rows, Silence
from isa_ros.run.group import ActuatorGroup
from isa_ros.run.in_process import LocalTransport
from isa_ros.run.pacing import Pace, ProgressMeter
from isa_ros.run.saved_state import RunState
from isa_ros.run.thinning import Thinning
from isa_ros.run.topics import topics_of
from isa_ros.surroundings.surroundings import SharedLoad

Tuned = Mapping[int, Mapping[str, float]]
"""Tick -> new values of an actuator's parameters, SI, by name."""


class LocalRun:
    """
    A run ready to be simulated; ``topics`` are what it records, in order.

    Its controllers do not take part: what they asked for is among the commands. ``tuned`` are
    the parameters that change under way, by actuator.
    """

    def __init__(self, run: RunConfig, tuned: Mapping[str, Tuned] | None = None) -> None:
        self._tuned = tuned or {}
        self._run = run = replace(run, controllers=())
        self._load = SharedLoad(run)
        self._order, topics = topics_of(run, self._load)
        self._thinning = Thinning(run.record, topics)
        self.topics = self._thinning.topics

    def simulate(
            self, n_ticks: int, commands: Callable[[int, Records], None], recorder: Recorder,
            should_stop: Callable[[], bool] = lambda: False, state: RunState | None = None,
            requests: Requests | None = None) -> None:
        """
        Hand every sample until t = ``n_ticks`` step_ns to ``recorder``; to be called once.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.
        Interrupted
            ``should_stop`` was true before the end.

        """
        run = self._run
        timing = Timing(run.step_ns, run.controller_offset_ns)
        group = ActuatorGroup(run.actuators, timing)
        tuners = [
            _Tuner(member.actuator, run.step_ns, self._tuned.get(config.name, {}))
            for member, config in zip(group.members, run.actuators)] if self._tuned else []
        transport = LocalTransport(group, self._load.starts(run), Silence(), tuners)
        rows = Rows(len(run.actuators))
        plan = Plan(step_ns=run.step_ns, rows=rows, n_ticks=n_ticks, commands=commands)
        coordinator = Coordinator(
            plan, self._order, transport, self._load, self._thinning.recorder(recorder),
            pace=Pace(), progress=ProgressMeter(None, None), should_stop=should_stop,
            requests=requests)
        coordinator.run(transport.join(rows), state)


class _Tuner:
    """Tunes one actuator at its ticks, as a user of its node would; listens to nobody."""

    def __init__(self, actuator: SmartActuator, step_ns: int, tuned: Tuned) -> None:
        self._actuator = actuator
        self._step_ns = step_ns
        self._tuned = tuned

    def serve(self) -> None:
        """Set what changes at the tick that comes next."""
        values = self._tuned.get(self._actuator.t_ns // self._step_ns)
        if values is not None:
            self._actuator.tune(values)

    def publish(self, applied: Messages, states: Messages) -> None:
        """Tell nobody."""
