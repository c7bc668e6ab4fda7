"""The resolved configuration of one run: every parameter filled in, immutable, loss-free text."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
import hashlib

from isa_ros.actuator.link import NO_LINK
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.runs.leg_config import ImuConfig, JointsKind, LegConfig, LegStart
from isa_ros.config.runs.recording import RecordConfig, RecordKind
from isa_ros.config.runs.supplies import refuse_misfed, SUPPLY, SupplyConfig, SupplyKind
from isa_ros.config.text.names import refuse_bad_name
from isa_ros.config.text.schema import Key, Named, Names, OneOf, ParameterSet, Plain, Section
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import dump, parse, Tree
from isa_ros.core.noise import seed_of
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.timebase import refuse_grid
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.sheet import LegSheet
from isa_ros.surroundings.supply import SupplySheet


COORDINATOR = 'coordinator'
"""Name of the coordinator's node; participants must have other names."""

ALL = 'all'
"""Stands for every actuator of a run."""


@dataclass(frozen=True, kw_only=True)
class Times(Parameters):
    """Timing of the lockstep."""

    step_ms: float = parameter('macro step H', 'ms', gt=0.0, le=100.0)
    controller_offset_ms: float = parameter(
        'offset of the samples of the REU from the ticks', 'ms', ge=0.0, le=100.0)
    tick_timeout_s: float = parameter(
        'host time after which a participant counts as lost', 's', gt=0.0, le=3600.0)


BodyConfig = LegConfig
"""The body that several actuators move; a union once there is another kind."""


@dataclass(frozen=True)
class ActuatorConfig:
    """One actuator with its whole data sheet."""

    name: str
    model: str
    preset: str
    sheet: ActuatorSheet
    load: LocalLoad | None
    """Its own load; None where it moves the body."""
    initial_position: float
    """m or rad."""
    beyond_range: str | None = None
    """Treatment of a setpoint beyond the range, one of `BEYOND_RANGE`; None: the first."""
    auto_enable: bool = True
    """Whether it is enabled once it is initialised."""
    mode: str | None = None
    """Mode at t = 0; None: the one with every block that is on."""


