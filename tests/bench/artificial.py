"""Artificial results of runs, for tests of their evaluation."""

from isa_ros.bench.spec import ACTUATORS, COORDINATOR, Measured, ProcessMemory

MIB = 1024 * 1024


def ran(ticks_per_s: float, n_children: int = 0, startup: float = 2.0) -> Measured:
    """Return a run whose tick is spent half on the actuators, half on the recorder."""
    tick = 1.0 / ticks_per_s
    processor = {COORDINATOR: 0.5 * tick} | ({ACTUATORS: tick} if n_children else {})
    return Measured(
        ticks_per_s=ticks_per_s,
        startup={'imports': 0.25 * startup, 'waiting for actuators to join': 0.75 * startup},
        to_tick_0=startup,
        phases={'actuators': 0.5 * tick, 'recorder': 0.5 * tick}, processor=processor,
        memory=[ProcessMemory(100 * MIB, 80 * MIB),
                *n_children * [ProcessMemory(90 * MIB, 50 * MIB)]])
