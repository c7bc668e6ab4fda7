"""
A body of a run: what a kind of bodies declares, and all that others need to know of it.

A kind is one class, derived from `BodyConfig`, and one row in `isa_ros.config.runs.body_kinds`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar, NamedTuple

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.names import parted, placed
from isa_ros.config.text.sections import Place, Section
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.fields import Field
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import Parameters
from isa_ros.errors import ConfigError
from isa_ros.surroundings.body import Body
from isa_ros.surroundings.joint_space import JointSpace
from isa_ros.surroundings.mechanism import Mechanism, Mounting
from isa_ros.surroundings.messages import BodyMessage

BODY = 'body'
"""Name of the body of a run file with ``body`` or ``leg``: its topics have no name in front."""
JOINT_COMMAND = 'joint_command'
"""Topic of the setpoints of its joints, after its prefix."""

BodyFactory = Callable[[Mounting], Body | Mechanism]
"""Returns a new body at t = 0, or the mechanism of one; called once for every simulation."""


class BodyInputs(NamedTuple):
    """What a body of a run is made with."""

    step_ns: int
    seed: int
    """Of the run's noise."""
    rows: Sequence[int]
    """Of its actuators, in the order of its joints."""
    factory: BodyFactory | None
    """Given by the caller of a simulation."""
    actuators: Sequence[ConfiguredActuator]
    """In the same order."""
    file: str
    """Name of the run file, for messages."""


@frozen(kw_only=True)
class BodyConfig:
    """A body that several actuators move; each kind replaces the methods that it needs."""

    kind: ClassVar[str]
    """Of a section ``{kind: ...}``."""
    KEYS: ClassVar[KeyTable]
    """Of its section, the kind left out."""
    is_given: ClassVar[bool] = False
    """Whether the caller of a simulation makes it."""
    has_urdf: ClassVar[bool] = False
    """Whether it has a `description`."""

    name: str = BODY
    """Of its topics and of the columns of a result."""
    joints: tuple[tuple[str, str], ...]
    """(joint, actuator that moves it), in the order of its rows."""
    model: str = ''
    """Of its data sheet, if there are several."""

    @classmethod
    def of(cls, name: str, values: dict[str, object], place: Place, step_ns: int,
           is_checked: bool) -> 'tuple[BodyConfig, Mapping[str, Section]]':
        """
        Return the body of the values of `KEYS`, and the sections that its sheets were built from.

        They have the keys of the sheets in the resolved text of the body.

        ``is_checked`` as in `isa_ros.config.runs.run_reading.run_of`.

        Raises
        ------
        ConfigError
            Values do not fit together.

        """
        raise NotImplementedError

    def body(self, made: BodyInputs) -> Body:
        """Return the body itself at t = 0; raises `ConfigError` if its start is not possible."""
        raise NotImplementedError

    def in_namespace(self, namespace: str) -> 'BodyConfig':
        """Return it with its name, and those of its actuators, in the namespace of a robot."""
        return replace(
            self, name=namespace if self.name == BODY else placed(namespace, self.name),
            joints=tuple((joint, placed(namespace, name)) for joint, name in self.joints))

    def out_of_namespace(self, namespace: str) -> 'BodyConfig':
        """Return it with the names of its robot's own file; inverse of `in_namespace`."""
        return replace(
            self, name=BODY if self.name == namespace else parted(self.name)[1],
            joints=tuple((joint, parted(name)[1]) for joint, name in self.joints))

    @property
    def label(self) -> str:
        """Return the key of its section, for messages and lists."""
        return BODY if self.name == BODY else f'bodies.{self.name}'

    @property
    def called(self) -> str:
        """Return how messages call it."""
        return f'the {self.kind}' if self.name == BODY else f'the {self.kind} {self.name}'

    def key_of(self, joint: str) -> str:
        """Return the key that names the actuator of a joint."""
        return f'{self.label}.joints.{joint}'

    @property
    def prefix(self) -> str:
        """Return what stands in front of the names of its topics, frames and noise."""
        return '' if self.name == BODY else f'{self.name}/'

    @property
    def fields(self) -> Sequence[Field]:
        """Return the fields of its sample, as far as the configuration knows them."""
        return ()

    @property
    def changing(self) -> Parameters | None:
        """Return what scenarios may change of it during a run, as it starts; None: nothing."""
        return None

    def messages(self, step_ns: int) -> Sequence[BodyMessage]:
        """Return what is published and recorded of its sample."""
        return ()

    @property
    def joint_space(self) -> JointSpace:
        """Return the joints that may be commanded in joint space, by their names in the URDF."""
        return {}

    def position_of(self, joint: str) -> float | None:
        """Return where a joint's actuator starts, m or rad; None: its section says so."""
        return None

    def refuse_reach(self, joint: str, sheet: ActuatorSheet, where: str) -> None:
        """Raise `ConfigError` if the start is outside the stroke of a joint's actuator."""

    def started(self, tree: Tree, place: Place, step_ns: int) -> 'BodyConfig':
        """
        Return it with the start that a scenario gives.

        Raises
        ------
        ConfigError
            It has no such start, or the start is not possible.

        """
        raise ConfigError(f'{place} is not used: a scenario cannot start {self.called}')

    @property
    def root_frame(self) -> str:
        """Return the frame that its description is drawn in, '': the world."""
        return ''

    def description(self, sheets: Mapping[str, ActuatorSheet], folder: Path,
                    control: Iterable[str] = ()) -> str:
        """
        Return its URDF with the frames of a run, if it `has_urdf`.

        ``sheets`` are those of its actuators by name, the run file is in ``folder``, and
        ``control`` is a tag of ros2_control.

        Raises
        ------
        ConfigError
            Its file is neither there nor shipped.

        """
        raise NotImplementedError

    def refuse_absent(self, file: str) -> None:
        """
        Raise `ConfigError` if nodes and the command line cannot make the body.

        ``file`` is the name of the run file, for messages.
        """

    def warnings(self, step_ns: int) -> Sequence[str]:
        """Return lines that are printed before a run."""
        return ()
