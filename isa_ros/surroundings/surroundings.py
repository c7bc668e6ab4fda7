"""
Surroundings of the actuators of a run: the supplies that feed them and the bodies they move.

They are the other side of the load port (equation L1) and independent of messages and of the
configuration; `isa_ros.config.assembly` makes them from a run.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from isa_ros.core.bound import Bound, nothing, Part
from isa_ros.core.changeable import Changeable, changeables, with_own_changes
from isa_ros.core.changing_values import bare, ChangingValues, OFF
from isa_ros.core.parameter import check
from isa_ros.core.saved_state import cut, restored_rows
from isa_ros.core.signals import SUPPLY_REPLY
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.surroundings.body import Body, BoundBody, ChangingBody, Records, SizedBody
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.emergency_line import changing_line
from isa_ros.surroundings.feeding import made, n_samples, SupplyCircuit
from isa_ros.surroundings.supply import saved_states, Supply
from isa_ros.surroundings.supply_port import ANSWER, SupplyPorts
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE, SUPPLY_STATE
from isa_ros.surroundings.supply_tick import Answers, keep_answers
import numpy as np

_NO_ANSWERS = np.zeros(0, SUPPLY_REPLY)


class Surroundings:
    """
    Supplies and bodies over a run; an actuator that moves no body has its own load.

    ``starts`` are `START` rows, (n_actuators,), with position and force at t = 0 of the
    actuators that do not move a body; ``sensor_stiffness`` is that of all actuators, N/m or
    Nm/rad, (n_actuators,). ``lines`` are the names of the groups with an emergency stop.
    """

    def __init__(
            self, circuits: Sequence[SupplyCircuit], bodies: Mapping[str, Body], starts: Records,
            sensor_stiffness: Sequence[float], step_ns: int, lines: Sequence[str] = ()) -> None:
        self.circuits = tuple(circuits)
        self.bodies = dict(bodies)
        """By name, in the order of the run."""
        ends = np.cumsum([0, *(n_samples(own.sheet) for own in circuits)])
        self.supplies: Records = np.zeros(ends[-1], SUPPLY_SAMPLE)
        """
        `SUPPLY_SAMPLE` of every supply at the end of the last tick; overwritten.

        A circuit has one more for each of its parts.
        """
        self._supplies = [
            made(own, step_ns, self.supplies[first:last])
            for own, first, last in zip(circuits, ends, ends[1:])]
        self._owners = [own.name for own in circuits for _ in range(n_samples(own.sheet))]
        self._circuits = [own for own in self._supplies if isinstance(own, Circuit)]
        self._ports = SupplyPorts(len(starts), [own for own in self._supplies if own.has_port])
        self.changing: Mapping[str, Changeable] = {
            name: own for circuit in circuits
            for name, own in changeables(circuit.sheet, f'{circuit.name}.').items()} | {
            name: own for line in lines for name, own in changing_line(line).items()} | {
            name: own for body, given in self._changing_bodies()
            for name, own in changeables(given.changing, f'{body}.').items()}
        """All that may change during a run, by SUPPLY.KEY or BODY.KEY, and the lines of groups."""
        self._values = ChangingValues(
            'supplies', list(self.changing), [own.value for own in self.changing.values()])
        self._rest = starts.copy()
        self._sensor_stiffness = sensor_stiffness

    @property
    def provenance(self) -> dict[str, str]:
        """Return what external bodies say of themselves, by BODY.KEY."""
        return {f'{name}.{key}': value for name, body in self.bodies.items()
                for key, value in getattr(body, 'provenance', {}).items()}

    def starts(self) -> Records:
        """
        Return the `START` of every actuator, shape (n_actuators,).

        An actuator that moves a body carries it: its force deflects the sensor, so the
        position of piston or rotor differs from the load's by force over stiffness (S1).
        """
        starts = self._rest.copy()
        self._fill_pressures(starts)
        for body in self.bodies.values():
            body.starts(starts)
            for row in body.rows:
                starts[row]['position'] += starts[row]['force'] / self._sensor_stiffness[row]
        return starts

    def ports(self, ports: Records) -> None:
        """
        Fill the `LOAD_PORT` of every actuator for the next tick, shape (n_actuators,).

        The tick begins: values that were tuned take effect.
        """
        if self._values.latch():
            self._change()
        for supply in self._supplies:
            supply.filling.to(ports).run()
        for body in self.bodies.values():
            body.ports(ports)

    def fill_feeds(self, feeds: Records) -> None:
        """Fill the `SUPPLY_PORT` of the actuators whose supply has a port, (n_actuators,)."""
        self._ports.fill(feeds)

    @property
    def has_supply_ports(self) -> bool:
        """Return whether the pressure of a supply moves within a tick."""
        return self._ports.are_there

    def _fill_pressures(self, rows: Records) -> None:
        for supply, circuit in zip(self._supplies, self.circuits):
            for fed, (pressure, back) in zip(circuit.groups, supply.pressures):
                rows['supply_pressure'][list(fed)] = pressure
                rows['return_pressure'][list(fed)] = back

    def tune(self, values: Mapping[str, float]) -> None:
        """
        Accept new values of `changing`, all or none; they take effect at the next tick.

        The last of several before one tick wins; pressures and pump flow are kept. A name may
        begin with `OVER` or `OFF`.

        Raises
        ------
        ConfigError
            An unknown name, a value out of its range, or a supply too small for the tick.

        """
        for given, value in values.items():
            name = bare(given)
            if name not in self.changing:
                raise ConfigError(f'{name} is unknown; {alternatives(name, self.changing)}')
            if not given.startswith(OFF):
                check(name, value, self.changing[name].declared)
        for all_values in self._values.with_accepted(values):
            for supply, sheet in self._sheets(all_values):
                supply.refuse(sheet)
        self._values.accept(values)

    @property
    def is_settled(self) -> bool:
        """Return whether no value changed at the last tick, or changes at the next."""
        return self._values.is_settled

    def tuned_value(self, name: str) -> float:
        """Return the last accepted value of one of `changing`."""
        return self._values.value(name)

    @property
    def tuned(self) -> dict[str, float]:
        """Return the values of `changing` that changed at the start of the last tick."""
        return self._values.applied

    def _sheets(self, values: Mapping[str, float]) -> Iterator[tuple[Supply | Circuit, Any]]:
        for supply, circuit in zip(self._supplies, self.circuits):
            yield supply, with_own_changes(circuit.sheet, circuit.name, values)

    def _changing_bodies(self) -> Iterator[tuple[str, ChangingBody]]:
        for name, body in self.bodies.items():
            if isinstance(body, ChangingBody):
                yield name, body

    def _change(self) -> None:
        """Let the values in force take effect in supplies and bodies."""
        values = self._values.in_force
        for supply, sheet in self._sheets(values):
            supply.change(sheet)
        for name, body in self._changing_bodies():
            body.change(with_own_changes(body.changing, name, values))

    def advance(self, replies: Records, fed: Records | None = None) -> None:
        """
        Advance bodies and supplies by one tick with the `LOAD_REPLY` of every actuator.

        ``fed`` are their `SUPPLY_REPLY`, where a supply has a port.

        Raises
        ------
        SimulationDiverged
            A state of a body is no longer finite.

        """
        for body in self.bodies.values():
            body.advance(replies)
        have_moved = self._ports.take(fed)
        for supply in self._supplies:
            supply.advancing.to(replies, self._answers(supply, have_moved)).run()
        self._settle()

    def _answers(self, supply: Supply | Circuit, have_moved: bool) -> Records:
        """Return the answers of a tick to a supply's port; none where it held its pressure."""
        return self._ports.answers if supply.has_port and have_moved else _NO_ANSWERS

    def _settle(self, found: int = 0) -> None:
        """End a tick that all supplies have advanced by."""
        for own in self._circuits:
            own.settle()

    def parts(
            self, ports: Records, feeds: Records, replies: Records, fed: Records
            ) -> tuple[list[Part], list[Part]] | None:
        """
        Return what a compiled loop calls before and after the actuators of a tick.

        The rows are those of `ports`, `fill_feeds` and `advance`, which do the same. None: a body
        is not of kernels.
        """
        supplies = self._supplies
        bodies = [own for own in self.bodies.values() if isinstance(own, BoundBody)]
        if len(bodies) < len(self.bodies):
            return None
        filling = [*(own.filling for own in supplies), *(own.filling for own in bodies)]
        before = [Part(own.to(ports), nothing) for own in filling]
        after = [Part(body.advancing.to(replies), body.refuse) for body in bodies]
        answers = self._ports.answers
        if self.has_supply_ports:
            before += [Part(own.feeding.to(answers, feeds), nothing)
                       for own in supplies if own.has_port]
            after.append(Part(Bound(keep_answers, Answers(fed, answers)), nothing))
        after += [Part(own.advancing.to(replies, self._answers(own, True)), nothing)
                  for own in supplies]
        after += [Part(own.is_due, self._settle)
                  for own in self._circuits if own.is_due is not None]
        return before, after

    def snapshot(self) -> bytes:
        """
        Return the complete state; `restore` continues from it byte for byte.

        Raises
        ------
        RunError
            The pressure or flow of a supply is not finite.
        SimulationDiverged
            A number in the state of a body is not finite.

        """
        return b''.join([saved_states(self.supplies, self._owners),
                         self._ports.snapshot(), self._values.snapshot(),
                         *(circuit.snapshot() for circuit in self._circuits),
                         *(body.snapshot() for body in self.bodies.values())])

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot` of the same configuration.

        Raises
        ------
        ConfigError
            The bytes are not a snapshot of these surroundings, or a number is not finite.

        """
        sizes = [len(self._owners) * SUPPLY_STATE.itemsize, self._ports.nbytes,
                 self._values.nbytes, *(own.saved_size for own in self._circuits)]
        end = sum(sizes)
        for body in self.bodies.values():
            sizes.append(body.saved_size(snapshot[end:]) if isinstance(body, SizedBody)
                         else len(body.snapshot()))
            end += sizes[-1]
        of_supplies, of_ports, of_values, *others = cut(snapshot, sizes, 'the surroundings')
        of_circuits, of_bodies = others[:len(self._circuits)], others[len(self._circuits):]
        supplies = np.concatenate([
            restored_rows(of_supplies, SUPPLY_STATE, 1, k * SUPPLY_STATE.itemsize, name)
            for k, name in enumerate(self._owners)])
        answers = restored_rows(of_ports, ANSWER, len(self._ports.answers), 0, 'supply ports')
        for own, state in zip(self._circuits, of_circuits):
            own.refuse_snapshot(state)
        self._values.restore(of_values)
        list(self._sheets(self._values.accepted))   # refuses what cannot be
        self._change()
        self.supplies[list(SUPPLY_STATE.names or ())] = supplies
        self._ports.restore(answers)
        for own, state in zip(self._circuits, of_circuits):
            own.restore(state)
        for body, state in zip(self.bodies.values(), of_bodies):
            body.restore(state)

    def restart(self, beginning: bytes) -> None:
        """Return to the `snapshot` of t = 0; tuned values stay, in force from the first tick."""
        _, beneath = self._values.with_accepted({})
        self.restore(beginning)
        self._values.accept(beneath)
