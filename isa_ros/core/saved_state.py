"""
The whole state of a run at a tick boundary, as a file: what a saved run goes on from.

The text ends with its own checksum, a file is written whole or not at all, and a number that is
not finite is neither written nor read: by `RunState` in the requests, by actuators, supplies and
bodies in their own states.
"""

from collections.abc import Mapping, Sequence
import hashlib
from itertools import accumulate
import json
from pathlib import Path
from typing import Any

from isa_ros.core.atomic_file import replace_file
from isa_ros.core.frozen import frozen
from isa_ros.core.record import first_not_finite
from isa_ros.core.signals import COMMAND, GAINS_OF_COMMAND, Records
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
import numpy as np
from numpy.typing import NDArray

FORMAT = 5
MAX_TICKS = 2**32  # sequence numbers of a bag
LARGEST_BYTES = 16 * 1024 * 1024
TIME_BYTES = 8    # at the begin of a snapshot of an actuator or a body: t, ns
_BYTES = ('load', 'requests', 'stops')
_CHECKSUM = 'sha256'
_SHOWN = 12  # digits of a digest


@frozen(kw_only=True)
class RunState:
    """Everything the rest of a run depends on but its configuration and its inputs."""

    tick: int
    load: bytes
    participants: list[bytes]
    """Actuators in the order of the configuration, then its controllers."""
    requests: bytes
    """`COMMAND` rows that controllers asked for, to take effect at ``tick``."""
    stops: bytes = b''
    """For how long each emergency stop has lasted; empty of a run without any."""

    def rows_of_requests(self, n_actuators: int) -> NDArray[np.void]:
        """Return the `COMMAND` rows that take effect at ``tick``, (n_actuators,)."""
        expected = n_actuators * COMMAND.itemsize
        if len(self.requests) != expected:
            raise ConfigError(
                f'the saved state has {len(self.requests)} bytes of requests, must have '
                f'{expected} for the {n_actuators} actuators of the run')
        return restored_rows(self.requests, COMMAND, n_actuators, 0, 'requests')

    def to_json(self, configuration: str, versions: Mapping[str, str]) -> str:
        """
        Return the text of a state file; ``configuration`` is the digest of the run's.

        Raises
        ------
        RunError
            A request is not finite.

        """
        if self.requests:
            broken = broken_number(np.frombuffer(self.requests, COMMAND))
            if broken is not None:
                raise RunError(
                    f'requests: {broken[0]} = {broken[1]}, must be finite to be saved')
        return sealed({
            'format': FORMAT, 'configuration.sha256': configuration, 'versions': dict(versions),
            'tick': self.tick, **{name: getattr(self, name).hex() for name in _BYTES},
            'participants': [snapshot.hex() for snapshot in self.participants]})

    @classmethod
    def from_json(cls, text: str, configuration: str, where: str) -> 'RunState':
        """
        Return the state of a text; inverse of `to_json`.

        Raises
        ------
        ConfigError
            It is no saved state, a damaged one, or one of another configuration; ``where``
            names the file.

        """
        if len(text) > LARGEST_BYTES:
            raise ConfigError(f'{where}: larger than {LARGEST_BYTES} bytes, no saved state')
        try:
            tree: Any = json.loads(text, parse_constant=_refuse_constant)
            if tree['format'] != FORMAT:
                raise ConfigError(f'{where}: format {tree["format"]!r}, must be {FORMAT}')
            if tree.pop(_CHECKSUM, None) != _checksum(tree):
                raise ConfigError(
                    f'{where}: is damaged, its {_CHECKSUM} is not that of its content')
            if tree['configuration.sha256'] != configuration:
                raise ConfigError(
                    f'{where}: saved from the configuration '
                    f'{str(tree["configuration.sha256"])[:_SHOWN]}..., must be that of this run, '
                    f'{configuration[:_SHOWN]}...; a scenario that changes loads or start is '
                    'part of it')
            tick = tree['tick']
            if type(tick) is not int or not 0 <= tick < MAX_TICKS:
                raise ConfigError(
                    f'{where}: tick = {tick!r}, must be an integer >= 0 and < {MAX_TICKS}')
            return cls(
                tick=tick, participants=[bytes.fromhex(own) for own in tree['participants']],
                **{name: bytes.fromhex(tree[name]) for name in _BYTES})
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise ConfigError(f'{where}: is no saved state of a run ({error})') from error


def broken_number(rows: Records) -> tuple[str, float] | None:
    """Return field and value of a number in a state that is not finite; None: all may be saved."""
    return first_not_finite(rows, GAINS_OF_COMMAND if rows.dtype == COMMAND else ())


