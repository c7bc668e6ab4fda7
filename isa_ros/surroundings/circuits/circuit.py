"""
A circuit over a run, with a port at each manifold that feeds actuators.

Actuators move the pressure of their manifold in their own tick by what it is said to be
(`isa_ros.surroundings.supply_port`), and use the return pressure of the tick's start; the circuit
then advances over the same interval with the mean flows. Equation E12.
"""

from collections.abc import Sequence

from isa_ros.core.bound import Bound
from isa_ros.errors import ConfigError, RunError
from isa_ros.surroundings.circuits.fed import Fed, OwnHeat
from isa_ros.surroundings.circuits.network import WORK_ROWS
from isa_ros.surroundings.circuits.nodes import gas_volume, node_energy, node_pressure
from isa_ros.surroundings.circuits.plan import Network, network_of
from isa_ros.surroundings.circuits.rest import at_rest, of_return
from isa_ros.surroundings.circuits.rows import rows_of_circuit
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.circuits.stiffness import steps_of
from isa_ros.surroundings.circuits.ticking import (
    advance, FED, fill_nodes, Flowing, Ports, show_rows, Shown)
from isa_ros.surroundings.circuits.warmth import coldest_oil, warmth_of
from isa_ros.surroundings.supply_port import FedNode
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE, SUPPLY_STATE
import numpy as np
from numpy.typing import NDArray


