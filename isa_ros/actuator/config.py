"""What an actuator is made from."""

from typing import Protocol

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.loads.sheets import LocalLoad


class ConfiguredActuator(Protocol):
    """An actuator as it is configured; `isa_ros.config.runs.run_file` provides it."""

    @property
    def name(self) -> str:
        """Return the name of the actuator and of its node."""

    @property
    def sheet(self) -> ActuatorSheet:
        """Return its data sheet."""

    @property
    def load(self) -> LocalLoad | None:
        """Return its own load; None if it moves a body."""

    @property
    def initial_position(self) -> float:
        """Return the position at t = 0, m or rad."""

    @property
    def beyond_range(self) -> str | None:
        """Return the treatment of a setpoint beyond the range; None: the default one."""

    @property
    def auto_enable(self) -> bool:
        """Return whether it is enabled once it is initialised."""

    @property
    def mode(self) -> str | None:
        """Return the mode at t = 0; None: the one with every block that is on."""
