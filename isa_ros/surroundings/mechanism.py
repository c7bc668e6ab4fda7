"""
A body made of two functions of any simulator: how it moves now, and its state after a tick.

`MechanismBody` makes the load ports (L1) from them by probing. The inverse mass is the change of
an actuator's acceleration by 1 N at it; the look-ahead of (L15) is the simulator's own step under
the forces of (L16). On request k and d, along the motion u that this force causes (L13), are the
changes of the acceleration by a small displacement and a small speed.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
import math
from pathlib import Path
import traceback
from typing import NamedTuple, Protocol, runtime_checkable

from isa_ros.core.fields import Field, record_type, units_of
from isa_ros.core.record import rows_of
from isa_ros.core.saved_state import broken_number
from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND
from isa_ros.errors import ConfigError, IsaError, RunError, SimulationDiverged
from isa_ros.surroundings.body import Records
from isa_ros.surroundings.port import keep_forces, kept_forces, match_ports
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PROBE_FORCE = 1.0           # N | Nm
PROBE_DISPLACEMENT = 1e-7   # m | rad of the actuator
PROBE_SPEED = 1e-5          # m/s | rad/s
_ROUNDS = 3                 # of the forces at rest: the mechanism may have friction
_STILL = 1e-3               # m/s2 | rad/s2 that is left at rest
_WINDOWS = (np.arange(FORCE_WINDOWS)[:, np.newaxis] + 0.5) / FORCE_WINDOWS


class Mounting(NamedTuple):
    """What a factory of bodies is called with: the k actuators of the body, and the run's tick."""

    names: Sequence[str]
    """Of the actuators, in the order of the run file's list; so are all arrays of k."""
    rows: NDArray[np.int64]
    """Their places among the actuators of the run, (k,)."""
    positions: Floats
    """Where pistons or rotors are at t = 0, ``initial_position_mm`` or ``_deg``: m | rad, (k,)."""
    are_rotary: Sequence[bool]
    step: float
    """The tick, s."""
    seed: int
    """Of the run's noise."""

    @property
    def step_ns(self) -> int:
        """Return the tick in ns."""
        return round(self.step * NS_PER_SECOND)


class Motion(NamedTuple):
    """How a mechanism with k actuators and n speeds moves at one instant."""

    position: Floats
    """Of the load's side of each force sensor, m | rad, (k,)."""
    velocity: Floats
    """m/s | rad/s, (k,)."""
    acceleration: Floats
    """x'' = J q'' + J' q', m/s2 | rad/s2, (k,)."""
    generalised: Floats | None = None
    """q'' in the mechanism's own speeds, (n,); only for stiffness and damping."""


@runtime_checkable
class Mechanism(Protocol):
    """
    Any simulator as functions of a state; no call changes it.

    A state is an array of floats with all that the next step depends on, the warm start of a
    solver too. A force pushes its actuator out if it is > 0, N | Nm.
    """

    @property
    def state(self) -> Floats:
        """Return the state at t = 0, (s,)."""
        ...

    def motion(self, state: Floats, forces: Floats) -> Motion:
        """Return how it moves under constant forces (k,)."""
        ...

    def stepped(self, state: Floats, forces: Floats, seconds: float) -> Floats:
        """
        Return the state after ``seconds``, one tick, in any number of own steps.

        ``forces`` are (5, k): each row for a fifth of the tick; a simulator whose own step is
        the tick takes their mean.
        """
        ...


class DisplaceableMechanism(Mechanism, Protocol):
    """A mechanism whose stiffness and damping are asked for."""

    def displaced(self, state: Floats, dq: Floats, dv: Floats) -> Floats:
        """Return the state moved by dq and made faster by dv, (n,) in its own coordinates."""
        ...


def holding_forces(mechanism: Mechanism, k: int) -> Floats:
    """
    Return the k forces under which the actuators do not accelerate at t = 0, N | Nm.

    Of several, where actuators share a motion, the smallest in the sum of squares.

    Raises
    ------
    ConfigError
        No forces hold it: an actuator has no lever on what accelerates.

    """
    def accelerations(forces: Floats) -> Floats:
        return np.asarray(mechanism.motion(mechanism.state, forces)[2], float)
    forces = np.zeros(k)
    for _ in range(_ROUNDS):
        free = accelerations(forces)
        by = np.array([accelerations(forces + PROBE_FORCE * one) - free
                       for one in np.eye(k)]).T / PROBE_FORCE
        forces = forces - np.linalg.lstsq(by, free)[0]
    rest = accelerations(forces)
    if not np.abs(rest).max() <= _STILL:
        raise ConfigError(
            'no forces of the actuators hold the body at t = 0, with them they accelerate by '
            f'{", ".join(f"{one:.3g}" for one in rest)} m/s2 | rad/s2')
    return forces


