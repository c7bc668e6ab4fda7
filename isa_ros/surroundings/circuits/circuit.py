"""
A circuit over a run, with a port at each manifold that feeds actuators.

Actuators move the pressure of their manifold in their own tick by what it is said to be
(`isa_ros.surroundings.supply_port`), and use the return pressure of the tick's start; the circuit
then advances over the same interval with the mean flows. Equation E12.
"""

from collections.abc import Sequence

from isa_ros.core.bound import Bound, Rebound
from isa_ros.errors import ConfigError, RunError
from isa_ros.surroundings.circuits import ticking as tick
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.network import WORK_ROWS
from isa_ros.surroundings.circuits.nodes import gas_volume, node_energy, node_pressure
from isa_ros.surroundings.circuits.plan import Network, network_of
from isa_ros.surroundings.circuits.rest import at_rest, of_return
from isa_ros.surroundings.circuits.rows import rows_of_circuit
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.circuits.stiffness import steps_of
from isa_ros.surroundings.circuits.warmth import coldest_oil, no_heat, warmth_of
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
        self._fed = tuple(fed)
        self._name, self._step = name, step_ns * 1e-9
        self._sheet, self._warmth = sheet, warmth_of(sheet)
        network = self._network = self._network_of(sheet)
        self._nodes = np.array([network.node(own.place) for own in fed], np.int64)
        self._returns = np.array(
            [network.node(sheet.return_of(own.place)) for own in fed], np.int64)
        first = rows_of_circuit(sheet, network)
        self.samples = np.zeros(len(first), SUPPLY_SAMPLE) if samples is None else samples
        self._row_of = {name: 1 + k for k, name in enumerate(sheet.by_name)}
        self.state: NDArray[np.float64] = at_rest(sheet, network)
        self._n_steps = np.zeros(1, np.int64)
        self._held = np.zeros(len(network.nodes))
        self._is_due = np.zeros(1, np.int64)
        self._oil = np.zeros((2, len(network.nodes)))
        self._stored = np.zeros(len(first))
        self._gas = np.array([gas_volume(node_pressure(*own), *own[1:])
                              for own in self._all_nodes()])
        self._take(sheet)
        self._bind(first, of_return(sheet, network))
        self._show()
        self._stored[:] = self.samples['stored_energy']
        self._show()

    @property
    def _steps(self) -> int:
        """Return the steps of a tick."""
        return int(self._n_steps[0])

    def _take(self, sheet: CircuitSupply) -> None:
        """Take the values of a sheet; the arrays stay where they are."""
        self._sheet, (network, self._n_steps[0]) = sheet, self._checked(sheet)
        own, amounts = self._network, network.nodes['gas']['amount']
        np.minimum(amounts, own.nodes['gas']['amount'], out=amounts)
        own.nodes[:], own.elements[:] = network.nodes, network.elements
        self._held[:] = [node_pressure(*node) for node in self._all_nodes()]
        if self._warmth is not None:
            self._warmth.take(sheet, network)

    def _bind(self, first: np.ndarray, is_return: np.ndarray) -> None:
        """Bind the kernels of a tick to the memory."""
        n, own = len(self._held), self._network
        flowing = tick.Flowing(
            own.nodes, own.elements, self.state, np.zeros(len(self.state)),
            np.zeros((WORK_ROWS, len(self.state))), self._held, np.zeros(n), self._n_steps,
            np.array([self._step]))
        self._shown = tick.ShownRows(
            flowing, np.zeros(n), first, is_return, self._stored, self._gas, self._oil,
            self.samples.view(np.dtype((np.record, SUPPLY_SAMPLE))),
            no_heat() if self._warmth is None else self._warmth.heating)
        groups = self._groups([own.rows for own in self._fed], [own.heated for own in self._fed])
        self._ports = np.zeros((len(self._fed), tick.FED))
        self._fill_nodes = Bound(tick.fill_nodes, tick.Nodes(flowing, groups, self._ports))
        self._show_rows = Bound(tick.show_rows, self._shown)
        self.filling = Rebound(tick.fill_pressures, lambda ports: tick.Pressures(
            self._held, groups, ports))
        """Of the ports: fills the pressures of its actuators."""
        self.feeding = Rebound(tick.fill_manifolds, lambda answers, feeds: tick.Feeds(
            flowing, groups, self._shown.heating.oil, answers, feeds))
        """Of last answers and ports of its actuators: fills the latter."""
        self.advancing = Rebound(tick.advance, lambda replies, answers: tick.CircuitTick(
            self._shown, groups, self._is_due, replies, answers))
        """Of replies and answers, or none: advances by one tick, which `settle` ends."""
        self.is_due = None if self._warmth is None else Bound(
            tick.is_due, tick.WarmthDue(self._is_due))
        """What returns 1 where `settle` has something to do; None: it never has."""

    def _groups(self, rows: Sequence[Sequence[int]], heated: Sequence[Sequence[int]]
                ) -> tick.Groups:
        """Return the actuators of its manifolds by their rows, and which warm up themselves."""
        return tick.Groups(
            self._nodes, self._returns,
            np.array([self._row_of[own.place] for own in self._fed], np.int64),
            np.array([row for of_one in rows for row in of_one], np.int64),
            np.array([row in own for of_one, own in zip(rows, heated) for row in of_one],
                     np.bool_),
            np.cumsum([0, *map(len, rows)], dtype=np.int64))

    def _all_nodes(self) -> list[tuple[float, float, np.record]]:
        """Return content, temperature and record of every node."""
        n = len(self._network.nodes)
        return [(float(self.state[k]), float(self.state[n + k]), self._network.nodes[k])
                for k in range(n)]

    def _checked(self, sheet: CircuitSupply) -> tuple[Network, int]:
        stiffest = network_of(sheet, coldest_oil(sheet, self._warmth))
        steps = steps_of(sheet, stiffest, self._step, self._name)
        if self._warmth is not None:
            self._warmth.refuse_cold(sheet, max(own.coldest for own in self._fed), self._name)
        for own, node in zip(self._fed, self._nodes):
            own.refuse_small(stiffest.nodes[node], self._name)
        return stiffest if self._warmth is None else self._network_of(sheet), steps

    def _network_of(self, sheet: CircuitSupply) -> Network:
        """Return the network with its oil as warm as it is."""
        return network_of(sheet, None if self._warmth is None else self._warmth.oil_now(sheet))

    def refuse(self, sheet: CircuitSupply) -> None:
        """Refuse a sheet with which `change` cannot continue; raises as the class."""
        if sheet != self._sheet:
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

    def settle(self) -> None:
        """End a tick after which the oil has the properties of another temperature."""
        if self._is_due[0]:
            self._is_due[0] = 0
            self.change(self._sheet)

    @property
    def pressures(self) -> list[tuple[float, float]]:
        """Return supply and return pressure of each manifold that feeds, for the next tick."""
        return [(float(self._held[node]), float(self._held[back]))
                for node, back in zip(self._nodes, self._returns)]

    def nodes(self) -> list[FedNode]:
        """Return the manifolds that feed actuators at the start of the next tick."""
        self._fill_nodes.run()
        return [FedNode(*own) for own in self._ports.tolist()]

    def _show(self) -> None:
        self._show_rows.run()

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
