"""
The step with which a circuit is integrated, or why it cannot be.

The fastest motion of the linearised network is bounded without eigenvalues, by sums that are the
same on every machine: with the steepest slopes g of all valves, pipes of inertance I and
capacities C of the oil alone, `r <= max(sum(g + g_n)/C) + sqrt(max(sum(1/I + 1/I_n)/C)) +
max(R/I) + max(1/T)`, g_n and I_n of what leads to another node with a capacity. The parts with g
and those with 1/I are each a graph's Laplacian scaled by 1/C, whose eigenvalues Gershgorin's
circles bound; norms add. Equation C53.
"""

import math
from typing import NamedTuple

from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits.line import LinePart
from isa_ros.surroundings.circuits.network import (
    OF_CHECK, OF_LINE, OF_ORIFICE, OF_PUMP)
from isa_ros.surroundings.circuits.orifice import SMOOTH
from isa_ros.surroundings.circuits.plan import Network
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.return_line import SUPPLY_STEP
import numpy as np

REACH = 1.0             # rate times step: RK4 errs by 0.8 % a radian of the fastest motion
SHORTEST_STEP = 2e-6    # s


class Rate(NamedTuple):
    """The greatest rate of a kind, 1/s, where, and by which part."""

    value: float
    place: str
    part: str


def _slopes(element: np.record) -> tuple[float, float, float]:
    """Return the steepest dQ/dP, what acts as 1/I, and the rate of its own state alone."""
    if element.law == OF_LINE:
        return 0.0, 1.0 / element.line.inertance, element.line.laminar / element.line.inertance
    if element.law == OF_PUMP:
        pump = element.pump
        return pump.g, pump.q_max / (pump.band * pump.lag), 1.0 / pump.lag
    if element.law == OF_ORIFICE:
        orifice = element.orifice
        return (orifice.k / math.sqrt(orifice.delta) + orifice.g, 0.0,
                1.0 / orifice.lag if orifice.lag > 0.0 else 0.0)
    if element.law == OF_CHECK:
        return element.check.k / math.sqrt(SMOOTH) + element.check.g, 0.0, 0.0
    return element.relief.g + element.relief.k, 0.0, 0.0


def rates(network: Network) -> tuple[Rate, Rate, Rate]:
    """Return the greatest rates of decays, of oscillations, and of parts by themselves  (C53)."""
    slopes = [_slopes(element) for element in network.elements]
    own = max((Rate(slope[2], owner, owner) for slope, owner in zip(slopes, network.owners)),
              key=lambda rate: rate.value)
    is_held = (network.nodes['is_held'] != 0.0).tolist()
    ends = [*zip(network.elements['inlet'].tolist(), network.elements['outlet'].tolist())]
    found = []
    for which in (0, 1):
        greatest = Rate(0.0, '', '')
        for k, c in enumerate(network.nodes['c'].tolist()):
            if is_held[k]:
                continue
            total, most, part = 0.0, 0.0, ''
            for (inlet, outlet), slope, owner in zip(ends, slopes, network.owners):
                if k in (inlet, outlet):
                    is_free = not (is_held[inlet] or is_held[outlet])
                    total += slope[which] * (1.0 + is_free)
                    if slope[which] > most:
                        most, part = slope[which], owner
            rate = math.sqrt(total / c) if which else total / c
            if rate > greatest.value:
                greatest = Rate(rate, network.places[k], part)
        found.append(greatest)
    return found[0], found[1], own


def steps_of(sheet: CircuitSupply, network: Network, step: float, name: str) -> int:
    """
    Return the number of steps of a tick of ``step`` s.

    Raises
    ------
    ParameterError
        They would be shorter than `SHORTEST_STEP`; the message names the part.

    """
    decay, swing, own = rates(network)
    fastest = decay.value + swing.value + own.value
    most = REACH / SHORTEST_STEP
    if fastest > most:
        worst = max(decay, swing, own, key=lambda rate: rate.value)
        where = f'parts.{worst.place}'
        by = '' if worst.part == worst.place else f' by {worst.part}'
        line = sheet.by_name[worst.place]
        advice = ('enlarge its oil_volume_l' if not isinstance(line, LinePart)
                  else 'reduce its lumps' if worst.value <= most * line.lumps
                  else 'enlarge its length_m')
        raise ParameterError(
            f'{name}: {where}: its pressure changes at {worst.value:.3g} 1/s{by}, all of the '
            f'circuit at {fastest:.3g} 1/s, must be <= {most:.3g} 1/s (steps of '
            f'{SHORTEST_STEP * 1e6:g} us); {advice}')
    return max(round(step / SUPPLY_STEP), math.ceil(step * fastest / REACH), 1)
