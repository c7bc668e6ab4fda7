"""Runs that a participant hears of and does not take part in."""

from collections.abc import Callable, Sequence
import time

from isa_ros.core.suggest import listed
from isa_ros.errors import one_line
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.steps import Step, StepKind
from rclpy.impl.rcutils_logger import RcutilsLogger

UNBOUND_PERIOD_S = 1.0
"""Time between two answers to a run that did not call this participant."""

WARNING_PERIOD_S = 10.0


class ForeignRuns:
    """Answers such runs by ``send``, and warns of those that do not list the participant."""

    def __init__(self, name: str, send: Callable[[bytes], None], log: RcutilsLogger) -> None:
        self._name, self._send, self._log = name, send, log
        self._without: set[int] = set()  # whose roster does not list this node
        self._unbound_due = 0.0

    def answer(self, step: Step) -> None:
        """
        Send this name to a run that did not call it: another node may have the name.

        It is sent again, as the run's coordinator may not have discovered this node yet.
        """
        now = time.monotonic()
        if step.kind in (StepKind.TICK, StepKind.BEGIN) and now >= self._unbound_due:
            self._unbound_due = now + UNBOUND_PERIOD_S
            self._send(encode_answer(
                AnswerKind.UNBOUND, step.run_id, step.tick, 0, (self._name.encode(),)))

    def warn(self, step: Step, names: Sequence[str], is_actuator: bool) -> None:
        """Warn once of a hello that does not list this name in its role."""
        if step.run_id not in self._without:
            self._without.add(step.run_id)
            role = 'actuators' if is_actuator else 'controllers'
            self._log.warning(
                one_line(f'the participants of a run are {listed(names)}, without '
                         f'{self._name!r} among the {role}; declare it in the run file'),
                throttle_duration_sec=WARNING_PERIOD_S)
