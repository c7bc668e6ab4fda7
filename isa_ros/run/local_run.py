"""A whole run in this process, without ROS: its ticks with a recorder."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from isa_ros.config.runs.body_config import BodyFactory
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.saved_state import RunState
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.recorders import Recorder
from isa_ros.run.thinning import Thinning
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
from isa_ros.tick.source import Source


class LocalRun:
    """
    A run ready to be simulated and recorded; ``topics`` are the recorded ones, in order.

    Its controllers do not take part: their requests are among the commands. ``factories`` make the
    external bodies, by name.
    """

    def __init__(
            self, run: RunConfig,
            factories: Mapping[str, BodyFactory] = MappingProxyType({})) -> None:
        self._run = replace(run, controllers=(), called=())
        self._loop = Simulation(idle(self._run), (), factories).loop
        self._packer = packer_of(self._run, self._loop.rows.published)
        self._thinning = Thinning(run.record, self._packer.topics)
        self.topics = self._thinning.topics

    def simulate(
            self, n_ticks: int, source: Source, recorder: Recorder,
            should_stop: Callable[[], bool] = lambda: False,
            state: RunState | None = None, *, has_end: bool = True) -> None:
        """
        Pass every sample until t = ``n_ticks`` step_ns to ``recorder``; call this once.

        ``has_end``: record the diagnostics of the last instant, as at the end of a run.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.
        Interrupted
            ``should_stop`` was true after a sample.

        """
        self._loop.source = source
        self._loop.sinks = (RunOutput(
            self._packer, self._run.step_ns,
            self._thinning.recorder(_Stoppable(recorder, should_stop)), has_end=has_end),)
        if state is not None:
            self._packer.rare.announce()
        self._loop.run(n_ticks, state)


class _Stoppable:
    """Ends the run after the sample at which ``should_stop`` becomes true."""

    def __init__(self, recorder: Recorder, should_stop: Callable[[], bool]) -> None:
        self._recorder, self._should_stop = recorder, should_stop

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Pass the messages on, then raise `Interrupted` if the run is to stop."""
        self._recorder.write_tick(t_ns, sequence, messages)
        if self._should_stop():
            raise Interrupted(f'stopped after {sequence} ticks')
