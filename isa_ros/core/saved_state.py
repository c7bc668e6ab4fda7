"""The whole state of a run at a tick boundary, as a file: what a saved run goes on from."""

from collections.abc import Mapping
from dataclasses import dataclass
import json
from pathlib import Path
from typing import Any

from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError
import numpy as np
from numpy.typing import NDArray

FORMAT = 2
MAX_TICKS = 2**32  # sequence numbers of a bag
LARGEST_BYTES = 16 * 1024 * 1024
_BYTES = ('load', 'requests')
_SHOWN = 12  # digits of a digest


@dataclass(frozen=True, kw_only=True)
class RunState:
    """Everything the rest of a run depends on but its configuration and its inputs."""

    tick: int
    load: bytes
    participants: list[bytes]
    """Actuators in the order of the configuration, then its controllers."""
    requests: bytes
    """`COMMAND` rows that controllers asked for, to take effect at ``tick``."""

    def rows_of_requests(self, n_actuators: int) -> NDArray[np.void]:
        """Return the `COMMAND` rows that take effect at ``tick``, (n_actuators,)."""
        expected = n_actuators * COMMAND.itemsize
        if len(self.requests) != expected:
            raise ConfigError(
                f'the saved state has {len(self.requests)} bytes of requests, must have '
                f'{expected} for the {n_actuators} actuators of the run')
        return np.frombuffer(self.requests, COMMAND)

    def to_json(self, configuration: str, versions: Mapping[str, str]) -> str:
        """Return the text of a state file; ``configuration`` is the digest of the run's."""
        return json.dumps({
            'format': FORMAT, 'configuration.sha256': configuration, 'versions': dict(versions),
            'tick': self.tick, **{name: getattr(self, name).hex() for name in _BYTES},
            'participants': [snapshot.hex() for snapshot in self.participants]}, indent=1) + '\n'

    @classmethod
    def from_json(cls, text: str, configuration: str, where: str) -> 'RunState':
        """
        Return the state of a text; inverse of `to_json`.

        Raises
        ------
        ConfigError
            It is no saved state, or one of another configuration; ``where`` names the file.

        """
        if len(text) > LARGEST_BYTES:
            raise ConfigError(f'{where}: larger than {LARGEST_BYTES} bytes, no saved state')
        try:
            tree: Any = json.loads(text)
            if tree['format'] != FORMAT:
                raise ConfigError(f'{where}: format {tree["format"]!r}, must be {FORMAT}')
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
