"""
A hydraulic supply: the pump side, and the supply as a whole.

Actuators use both pressures of the tick's start over the whole tick and report the volumes that
they drew and returned; the supply then advances over the same interval. They pay for the oil what
it costs at these held pressures, and that is what the supply gives; by what a line gave more or
less, its pressure having moved meanwhile, is an entry of its own (E9). With a moving port they
integrate the pressure over the tick, and pay at it (`isa_ros.surroundings.supply_port`): the
entry is then the difference of the two integrations. Pressures are gauge, flows
leave the supply and enter the return line when positive. The pump with its accumulator is
`isa_ros.surroundings.accumulator`, the return line `isa_ros.surroundings.return_line`, the dump
valve `isa_ros.surroundings.dump`. Equation E9.

Neglected: length and resistance of the pressure line, heat.
"""

from collections.abc import Sequence
from functools import cached_property

from isa_ros.core.bound import Bound, Rebound
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import nested, parameter, Parameters
from isa_ros.core.record import floats, row_record
from isa_ros.core.saved_state import broken_number
from isa_ros.core.signals import LOAD_REPLY, Records, SUPPLY_REPLY
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import MPA
from isa_ros.errors import ParameterError, RunError
from isa_ros.surroundings import supply_tick as tick
from isa_ros.surroundings.accumulator import (
    AccumulatorSupply, capacitance, SUPPLY, supply_record)
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.dump import dump_fields, LagDump, NoneDump
from isa_ros.surroundings.return_line import (
    HeldReturn, RETURN_LINE, return_record, ReturnLine, SUPPLY_STEP, VolumeReturn)
from isa_ros.surroundings.supply_port import MovingPort, PORT_STEPS
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE, SUPPLY_STATE
from isa_ros.surroundings.supply_tick import held_pressure, SupplyRecords
import numpy as np

_SLOWEST_TICKS = 10.0        # shortest time constant in ticks (coupling.md)


