"""
Load ports of an external body, kept in its sample so that they are recorded, and given again.

`RecordedBody` adds them to the sample of any body; `GivenBody` has no body: its ports come from a
bag, or from the loop of somebody else.
"""

from collections.abc import Callable, Mapping, Sequence
import math

from isa_ros.core.fields import Field, record_type
from isa_ros.core.record import first_not_finite
from isa_ros.core.signals import START
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.body import Body, Records
from isa_ros.surroundings.callers import failures_of
from isa_ros.surroundings.messages import JointStates
import numpy as np
from numpy.typing import NDArray

_UNITS = {
    'x0': ('m | rad', 'place of the load at the start of the last tick'),
    'v0': ('m/s | rad/s', 'its speed'),
    'a0': ('m/s2 | rad/s2', 'its acceleration along the reference'),
    'inverse_mass': ('1/kg | 1/(kg m2)', '1/m_eff'),
    'a_bias': ('m/s2 | rad/s2', "its acceleration without this actuator's force"),
    'jerk': ('m/s3 | rad/s3', 'slope of a_bias'),
    'stiffness': ('1/s2', 'k'),
    'damping': ('1/s', 'd'),
}
"""Unit and meaning of what a body fills of a `LOAD_PORT`, in its order."""
PORT = tuple(_UNITS)
_FORCE = 'force'
LOAD_PORT_TOPIC = 'load_port'
"""Of an actuator that moves an external body; an input of a replay."""
_PREFIX = 'port_'
_WORD = 8   # bytes of a whole number in a snapshot
FORMAT = np.dtype([(name, '<f8') for name in (*PORT, _FORCE)])
"""One port as recorded, with the sensor's force at the end of the tick, N | Nm."""


def port_fields(k: int) -> list[Field]:
    """Return the fields of a sample that has the ports of k actuators."""
    return [*(Field(f'{_PREFIX}{name}', unit, meaning, (k,))
              for name, (unit, meaning) in _UNITS.items()),
            Field(f'{_PREFIX}{_FORCE}', 'N | Nm', 'in the sensor at the end of the tick', (k,))]


def has_ports(record: np.dtype[np.void]) -> bool:
    """Return whether a record is the sample of an external body."""
    return f'{_PREFIX}{_FORCE}' in (record.names or ())


def _port_units() -> dict[str, str]:
    """Return the units of `port_fields`; actuators of a body may be linear and rotary."""
    return {field.name: field.unit for field in port_fields(1)}


def port_message(actuator: str, j: int) -> JointStates:
    """
    Return the message of the port of actuator number j of a body.

    Three entries: NAME has x0, v0 and the force, NAME/acceleration a0, jerk and a_bias,
    NAME/response stiffness, damping and 1/m_eff.
    """
    def column(name: str) -> str:
        return f'{_PREFIX}{name}[{j}]'
    return JointStates(
        f'/{actuator}/{LOAD_PORT_TOPIC}',
        [actuator, f'{actuator}/acceleration', f'{actuator}/response'],
        [column('x0'), column('a0'), column('stiffness')],
        [column('v0'), column('jerk'), column('damping')],
        [column(_FORCE), column('a_bias'), column('inverse_mass')])


_RECORDED = (('x0', 'a0', 'stiffness'), ('v0', 'jerk', 'damping'),
             (_FORCE, 'a_bias', 'inverse_mass'))


def port_of_message(arrays: Sequence[Sequence[float]]) -> np.void:
    """
    Return the `FORMAT` row of the position, velocity and effort of a message.

    Raises
    ------
    ConfigError
        An array has not three numbers, or a number is not finite.

    """
    rows: Records = np.zeros(1, FORMAT)
    for names, values in zip(_RECORDED, arrays, strict=True):
        if len(values) != len(names):
            raise ConfigError(
                f'{len(values)} numbers, must be {len(names)}: {", ".join(names)}')
        for name, value in zip(names, values):
            if not math.isfinite(value):
                raise ConfigError(f'{name} = {value}, must be finite')
            rows[name] = value
    row: np.void = rows[0]
    return row


class _Ports:
    """The ports of k actuators as part of a sample, each with the tick that it ends."""

    def __init__(self, rows: NDArray[np.int64], others: np.dtype[np.void] | None) -> None:
        self.rows = rows
        own = record_type(port_fields(len(rows)))
        described = [] if others is None else [
            (name, others[name].base, others[name].shape) for name in others.names or ()]
        described += [(name, own[name].base, own[name].shape) for name in own.names or ()]
        self.sample: Records = np.zeros(1, described)
        self._ports: Records = np.zeros(len(rows), FORMAT)
        self._ticks = 0

    def _begin(self, starts: Records) -> None:
        """Take the `START` rows of the body's actuators, (k,)."""
        self._ports['x0'], self._ports[_FORCE] = starts['position'], starts['force']
        self._show(self._ports)

    def _show(self, ports: Records) -> None:
        """Put ports, and the forces at the end of their tick, into the sample."""
        for name in FORMAT.names or ():
            self.sample[f'{_PREFIX}{name}'] = ports[name]

    def _advance(self, replies: Records) -> None:
        self._ticks += 1
        self._ports[_FORCE] = replies['force'][self.rows]
        self._show(self._ports)

    def saved_size(self, snapshot: bytes) -> int:
        """Return how many bytes of a snapshot, which begins with this body's, are its own."""
        return int.from_bytes(snapshot[:_WORD], 'little')

    def _snapshot(self, rest: bytes) -> bytes:
        state = self._ticks.to_bytes(_WORD, 'little') + self._ports.tobytes() + rest
        return (_WORD + len(state)).to_bytes(_WORD, 'little') + state

    def _restore(self, snapshot: bytes) -> bytes:
        """Continue from a `_snapshot` and return its rest."""
        at = 2 * _WORD + self._ports.nbytes
        self._ticks = int.from_bytes(snapshot[_WORD:2 * _WORD], 'little')
        self._ports[:] = np.frombuffer(snapshot[2 * _WORD:at], FORMAT)
        self._show(self._ports)
        return snapshot[at:]


