"""Who takes part in a run, as the coordinator knows it from the configuration."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.run.exchange import Records
from isa_ros.run.wire import Cast


class Expected(NamedTuple):
    """A participant of the configuration; the actuators come first, in file order."""

    name: str
    digest: str
    """Empty: not compared."""


class Limits(NamedTuple):
    """How long participants are waited for, in seconds of the host."""

    join_s: float
    tick_s: float


class Participants(NamedTuple):
    """Who takes part in a run, and how the actuators begin it."""

    expected: Sequence[Expected]
    cast: Cast
    starts: Records
    """`START` rows of the actuators, (n_actuators,)."""
    step_ns: int
    first_remote: int = 0
    """Participants before it live in the coordinator's process and are not called here."""
