"""The actuators of one process, advanced by one call of the kernel."""

from collections.abc import Sequence

from isa_ros.actuator import kernel as kernels
from isa_ros.actuator.actuator import ActuatorConfig, SmartActuator, Timing
from isa_ros.actuator.rows import ActuatorRows
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.run.exchange import Messages, Records
from isa_ros.run.stepping import SteppedActuator
from msg_adapters.actuator_messages import STATE_TOPICS, StateMessages


class ActuatorGroup:
    """
    Actuators that share one memory, and what they say at the same instants.

    Ticked together they do what each does alone, bit for bit.
    """

    def __init__(self, configs: Sequence[ActuatorConfig], timing: Timing) -> None:
        self._timing = timing
        self._steps = timing.steps
        self._rows = ActuatorRows(len(configs))
        self.members = [
            SteppedActuator(config, timing, SmartActuator(config, timing, self._rows, k))
            for k, config in enumerate(configs)]
        """The same actuators one by one, in the order of ``configs``."""
        self._actuators = [member.actuator for member in self.members]
        self._states = state_messages(configs)

    @property
    def t_ns(self) -> int:
        """Return the simulated time reached."""
        return self._actuators[0].t_ns

    @property
    def replies(self) -> Records:
        """Return the `LOAD_REPLY` of all at the end of the last tick, (n,); overwritten."""
        return self._rows.replies

    @property
    def samples(self) -> Records:
        """Return the `SAMPLE` of all at the end of the last tick, (n,); overwritten."""
        return self._rows.samples

    def advance(self, ports: Records) -> list[Messages]:
        """
        Advance all by one tick under their `LOAD_PORT` rows; return what each applied.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        for actuator in self._actuators:
            actuator.begin_tick()
        tick_start = self.t_ns
        broken = kernels.actuator_tick(
            tick_start // PLANT_STEP_NS, self._steps, ports, *self._rows.arrays)
        for k, actuator in enumerate(self._actuators):
            first = k * kernels.STATE_SIZE
            actuator.end_tick(
                broken - first if first <= broken < first + kernels.STATE_SIZE else -1)
        return [member.applied(tick_start) for member in self.members]

    def states(self) -> list[Messages]:
        """Return the state messages of this instant of each, in the order of `STATE_TOPICS`."""
        return by_actuator(self._states.pack(self.samples, self.t_ns))


def state_messages(configs: Sequence[ActuatorConfig]) -> StateMessages:
    """Return the prepared state messages of actuators."""
    return StateMessages([(config.name, config.sheet.is_rotary) for config in configs])


def by_actuator(packed: Sequence[bytes]) -> list[Messages]:
    """Return the state messages of several actuators as those of each."""
    n = len(STATE_TOPICS)
    return [packed[k:k + n] for k in range(0, len(packed), n)]
