"""
One smart actuator, advanced tick by tick: setpoints in, samples out. No ROS.

The same class is used by a single node, by many nodes in one process, and by replay.
"""

from collections.abc import Mapping
from functools import cached_property
from typing import NoReturn

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.constants import digest_of, write_constants
from isa_ros.actuator.inbox import merge
from isa_ros.actuator.integration import state_name
from isa_ros.actuator.link import NONE
from isa_ros.actuator.requests import (
    deafness_of, link_answer, mode_after, mode_command, refusal_of, start_mode)
from isa_ros.actuator.rest import put_at_rest
from isa_ros.actuator.rows import Memory, memory_of
from isa_ros.actuator.saved_rows import SavedRows
from isa_ros.actuator.setpoint_in_force import gain_after, setpoint_after, SetpointInForce
from isa_ros.actuator.setpoint_range import complete, SetpointRange
from isa_ros.actuator.ticking import bound_tick, ticked
from isa_ros.actuator.timing import Timing
from isa_ros.actuator.tunable import GAINS
from isa_ros.actuator.tuning import gains_command, Tuning
from isa_ros.core.bound import Bound
from isa_ros.core.record import row_record
from isa_ros.core.saved_state import TIME_BYTES, time_of
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP_NS
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.loads.sheets import static_force
from isa_ros.reu.bumpless import EVERY_BLOCK
from isa_ros.reu.cascade import initial_gains
import numpy as np

PAPER_SUPPLY = 20.7e6
"""Pa gauge: supply pressure of the paper's rigs, used if no supply is configured."""