@dataclass(frozen=True)
class RunConfig:
    """Everything that defines a run, except the setpoints."""

    name: str
    step_ns: int
    controller_offset_ns: int
    tick_timeout_s: float
    supplies: tuple[SupplyConfig, ...]
    """Each actuator is fed by exactly one of them."""
    actuators: tuple[ActuatorConfig, ...]
    """In the order of the file, which is the order of every record."""
    body: BodyConfig | None = None
    """What several actuators move together; None: each has a load of its own."""
    controllers: tuple[str, ...] = ()
    """Names of the nodes, besides the actuators, that every tick waits for."""
    source: str = field(default='')
    """Name of the file it was read from, without its directory."""
    record: RecordConfig = RecordConfig()
    seed: int = 0
    """Of all noise."""

    @property
    def leg(self) -> LegConfig | None:
        """Return the body where it is a leg."""
        return self.body if isinstance(self.body, LegConfig) else None

    @property
    def linked(self) -> tuple[str, ...]:
        """Return the actuators with a link."""
        return tuple(own.name for own in self.actuators if own.sheet.link.kind != NO_LINK.kind)

    def supply_of(self, name: str) -> SupplySheet:
        """Return the sheet of the supply that feeds an actuator; as `actuator`."""
        fed = self.actuator(name).name
        return next(own.sheet for own in self.supplies if fed in own.feeds)

    def span_of(self, name: str) -> float:
        """Return the supply pressure above return pressure of an actuator, Pa; as `actuator`."""
        fed = self.actuator(name).name
        return next(own.span for own in self.supplies if fed in own.feeds)

    def alone(self, actuator: ActuatorConfig) -> 'RunConfig':
        """Return a run of ``actuator`` alone, on the supply of the actuator of its name."""
        supply = SupplyConfig(SUPPLY, self.supply_of(actuator.name), (actuator.name,))
        return replace(self, actuators=(actuator,), supplies=(supply,), body=None)

    @property
    def digest(self) -> str:
        """Return the sha256 of the resolved text without the section `record`."""
        text = replace(self, record=RecordConfig()).to_yaml()
        return hashlib.sha256(text.encode()).hexdigest()

    def actuator(self, name: str) -> ActuatorConfig:
        """
        Return the actuator of a name.

        Raises
        ------
        ConfigError
            The run has no actuator of this name.

        """
        for actuator in self.actuators:
            if actuator.name == name:
                return actuator
        names = ', '.join(a.name for a in self.actuators)
        raise ConfigError(f'{self.source}: no actuator {name!r}; valid: {names}')

    def index(self, name: str) -> int:
        """Return the row of an actuator in every record; as `actuator`."""
        return self.actuators.index(self.actuator(name))

    def names_here(self, elsewhere: Sequence[str]) -> tuple[str, ...]:
        """
        Return the actuators that this host starts: all except those ``elsewhere``.

        Raises
        ------
        ConfigError
            ``elsewhere`` has a name that is not an actuator of the run.

        """
        if list(elsewhere) == [ALL]:
            return ()
        away = {self.actuator(name).name for name in elsewhere}
        return tuple(own.name for own in self.actuators if own.name not in away)

    def with_controllers(self, names: Sequence[str]) -> 'RunConfig':
        """
        Return the run with more controllers.

        Raises
        ------
        ConfigError
            A name is already taken.

        """
        for name in names:
            refuse_bad_name(name, f'{self.source}: controllers')
        every = (*self.controllers, *names)
        taken = [COORDINATOR, *(actuator.name for actuator in self.actuators)]
        for k, name in enumerate(every):
            if name in (*taken, *every[:k]):
                raise ConfigError(
                    f'{self.source}: controllers: the name {name!r} is taken; '
                    f'taken: {", ".join([*taken, *every[:k]])}')
        return replace(self, controllers=every)

    def with_start(self, start: LegStart) -> 'RunConfig':
        """Return the run with another start of its leg and of the actuators on it."""
        if self.leg is None:
            raise ConfigError(f'{self.source}: the run has no leg that could start at {start}')
        leg = replace(self.leg, start=start)
        joint_of = {actuator: joint for joint, actuator in leg.joints}
        return replace(self, body=leg, actuators=tuple(
            replace(a, initial_position=leg.position_of(joint_of[a.name]))
            if a.name in joint_of else a for a in self.actuators))

    def stored(
            self, compression: str | None, split_mb: float | None, where: str) -> 'RunConfig':
        """Return the run with storage values given at ``where``; as `RecordConfig.stored`."""
        return replace(self, record=self.record.stored(compression, split_mb, where))

    def to_yaml(self) -> str:
        """Return the resolved configuration as text; `from_yaml` undoes it bit for bit."""
        return dump(RUN.tree(self))

    @classmethod
    def from_yaml(cls, text: str, name: str = 'configuration.yaml') -> 'RunConfig':
        """
        Return the configuration of a resolved text; error messages begin with ``name``.

        Raises
        ------
        ConfigError
            The text is not an output of `to_yaml`.

        """
        return cls.from_tree(parse(text, name), name)

    @classmethod
    def from_tree(cls, tree: Tree, name: str) -> 'RunConfig':
        """Return the configuration of the tree of a resolved text; as `from_yaml`."""
        run: RunConfig = RUN.read(modern(tree), Place(name))
        refuse_grid(run.step_ns, run.controller_offset_ns, name)
        seed_of(run.seed, f'{name}: seed')
        for actuator in run.actuators:
            refuse_bad_name(actuator.name, f'{name}: actuators: the name')
        refuse_misfed(
            run.supplies, [actuator.name for actuator in run.actuators], Place(name, 'supplies'))
        return run


RUN = Section(RunConfig, {
    'name': Key(Plain(str)), 'source': Key(Plain(str)), 'step_ns': Key(Plain(int)),
    'controller_offset_ns': Key(Plain(int)), 'tick_timeout_s': Key(Plain(float)),
    'seed': Key(Plain(int), meant='0'),
    'supplies': Key(Named(SupplyKind())),
    'record': Key(RecordKind(), meant='everything'),
    'actuators': Key(Named(Section(ActuatorConfig, {
        'model': Key(Plain(str)), 'preset': Key(Plain(str)),
        'initial_position': Key(Plain(float)),
        'beyond_range': Key(Plain(str), is_optional=True),
        'auto_enable': Key(Plain(bool), meant='true'),
        'mode': Key(Plain(str), is_optional=True),
        'load': Key(ParameterSet(LocalLoad), is_optional=True),
        'sheet': Key(ParameterSet(ActuatorSheet))}))),
    'controllers': Key(Names(), meant='none'),
    'body': Key(OneOf({'leg': Section(LegConfig, {
        'model': Key(Plain(str)), 'joints': Key(JointsKind()),
        'start': Key(ParameterSet(LegStart)),
        'imus': Key(Named(Section(ImuConfig, {'sheet': Key(ParameterSet(Imu))})), meant='none'),
        'sheet': Key(ParameterSet(LegSheet))})}), is_optional=True),
})
"""Every key of a resolved configuration."""


def modern(tree: Tree) -> Tree:
    """Return the tree of a resolved configuration that may still say ``supply`` and ``leg``."""
    tree = dict(tree)
    actuators, supply = tree.get('actuators'), tree.get(SUPPLY)
    if isinstance(supply, dict) and isinstance(actuators, dict) and 'supplies' not in tree:
        del tree[SUPPLY]
        tree['supplies'] = {SUPPLY: supply | {'feeds': list(actuators)}}
    if isinstance(tree.get('leg'), dict) and 'body' not in tree:
        leg: Tree = {'kind': 'leg'}
        tree['body'] = leg | tree.pop('leg')  # type: ignore[operator]
    return tree
