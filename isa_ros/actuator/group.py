"""The actuators of one process, advanced by one kernel call; rows in, rows out."""

from collections.abc import Mapping, Sequence
import struct

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.integration import STATE_SIZE
from isa_ros.actuator.rows import memory_of, row_of
from isa_ros.actuator.tick_log import LoggedTicks, TickLog
from isa_ros.actuator.ticking import bound_tick, ticked
from isa_ros.actuator.timing import Timing
from isa_ros.core.signals import Records
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.errors import ConfigError

_SIZE = struct.Struct('<I')


class ActuatorGroup:
    """
    Actuators that share one memory and advance together.

    Their results equal those of single actuators bit for bit. To use them in your own loop::

        from isa_ros.config.assembly import group_of
        from isa_ros.config.paths import CONFIG, find
        from isa_ros.config.runs.run_file import load_run
        from isa_ros.core.signals import LOAD_PORT
        import numpy as np

        group = group_of(load_run(find('rig_linear', CONFIG)))
        ports = np.zeros(len(group.actuators), LOAD_PORT)
        ports['supply_pressure'] = 20.7e6
        replies = group.advance(ports)

    ``ports`` are `LOAD_PORT` rows: the pressures, and the motion of a load that is not the
    actuator's own during the tick (equation L1); `advance` takes `COMMAND` rows too, and
    ``replies`` are `LOAD_REPLY` rows; (n,) each, in the order of ``configs``.
    """

    def __init__(self, configs: Sequence[ConfiguredActuator], timing: Timing) -> None:
        self._timing = timing
        self._steps = timing.steps
        self._memory = memory_of(len(configs))
        self.actuators = [
            SmartActuator(config, timing, row_of(self._memory, k))
            for k, config in enumerate(configs)]
        """The same actuators one by one, in the order of ``configs``."""
        self._values = [actuator.tuning.values for actuator in self.actuators]
        self.ticked = ticked(self._memory, self._steps)
        """Memory of their tick."""
        self.tick = bound_tick(self.ticked)
        """Their tick, between `set_clock` and `pass_ticks`; it returns what `refuse` takes."""

    @property
    def t_ns(self) -> int:
        """Return the simulated time reached, ns."""
        return self.actuators[0].t_ns

    @property
    def replies(self) -> Records:
        """Return the `LOAD_REPLY` of all at the end of the last tick, (n,); overwritten."""
        return self._memory.replies

    @property
    def feeds(self) -> Records:
        """Return the `SUPPLY_PORT` of all for the next tick, (n,), to be filled; 0: held."""
        return self._memory.feeds

    @property
    def fed(self) -> Records:
        """Return the `SUPPLY_REPLY` of all, (n,), as `replies`."""
        return self._memory.fed

    @property
    def samples(self) -> Records:
        """Return the `SAMPLE` of all at the end of the last tick, (n,); overwritten."""
        return self._memory.samples

    @property
    def observed(self) -> Records:
        """
        Return the `SAMPLE` of all that listeners have at the end of the last tick, (n,).

        Without a link it is that of `samples`, behind one the newest that has arrived, with its
        ``age``; overwritten.
        """
        return self._memory.observed

    @property
    def sent(self) -> Records:
        """Return the `COMMAND` rows handed to the links at its start, (n,); overwritten."""
        return self._memory.sent

    @property
    def applied(self) -> Records:
        """
        Return the commands that took effect in the last tick, (n,); overwritten.

        `COMMAND` rows: ``kinds`` is 0 without a command; otherwise a row has all values in force.
        """
        return self._memory.applied

    @property
    def tuned(self) -> dict[int, Mapping[str, float]]:
        """Return the parameters that changed at the start of the last tick, SI, by row."""
        for values in self._values:
            if not values.is_settled:
                break
        else:       # at nearly every tick
            return {}
        return {row: changed for row, actuator in enumerate(self.actuators)
                if (changed := actuator.applied_parameters)}

    def start(self, starts: Records) -> None:
        """Put all at rest at t = 0 according to their `START` rows, (n,)."""
        for actuator, start in zip(self.actuators, starts):
            actuator.start(*start.item())

    def advance(self, ports: Records, commands: Records | None = None) -> Records:
        """
        Advance all by one tick and return their `LOAD_REPLY` rows, (n,).

        ``ports`` are their `LOAD_PORT` rows; an actuator with its own load uses only the
        pressures. ``commands`` are valid `COMMAND` rows that take effect now.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        self._latch()
        own = self.ticked
        if ports is not own.ports:
            own.ports[:] = ports
        if commands is None:
            own.commands['kinds'] = 0
        elif commands is not own.commands:
            own.commands[:] = commands
        self.set_clock()
        found = self.tick.run()
        self.pass_ticks(1)
        self.refuse(found)
        return self._memory.replies

    def advance_many(
            self, ports: Records, commands: Records, *, with_samples: bool = True) -> TickLog:
        """
        Advance all by a tick for each row of ``commands``, (n_ticks, n), in one call.

        As many calls of `advance` with the same ``ports``, but much faster where ticks are
        short; meant for actuators with loads of their own and a constant supply. The log has
        no row of samples unless ``with_samples``. Raises as `advance`.
        """
        self.ticked.ports[:] = ports
        ticks = LoggedTicks(self.tick, self.ticked, commands, with_samples=with_samples)
        left = len(commands)
        while left:
            self._latch()
            self.set_clock()
            begun, found = ticks.run(left if self.is_settled else 1)
            self.pass_ticks(begun)
            self.refuse(found)
            left -= begun
        return ticks.log

    def _latch(self) -> None:
        """Let changed parameters take effect."""
        for actuator, values in zip(self.actuators, self._values):
            if not values.is_settled:
                actuator.latch_tuning()

    def set_clock(self) -> None:
        """Let the next `tick` begin at the time that is reached."""
        self.ticked.clock[0] = self.t_ns // PLANT_STEP_NS

    def pass_ticks(self, n_ticks: int) -> None:
        """Move the time of the actuators on by the ticks that `tick` has run."""
        passed_ns = n_ticks * self._timing.step_ns
        for actuator in self.actuators:
            actuator.t_ns += passed_ns

    def refuse(self, found: int) -> None:
        """Raise `SimulationDiverged` for what `tick` has found; 0: nothing."""
        if found:
            row, state = divmod(found - 1, STATE_SIZE)
            self.actuators[row].raise_diverged(state)

    @property
    def is_settled(self) -> bool:
        """Return whether no value changed at the last tick, or changes at the next."""
        return all(values.is_settled for values in self._values)

    def snapshot(self) -> bytes:
        """Return the complete state of all; `restore` continues from it byte for byte."""
        snapshots = [actuator.snapshot() for actuator in self.actuators]
        return b''.join(_SIZE.pack(len(own)) + own for own in snapshots)

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot` of actuators with the same digests.

        Raises
        ------
        ConfigError
            The bytes are not a snapshot of these actuators.

        """
        at = 0
        for actuator in self.actuators:
            if len(snapshot) < at + _SIZE.size:
                raise ConfigError(f'{actuator.name}: missing in the saved state')
            size, = _SIZE.unpack_from(snapshot, at)
            at += _SIZE.size + size
            actuator.restore(snapshot[at - size:at])
        if at != len(snapshot):
            raise ConfigError(f'saved state has {len(snapshot)} bytes, must have {at}')