class SmartActuator:
    """
    Valve, oil, piston or rotor, sensors and REU of one actuator.

    Before the first setpoint it is enabled and holds the position measured at t = 0. Actuators
    with equal `digest` have equal parameters. ``memory`` is its row in the memory of several
    actuators; None: it gets its own.
    """

    def __init__(
            self, config: ConfiguredActuator, timing: Timing,
            memory: Memory | None = None) -> None:
        self.name = config.name
        self.sheet = config.sheet
        self.is_rotary = config.sheet.is_rotary
        self.memory = memory_of(1) if memory is None else memory
        """Its row in the memory of the tick kernel."""
        self._config = config
        self._timing = timing
        write_constants(config, timing, self.memory)
        self.has_link = config.sheet.link.kind != NONE
        """Whether commands and samples travel in the frames of a link."""
        self.saved = SavedRows(config.name, self.memory, self.has_link)
        """The rows that are its state."""
        # Rows with their fields as attributes, on the same memory.
        self._constants, self._body = (
            row_record(rows) for rows in (self.memory.constants, self.memory.continuous))
        self._reu, self._pending = row_record(self.memory.reu), row_record(self.memory.pending)
        self._applied, self._reply, self._sample = (
            row_record(rows) for rows in (
                self.memory.applied, self.memory.replies, self.memory.samples))
        self.ticked = ticked(self.memory, timing.steps)
        """Its tick's memory: ports, command and clock."""
        self._commands = self.ticked.commands
        self._first_mode = start_mode(config.name, config.mode, config.sheet.reu)
        self.digest = digest_of(config, timing, self._first_mode, self.memory)
        self.setpoint_range = SetpointRange(config.name, config.sheet, config.beyond_range)
        """The range of its setpoints, for those that come from outside."""
        self.tuning = Tuning(
            config.name, config.sheet, timing.offset_steps, self.memory.constants, config.load,
            self.memory.ports, timing.step_ns / NS_PER_SECOND,
            row_record(self.memory.links) if self.has_link else None)
        """Tuned parameters, accepted and in force."""
        self._changed_mode: str | None = None
        self.start(config.initial_position, static_force(config.load), PAPER_SUPPLY, 0.0)

    def start(
            self, position: float, force: float,
            supply_pressure: float, return_pressure: float) -> None:
        """
        Put the actuator at rest at ``position`` (m | rad), t = 0, holding ``force`` (N | Nm).

        Pressures are gauge, Pa. The first sample has the sensor readings at that time. Tuned
        values stay, and are in force again from the first tick on.
        """
        self.clear(position)
        put_at_rest(self.memory, (position, force, supply_pressure, return_pressure),
                    initial_gains(self.sheet.reu), self._first_mode, self._config.auto_enable)

    def clear(self, position: float) -> None:
        """Set the state to zero at t = 0, before `put_at_rest`; a load of its own to a place."""
        self.t_ns = 0
        self.saved.clear()
        self.memory.feeds.fill(0)
        self.memory.fed.fill(0)
        self.accept(gains_command(self.tuning.reset(position)))
        if self._changed_mode is not None:
            self.change_mode(self._changed_mode)

    @property
    def sample(self) -> np.record:
        """Return the `SAMPLE` at the end of the last tick; the next tick overwrites it."""
        return self._sample

    @property
    def reply(self) -> np.record:
        """Return the `LOAD_REPLY` of the last tick; the next tick overwrites it."""
        return self._reply

    @property
    def applied(self) -> np.record | None:
        """
        Return the command that took effect at the start of the last tick, or None.

        A `COMMAND` row with the gains in force and the enable state; at t = 0 the initial state
        of the actuator.
        """
        return self._applied if self._applied.kinds else None

    @property
    def applied_parameters(self) -> dict[str, float]:
        """Return the tuned values that changed at the start of the last tick, SI, by name."""
        return self.tuning.applied

    def accept(self, command: np.void) -> None:
        """
        Accept a valid `COMMAND`; it takes effect at the next tick.

        The last of several before one tick wins; a gain of NaN leaves the pending one unchanged.
        """
        self._commands[0] = command
        merge(row_record(self._commands), self._pending)

    def admit(self, command: np.void) -> str:
        """
        Check and accept a command from outside; return what was limited, or ''.

        Raises
        ------
        SetpointError
            As `SetpointRange.admit`; nothing is accepted.

        """
        limited = self.setpoint_range.admit(command, self.mode)
        complete(command, self.setpoint.position)
        self.accept(command)
        return limited

    def change_mode(self, mode: str) -> None:
        """
        Change the mode from the next tick on, and again at the start of another run.

        Raises
        ------
        ConfigError
            The mode does not exist, or the wiring does not have it.

        """
        self.accept(mode_command(mode, self.sheet.reu))
        self._changed_mode = mode

    def tune(self, values: Mapping[str, float]) -> None:
        """
        Accept new values by the keys and in the units of `isa params`, all or none.

        They take effect at the next tick; the last of several before one tick wins; the loops
        keep their states. A gain of the impedance is a command for this gain only. Raises as
        `isa_ros.actuator.tunable.with_changed`.
        """
        self.accept(gains_command(self.tuning.accept(values)))

    @property
    def setpoint(self) -> SetpointInForce:
        """Return its setpoint as it will be at the next tick; behind a link without its frames."""
        return setpoint_after(self._pending, self._reu)

    @property
    def mode(self) -> int:
        """Return the mode as it will be at the next tick, a number of `isa_ros.core.device`."""
        return mode_after(self._pending, self._reu)

    @property
    def deafness(self) -> str:
        """Return why a setpoint would not be followed at the next tick, or ''; '' by a link."""
        return '' if self.has_link else deafness_of(
            self._pending, self._constants.reu, self._reu)

    def request(self, command: np.void, what: str) -> tuple[bool, str]:
        """
        Accept a request to enable, clear or stop where the state of the device allows it.

        Returns whether, and the answer in words; ``what`` is the request in words. Behind a link
        the state is not known: the request is handed to it, and one to a dead link fails.
        """
        if self.has_link:
            self.accept(command)
            is_alive, answer = link_answer(self.t_ns, row_record(self.memory.observed))
            return is_alive, f'{what}: {answer}'
        refusal = refusal_of(command, self._pending, self._constants.reu, self._reu)
        if refusal:
            return False, refusal
        self.accept(command)
        return True, f'{what} from t = {self.t_ns * 1e-9:.6f} s'

    def parameter(self, name: str) -> float | str:
        """Return a value as it will be at the next tick, set by `tune`, a fault or a command."""
        own = self.tuning.known(name)
        value: float = (gain_after(self._pending, self._reu, GAINS[own.name])
                        if own.name in GAINS else self.tuning.value(own.name))
        return own.shown(value) if name == own.name else value / own.scale

    def tick(self, port: np.void | None = None) -> None:
        """
        Advance one tick; ``port`` is its `LOAD_PORT` row.

        An actuator with its own load reads only the pressures of the port; None leaves its
        pressures unchanged.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        own = self.ticked
        own.ports[0] = self.memory.ports[0] if port is None else port
        self.latch_tuning()
        own.commands['kinds'] = 0
        own.clock[0] = self.t_ns // PLANT_STEP_NS
        self.end_ticks(1, self.advance.run())

    @cached_property
    def advance(self) -> Bound:
        """Return its own tick over `ticked`; after a `tick` others may run it: `end_ticks`."""
        return bound_tick(self.ticked)

    @property
    def is_settled(self) -> bool:
        """Return whether no tuned value takes effect at the next tick, or did at the last one."""
        return self.tuning.values.is_settled

    def end_ticks(self, n: int, broken: int) -> None:
        """Move the time on by n ticks, of which the last returned ``broken``; raise as `tick`."""
        self.t_ns += n * self._timing.step_ns
        if broken:
            self.raise_diverged(broken - 1)

    def latch_tuning(self) -> None:
        """Begin a tick: put tuned values in force, without a jump of the valve current."""
        if self.tuning.latch(self.t_ns // PLANT_STEP_NS) and self._reu.status.is_on:
            self._reu.status.fade.begins = EVERY_BLOCK

    def raise_diverged(self, state: int) -> NoReturn:
        """Raise `SimulationDiverged` for a state, given by its index in `CONTINUOUS`."""
        raise SimulationDiverged(
            self.t_ns, f'{self.name}: {state_name(state)}',
            self.memory.states[0, state])

    def snapshot(self) -> bytes:
        """
        Return the complete state; `restore` continues from it byte for byte.

        Raises
        ------
        SimulationDiverged
            A number of the state is not finite.

        """
        state = self.saved.snapshot(self.t_ns)
        return self.t_ns.to_bytes(TIME_BYTES, 'little') + state + self.tuning.snapshot()

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot` of an actuator with the same digest.

        Raises
        ------
        ConfigError
            The bytes are not a snapshot of this actuator, or a number in it is not finite or
            beyond its range; the actuator is then as before.

        """
        expected = TIME_BYTES + self.saved.nbytes + self.tuning.nbytes
        if len(snapshot) != expected:
            raise ConfigError(
                f'{self.name}: saved state has {len(snapshot)} bytes, must have {expected}')
        t_ns = time_of(snapshot, self._timing.step_ns, self.name)
        found = self.saved.read(snapshot, TIME_BYTES)
        self.tuning.restore(snapshot[TIME_BYTES + self.saved.nbytes:])
        self.t_ns = t_ns
        self.saved.restore(found)
