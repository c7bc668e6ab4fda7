"""A body that the caller of a simulation gives: any object with the Protocol `Body`."""

from dataclasses import dataclass
from typing import Any, ClassVar

from isa_ros.config.runs.body_config import BodyConfig, Made
from isa_ros.config.text.keys import Key, KeyTable, NAMES
from isa_ros.config.text.sections import Place, Section
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.surroundings.body import Body
import numpy as np


@dataclass(frozen=True, kw_only=True)
class ExternalConfig(BodyConfig):
    """A body that is made by ``body`` of `isa_ros.scripting.run.Run.simulate`, in memory only."""

    kind: ClassVar[str] = 'external'
    is_given: ClassVar[bool] = True
    KEYS: ClassVar[KeyTable] = KeyTable((
        Key('actuators', NAMES, 'the actuators that move it, in the order of its rows',
            of=lambda own: [actuator for _, actuator in own.joints]),))

    @classmethod
    def of(cls, name: str, values: dict[str, Any], place: Place, step_ns: int,
           is_checked: bool) -> tuple[BodyConfig, Section]:
        """Return the body; as `BodyConfig.of`."""
        actuators = values['actuators']
        if not actuators:
            raise ConfigError(f'{place / "actuators"} is empty, must name at least one actuator')
        return cls(name=name, joints=tuple((own, own) for own in actuators)), {}

    def key_of(self, joint: str) -> str:
        """Return the list of its actuators."""
        return f'{self.label}.actuators'

    def body(self, made: Made) -> Body:
        """Return what the caller's factory makes; as `BodyConfig.body`."""
        if made.factory is None:
            raise ConfigError(
                f'{self.label} is external: it exists in Python only, by simulate(body=...)')
        return made.factory(np.array(made.rows, np.int64), made.step_ns / NS_PER_SECOND)
