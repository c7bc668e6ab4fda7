"""What a participant answers to a step: its result, or the reason of its failure."""

from collections.abc import Callable
from typing import NamedTuple

from isa_ros.errors import IsaError, SimulationDiverged
from isa_ros.run.wire.answers import AnswerKind, DIVERGENCE
from isa_ros.run.wire.parts import Parts
from isa_ros.surroundings.callers import cause_of


class StepOutcome(NamedTuple):
    """Kind and parts of an answer."""

    kind: AnswerKind
    parts: Parts
    error: BaseException | None = None
    """What also ends this process: all exceptions but `IsaError`."""


def outcome_of(kind: AnswerKind, work: Callable[[], Parts]) -> StepOutcome:
    """Return the outcome of ``work``, of this ``kind`` if it does not fail."""
    try:
        return StepOutcome(kind, work())
    except SimulationDiverged as error:
        return StepOutcome(AnswerKind.DIVERGED, (
            DIVERGENCE.pack(error.t_ns, error.value), error.field.encode()))
    except IsaError as error:
        return StepOutcome(AnswerKind.REFUSED, (_encoded(str(error)),))
    except BaseException as error:
        return StepOutcome(
            AnswerKind.REFUSED, (_encoded(cause_of(error)),), error)


def _encoded(text: str) -> bytes:
    return text.encode(errors='backslashreplace')