class RecordedBody(_Ports):
    """
    A body whose ports are part of its sample.

    A sample has the port of the tick that it ends; that of t = 0 place and force at rest.
    """

    def __init__(
            self, own: Body, name: str, actuators: Sequence[str], step_ns: int) -> None:
        super().__init__(own.rows, own.sample.dtype)
        self._own, self._name, self._actuators, self._step_ns = own, name, actuators, step_ns
        self._names = own.sample.dtype.names or ()
        starts: Records = np.zeros(int(own.rows.max()) + 1, START)
        self.starts(starts)
        self._begin(starts[own.rows])
        self._copy()

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the sample."""
        return {**self._own.units, **_port_units()}

    @property
    def provenance(self) -> Mapping[str, str]:
        """Return what the body says of itself, if it does."""
        given: Mapping[str, str] = getattr(self._own, 'provenance', {})
        return given

    def _copy(self) -> None:
        for name in self._names:
            self.sample[name] = self._own.sample[name]

    def starts(self, starts: Records) -> None:
        """Fill the starts; as `Body.starts`."""
        with failures_of(f'{type(self._own).__name__}.starts'):
            self._own.starts(starts)

    def ports(self, ports: Records) -> None:
        """
        Fill the ports and keep them; as `Body.ports`.

        Raises
        ------
        RunError
            The body fails.
        SimulationDiverged
            A number of a port is not finite.

        """
        with failures_of(f'{type(self._own).__name__}.ports'):
            self._own.ports(ports)
        for name in PORT:
            self._ports[name] = ports[name][self.rows]
        if first_not_finite(self._ports) is not None:
            name, j = next((name, j) for name in PORT for j, value in enumerate(self._ports[name])
                           if not math.isfinite(value))
            raise self._diverged(
                f'{_PREFIX}{name}[{j}] ({self._actuators[j]})', self._ports[name][j])

    def advance(self, replies: Records) -> None:
        """
        Advance; as `Body.advance`.

        Raises
        ------
        RunError
            The body fails.
        SimulationDiverged
            A number of its sample is not finite.

        """
        with failures_of(f'{type(self._own).__name__}.advance'):
            self._own.advance(replies)
        self._copy()
        self._advance(replies)
        broken = first_not_finite(self._own.sample)
        if broken is not None:
            raise self._diverged(*broken)

    def _diverged(self, field: str, value: float) -> SimulationDiverged:
        return SimulationDiverged(
            self._ticks * self._step_ns, f'{self._name}.{field}', float(value))

    def snapshot(self) -> bytes:
        """Return the complete state; as `Body.snapshot`."""
        with failures_of(f'{type(self._own).__name__}.snapshot'):
            return self._snapshot(self._own.snapshot())

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`; as `Body.restore`."""
        with failures_of(f'{type(self._own).__name__}.restore'):
            self._own.restore(self._restore(snapshot))
        self._copy()


Given = Callable[[int], Records]
"""Returns the `FORMAT` rows (k,) of a sample by its number: 0 the start, n the tick it ends."""


class GivenBody(_Ports):
    """A body without a simulator: its ports are ``given`` from outside, tick by tick."""

    def __init__(self, rows: NDArray[np.int64], given: Given) -> None:
        super().__init__(rows, None)
        self._given = given
        self._start = np.zeros(len(rows), START)
        self._start['position'], self._start['force'] = given(0)['x0'], given(0)[_FORCE]
        self._begin(self._start)

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the sample."""
        return _port_units()

    def starts(self, starts: Records) -> None:
        """Fill the starts as given; as `Body.starts`."""
        for name in ('position', 'force'):
            starts[name][self.rows] = self._start[name]

    def ports(self, ports: Records) -> None:
        """Fill the ports as given; as `Body.ports`."""
        given = self._given(self._ticks + 1)
        for name in PORT:
            self._ports[name] = ports[name][self.rows] = given[name]

    def advance(self, replies: Records) -> None:
        """Take the forces at the end of the tick; as `Body.advance`."""
        self._advance(replies)

    def snapshot(self) -> bytes:
        """Return the complete state; as `Body.snapshot`."""
        return self._snapshot(b'')

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot` of it, or of the `RecordedBody` in its place."""
        self._restore(snapshot)


def zeros_given(k: int) -> Given:
    """Return zeros at all times, for a body of which only the form of its sample is wanted."""
    rows: Records = np.zeros(k, FORMAT)
    return lambda number: rows