class Circuit:
    """
    One circuit over a run; ``name`` is used in errors.

    ``samples`` are the rows of the whole and of its parts, `SUPPLY_SAMPLE`, (n_rows,); None: new
    rows are made.

    Raises
    ------
    ParameterError
        The circuit cannot be integrated, or a manifold is too small for its actuators.

    """

    def __init__(
            self, sheet: CircuitSupply, step_ns: int, fed: Sequence[Fed],
            samples: np.ndarray | None = None, name: str = 'supply') -> None:
        self.has_port = True
        """Whether its pressures move within a tick."""
        self.fed = tuple(fed)
        self._name, self._step = name, step_ns * 1e-9
        self._sheet, self._warmth = sheet, warmth_of(sheet)
        network = self._network_of(sheet)
        self._nodes = [network.node(own.place) for own in fed]
        self._returns = [network.node(sheet.return_of(own.place)) for own in fed]
        self._first = rows_of_circuit(sheet, network)
        self.samples = np.zeros(len(self._first), SUPPLY_SAMPLE) if samples is None else samples
        self._shown = self.samples.view(np.dtype((np.record, SUPPLY_SAMPLE)))
        self._row_of = {name: 1 + k for k, name in enumerate(sheet.by_name)}
        self._rows = [self._row_of[own.place] for own in fed]
        self.state: NDArray[np.float64] = at_rest(sheet, network)
        self._network, self._steps = network, 0
        self._work = np.zeros((WORK_ROWS, len(self.state)))
        self._rates = np.zeros(len(self.state))
        self._held = np.zeros(len(network.nodes))
        self._flows = np.zeros(len(network.nodes))
        self._ports = np.zeros((len(fed), FED))
        self._none = np.zeros(len(network.nodes))
        self._stored = np.zeros(len(self._first))
        self._is_return = of_return(sheet, network)
        self._oil = np.zeros((2, len(network.nodes)))
        self._gas = np.array([gas_volume(node_pressure(*own), *own[1:])
                              for own in self._all_nodes()])
        self._take(sheet)
        self._show()
        self._stored[:] = self.samples['stored_energy']
        self._show()

    def _take(self, sheet: CircuitSupply) -> None:
        self._sheet, (network, self._steps) = sheet, self._checked(sheet)
        amounts = network.nodes['gas']['amount']
        np.minimum(amounts, self._network.nodes['gas']['amount'], out=amounts)
        self._network = network
        self._held[:] = [node_pressure(*own) for own in self._all_nodes()]
        self._bind()
        if self._warmth is not None:
            self._warmth.take(sheet, network)

    def _bind(self) -> None:
        """Bind the kernels of a tick to the memory, of which the network is another one."""
        flowing = Flowing(
            self._network.nodes, self._network.elements, self.state, self._rates, self._work,
            self._held, self._flows, np.array([self._steps]), np.array([self._step]))
        self._advance = Bound(advance, flowing)
        self._fill_nodes = Bound(fill_nodes, Ports(
            flowing, np.array(self._nodes, np.int64), self._ports))
        self._show_rows = Bound(show_rows, Shown(
            flowing, self._none, self._first, self._is_return, self._stored, self._gas, self._oil,
            self._shown))

    def _all_nodes(self) -> list[tuple[float, float, np.record]]:
        """Return content, temperature and record of every node."""
        n = len(self._network.nodes)
        return [(float(self.state[k]), float(self.state[n + k]), self._network.nodes[k])
                for k in range(n)]

    def _checked(self, sheet: CircuitSupply) -> tuple[Network, int]:
        stiffest = network_of(sheet, coldest_oil(sheet, self._warmth))
        steps = steps_of(sheet, stiffest, self._step, self._name)
        if self._warmth is not None:
            self._warmth.refuse_cold(sheet, max(own.coldest for own in self.fed), self._name)
        for own, node in zip(self.fed, self._nodes):
            own.refuse_small(stiffest.nodes[node], self._name)
        return stiffest if self._warmth is None else self._network_of(sheet), steps

    def _network_of(self, sheet: CircuitSupply) -> Network:
        """Return the network with its oil as warm as it is."""
        return network_of(sheet, None if self._warmth is None else self._warmth.oil_now(sheet))

    def refuse(self, sheet: CircuitSupply) -> None:
        """Refuse a sheet with which `change` cannot continue; raises as the class."""
        self._checked(sheet)

    def change(self, sheet: CircuitSupply) -> None:
        """
        Continue with other values of the sheet: contents, flows and openings keep theirs.

        Gas that has escaped stays away, with what it and its pressure had stored; it counts as
        lost. The tank is paid for its oil at the pressure that it had. Raises as the class.
        """
        n = len(self._network.nodes)
        before = [(node_energy(*own), own[2].p_held) for own in self._all_nodes()]
        self._take(sheet)
        for k, (own, (energy, p_held)) in enumerate(zip(self._all_nodes(), before)):
            self.state[3 * n + k] += node_energy(*own) - energy + (p_held - own[2].p_held) * own[0]
        self._show()

    def fill(self, rows: np.ndarray) -> None:
        """Fill both pressures of the fed actuators, of all rows of a run, for the next tick."""
        for own, node, back in zip(self.fed, self._nodes, self._returns):
            for row in own.rows:
                rows['supply_pressure'][row] = self._held[node]
                rows['return_pressure'][row] = self._held[back]

    @property
    def pressures(self) -> list[tuple[float, float]]:
        """Return supply and return pressure of each manifold that feeds, for the next tick."""
        return [(float(self._held[node]), float(self._held[back]))
                for node, back in zip(self._nodes, self._returns)]

    @property
    def oil_celsius(self) -> float | None:
        """Return the temperature of the oil in its tank now; None: its oil has none."""
        return None if self._warmth is None else float(self._warmth.oil.celsius)

    def nodes(self) -> list[FedNode]:
        """Return the manifolds that feed actuators at the start of the next tick."""
        self._fill_nodes.run()
        return [FedNode(*own) for own in self._ports.tolist()]

    def advance_nodes(
            self, drawn: Sequence[float], paid: Sequence[float], returned: Sequence[float],
            heated: Sequence[OwnHeat] = ()) -> None:
        """
        Advance by one tick in which these volumes were drawn at its nodes, m3.

        ``paid`` is the energy that the actuators counted for them, J: the integral of P q over
        the tick. ``returned`` are the volumes given to the return, m3, and ``heated`` has of each
        node what its actuators with a temperature of their own did.
        """
        flows = self._flows
        flows[:] = 0.0
        for node, back, volume, given in zip(self._nodes, self._returns, drawn, returned):
            flows[node] += volume / self._step
            flows[back] -= given / self._step
        n = len(self._network.nodes)
        self.state[2 * n:3 * n] = 0.0
        self._advance.run()
        taken, carried = self._account(drawn, paid, returned), 0.0
        for own, back in zip(heated, self._returns):
            taken -= own.paid - float(self._held[back]) * own.returned
            carried += own.heat
        self._held[:] = self._work[0, :n]
        if self._warmth is not None and self._warmth.advance(
                self._step, taken, carried, self.state, self._network):
            self.change(self._sheet)
            return
        self._show()

    def advance_held(self, drawn: Sequence[float], returned: Sequence[float]) -> None:
        """Advance by one tick over which the actuators paid the pressures of its start."""
        self.advance_nodes(
            drawn, [self._held[node] * volume for node, volume in zip(self._nodes, drawn)],
            returned)

    def _account(
            self, drawn: Sequence[float], paid: Sequence[float],
            returned: Sequence[float]) -> float:
        """Add oil and energy of the actuators to manifolds and the whole; return the energy."""
        n = len(self._network.nodes)
        means = self.state[2 * n:3 * n] / self._step
        whole, total = self.samples[0], 0.0
        for k, row in enumerate(self._rows):
            own, back = self.samples[row], self._returns[k]
            energy = paid[k] - float(self._held[back]) * returned[k]
            given = means[self._nodes[k]] * drawn[k] - means[back] * returned[k]
            total += energy
            own['power'] = energy / self._step
            own['peak_power'] = max(own['peak_power'], own['power'])
            self._oil[0, self._nodes[k]] += drawn[k]
            self._oil[1, back] += returned[k]
            whole['drawn'] += drawn[k]
            whole['returned'] += returned[k]
            for sample in (own, whole):
                sample['energy'] += energy
                sample['held_energy'] += energy - given
        whole['power'] = total / self._step
        whole['peak_power'] = max(whole['peak_power'], whole['power'])
        return total

    def _show(self) -> None:
        self._show_rows.run()
        if self._warmth is not None:
            self._warmth.show(self._row_of, self.samples)

    @property
    def _heat_at(self) -> int:
        """Return how many numbers of a `snapshot` are before those of the heat."""
        return len(self.state) + self._oil.size + len(self._held)

    @property
    def saved_size(self) -> int:
        """Return the bytes of a `snapshot`: state, oil of actuators, gas that is left, heat."""
        heat = 0 if self._warmth is None else len(self._warmth.snapshot())
        return self._heat_at * self.state.itemsize + heat

    def snapshot(self) -> bytes:
        """
        Return the state beside the samples; `restore` continues from both.

        Raises
        ------
        RunError
            A number is not finite.

        """
        if not np.isfinite(self.state).all():
            raise RunError(f'{self._name}: its state is not finite, cannot be saved')
        amounts = self._network.nodes['gas']['amount']
        heat = b'' if self._warmth is None else self._warmth.snapshot()
        return self.state.tobytes() + self._oil.tobytes() + amounts.tobytes() + heat

    def refuse_snapshot(self, snapshot: bytes) -> None:
        """Refuse bytes that are not a `snapshot` of this circuit; raises `ConfigError`."""
        if len(snapshot) != self.saved_size or not self._can_be(np.frombuffer(snapshot)):
            raise ConfigError(f'{self._name}: saved state is not one of this circuit')

    def _can_be(self, numbers: NDArray[np.float64]) -> bool:
        return bool(np.isfinite(numbers).all()) and (
            self._warmth is None or self._warmth.can_be(numbers[self._heat_at:]))

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`, whose sheet and samples are in force."""
        values = np.frombuffer(snapshot)
        size = len(self.state)
        self.state[:] = values[:size]
        self._oil[:] = values[size:size + self._oil.size].reshape(self._oil.shape)
        self._network.nodes['gas']['amount'] = values[size + self._oil.size:self._heat_at]
        if self._warmth is not None:
            self._warmth.restore(values[self._heat_at:])
            self._take(self._sheet)
        self._held[:] = [node_pressure(*own) for own in self._all_nodes()]
        saved = list(SUPPLY_STATE.names or ())
        samples = self.samples[saved].copy()
        self._show()
        self.samples[saved] = samples
