"""Answers: the messages of the participants."""

from enum import IntEnum
import struct
from typing import NamedTuple

from isa_ros.run.wire.header import opened, prefix, VERSION, WireError
from isa_ros.run.wire.parts import joined, Parts, split

ACKNOWLEDGEMENT_TOPIC = '_isa/acknowledgement'
"""Relative: of the namespace of the nodes."""

_ACKNOWLEDGEMENT = struct.Struct('<IIIIHHIIIQq')
"""Prefix; version, kind, index, number of parts, is_repeated, run id, tick."""

HEADER_BYTES = _ACKNOWLEDGEMENT.size

DIVERGENCE = struct.Struct('<qd')
"""First part of a `DIVERGED` answer: t_ns, value."""

IDENTITY, DIGEST, FIRST = 0, 1, 2
"""Parts of a `READY` answer; the parts of the role follow."""

LONGEST_IDENTITY = 64
"""Bytes."""


class AnswerKind(IntEnum):
    """Kinds of answers of a participant."""

    READY = 1
    """To a hello: identity, digest, then the parts of the participant's role at t = 0."""
    DONE = 2
    """To a tick: the parts of the participant's role at the tick's end."""
    DIVERGED = 3
    """To a tick: t_ns and value, then the name of the field that is no longer finite."""
    BUSY = 4
    """To a hello: this participant takes part in another run."""
    REFUSED = 5
    """To a tick, a save or a restore: the reason of its failure."""
    UNBOUND = 6
    """To a message of a run that has not called this participant: its name, once a second."""
    SAVED = 7
    """To a save: the complete state."""
    RESTORED = 8
    """To a restore: the parts of the participant's role at that instant."""
    CHANGED = 9
    """To a change of parameters: no parts."""


# Calling an enumeration takes about a microsecond per tick; a dictionary a twentieth of it.
_ANSWER_KINDS = {int(kind): kind for kind in AnswerKind}


class Answer(NamedTuple):
    """One message of a participant."""

    kind: AnswerKind
    run_id: int
    tick: int
    participant: int
    """Index into the names of the hello."""
    parts: list[bytes | None]
    is_repeated: bool
    """Whether the step had been answered before."""


def encode_answer(
        kind: AnswerKind, run_id: int, tick: int, index: int,
        parts: Parts, is_repeated: bool = False) -> bytes:
    """Return the bytes of an answer; a part that is None stays None."""
    body = joined(parts)
    return _ACKNOWLEDGEMENT.pack(
        *prefix(_ACKNOWLEDGEMENT.size + len(body)), VERSION, kind, index, len(parts),
        is_repeated, run_id, tick) + body


def decode_answer(data: bytes) -> Answer:
    """
    Return the message of a participant from its bytes.

    The parts of a role are checked where the participant is known; see `parts`.

    Raises
    ------
    WireError
        The bytes are not a message, or from another version of this package.

    """
    (kind, index, n, is_repeated, run_id, tick), body = opened(
        data, _ACKNOWLEDGEMENT, 'answer')
    if kind not in _ANSWER_KINDS:
        raise WireError(f'an answer of kind {kind}')
    parts = split(body, n)
    if not _has_form(_ANSWER_KINDS[kind], parts):
        raise WireError(f'an answer {_ANSWER_KINDS[kind].name} with other parts')
    return Answer(_ANSWER_KINDS[kind], run_id, tick, index, parts, bool(is_repeated))


def _has_form(kind: AnswerKind, parts: Parts) -> bool:
    """Return whether parts are those of a kind of answer, without the parts of a role."""
    if kind is AnswerKind.READY:
        return (len(parts) >= FIRST and 0 < len(parts[IDENTITY] or b'') <= LONGEST_IDENTITY
                and _is_text(parts[DIGEST]))
    if kind is AnswerKind.DIVERGED:
        return (len(parts) == 2 and len(parts[0] or b'') == DIVERGENCE.size
                and _is_text(parts[1]))
    if kind in (AnswerKind.REFUSED, AnswerKind.UNBOUND):
        return len(parts) == 1 and _is_text(parts[0])
    if kind is AnswerKind.SAVED:
        return len(parts) == 1 and parts[0] is not None
    return True


def _is_text(part: bytes | None) -> bool:
    try:
        return part is not None and part.decode() is not None
    except UnicodeDecodeError:
        return False
