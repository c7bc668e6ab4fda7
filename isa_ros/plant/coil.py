"""
Coil current behind the amplifier: the closed current loop of the paper, or the coil itself.

Equation 10 of the paper IS the closed current loop: it is never combined with an explicit coil.
Currents are the amplifier's, in A. The valve curves' series scale is the current through
both coils in series that moves the valve as far. Positive current extends.

Neglected: the mutual inductance of the two coils, and the time in which the current divides
between a sound coil and one with shorted turns; by `ClosedLoopCoil` also the 1.8 kHz mode and the
sampling of the current loop.
"""

import math
from typing import NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, fault, parameter, Parameters
from isa_ros.core.record import record
import numpy as np

_COILS = ('parallel', 'series', 'one_open')
CLOSED_LOOP = 0
EXPLICIT = 1


@frozen(kw_only=True)
class Coil(Parameters):
    """The amplifier and the valve's two redundant coils."""

    coils: str = choice(
        'how the two coils are wired; one_open: parallel, with one of them broken', *_COILS)
    supply_voltage: float = parameter(
        'amplifier saturation', 'V', changeable=True, gt=0.0, le=100.0)
    coil_resistance: float = parameter('of one coil', 'ohm', gt=0.0, le=1.0e5)
    coil_inductance: float = parameter('of one coil', 'H', gt=0.0, le=200.0)
    open_coils: float = fault(
        'coils whose wire is broken, besides that of one_open', '1', is_whole=True, ge=0.0, le=2.0)
    shorted_turns: float = fault(
        'share of the turns of one coil that are shorted', '1', ge=0.0, le=0.95)


@frozen(kw_only=True)
class ClosedLoopCoil(Coil):
    """The closed current loop as one pole (eq 10)."""

    bandwidth_rad_per_s: float = parameter(
        'pole p_c of the closed current loop (eq 10)', 'rad/s', gt=0.0, le=5.0e4)


@frozen(kw_only=True)
class ExplicitCoil(Coil):
    """The coil driven by the amplifier's voltage, with the resonance of the paper's figure 8 B."""

    mode_frequency_hz: float = parameter('of the resonance', 'Hz', gt=0.0, le=5.0e3)
    mode_strength: float = parameter('its share k of the current', '1', ge=0.0, le=0.5)
    mode_damping: float = parameter('its damping ratio', '1', gt=0.0, le=1.0)


COIL = np.dtype([
    ('kind', 'i8'), ('voltage', 'f8'), ('resistance', 'f8'), ('inductance', 'f8'),
    ('parallel', 'f8'),         # amplifier current per series-scale current
    ('p_c', 'f8'),              # closed loop
    ('mode_w', 'f8'), ('mode_share', 'f8'), ('mode_zeta', 'f8'),  # explicit
])
COIL_STATE = np.dtype([('current', 'f8'), ('mode', 'f8'), ('mode_rate', 'f8')])


class CoilCircuit(NamedTuple):
    """The two coils as the amplifier has them."""

    resistance: float
    """ohm."""
    inductance: float
    """H."""
    per_series: float
    """Amplifier current per series-scale current."""
    is_closed: bool
    """Whether a current can flow."""


def circuit(sheet: Coil) -> CoilCircuit:
    """
    Return the circuit of the coils that are sound, and of one with shorted turns  (V19).

    Two coils in parallel share the current; with the same current a single coil moves the
    valve half as far. Of the share 1 - s of its turns a coil has R (1 - s) and L (1 - s)^2; a
    single coil that is left is the one with the short.
    """
    turns = 1.0 - sheet.shorted_turns
    r_1, l_1 = sheet.coil_resistance, sheet.coil_inductance
    r_2, l_2 = r_1 * turns, l_1 * turns * turns
    n_open = sheet.open_coils + (sheet.coils == 'one_open')
    if sheet.coils == 'series':
        if not turns < 1.0:
            return CoilCircuit(2.0 * r_1, 2.0 * l_1, 1.0, n_open == 0)
        return CoilCircuit(r_1 + r_2, l_1 + l_2, 2.0 / (1.0 + turns), n_open == 0)
    if n_open > 0:
        return CoilCircuit(r_2, l_2, 2.0 / turns, n_open < 2)
    if not turns < 1.0:
        return CoilCircuit(0.5 * r_1, 0.5 * l_1, 2.0, True)
    return CoilCircuit(r_1 * r_2 / (r_1 + r_2), l_1 * l_2 / (l_1 + l_2),
                       (1.0 + turns) / turns, True)


def coil_record(sheet: ClosedLoopCoil | ExplicitCoil) -> np.record:
    """
    Return the `COIL` record of a sheet; what the other kind of coil has is zero.

    Without a closed circuit the amplifier's voltage does not reach the coils: their current
    decays with L/R.
    """
    wired = circuit(sheet)
    kind, p_c, mode_w, mode_share, mode_zeta = CLOSED_LOOP, 0.0, 0.0, 0.0, 0.0
    if isinstance(sheet, ExplicitCoil):
        kind, mode_w = EXPLICIT, 2.0 * math.pi * sheet.mode_frequency_hz
        mode_share, mode_zeta = sheet.mode_strength, sheet.mode_damping
    else:
        p_c = sheet.bandwidth_rad_per_s
    return record(
        COIL, kind=kind, voltage=sheet.supply_voltage if wired.is_closed else 0.0,
        resistance=wired.resistance, inductance=wired.inductance, parallel=wired.per_series,
        p_c=p_c, mode_w=mode_w, mode_share=mode_share, mode_zeta=mode_zeta)


@kernel
def current_rate(current, reference, coil):
    """
    Return di/dt = p_c (i_r - i), bounded by (+-U - R i)/L  (V1), in A/s.

    Equation 10 of the paper with the voltage limit of the amplifier.
    """
    highest = (coil.voltage - coil.resistance * current) / coil.inductance
    lowest = (-coil.voltage - coil.resistance * current) / coil.inductance
    return max(lowest, min(highest, coil.p_c * (reference - current)))


@kernel
def explicit_rates(y, voltage, coil):
    """
    Return the rates of the explicit coil under ``voltage``  (V11), in A/s, A/s, A/s2.

    L di_1/dt = U - R i_1, and the resonance on it, m'' = w^2 (i_1 - m) - 2 zeta w m'.
    """
    u = max(-coil.voltage, min(coil.voltage, voltage))
    first = (u - coil.resistance * y.current) / coil.inductance
    w = coil.mode_w
    second = w * w * (y.current - y.mode) - 2.0 * coil.mode_zeta * w * y.mode_rate
    return first, y.mode_rate, second


@kernel
def coil_current(y, coil):
    """Return i = i_1 + k (m - i_1), the current with its resonance, in A  (V11)."""
    if coil.kind == EXPLICIT:
        return y.current + coil.mode_share * (y.mode - y.current)
    return y.current


@kernel
def coil_heat(y, coil):
    """Return R i^2 in W  (E8)."""
    current = coil_current(y, coil)
    return coil.resistance * current * current


@kernel
def coil_rates(y, drive, coil, rates):
    """Write the rates of one `COIL_STATE`; ``drive``: a reference in A; explicit coil: in V."""
    if coil.kind == EXPLICIT:
        rates.current, rates.mode, rates.mode_rate = explicit_rates(y, drive, coil)
    else:
        rates.current = current_rate(y.current, drive, coil)
        rates.mode, rates.mode_rate = 0.0, 0.0