@contextmanager
def failures_of(function: str, mechanism: object) -> Iterator[None]:
    """Raise `RunError` with the place in the caller's code where it fails."""
    try:
        yield
    except IsaError:
        raise
    except Exception as error:
        raise RunError(f'{type(mechanism).__name__}.{function}: {cause_of(error)}') from error


def cause_of(error: Exception) -> str:
    """Return an error as one line, with the place where it was raised."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    said = ' '.join(str(error).split())
    return f'{type(error).__name__}: {said} ({Path(place.filename).name}:{place.lineno})'


class MechanismBody:
    """
    A `isa_ros.Body` made of a mechanism: ports by probing, steps by its own integrator.

    ``has_response``: the ports have stiffness and damping too, for which the mechanism has
    `DisplaceableMechanism.displaced`. Its sample has NAME_position, NAME_velocity and NAME_force
    of each actuator.
    """

    def __init__(
            self, mechanism: Mechanism, mounting: Mounting, *, has_response: bool = False
            ) -> None:
        self._mechanism, self._mounting = mechanism, mounting
        self._has_response = has_response
        self.rows = mounting.rows
        k, step = len(mounting.rows), mounting.step
        self._fields = [
            Field(f'{name}_{what}', units[is_rotary], '')
            for name, is_rotary in zip(mounting.names, mounting.are_rotary)
            for what, units in (('position', ('m', 'rad')), ('velocity', ('m/s', 'rad/s')),
                                ('force', ('N', 'Nm')))]
        self.sample: Records = np.zeros(1, record_type(self._fields))
        self._values = self.sample.view(np.float64).reshape(k, 3)
        self._state = self._checked_state(mechanism.state, None)
        self._kept = rows_of(1, np.dtype(kept_forces(k)))
        self._t_ns = 0
        self._stiffest = math.pi * math.pi / (step * step)
        self._refuse_motion(self._motion(self._state, np.zeros(k)))
        self._rest = holding_forces(mechanism, k)
        for field in ('force', 'mean_force', 'older_mean'):
            self._kept[field] = self._rest
        self._take(self._rest)

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the sample."""
        return units_of(self._fields)

    @property
    def provenance(self) -> Mapping[str, str]:
        """Return what the mechanism says of itself, if it does."""
        given: Mapping[str, str] = getattr(self._mechanism, 'provenance', {})
        return given

    def _motion(self, state: Floats, forces: Floats) -> Motion:
        """Return what the mechanism gives, as arrays; raises `RunError` if it fails."""
        with failures_of('motion', self._mechanism):
            place, speed, acceleration, *rest = self._mechanism.motion(state, forces)
            return Motion(
                np.asarray(place, float), np.asarray(speed, float),
                np.asarray(acceleration, float),
                np.asarray(rest[0], float) if rest and rest[0] is not None else None)

    def _checked_state(self, given: Floats, size: int | None) -> Floats:
        """Return a state that nobody can change."""
        state = np.array(given, float)
        if state.ndim != 1 or (size is not None and len(state) != size):
            raise ConfigError(
                f'{type(self._mechanism).__name__}: its state has the shape {state.shape}, must '
                f'have ({"s" if size is None else size},)')
        state.flags.writeable = False
        return state

    def _refuse_motion(self, motion: Motion) -> None:
        """Refuse a motion at t = 0 that is none of k actuators, or cannot be pushed."""
        names, mechanism = self._mounting.names, self._mechanism
        called = type(mechanism).__name__
        if self._has_response and (
                motion.generalised is None or not hasattr(mechanism, 'displaced')):
            raise ConfigError(f'{called}: has_response needs generalised accelerations in its '
                              'Motion, and displaced(state, dq, dv)')
        for name, values in zip(Motion._fields, motion[:3]):
            if values.shape != (len(names),):
                raise ConfigError(
                    f'{called}: {name} of its motion has the shape {values.shape}, '
                    f'must have ({len(names)},): one number for each of {", ".join(names)}')
            if not np.isfinite(values).all():
                raise ConfigError(f'{called}: {name} of its motion at t = 0 is {values.tolist()}, '
                                  'must be finite')
        for j, name in enumerate(names):
            inverse_mass, _, _ = self._probed(j, motion, np.zeros(len(names)))
            if inverse_mass < 0.0:
                raise ConfigError(
                    f'{called}: {name} accelerates by {inverse_mass:g} '
                    'm/s2 | rad/s2 under 1 N | Nm at t = 0, must be >= 0: a force > 0 pushes it '
                    'out')

    def _take(self, forces: Floats) -> None:
        """Fill the sample with the motion of now under sensor forces (k,)."""
        now = self._motion(self._state, forces)
        self._values[:] = np.column_stack([now.position, now.velocity, forces])

    def starts(self, starts: Records) -> None:
        """Fill the places at t = 0 and the forces that hold them."""
        starts['position'][self.rows], starts['force'][self.rows] = (
            self._values[:, 0], self._rest)

    def ports(self, ports: Records) -> None:
        """Fill the ports of the next tick: k + 2 motions and a step; 2 k more with a response."""
        state, step = self._state, self._mounting.step
        forces, slope = self._kept[0]['force'].copy(), self._kept[0]['slope']
        now = self._motion(state, forces)
        own = np.zeros((3, len(forces)))
        for j in range(len(forces)):
            own[:, j] = self._probed(j, now, forces)
        for name, values in zip(
                ('x0', 'v0', 'a0', 'inverse_mass', 'stiffness', 'damping'), (*now[:3], *own)):
            ports[name][self.rows] = values
        end = self._motion(self._stepped(forces + _WINDOWS * step * slope), forces)
        match_ports(ports, self.rows, step, self._kept[0], end.position, end.velocity)

    def _probed(self, j: int, now: Motion, forces: Floats) -> tuple[float, float, float]:
        """
        Return 1/m_eff, k and d of an actuator  (L13).

        At a cylinder's dead centre 1/m_eff is 0, and k and d per its metre are without bounds:
        they are cut to what a tick resolves, |k| <= pi^2/H^2 and |d| <= 1/H.
        """
        mechanism, state = self._mechanism, self._state
        push = forces.copy()
        push[j] += PROBE_FORCE
        pushed = self._motion(state, push)
        inverse_mass = float(pushed.acceleration[j] - now.acceleration[j]) / PROBE_FORCE
        if not self._has_response:
            return inverse_mass, 0.0, 0.0
        assert pushed.generalised is not None and now.generalised is not None
        u = (pushed.generalised - now.generalised) / (PROBE_FORCE * inverse_mass)
        still, fastest = np.zeros(len(u)), 1.0 / self._mounting.step

        def change(dq: Floats, dv: Floats, by: float) -> float:
            moved = mechanism.displaced(state, dq, dv)  # type: ignore[attr-defined]
            return float(now.acceleration[j]
                         - self._motion(moved, forces).acceleration[j]) / by
        k = change(PROBE_DISPLACEMENT * u, still, PROBE_DISPLACEMENT)
        d = change(still, PROBE_SPEED * u, PROBE_SPEED)
        return (inverse_mass, float(np.clip(k, -self._stiffest, self._stiffest)),
                float(np.clip(d, -fastest, fastest)))

    def advance(self, replies: Records) -> None:
        """Advance by the simulator's own steps; as `isa_ros.Body.advance`."""
        step, own = self._mounting.step, replies[self.rows]
        self._state = self._stepped(own['mean_forces'].T)
        self._t_ns += self._mounting.step_ns
        keep_forces(self._kept[0], step, self.rows, replies)
        self._take(own['force'])
        broken = broken_number(self.sample)
        if broken is None and not np.isfinite(self._state).all():
            at = int(np.flatnonzero(~np.isfinite(self._state))[0])
            broken = f'state[{at}]', float(self._state[at])
        if broken is not None:
            raise SimulationDiverged(self._t_ns, f'body.{broken[0]}', broken[1])

    def _stepped(self, forces: Floats) -> Floats:
        """Return the state after a tick; raises `RunError` if the mechanism fails."""
        with failures_of('stepped', self._mechanism):
            return self._checked_state(self._mechanism.stepped(
                self._state, forces, self._mounting.step), len(self._state))

    def snapshot(self) -> bytes:
        """Return the complete state; as `isa_ros.Body.snapshot`."""
        return (self._t_ns.to_bytes(8, 'little') + self.sample.tobytes() + self._kept.tobytes()
                + self._state.tobytes())

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`; as `isa_ros.Body.restore`."""
        kept = 8 + self.sample.nbytes
        state = kept + self._kept.nbytes
        self._t_ns = int.from_bytes(snapshot[:8], 'little')
        self.sample[:] = np.frombuffer(snapshot[8:kept], self.sample.dtype)
        self._kept[:] = np.frombuffer(snapshot[kept:state], self._kept.dtype)
        self._state = np.frombuffer(snapshot[state:])   # nobody can change it either
