"""The CPU time of the parts of a tick of the crane in MuJoCo; see `scripts.measure_door`."""

from collections.abc import Callable, Iterator
import time

import isa_ros
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.simulation import Simulation
from isa_ros.surroundings.port import keep_forces, kept_forces, match_ports
import numpy as np
from scripts.mechanisms import crane, crane_model, CRANE_NAMES, crane_run

REPEATS = 400       # of each part, interleaved with all others


def costs() -> Iterator[tuple[str, float]]:
    """Yield the CPU time of the parts of a tick of the crane, us: the lowest tenth of many."""
    import mujoco
    run = crane_run(1.0)
    own: Simulation = run.simulation(body=crane(2e-4, 'RK4'))
    bodies, kept = {}, np.zeros(1, kept_forces(3)).view(np.recarray)[0]
    mounting = isa_ros.Mounting(
        CRANE_NAMES, np.arange(3), np.full(3, 0.1), [False] * 3, 1e-3, 0)
    for has_response in (False, True):
        bodies[has_response] = isa_ros.MechanismBody(
            crane(2e-4, 'RK4')(mounting), mounting, has_response=has_response)
    mechanism = crane(2e-4, 'RK4')(mounting)
    model, data = crane_model(2e-4, 'RK4')
    state, forces, ports = mechanism.state, np.zeros(3), np.zeros(3, LOAD_PORT)
    replies, rows, fifths = np.zeros(3, LOAD_REPLY), np.arange(3), np.zeros((5, 3))
    mechanism.motion(state, forces)
    ports['inverse_mass'] = 0.01
    x, v = np.full(3, 0.1), np.zeros(3)

    def kernels() -> None:
        keep_forces(kept, 1e-3, rows, replies)
        match_ports(ports, rows, 1e-3, kept, x, v)
    parts: dict[str, Callable[[], object]] = {
        'mj_forward': lambda: mujoco.mj_forward(model, data),
        'mj_step, RK4': lambda: mujoco.mj_step(model, data),
        'motion, of a new state': lambda: mechanism.motion(state.copy(), forces),
        'motion, of other forces': lambda: mechanism.motion(state, forces),
        'stepped, 5 mj_step': lambda: mechanism.stepped(state, fifths, 1e-3),
        'kernels of the coupling': kernels,
        'a port, look-ahead': lambda: bodies[False].ports(ports),
        'a port, full': lambda: bodies[True].ports(ports),
        'advance of the body': lambda: bodies[False].advance(replies),
        'three actuators': lambda: own.group.advance(own.loop.rows.ports),
        'a whole tick, look-ahead': own.step}
    found: dict[str, list[int]] = {name: [] for name in parts}
    for _ in range(REPEATS):
        for name, part in parts.items():
            if name.startswith('motion, of other'):
                mechanism.motion(state, forces)
            before = time.thread_time_ns()
            part()
            found[name].append(time.thread_time_ns() - before)
    for name, times in found.items():
        yield name, float(np.percentile(times, 10)) * 1e-3
