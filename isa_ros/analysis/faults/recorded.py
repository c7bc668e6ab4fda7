"""Signals of one actuator of a rig: what its sensors read, what it reports, and what is exact."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from isa_ros.analysis.faults.rigs import FaultRig
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.bound import nothing, Part
from isa_ros.core.signals import CHANNELS, COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE
from isa_ros.core.units import MILLI
from isa_ros.scripting.log import RowColumn
from isa_ros.simulation import Simulation
from isa_ros.text.table import digits
from isa_ros.tick.exchange import Rows, RowSink
import numpy as np
from numpy.typing import NDArray

STEP_S = 1e-3
"""Tick of the rigs."""
BIT_SETS = {'warnings': 'warning', 'trips': 'trip'}
STATE = 'device_state'
DEVICE = (STATE, 'device_mode', 'device_event', *BIT_SETS, 'state_since')
"""Fields of a `SAMPLE` in which an actuator reports of itself."""
SUPPLY = 'supply pressure'
EXACT = ('exact position', 'exact force')
"""Of the piston and in the force sensor, which no fault of a sensor alters: m, N."""

Signals = Mapping[str, NDArray[np.float64]]
"""A value at each tick by name, (n,)."""


def recorded(
        rig: FaultRig, faults: Sequence[Tree], duration_s: float,
        clear_s: float | None = None) -> Signals:
    """
    Return the signals of a run with some faults: `SUPPLY`, `CHANNELS`, `DEVICE` and `EXACT`.

    What the device keeps of the faults is cleared at ``clear_s``; None: never.

    Raises
    ------
    SimulationDiverged
        A state is no longer finite.

    """
    scenario = rig.run.scenario.with_faults(faults)
    simulation = Simulation(replace(scenario, run=rig.run.configuration))
    n, loop = round(duration_s / STEP_S), simulation.loop
    kept = _RigRows(simulation, n)
    loop.sinks = (kept,)
    loop.begin()
    if clear_s is not None:
        for tick, kind in enumerate((HAS_CLEAR_FAULT, HAS_ENABLE), round(clear_s / STEP_S)):
            loop.advance_to(tick)
            _request(simulation, rig.row, kind)
    loop.advance_to(n)
    rows, replies = kept.samples.rows[:, rig.row], kept.replies.rows[:, rig.row]
    return {SUPPLY: rows['supply_pressure']} | {
        name: rows[name] for name in (*CHANNELS, *DEVICE)} | dict(
            zip(EXACT, (replies['position'], replies['force'])))


class _RigRows(RowSink):
    """Keeps what the actuators read and how they move, at each of so many ticks."""

    def __init__(self, simulation: Simulation, n_ticks: int) -> None:
        samples, replies = simulation.group.samples, simulation.loop.rows.replies
        self.samples = RowColumn(samples, n_ticks + 1, *samples.shape)
        self.replies = RowColumn(replies, n_ticks + 1, *replies.shape)

    def take(self, tick: int, rows: Rows) -> None:
        """Keep the rows of a tick."""
        self.samples.take(tick)
        self.replies.take(tick)

    def quiet_ticks(self, tick: int) -> int:
        """Return how many ticks follow."""
        return len(self.samples.rows) - 1 - tick

    def takes_applied(self, expected: NDArray[np.bool_]) -> bool:
        """Return True: commands are not kept."""
        return True

    def begin_quiet(
            self, tick: int, most: int, clock: NDArray[np.int64]) -> tuple[int, Sequence[Part]]:
        """Return what keeps the rows."""
        return most, [Part(own.keeping(clock), nothing) for own in (self.samples, self.replies)]


def _request(simulation: Simulation, row: int, kind: int) -> None:
    """Clear the fault that the device keeps, or enable it."""
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['is_enabled'] = kind, 1
    simulation.group.actuators[row].accept(command)


def largest_error(faulty: Signals, sound: Signals, name: str, end: int | None = None) -> float:
    """Return the largest distance of a signal from the sound run, before tick ``end``."""
    return float(np.abs(faulty[name] - sound[name])[:end].max())


def in_mm(error: float) -> str:
    """Return a distance in m as text in mm, with three digits, to a micrometre."""
    return digits(round(error / MILLI, 3), 3)


def in_newtons(error: float) -> str:
    """Return a force as text in N, to 1 N, below 10 N to 0.1 N."""
    return f'{error:.0f}' if error >= 10.0 else f'{error:.1f}'
