"""
The network of a circuit: nodes, the elements between them, and their equations over time.

Its state is a row of floats: of every node its content, the temperature of its gas, the integral
of its pressure and the heat that its gas got; of every element its own state (flow of a pump or
a lump of a line, opening of a valve), what it has lost or given, the oil that went through it,
and the latch of an unloading valve. Contents change by what flows alone, so that all oil, with
that of the tank and outside, stays the same to rounding. Equations C45 to C52, E10 to E12.

Steps are of RK4. All that a circuit has is continuous and, by its lines and small manifolds,
oscillates or decays about as fast everywhere: an implicit step would be as long only where those
resonances are damped away, which are what lines are simulated for. So the step follows the
fastest of them (`isa_ros.surroundings.circuits.stiffness`).
"""

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.circuits.check import CHECK, check_flow
from isa_ros.surroundings.circuits.line import friction_drop, LINE, line_rate
from isa_ros.surroundings.circuits.nodes import (
    heat_rates, node_energy, node_pressure, phase_of, temperature_with)
from isa_ros.surroundings.circuits.orifice import latched, opening_rate, ORIFICE, orifice_flow
from isa_ros.surroundings.circuits.pump import PUMP, pump_rate
from isa_ros.surroundings.circuits.relief import RELIEF, relief_flow
import numpy as np

OF_LINE, OF_PUMP, OF_ORIFICE, OF_CHECK, OF_RELIEF = range(5)
"""Laws of elements."""

ELEMENT = np.dtype((np.record, [
    ('law', 'i8'),
    ('inlet', 'i8'), ('outlet', 'i8'),      # nodes
    ('senses', 'i8'),                       # node whose pressure switches an unloading valve
    ('line', LINE), ('pump', PUMP), ('orifice', ORIFICE), ('check', CHECK), ('relief', RELIEF)]))

_NOTHING = 1e-100       # of any unit: what decays ends here, before it slows the processor

PER_NODE, PER_ELEMENT = 4, 4
"""Floats of a state: contents, temperatures, impulses, heats; own, lost, through, latches."""
STAGES = 4
WORK_ROWS = 6
"""Rows as long as a state that `circuit_advance` works in."""


@kernel
def element_flow(drop, own, element):
    """Return the flow of an element from its inlet to its outlet, m3/s."""
    if element.law == OF_LINE:
        return own
    if element.law == OF_PUMP:
        return own + element.pump.g * drop
    if element.law == OF_ORIFICE:
        return orifice_flow(drop, own, element.orifice)
    if element.law == OF_CHECK:
        return check_flow(drop, element.check)
    return relief_flow(drop, element.relief)


@kernel
def own_rate(drop, own, latch, element):
    """Return the rate of the own state of an element."""
    if element.law == OF_LINE:
        return line_rate(drop, own, element.line)
    if element.law == OF_PUMP:
        return pump_rate(-drop, own, element.pump)
    if element.law == OF_ORIFICE:
        return opening_rate(own, latch, element.orifice)
    return 0.0


@kernel
def lost_power(drop, flow, element):
    """Return what an element takes of the oil's power, W; < 0: a pump gives it  (E11)."""
    if element.law == OF_LINE:
        return friction_drop(flow, element.line) * flow
    return drop * flow


@kernel
def circuit_rates(state, drawn, nodes, elements, pressures, rates):
    """
    Write d(state)/dt and the pressures of all nodes.

    ``drawn`` are the flows that actuators take from each node, (n,), m3/s.
    """
    n, m = len(nodes), len(elements)
    own = PER_NODE * n
    for i in range(n):
        pressures[i] = node_pressure(state[i], state[n + i], nodes[i])
        rates[i] = -drawn[i]
        rates[2 * n + i] = pressures[i]
    for j in range(m):
        element = elements[j]
        drop = pressures[element.inlet] - pressures[element.outlet]
        flow = element_flow(drop, state[own + j], element)
        rates[own + j] = own_rate(drop, state[own + j], state[own + 3 * m + j], element)
        rates[own + m + j] = lost_power(drop, flow, element)
        rates[own + 2 * m + j] = flow
        rates[own + 3 * m + j] = 0.0
        rates[element.inlet] -= flow
        rates[element.outlet] += flow
    for i in range(n):
        rates[n + i], rates[3 * n + i] = heat_rates(
            pressures[i], state[n + i], rates[i], nodes[i])


@kernel
def rk4_step(h, drawn, nodes, elements, state, work):
    """
    Advance the state of a circuit by one step of ``h`` s, but for latches; as `circuit_advance`.

    What flows into a node with gas brings it P dD, with the weights of the stages: where the step
    crosses a corner of its pressure, the gas has the temperature of that energy  (E12).
    """
    n, size = len(nodes), len(state)
    pressures, between, rates, total, last, brought = (
        work[0], work[1], work[2], work[3], work[4], work[5])
    for k in range(size):
        last[k] = between[k] = state[k]
        total[k] = brought[k] = 0.0
    for stage in range(STAGES):
        circuit_rates(between, drawn, nodes, elements, pressures, rates)
        weight = 1.0 if stage == 0 or stage == STAGES - 1 else 2.0
        share = 0.5 if stage < 2 else 1.0   # of the step, at which the next stage is
        for k in range(size):
            total[k] += weight * rates[k]
            between[k] = last[k] + share * h * rates[k]
        for i in range(n):
            brought[i] += weight * pressures[i] * rates[i]
    for k in range(size):
        state[k] = last[k] + h / 6.0 * total[k]
    for i in range(n):
        before, node = last[n + i], nodes[i]
        if node.gas.amount > 0.0 and (
                phase_of(last[i], before, node) != phase_of(state[i], state[n + i], node)):
            energy = (node_energy(last[i], before, node) + h / 6.0 * brought[i]
                      + (state[3 * n + i] - last[3 * n + i]))
            state[n + i] = temperature_with(energy, state[i], state[n + i], node)


@kernel
def circuit_advance(steps, h, drawn, nodes, elements, state, work):
    """
    Advance the state of a circuit by ``steps`` steps of ``h`` s, by RK4.

    ``work`` is room for `WORK_ROWS` rows as long as the state. The pressures of the nodes at the
    end are in its first row.
    """
    n, m, size = len(nodes), len(elements), len(state)
    pressures = work[0]
    latches = PER_NODE * n + 3 * m
    for _ in range(steps):
        rk4_step(h, drawn, nodes, elements, state, work)
        for j in range(m):
            if elements[j].law == OF_ORIFICE:
                sensed = elements[j].senses
                state[latches + j] = latched(
                    state[latches + j],
                    node_pressure(state[sensed], state[n + sensed], nodes[sensed]),
                    elements[j].orifice)
    for k in range(size):
        if abs(state[k]) < _NOTHING:
            state[k] = 0.0
    for i in range(n):
        pressures[i] = node_pressure(state[i], state[n + i], nodes[i])
