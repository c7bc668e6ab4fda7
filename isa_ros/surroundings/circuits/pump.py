"""
A pump with pressure compensator, displacement limit and power limit.

Its swash plate follows with one lag; its largest displacement at its speed is its largest flow.
Flow > 0 runs from its inlet to its outlet. Without current it delivers nothing. Equation C47.

Neglected: its pulsation, and whether its inlet can follow; its leakage goes back to the inlet. The
friction of its shaft heats the oil (T8), and changes nothing else.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, name, parameter, Parameters
from isa_ros.core.units import LPM, MILLILITRE, MPA
import numpy as np

_LEAST_DROP = 1e4       # Pa: below it no power limit is felt
_PER_MINUTE = 1.0 / 60.0

PUMP = np.dtype((np.record, [
    ('p_set', 'f8'), ('band', 'f8'),    # Pa
    ('q_max', 'f8'),                    # m3/s
    ('power', 'f8'),                    # W
    ('lag', 'f8'),                      # s
    ('g', 'f8'),                        # leakage, m3/s/Pa
    ('is_stuck', 'f8')]))


@frozen(kw_only=True)
class PumpPart(Parameters):
    """A pump that reduces its flow at its set pressure, and at its power."""

    inlet: str = name('the tank, or the manifold that it draws from')
    outlet: str = name('the manifold that it feeds')
    pressure_mpa: float = parameter(
        'above its inlet, at which its compensator has reduced the flow to nothing', 'MPa',
        changeable=True, gt=0.0, le=70.0)
    displacement_ml: float = parameter(
        'per turn, at the limit of its displacement', 'ml', changeable=True, gt=0.0, le=1000.0)
    speed_rpm: float = parameter(
        'of its shaft; 0: it stands', 'rpm', changeable=True, ge=0.0, le=10000.0)
    power_w: float = parameter(
        'hydraulic, at which its flow is limited', 'W', absent=1e6, source='assumed, none',
        changeable=True, gt=0.0, le=1e6)
    band_mpa: float = parameter(
        'below the set pressure at full flow', 'MPa', absent=0.5, source='assumed', ge=0.01,
        le=10.0)
    lag_s: float = parameter(
        'of its displacement', 's', absent=0.03, source='assumed', ge=1e-3, le=10.0)
    leakage_lpm_per_mpa: float = parameter(
        'back to its inlet per pressure', 'l/min/MPa', absent=0.0, source='assumed', ge=0.0,
        le=10.0)
    efficiency_percent: float = parameter(
        'hydro-mechanical: power of its flow over that of its shaft; the rest heats the oil', '%',
        absent=100.0, source='assumed, no friction', ge=10.0, le=100.0)
    stuck: float = fault('1: its displacement stays as it is', '1', is_whole=True, ge=0.0, le=1.0)
    worn_lpm_per_mpa: float = fault('more leakage', 'l/min/MPa', ge=0.0, le=100.0)


def largest_flow(sheet: PumpPart) -> float:
    """Return the flow at the limit of the displacement, m3/s."""
    return sheet.displacement_ml * MILLILITRE * sheet.speed_rpm * _PER_MINUTE


def pump_fields(
        sheet: PumpPart, has_current: bool, thickness: float = 1.0) -> tuple[float, ...]:
    """Return the fields of the `PUMP` of a pump, in oil that is ``thickness`` times as thick."""
    return (sheet.pressure_mpa * MPA, sheet.band_mpa * MPA, largest_flow(sheet) * has_current,
            sheet.power_w, sheet.lag_s,
            (sheet.leakage_lpm_per_mpa + sheet.worn_lpm_per_mpa) * LPM / MPA / thickness,
            sheet.stuck)


@kernel
def pump_rate(rise, flow, pump):
    """
    Return dQ/dt of a pump at the pressure ``rise`` from inlet to outlet, m3/s2  (C47).

    `T Q' = min(Q_max clip((P_set - dP)/band), W/dP) - Q`; T and band > 0 by their ranges.
    """
    demand = pump.q_max * max(0.0, min(1.0, (pump.p_set - rise) / pump.band))
    if rise > _LEAST_DROP:
        demand = min(demand, pump.power / rise)
    return (1.0 - pump.is_stuck) * (demand - flow) / pump.lag
