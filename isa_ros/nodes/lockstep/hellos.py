"""What arrives of the participants before a run begins: answers to the coordinator's hellos."""

import time

from isa_ros.nodes.lockstep.answer_checks import AnswerChecks
from isa_ros.nodes.middleware.mailboxes import Mailbox
from isa_ros.run.wire.answers import Answer

HELLO_PERIOD_S = 0.05


class Hellos:
    """Receives the answers of so many participants; ``checks`` decides on each."""

    def __init__(self, mailbox: Mailbox, checks: AnswerChecks, n_participants: int) -> None:
        self._mailbox, self._checks, self._n = mailbox, checks, n_participants
        self.past_runs: set[int] = set()
        """Ids of the coordinator's runs that have ended, whose answers may be late."""

    def answers(self, run_id: int, count: int, is_last: bool) -> dict[int, Answer]:
        """Return the answers to the ``count``-th hello; wait the whole period for the last one."""
        answers: dict[int, Answer] = {}
        end = time.monotonic() + HELLO_PERIOD_S
        while is_last or len(answers) < self._n:
            left = end - time.monotonic()
            if left <= 0.0:
                break
            data = self._mailbox.wait(left)
            if data is None:
                continue
            answer = self._checks.decoded(data, run_id)
            if answer is None or answer.run_id in self.past_runs:
                continue
            if self._checks.is_ready(answer, run_id) and answer.tick == count:
                answers[answer.participant] = answer
        return answers
