"""
The standard services of simulators, as the package simulation_interfaces has them.

They are the requests of `Coordinator` under other names. A *step* is a tick. *Stopped* is a run
that waits at t = 0 and has not been paused there: as ``--paused`` starts it, or after a reset to
it. What the standard has and these have not is not among the features.
"""

from collections.abc import Callable
from typing import Any

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.version import VERSION
from isa_ros.errors import ConfigError
from isa_ros.nodes.coordinator.attempts import attempted, LARGEST_STEP
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.run.coordinator import Coordinator
from rclpy.node import Node
from rclpy.service import Service
from simulation_interfaces.msg import Result, SimulationState, SimulatorFeatures
from simulation_interfaces.srv import (
    GetSimulationState, GetSimulatorFeatures, ResetSimulation, SetSimulationState, StepSimulation)

_ALWAYS = (
    SimulatorFeatures.SIMULATION_STATE_GETTING, SimulatorFeatures.SIMULATION_STATE_SETTING,
    SimulatorFeatures.SIMULATION_STATE_PAUSE, SimulatorFeatures.STEP_SIMULATION_SINGLE,
    SimulatorFeatures.STEP_SIMULATION_MULTIPLE)
_WHOLE_SCOPE = ResetSimulation.Request.SCOPE_TIME | ResetSimulation.Request.SCOPE_STATE


class SimulationServices:
    """
    Creates the services on ``node``, in its namespace; `services` are to be served.

    ``run`` returns the run that they act on.
    """

    def __init__(
            self, node: Node, run: Callable[[], Coordinator], acceptance: Acceptance | None
            ) -> None:
        self._run, self._acceptance = run, acceptance
        self._paused_at_start: Coordinator | None = None
        self.services: list[Service] = [
            node.create_service(kind, name, answer) for kind, name, answer in (
                (GetSimulatorFeatures, 'get_simulator_features', self._on_features),
                (GetSimulationState, 'get_simulation_state', self._on_get_state),
                (SetSimulationState, 'set_simulation_state', self._on_set_state),
                (StepSimulation, 'step_simulation', self._on_step),
                (ResetSimulation, 'reset_simulation', self._on_reset))]

    @property
    def _state(self) -> int:
        """Return the state as the standard numbers it."""
        run = self._run()
        if not run.is_paused:
            return int(SimulationState.STATE_PLAYING)
        is_stopped = run.ticks == 0 and run is not self._paused_at_start
        return int(SimulationState.STATE_STOPPED if is_stopped else SimulationState.STATE_PAUSED)

    @property
    def _may_reset(self) -> bool:
        return self._acceptance is None or self._acceptance.is_open

    def _on_features(
            self, _: Any, response: GetSimulatorFeatures.Response
            ) -> GetSimulatorFeatures.Response:
        resets = (SimulatorFeatures.SIMULATION_RESET,) if self._may_reset else ()
        response.features.features = sorted((*_ALWAYS, *resets))
        response.features.custom_info = (
            f'isa_ros {VERSION}: a step is {self._run().step_ns / NS_PER_SECOND:g} s; a reset is '
            'of time and state together')
        return response

    def _on_get_state(
            self, _: Any, response: GetSimulationState.Response) -> GetSimulationState.Response:
        response.state.state = self._state
        response.result.result = Result.RESULT_OK
        return response

    def _on_set_state(
            self, request: SetSimulationState.Request, response: SetSimulationState.Response
            ) -> SetSimulationState.Response:
        target = request.state.state
        transition = {
            SimulationState.STATE_STOPPED: self._stop, SimulationState.STATE_PAUSED: self._pause,
            SimulationState.STATE_PLAYING: self._play}.get(target)
        if transition is None:
            return _answer(
                response, Result.RESULT_FEATURE_UNSUPPORTED,
                f'state = {target}, must be 0 (stopped), 1 (playing) or 2 (paused)')
        if target == self._state:
            return _answer(response, response.ALREADY_IN_TARGET_STATE, 'it is in this state')
        return _done(response, transition, response.STATE_TRANSITION_ERROR)

    def _stop(self) -> str:
        self._refuse_closed()
        self._run().reset(is_paused=True)
        return ''

    def _pause(self) -> str:
        run = self._run()
        if run.is_paused:   # stopped: it stays where it is
            self._paused_at_start = run
        run.pause(True)
        return ''

    def _play(self) -> str:
        self._run().pause(False)
        return ''

    def _on_step(
            self, request: StepSimulation.Request, response: StepSimulation.Response
            ) -> StepSimulation.Response:
        return _done(response, lambda: self._step(request.steps), Result.RESULT_OPERATION_FAILED)

    def _step(self, n_steps: int) -> str:
        if not 1 <= n_steps <= LARGEST_STEP:
            raise ConfigError(f'steps = {n_steps}, must be >= 1 and <= {LARGEST_STEP}')
        run = self._run()
        before = run.ticks
        run.step(n_steps)
        if run.ticks - before < n_steps:
            raise ConfigError(f'the run has ended after {run.ticks - before} of {n_steps} steps')
        return ''

    def _on_reset(
            self, request: ResetSimulation.Request, response: ResetSimulation.Response
            ) -> ResetSimulation.Response:
        scope = request.scope
        if scope != request.SCOPE_DEFAULT and scope & _WHOLE_SCOPE != _WHOLE_SCOPE:
            return _answer(
                response, Result.RESULT_FEATURE_UNSUPPORTED,
                f'scope = {scope}, must be 0 or have time and state, {_WHOLE_SCOPE}: they are '
                'reset together')
        return _done(response, self._reset, Result.RESULT_FEATURE_UNSUPPORTED)

    def _reset(self) -> str:
        self._refuse_closed()
        self._run().reset()
        return ''

    def _refuse_closed(self) -> None:
        if self._acceptance is not None:
            self._acceptance.refuse_closed()


def _done(response: Any, request: Callable[[], str], refused: int) -> Any:
    """Do a request and return the response; ``refused`` is the result if it is refused."""
    is_done, message = attempted(request)
    return _answer(response, Result.RESULT_OK if is_done else refused, message)


def _answer(response: Any, result: int, message: str) -> Any:
    response.result.result, response.result.error_message = result, message
    return response
