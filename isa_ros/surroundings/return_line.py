"""
The return line of a supply: to its tank, through a filter or a long hose.

Pressures are gauge; flows enter the line when positive. Equation C9. Neglected: heat, air in the
tank.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.units import LITRE, LPM, MPA
import numpy as np

SUPPLY_STEP = 1e-4  # s, step of the RK4 of supply and return line


@frozen(kw_only=True)
class HeldReturn(Parameters):
    """A return line at the constant pressure of the tank."""


@frozen(kw_only=True)
class VolumeReturn(Parameters):
    """A return line with a volume of oil, separated from the tank by a filter or a long hose."""

    oil_volume_l: float = parameter('oil in the return line', 'l', gt=0.0, le=100.0)
    bulk_modulus: float = parameter('effective, of the return line', 'Pa', gt=0.0, le=2e9)
    tank_lpm_per_mpa: float = parameter(
        'flow to the tank per pressure above it', 'l/min/MPa', changeable=True, gt=0.0, le=1e4)


ReturnLine = HeldReturn | VolumeReturn

RETURN_LINE = np.dtype([
    ('p_t', 'f8'),              # pressure of the tank, Pa
    ('c', 'f8'),                # V/beta, m3/Pa
    ('g', 'f8'),                # conductance to the tank, m3/s/Pa
])


def return_record(line: VolumeReturn, tank_pressure: float) -> np.ndarray:
    """Return the `RETURN_LINE` record of a return line with a volume, shape (1,)."""
    record = np.zeros(1, RETURN_LINE)
    record['p_t'] = tank_pressure
    record['c'] = line.oil_volume_l * LITRE / line.bulk_modulus
    record['g'] = line.tank_lpm_per_mpa * LPM / MPA
    return record


@kernel
def return_rate(pressure, returned, line):
    """Return dP/dt of the return line: C dP/dt = Q_returned - G (P - P_tank)  (C9), in Pa/s."""
    return (returned - line.g * (pressure - line.p_t)) / line.c


@kernel
def tank_power(pressure, line):
    """Return P G (P - P_tank), what the oil loses on its way to the tank  (E9), in W."""
    return pressure * line.g * (pressure - line.p_t)


@kernel
def return_advance(steps, returned, lines, states):
    """Advance the return line of ``states[0]`` with the mean flow ``returned``, by RK4."""
    h, line, state = SUPPLY_STEP, lines[0], states[0]
    held, impulse = state.return_pressure, 0.0
    for _ in range(steps):
        p = state.return_pressure
        p_1 = return_rate(p, returned, line)
        p_2 = return_rate(p + 0.5 * h * p_1, returned, line)
        p_3 = return_rate(p + 0.5 * h * p_2, returned, line)
        p_4 = return_rate(p + h * p_3, returned, line)
        state.return_pressure = p + h / 6.0 * (p_1 + 2.0 * (p_2 + p_3) + p_4)
        impulse += h * p + h * h / 6.0 * (p_1 + p_2 + p_3)
        state.return_energy += h / 6.0 * (
            tank_power(p, line) + 2.0 * (tank_power(p + 0.5 * h * p_1, line)
                                         + tank_power(p + 0.5 * h * p_2, line))
            + tank_power(p + h * p_3, line))
    now = state.return_pressure
    state.stored_energy += 0.5 * line.c * (now * now - held * held)
    state.held_energy += returned * (impulse - held * (steps * h))
