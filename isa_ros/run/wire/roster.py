"""The participants of a run, as a hello of the private wire lists them."""

from collections.abc import Mapping, Sequence
import json
from typing import Any, NamedTuple

from isa_ros.run.wire.header import WireError
import numpy as np

MOST_NAMES = 1000
LONGEST_NAME = 256
_MOST_FIELDS = 10_000    # a quadruped with 16 contacts has 108
_LARGEST_SHAPE = 4096
_FLOATS = '<f8'


class Roster(NamedTuple):
    """The participants of a run, and the supplies and bodies whose samples controllers receive."""

    names: Sequence[str]
    """The participants in order: the actuators first, then the controllers."""
    supplies: Sequence[str]
    bodies: Mapping[str, np.dtype[np.void]]
    """Record type of the sample of each body, by name."""
    has_supply_ports: bool = False
    """Whether a tick has the `SUPPLY_PORT` of each actuator too."""

    def encode(self) -> bytes:
        """Return the bytes that `decode` reads."""
        bodies = [
            [body, [[name, own[name].base.str, own[name].shape] for name in own.names or ()]]
            for body, own in self.bodies.items()]
        told = [list(self.names), list(self.supplies), bodies]
        return json.dumps([*told, True] if self.has_supply_ports else told).encode()

    @classmethod
    def decode(cls, data: bytes) -> 'Roster':
        """
        Return the roster from its bytes.

        Raises
        ------
        WireError
            The bytes are not a roster.

        """
        try:
            names, supplies, bodies, *ported = json.loads(data)
        except (ValueError, TypeError, RecursionError) as error:
            raise WireError('a hello without participants') from error
        if ported not in ([], [True]):
            raise WireError('a hello with more than participants')
        return cls(_names(names), _names(supplies), _records(bodies), bool(ported))


def _names(value: Any) -> list[str]:
    if (isinstance(value, list) and len(value) <= MOST_NAMES
            and all(isinstance(name, str) and len(name) <= LONGEST_NAME for name in value)
            and len(set(value)) == len(value)):
        return value
    raise WireError(f'names of a hello, must be <= {MOST_NAMES} different texts')


def _records(value: Any) -> dict[str, np.dtype[np.void]]:
    """Return the record type of each body's sample by name."""
    if not isinstance(value, list) or not all(
            isinstance(entry, list) and len(entry) == 2 for entry in value):
        raise WireError('the bodies of a hello are not a list of names and records')
    names = _names([name for name, _ in value])
    return {name: _record(fields) for name, (_, fields) in zip(names, value)}


def _record(value: Any) -> np.dtype[np.void]:
    """Return the record type of a body's sample: named floats, or arrays of them."""
    if not isinstance(value, list) or not 0 < len(value) <= _MOST_FIELDS:
        raise WireError('the record of a body in a hello is not a list of fields')
    fields = []
    for field in value:
        if not isinstance(field, list) or len(field) != 3:
            raise WireError('the record of a body in a hello has an invalid field')
        name, kind, shape = field
        if not (isinstance(name, str) and name.isidentifier() and kind == _FLOATS
                and isinstance(shape, list) and len(shape) <= 2
                and all(type(n) is int and 0 < n <= _LARGEST_SHAPE for n in shape)):
            raise WireError('the record of a body in a hello has an invalid field')
        fields.append((name, kind, tuple(shape)))
    if len({name for name, _, _ in fields}) != len(fields):
        raise WireError('the record of a body in a hello names a field twice')
    return np.dtype(fields)
