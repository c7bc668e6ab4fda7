"""
A body made of a `Mechanism`: any simulator.

`MechanismBody` makes the load ports (L1) from its functions by probing. The inverse mass is the
change of an actuator's acceleration by 1 N at it; the look-ahead of (L15) is the simulator's own
step under the forces of (L16). On request k and d, along the motion u that this force causes
(L13), are the changes of the acceleration by a small displacement and a small speed.
"""

from collections.abc import Mapping
import math

from isa_ros.core.fields import Field, record_type, units_of
from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.body import Records
from isa_ros.surroundings.callers import failures_of, numbers_of
from isa_ros.surroundings.mechanism import Floats, Mechanism, Motion, Mounting
from isa_ros.surroundings.port import keep_forces, kept_forces, match_ports
import numpy as np

PROBE_FORCE = 1.0           # N | Nm
PROBE_DISPLACEMENT = 1e-7   # m | rad of the actuator
PROBE_SPEED = 1e-5          # m/s | rad/s
_ROUNDS = 3                 # of the forces at rest: the mechanism may have friction
_STILL = 1e-3               # m/s2 | rad/s2 that is left at rest
_WINDOWS = (np.arange(FORCE_WINDOWS)[:, np.newaxis] + 0.5) / FORCE_WINDOWS


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


def motion_fields(name: str, is_rotary: bool) -> list[Field]:
    """Return the fields of an actuator in the sample of a `MechanismBody`."""
    return [Field(f'{name}_{what}', units[is_rotary], meaning) for what, units, meaning in (
        ('position', ('m', 'rad'), "of the load's side of the force sensor"),
        ('velocity', ('m/s', 'rad/s'), 'likewise'),
        ('force', ('N', 'Nm'), 'in the sensor at the end of the tick'))]


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
        self._fields = [field for name, is_rotary in zip(mounting.names, mounting.are_rotary)
                        for field in motion_fields(name, is_rotary)]
        self.sample: Records = np.zeros(1, record_type(self._fields))
        self._values = self.sample.view(np.float64).reshape(k, 3)
        self._t_ns = 0
        self._state = self._checked_state(mechanism.state, None)
        self._kept = rows_of(1, np.dtype(kept_forces(k)))
        self._stiffest = math.pi * math.pi / (step * step)
        self._refuse_motion(self._motion(self._state, np.zeros(k)))
        self._rest = holding_forces(mechanism, k)
        for field in ('force', 'mean_force', 'older_mean'):
            self._kept[field] = self._rest
        self._take(self._rest)
        self._load_kernels()

    def _load_kernels(self) -> None:
        """Load or compile what the first tick calls: actuators in other processes wait for it."""
        n = int(self.rows.max()) + 1
        self.ports(np.zeros(n, LOAD_PORT))
        keep_forces(
            self._kept.copy()[0], self._mounting.step, self.rows, np.zeros(n, LOAD_REPLY))

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
        with failures_of(f'{type(self._mechanism).__name__}.motion'):
            place, speed, acceleration, *rest = self._mechanism.motion(state, forces)
            return Motion(
                np.asarray(place, float), np.asarray(speed, float),
                np.asarray(acceleration, float),
                np.asarray(rest[0], float) if rest and rest[0] is not None else None)

    def _checked_state(self, given: Floats, size: int | None) -> Floats:
        """Return a state that nobody can change, with finite numbers."""
        state = np.array(given, float)
        if state.ndim != 1 or (size is not None and len(state) != size):
            raise ConfigError(
                f'{type(self._mechanism).__name__}: its state has the shape {state.shape}, must '
                f'have ({"s" if size is None else size},)')
        if not np.isfinite(state).all():
            broken = int(np.flatnonzero(~np.isfinite(state))[0])
            raise SimulationDiverged(
                self._t_ns, f'{type(self._mechanism).__name__}: state[{broken}]',
                float(state[broken]))
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
            numbers_of(names, f'{name} of the motion of {called} at t = 0', values)
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

        Near a cylinder's dead centre 1/m_eff vanishes, and k and d per its metre are without
        bounds: they are cut to what a tick resolves, |k| <= pi^2/H^2 and |d| <= 1/H, and are 0
        where its force moves nothing.
        """
        mechanism, state = self._mechanism, self._state
        push = forces.copy()
        push[j] += PROBE_FORCE
        pushed = self._motion(state, push)
        inverse_mass = float(pushed.acceleration[j] - now.acceleration[j]) / PROBE_FORCE
        if not self._has_response or inverse_mass == 0.0:
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
        self._t_ns += self._mounting.step_ns
        self._state = self._stepped(own['mean_forces'].T)
        keep_forces(self._kept[0], step, self.rows, replies)
        self._take(own['force'])

    def _stepped(self, forces: Floats) -> Floats:
        """
        Return the state after a tick.

        Raises `RunError` if the mechanism fails, `SimulationDiverged` if a number is not finite.
        """
        with failures_of(f'{type(self._mechanism).__name__}.stepped'):
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
