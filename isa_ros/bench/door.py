"""
A tick with an external body: a crane in MuJoCo, and masses on springs in numpy.

The lowest tenth of many calls, interleaved, in time of the processor: each part begins with caches
that others have used, as in a run.
"""

from collections.abc import Callable, Mapping
from importlib.util import find_spec
import time

import isa_ros
from isa_ros.bench.crane import crane, crane_model, CRANE_NAMES, crane_run
from isa_ros.bench.parts import left_of
from isa_ros.bench.row import Row
from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.simulation import Simulation
from isa_ros.surroundings.port import keep_forces, kept_forces, match_ports
import numpy as np
from numpy.typing import NDArray

REPEATS = 400       # of each part
_SHARE = 10         # %
LEFT = 0.35
"""Of a whole tick, that port, actuators and advance may leave: Python of the tick itself."""
_MASS, _STIFFNESS, _PLACE = 100.0, 1e5, 0.1     # kg, N/m, m

Floats = NDArray[np.float64]


class Masses:
    """Three masses on springs, each with a cylinder; a step of Euler for each fifth of a tick."""

    def __init__(self, mounting: isa_ros.Mounting) -> None:
        self._k = len(mounting.names)
        self.state = np.zeros(2 * self._k)

    def motion(self, state: Floats, forces: Floats) -> isa_ros.Motion:
        """Return the motion of the masses."""
        q, v = state[:self._k], state[self._k:]
        return isa_ros.Motion(_PLACE + q, v, (forces - _STIFFNESS * q) / _MASS)

    def stepped(self, state: Floats, forces: Floats, seconds: float) -> Floats:
        """Return the state after a tick."""
        q, v, h = state[:self._k], state[self._k:], seconds / len(forces)
        for row in forces:
            v = v + h / _MASS * (row - _STIFFNESS * q)
            q = q + h * v
        return np.concatenate([q, v])


def door_rows() -> list[Row]:
    """Measure both; without MuJoCo the masses alone."""
    if find_spec('mujoco') is None:
        return [*masses_rows(), Row('crane in MuJoCo: a whole tick', None, 'us',
                                    note="needs MuJoCo, pip install -e '.[mujoco]'")]
    return [*masses_rows(), *crane_rows()]


def masses_rows() -> list[Row]:
    """Measure the parts of a tick of three cylinders on masses, whose functions are numpy."""
    own: Simulation = crane_run(1.0).simulation(body=Masses)
    body = isa_ros.MechanismBody(Masses(_mounting()), _mounting())
    ports, replies = np.zeros(3, LOAD_PORT), np.zeros(3, LOAD_REPLY)
    return _rows('masses in numpy', {
        'a port': lambda: body.ports(ports), 'advance of the body': lambda: body.advance(replies),
        'three actuators': lambda: own.group.advance(own.loop.rows.ports),
        'a whole tick': own.step}, 'a port')


def _mounting() -> isa_ros.Mounting:
    return isa_ros.Mounting(CRANE_NAMES, np.arange(3), np.full(3, _PLACE), [False] * 3, 1e-3, 0)


def _rows(of: str, parts: Mapping[str, Callable[[], object]], port: str) -> list[Row]:
    """Return the time of each part; the last is a whole tick, ``port`` that of its body."""
    found: dict[str, list[int]] = {name: [] for name in parts}
    for _ in range(REPEATS):
        for name, part in parts.items():
            before = time.thread_time_ns()
            part()
            found[name].append(time.thread_time_ns() - before)
    rows = {name: Row(f'{of}: {name}', float(np.percentile(times, _SHARE)) * 1e-3, 'us')
            for name, times in found.items()}
    *_, whole = rows.values()
    covered = [rows[name] for name in (port, 'advance of the body', 'three actuators')]
    return [*rows.values(), left_of(whole, covered, LEFT).under(whole)]


def crane_rows() -> list[Row]:
    """Measure the parts of a tick of three cylinders on a crane in MuJoCo, in CPU time."""
    import mujoco
    run = crane_run(1.0)
    own: Simulation = run.simulation(body=crane(2e-4, 'RK4'))
    bodies, kept = {}, rows_of(1, np.dtype(kept_forces(3)))[0]
    mounting = _mounting()
    for has_response in (False, True):
        bodies[has_response] = isa_ros.MechanismBody(
            crane(2e-4, 'RK4')(mounting), mounting, has_response=has_response)
    mechanism = crane(2e-4, 'RK4')(mounting)
    model, data = crane_model(2e-4, 'RK4')
    state, forces, ports = mechanism.state, np.zeros(3), np.zeros(3, LOAD_PORT)
    replies, rows, fifths = np.zeros(3, LOAD_REPLY), np.arange(3), np.zeros((5, 3))
    ports['inverse_mass'] = 0.01
    x, v = np.full(3, 0.1), np.zeros(3)

    def step() -> None:     # the next motion is that of a new state
        nonlocal state
        state = mechanism.stepped(state, fifths, 1e-3)

    def kernels() -> None:
        keep_forces(kept, 1e-3, rows, replies)
        match_ports(ports, rows, 1e-3, kept, x, v)
    parts: dict[str, Callable[[], object]] = {
        'mj_forward': lambda: mujoco.mj_forward(model, data),
        'mj_step, RK4': lambda: mujoco.mj_step(model, data),
        'motion, of a new state': lambda: mechanism.motion(state, forces),
        'motion, of other forces': lambda: mechanism.motion(state, forces),
        'stepped, 5 mj_step': step,
        'kernels of the coupling': kernels,
        'a port, look-ahead': lambda: bodies[False].ports(ports),
        'a port, full': lambda: bodies[True].ports(ports),
        'advance of the body': lambda: bodies[False].advance(replies),
        'three actuators': lambda: own.group.advance(own.loop.rows.ports),
        'a whole tick, look-ahead': own.step}
    return _rows('crane in MuJoCo', parts, 'a port, look-ahead')