def restored_rows(
        snapshot: bytes, dtype: np.dtype[np.void], n: int, offset: int, owner: str) -> Records:
    """
    Return ``n`` rows at an offset of a snapshot; ``owner`` names whose state it is.

    Raises
    ------
    ConfigError
        A number is not finite; the gains of a `COMMAND` may be NaN.

    """
    rows: Records = np.frombuffer(snapshot, dtype, n, offset)
    broken = broken_number(rows)
    if broken is not None:
        raise ConfigError(
            f'{owner}: saved state has {broken[0]} = {broken[1]}, must be finite')
    return rows


def cut(snapshot: bytes, sizes: Sequence[int], owner: str) -> list[bytes]:
    """
    Return consecutive parts of a snapshot of these sizes.

    Raises
    ------
    ConfigError
        It has another length; ``owner`` names whose state it is.

    """
    ends = list(accumulate(sizes))
    if len(snapshot) != ends[-1]:
        raise ConfigError(
            f'saved state of {owner} has {len(snapshot)} bytes, must have {ends[-1]}')
    return [snapshot[end - size:end] for size, end in zip(sizes, ends)]


def time_of(snapshot: bytes, step_ns: int, owner: str) -> int:
    """
    Return the time at the begin of a snapshot, ns.

    Raises
    ------
    ConfigError
        It is not that of a tick of ``step_ns``.

    """
    t_ns = int.from_bytes(snapshot[:TIME_BYTES], 'little')
    if t_ns % step_ns or t_ns // step_ns >= MAX_TICKS:
        raise ConfigError(
            f'{owner}: saved state at t = {t_ns} ns, must be a multiple of {step_ns} ns and less '
            f'than {MAX_TICKS} times as much')
    return t_ns


def saved_body(t_ns: int, state: Records, sample: Records, owner: str) -> bytes:
    """
    Return the snapshot of a body: its time, ns, and the rows of its state and sample.

    Raises
    ------
    SimulationDiverged
        A number is not finite; ``owner`` names whose state it is.

    """
    for rows in (state, sample):
        broken = broken_number(rows)
        if broken is not None:
            raise SimulationDiverged(t_ns, f'{owner}.{broken[0]}', broken[1])
    return t_ns.to_bytes(TIME_BYTES, 'little') + state.tobytes() + sample.tobytes()


def restored_body(
        snapshot: bytes, state: np.dtype[np.void], sample: np.dtype[np.void], step_ns: int,
        owner: str) -> tuple[int, Records, Records]:
    """Return what `saved_body` has saved, a row each; raises as `time_of` and `restored_rows`."""
    return (time_of(snapshot, step_ns, owner),
            restored_rows(snapshot, state, 1, TIME_BYTES, owner),
            restored_rows(snapshot, sample, 1, TIME_BYTES + state.itemsize, owner))


def sealed(tree: Mapping[str, Any]) -> str:
    """Return the text of a state file with its checksum, of its content without one."""
    return _text({**tree, _CHECKSUM: _checksum(tree)})


def _text(tree: Mapping[str, Any]) -> str:
    return json.dumps(tree, indent=1) + '\n'


def _checksum(tree: Mapping[str, Any]) -> str:
    return hashlib.sha256(_text(tree).encode()).hexdigest()


def _refuse_constant(name: str) -> None:
    raise ValueError(f'{name} is not a number')


def write_state(path: Path, text: str) -> None:
    """
    Write the text of `RunState.to_json` to a file, which is on the disk when this returns.

    Raises
    ------
    RunError
        It cannot be written; a file that was there before is unchanged.

    """
    if len(text) > LARGEST_BYTES:
        raise RunError(f'{path}: cannot save {len(text)} bytes, must be <= {LARGEST_BYTES}')
    try:
        replace_file(path, text.encode(), is_durable=True)
    except OSError as error:
        raise RunError(f'{path}: cannot save, {error.strerror}') from error


def read_state(path: Path, configuration: str) -> RunState:
    """
    Return the state in a file; as `RunState.from_json`.

    Raises
    ------
    ConfigError
        The file cannot be read.

    """
    try:
        with path.open('rb') as file:
            data = file.read(LARGEST_BYTES + 1)
        if len(data) > LARGEST_BYTES:
            raise ConfigError(f'{path}: larger than {LARGEST_BYTES} bytes, no saved state')
        text = data.decode()
    except OSError as error:
        raise ConfigError(f'{path}: cannot be read, {error.strerror}') from error
    except UnicodeDecodeError as error:
        raise ConfigError(f'{path}: is no saved state of a run ({error})') from error
    return RunState.from_json(text, configuration, str(path))
