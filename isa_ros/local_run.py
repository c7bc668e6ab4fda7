"""A whole run in this process, without ROS: what replay and experiments simulate with."""

from collections.abc import Callable

from isa_ros.actuator import Timing
from isa_ros.coordinator import Coordinator, Plan, Recorder, Records
from isa_ros.pacing import Pace, ProgressMeter
from isa_ros.run_config import RunConfig
from isa_ros.shared_load import SharedLoad
from isa_ros.stepping import LocalTransport, QuietActuator
from isa_ros.topics import topics_of


class LocalRun:
    """A run ready to be simulated; ``topics`` are what it records, in order."""

    def __init__(self, run: RunConfig) -> None:
        self._run = run
        self._load = SharedLoad(run)
        self._order, self.topics = topics_of(run, self._load)

    def simulate(
            self, n_ticks: int, commands: Callable[[int, Records], None], recorder: Recorder,
            should_stop: Callable[[], bool] = lambda: False) -> None:
        """
        Hand every sample of ``n_ticks`` ticks to ``recorder``; to be called once.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.
        Interrupted
            ``should_stop`` was true before the end.

        """
        run = self._run
        timing = Timing(run.step_ns, run.controller_offset_ns)
        transport = LocalTransport(
            [QuietActuator(actuator, timing) for actuator in run.actuators],
            self._load.starts(run), _nobody_listens, _nobody_listens)
        plan = Plan(step_ns=run.step_ns, n_actuators=len(run.actuators), n_ticks=n_ticks,
                    commands=commands)
        coordinator = Coordinator(
            plan, self._order, transport, self._load, recorder, pace=Pace(),
            progress=ProgressMeter(None, None), should_stop=should_stop)
        coordinator.run(transport.join())


def _nobody_listens(message: object) -> None:
    """Drop what a run would publish."""