@frozen(kw_only=True)
class ConstantSupply(Parameters):
    """An ideal supply: constant pressure at any flow."""

    pressure_mpa: float = parameter(
        'gauge supply pressure', 'MPa', changeable=True, gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter(
        'gauge return pressure', 'MPa', changeable=True, ge=0.0, le=5.0)
    return_line: ReturnLine = nested(HeldReturn())
    dump: NoneDump | LagDump = nested(NoneDump())


SupplySheet = ConstantSupply | AccumulatorSupply | CircuitSupply


def is_dumped(sheet: SupplySheet) -> bool:
    """Return whether the emergency stop acts on a supply."""
    if isinstance(sheet, CircuitSupply):
        return sheet.is_switched
    return not isinstance(sheet.dump, NoneDump)


def saved_states(samples: Records, names: Sequence[str]) -> bytes:
    """
    Return the `SUPPLY_STATE` of samples, (n,), of supplies of these names.

    Raises
    ------
    RunError
        The pressure or flow of a supply is not finite.

    """
    for k, name in enumerate(names):
        broken = broken_number(samples[k:k + 1])
        if broken is not None:
            raise RunError(f'{name}: {broken[0]} = {broken[1]}, must be finite to be saved')
    return floats(samples)[:, :len(SUPPLY_STATE.names or ())].tobytes()


class Supply:
    """
    One supply over a run.

    ``flow_slope`` is the sum of the valves' largest dQ/dP in m3/s/Pa; ``state`` is the supply's
    `SUPPLY_SAMPLE` row, shape (1,); None: a new row is made. ``name`` is used in errors, ``rows``
    are those of its actuators.

    Raises
    ------
    ParameterError
        The supply or its return line is too small to hold its pressure over one tick, or the
        return line is too fast for its integration.

    """

    def __init__(
            self, sheet: SupplySheet, step_ns: int, flow_slope: float,
            state: np.ndarray | None = None, name: str = 'supply',
            rows: Sequence[int] = ()) -> None:
        self._name = name
        self._step = step_ns * 1e-9
        self._sheet = sheet
        self._flow_slope = flow_slope
        self.state = np.zeros(1, SUPPLY_SAMPLE) if state is None else state
        self.state['pressure'] = sheet.pressure_mpa * MPA
        self.state['return_pressure'] = sheet.return_pressure_mpa * MPA
        self.rows = np.array(rows, np.int64)
        """Of its actuators."""
        self.records = self._records(sheet)
        """Its constants; changed in place."""
        if not isinstance(sheet.dump, NoneDump):
            self.state['dump_opening'] = sheet.dump.opened
            self._hold()
        self.has_port = isinstance(sheet, AccumulatorSupply) and isinstance(
            sheet.port, MovingPort)
        """Whether its pressure moves within a tick."""
        self.filling = Rebound(
            tick.fill_pressures,
            lambda ports: tick.SupplyPressures(self.state, self.rows, ports))
        """Of the ports: fills the pressures of its actuators."""
        self.feeding = Rebound(tick.fill_line, lambda answers, feeds: tick.SupplyFeeds(
            self.state, self.records.supply, self.rows, answers, feeds))
        """Of last answers and ports of a supply that has a port: fills the latter."""
        self.advancing = Rebound(tick.advance, lambda replies, answers: self._tick(
            self.rows, replies, answers))
        """Of replies and answers, or none where the pressure was held: advances by one tick."""
        self._given = np.zeros(1, LOAD_REPLY), np.zeros(1, SUPPLY_REPLY)

    def _tick(self, rows: np.ndarray, replies: np.ndarray, answers: np.ndarray
              ) -> tick.SupplyTick:
        return tick.SupplyTick(
            self.state, self.records, np.array([self._step]), rows, replies, answers)

    @cached_property
    def _advancing_by(self) -> tuple[Bound, Bound]:
        """Return what advances with the volumes of one row, the pressure held or paid."""
        replies, answers = self._given
        first = np.zeros(1, np.int64)
        return (Bound(tick.advance, self._tick(first, replies, answers[:0])),
                Bound(tick.advance, self._tick(first, replies, answers)))

    def change(self, sheet: SupplySheet) -> None:
        """
        Continue with other values of the sheet: pressure and pump flow keep theirs.

        Only an ideal supply, and a return line that is held, take the new pressure at once.
        Raises as the class.
        """
        self._sheet = sheet
        for own, new in zip(self.records, self._records(sheet)):
            own[:] = new
        if len(self.records.ideal):
            self._hold()
        if not len(self.records.line):
            self.state['return_pressure'] = sheet.return_pressure_mpa * MPA

    def _hold(self) -> None:
        """Give an ideal supply its pressure."""
        ideal = row_record(self._ideal(self._sheet))
        self.state['pressure'] = held_pressure(float(self.state['dump_opening'][0]), ideal)

    def _ideal(self, sheet: SupplySheet) -> np.ndarray:
        """Return a sheet as an `isa_ros.surroundings.supply_tick.IDEAL`, (1,)."""
        assert not isinstance(sheet, CircuitSupply)
        return np.array([(sheet.pressure_mpa, sheet.return_pressure_mpa,
                          dump_fields(sheet.dump, self._step))], tick.IDEAL)

    def refuse(self, sheet: SupplySheet) -> None:
        """Refuse a sheet with which `change` cannot continue; raises as the class."""
        self._records(sheet)

    def _records(self, sheet: SupplySheet) -> SupplyRecords:
        """Return the records of a sheet."""
        supply: np.ndarray = np.zeros(0, SUPPLY)
        ideal, line = np.zeros(0, tick.IDEAL), np.zeros(0, RETURN_LINE)
        if isinstance(sheet, AccumulatorSupply):
            supply = supply_record(sheet)
            if isinstance(sheet.port, MovingPort):
                self._refuse_stiff(supply[0])
            else:
                self._refuse_small(
                    'capacitance', capacitance(sheet.pressure_mpa * MPA, supply[0]),
                    f'{"line_volume_l" if sheet.accumulator_lost else "gas_volume_l"}, or let '
                    'the pressure move (port: {kind: moving})')
        else:
            ideal = self._ideal(sheet)
        if isinstance(sheet.return_line, VolumeReturn):
            line = return_record(sheet.return_line, sheet.return_pressure_mpa * MPA)
            self._refuse_small(
                'capacitance of the return line', float(line['c'][0]),
                'return_line.oil_volume_l')
            self._refuse_fast(line[0])
        return SupplyRecords(ideal, supply, line)

    def _refuse_small(self, what: str, c: float, key: str) -> None:
        """Refuse a capacitance whose pressure is not constant enough over a tick."""
        holds, bound = c / self._flow_slope, _SLOWEST_TICKS * self._step
        if holds < bound:
            raise ParameterError(
                f'{self._name}: {what} over flow slope = {holds * 1e3:.3g} ms, '
                f'must be >= {bound * 1e3:.3g} ms (ten ticks); enlarge {key}')

    def _refuse_stiff(self, supply: np.void) -> None:
        """Refuse a line that neither actuators nor the supply itself can integrate  (C16)."""
        c = float(supply['c_line'])     # what is left when the accumulator is empty
        holds, bound = c / self._flow_slope, PORT_STEPS * PLANT_STEP
        if holds < bound:
            raise ParameterError(
                f'{self._name}: capacitance of the line over flow slope = {holds * 1e3:.3g} ms, '
                f'must be >= {bound * 1e3:.3g} ms (four plant steps); enlarge line_volume_l')
        slope = float(supply['k_relief'] + supply['k_leak'])
        if c < 0.5 * SUPPLY_STEP * slope:
            raise ParameterError(
                f'{self._name}: time constant of relief valve and line = {c / slope * 1e3:.3g} '
                f'ms, must be >= {0.5 * SUPPLY_STEP * 1e3:g} ms; enlarge line_volume_l or reduce '
                'relief_lpm_per_mpa')

    def _refuse_fast(self, line: np.void) -> None:
        """Refuse a return line whose time constant C/G is below the step of the integration."""
        constant = float(line['c'] / line['g'])
        if constant < SUPPLY_STEP:
            raise ParameterError(
                f'{self._name}: time constant of the return line = {constant * 1e3:.3g} ms, '
                f'must be >= {SUPPLY_STEP * 1e3:g} ms; reduce return_line.tank_lpm_per_mpa')

    @property
    def pressure(self) -> float:
        """Return the gauge supply pressure in Pa, constant over the next tick."""
        return float(self.state['pressure'][0])

    @property
    def return_pressure(self) -> float:
        """Return the gauge return pressure in Pa, constant over the next tick."""
        return float(self.state['return_pressure'][0])

    @property
    def pressures(self) -> list[tuple[float, float]]:
        """Return both pressures of the next tick, of what feeds its actuators: itself."""
        return [(self.pressure, self.return_pressure)]

    def advance(self, drawn: float, returned: float = 0.0, paid: float | None = None) -> None:
        """
        Advance one tick in which the actuators drew and returned these volumes (m3).

        ``paid`` is what they paid for the oil drawn, J; None: the pressure was held.
        """
        replies, answers = self._given
        replies['supply_volume'], replies['return_volume'] = drawn, returned
        held, moved = self._advancing_by
        if paid is None:
            held.run()
        else:
            answers['paid'] = paid
            moved.run()
