"""Signals of one actuator of a rig: what its sensors read, what it reports, and what is exact."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from isa_ros.analysis.faults.rigs import FaultRig
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.signals import (
    CHANNELS, COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, LOAD_REPLY, SAMPLE)
from isa_ros.core.units import MILLI
from isa_ros.simulation import Simulation
from isa_ros.text.table import digits
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
    n, row = round(duration_s / STEP_S), rig.row
    clear = None if clear_s is None else round(clear_s / STEP_S)
    rows, replies = np.zeros(n + 1, SAMPLE), np.zeros(n + 1, LOAD_REPLY)
    for tick in range(n + 1):
        if tick:
            simulation.step()
        rows[tick] = simulation.group.samples[row]
        replies[tick] = simulation.loop.rows.replies[row]
        if clear is not None and tick in (clear, clear + 1):
            _clear(simulation, row, tick == clear)
    return {SUPPLY: rows['supply_pressure']} | {
        name: rows[name] for name in (*CHANNELS, *DEVICE)} | dict(
            zip(EXACT, (replies['position'], replies['force'])))


def _clear(simulation: Simulation, row: int, is_first: bool) -> None:
    """Clear the fault that the device keeps, then enable it again."""
    command = np.zeros(1, COMMAND)[0]
    command['kinds'] = HAS_CLEAR_FAULT if is_first else HAS_ENABLE
    command['is_enabled'] = 1
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
