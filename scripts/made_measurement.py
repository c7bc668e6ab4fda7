"""A measurement of a machine that is a simulation: other parameters, noise, and a fast clock."""

from collections.abc import Mapping
import math
from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.controller import Controller, Setpoint, State
import numpy as np

CLOCK_PPM = 150.0
MAPPING = """
time: {column: t, unit: ms}
signals:
  position_command: {column: cmd, unit: mm}
  position: {column: pos, unit: mm, sign: -1, offset: 100.0}
  force: {column: force, unit: kN}
  pressure_a: {column: pa, unit: bar}
  pressure_b: {column: 6, unit: bar}
"""


def wanted(t: float) -> float:
    """Return the commanded position, m: a sweep from 0.5 to 6 Hz in 4 s."""
    return 0.05 + 0.01 * math.sin(2.0 * math.pi * (0.5 + 0.6875 * t) * t)


def wanted_speed(t: float) -> float:
    """Return the slope of `wanted`, m/s."""
    return 0.01 * 2.0 * math.pi * (0.5 + 2.0 * 0.6875 * t) * math.cos(
        2.0 * math.pi * (0.5 + 0.6875 * t) * t)


class PositionSweep(Controller):
    """Commands the position, alone or with its velocity."""

    def __init__(self, has_velocity: bool = False) -> None:
        self._has_velocity = has_velocity

    def step(self, state: State) -> dict[str, Setpoint]:
        """Return the setpoint of the next tick."""
        t = (state.t_ns + 1_000_000) * 1e-9
        return {'ram': Setpoint(
            position=wanted(t), velocity=wanted_speed(t) if self._has_velocity else None)}


def measured(
        directory: Path, duration: float, changes: Mapping[str, float], *, noise: float = 1.0,
        clock_ppm: float = CLOCK_PPM, machine: str | Mapping[str, Any] = 'rig_linear',
        has_velocity: bool = False, delay: float = 0.0, seed: int = 5) -> tuple[Path, Path]:
    """
    Return a CSV file of a machine with ``changes``, and its mapping; ``seed`` of the noise.

    ``has_velocity``: it was commanded with the velocity too, which the file does not have.
    ``delay``, s: what it shows is so much later than its commands.
    """
    sweep = PositionSweep(has_velocity)
    result = isa_ros.load(machine, changes=changes).simulate(duration, [sweep])
    random = np.random.default_rng(seed)
    t = result.time
    columns = [1e3 * t, [1e3 * wanted(own) for own in t]]
    for name, scale, offset, spread in (
            ('position', -1e3, 100.0, 0.005), ('force', 1e-3, 0.0, 0.01),
            ('pressure_a', 1e-5, 0.0, 0.3), ('pressure_b', 1e-5, 0.0, 0.3)):
        shown = np.interp(t, t * (1.0 + 1e-6 * clock_ppm) + delay, result[f'ram.{name}'])
        columns.append(scale * shown + offset + noise * random.normal(0.0, spread, len(t)))
    path, mapping = directory / 'press.csv', directory / 'press.yaml'
    np.savetxt(path, np.stack(columns, axis=1), '%.6f', ',',
               header='t,cmd,pos,force,pa,pb', comments='')
    mapping.write_text(MAPPING)
    return path, mapping
