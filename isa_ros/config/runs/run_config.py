"""The configuration of one run: its keys, every parameter filled in, immutable, loss-free text."""

from collections.abc import Iterable, Sequence
from dataclasses import field, replace
import hashlib
from pathlib import Path
from typing import Any

from isa_ros.actuator.link import LinkSheet, NO_LINK
from isa_ros.config.models.links import LINK
from isa_ros.config.runs.acceptance import ACCEPT, ACCEPT_ALL
from isa_ros.config.runs.actuator_config import ACTUATOR, ActuatorConfig
from isa_ros.config.runs.body_config import BODY, BodyConfig
from isa_ros.config.runs.body_kinds import BODY_KINDS
from isa_ros.config.runs.controller_config import (
    ControllerConfig, CONTROLLERS, ControllerSections, NamedControllers)
from isa_ros.config.runs.emergency_stops import (
    ALL as EVERY, EmergencyStopConfig, GROUPS, KEY as EMERGENCY_STOPS)
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.one_robot import one_robot
from isa_ros.config.runs.publishing import PUBLISH, PublishConfig
from isa_ros.config.runs.recording import RECORD, RecordConfig
from isa_ros.config.runs.supplies import Sampled, SUPPLY, SUPPLY_KEYS, SupplyConfig
from isa_ros.config.runs.tick_grid import OFFSET, OFFSET_NS, START_TIME, STEP, STEP_NS
from isa_ros.config.text.key_tables import KeyTable, NamedSections, OneOf
from isa_ros.config.text.keys import (
    InText, Key, Layer, NAME, number, ParameterSet, TEXT, Value)
from isa_ros.config.text.names import COORDINATOR, parted, refuse_bad_name
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import dump
from isa_ros.core.frozen import frozen
from isa_ros.core.noise import seed_of
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.surroundings.supply import SupplySheet

__all__ = ['ActuatorConfig', 'ALL', 'COORDINATOR', 'LegConfig', 'RUN', 'RunConfig']

ALL = 'all'
"""Stands for every actuator of a run."""
ROBOTS = 'robots'
"""Key of the robots of a run file, which `isa_ros.config.runs.robots` resolves."""


@frozen
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
    bodies: tuple[BodyConfig, ...] = ()
    """What several actuators move together; all others have a load of their own."""
    controllers: tuple[str, ...] = ()
    """Names of the nodes, besides the actuators, that every tick waits for."""
    source: str = field(default='')
    """Name of the file it was read from, without its directory."""
    record: RecordConfig = RecordConfig()
    publish: PublishConfig = PublishConfig()
    accept: str = ACCEPT_ALL
    """Who commands: also topics, services and parameters, or the scenario of the run only."""
    seed: int = 0
    """Of all noise."""
    start_time_s: int = 0
    """Time of all stamps at t = 0; whole, so that both have the same full seconds."""
    emergency_stops: tuple[EmergencyStopConfig, ...] = ()
    """Groups of actuators that stop together, as given; see `stop_groups`."""
    called: tuple[ControllerConfig, ...] = ()
    """Controllers that the run makes and calls by itself."""

    @property
    def start_ns(self) -> int:
        """Return the time of all stamps at t = 0, ns."""
        return self.start_time_s * NS_PER_SECOND

    @property
    def legs(self) -> tuple[LegConfig, ...]:
        """Return the legs of the run."""
        return tuple(own for own in self.bodies if isinstance(own, LegConfig))

    @property
    def leg(self) -> LegConfig | None:
        """Return the leg of the run; None without one, or with several."""
        return self.legs[0] if len(self.legs) == 1 else None

    def body(self, name: str) -> BodyConfig | None:
        """Return the body of a name; None: the run has none."""
        return next((own for own in self.bodies if own.name == name), None)

    @property
    def only_body(self) -> BodyConfig | None:
        """Return the body of a run file with ``body``; None: several, or another name."""
        return self.body(BODY) if len(self.bodies) == 1 else None

    def description(self, body: BodyConfig, folder: Path, control: Iterable[str] = ()) -> str:
        """Return the URDF of a body with the frames of this run; as `BodyConfig.description`."""
        return body.description(
            {name: self.actuator(name).sheet for _, name in body.joints}, folder, control)

    def body_of(self, actuator: str) -> BodyConfig | None:
        """Return the body that an actuator moves; None: it has a load of its own."""
        return next((own for own in self.bodies
                     if any(actuator == name for _, name in own.joints)), None)

    @property
    def stop_groups(self) -> tuple[EmergencyStopConfig, ...]:
        """Return the groups that stop together: one of all actuators if none is given."""
        return self.emergency_stops or (
            EmergencyStopConfig(EVERY, tuple(own.name for own in self.actuators)),)

    @property
    def linked(self) -> tuple[str, ...]:
        """Return the actuators with a link."""
        return tuple(own.name for own in self.actuators if own.sheet.link.kind != NO_LINK.kind)

    def supply_of(self, name: str) -> SupplySheet:
        """Return the sheet of the supply that feeds an actuator; as `actuator`."""
        fed = self.actuator(name).name
        return next(own.sheet for own in self.supplies if fed in own.feeds)

    @property
    def sampled_supplies(self) -> tuple[Sampled, ...]:
        """Return the rows of the samples of all supplies, in their order."""
        return tuple(row for own in self.supplies for row in own.sampled)

    def alone(self, actuator: ActuatorConfig) -> 'RunConfig':
        """Return a run of ``actuator`` alone, on the supply of the actuator of its name."""
        fed = next(own for own in self.supplies if actuator.name in own.feeds)
        supply = replace(fed.feeding([actuator.name]), name=SUPPLY)
        return replace(
            self, actuators=(actuator,), supplies=(supply,), bodies=(), emergency_stops=())

    @property
    def digest(self) -> str:
        """Return the sha256 of the resolved text, without what changes no signal."""
        text = replace(self, record=RecordConfig(), publish=PublishConfig(), start_time_s=0,
                       accept=ACCEPT_ALL).to_yaml()
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
            refuse_bad_name(name, f'{self.source}: controllers', is_placed=True)
        every = (*self.controllers, *names)
        self._refuse_taken([*(own.name for own in self.called), *every])
        return replace(self, controllers=every)

    def _refuse_taken(self, controllers: Sequence[str]) -> None:
        """Refuse a name that a controller shares with another one or with an actuator."""
        taken = [COORDINATOR, *(actuator.name for actuator in self.actuators)]
        for k, name in enumerate(controllers):
            if name in (before := [*taken, *controllers[:k]]):
                raise ConfigError(
                    f'{self.source}: controllers: the name {name!r} is taken; '
                    f'taken: {", ".join(before)}')

    def calling(self, called: Sequence[ControllerConfig]) -> 'RunConfig':
        """Return the run with these controllers of its own; as `with_controllers`."""
        self._refuse_taken([*self.controllers, *(own.name for own in called)])
        for own in called:
            if robot := parted(own.name)[0]:
                one_robot(self, robot, f'{self.source}: {own.label}')
        return replace(self, called=tuple(called))

    def with_body(self, body: BodyConfig) -> 'RunConfig':
        """Return the run with another start of a body and of the actuators on it."""
        joint_of = {actuator: joint for joint, actuator in body.joints}

        def started(own: ActuatorConfig) -> ActuatorConfig:
            start = body.position_of(joint_of[own.name]) if own.name in joint_of else None
            return own if start is None else replace(own, initial_position=start)
        return replace(
            self, bodies=tuple(body if own.name == body.name else own for own in self.bodies),
            actuators=tuple(map(started, self.actuators)))

    def stored(
            self, compression: str | None, split_mb: float | None, where: str) -> 'RunConfig':
        """Return the run with storage values given at ``where``; as `RecordConfig.stored`."""
        return replace(self, record=self.record.stored(compression, split_mb, where))

    def to_yaml(self) -> str:
        """Return the resolved configuration as text; `run_of_text` undoes it bit for bit."""
        return dump(RUN.tree(self))


def refuse_nested(value: Any, place: Place) -> Any:
    """Refuse robots in the file of a robot; raises `ConfigError`."""
    raise ConfigError(f'{place} is not used here: a robot has no robots of its own')


_BODY = OneOf({name: kind.KEYS for name, kind in BODY_KINDS.items()})
RUN = KeyTable((
    Key('name', NAME, 'the name of the run', in_text=InText.ALWAYS),
    Key('source', TEXT, 'the file that the run was resolved from', None,
        'the name of the file', in_text=InText.ONLY),
    STEP, OFFSET, STEP_NS, OFFSET_NS,
    number('tick_timeout_s', 's', 'host time after which a participant counts as lost', 5.0,
           gt=0.0, le=3600.0),
    Key('seed', Value('whole number', lambda value, place: seed_of(value, str(place))),
        'of all noise', 0),
    ACCEPT, START_TIME,
    Key(SUPPLY, ParameterSet(SupplySheet), 'the supply of all actuators', None,
        'required, or `supplies`', InText.NEVER),
    Key('supplies', NamedSections(SUPPLY_KEYS, are_placed=True),
        'several supplies, instead of `supply`', None, in_text=InText.ALWAYS,
        instead_of=(SUPPLY,)),
    Key('record', RECORD, 'what is recorded', {}, 'everything'), PUBLISH,
    Key(LINK, Layer(LinkSheet), 'the link of all actuators', {}, in_text=InText.NEVER),
    Key('actuators', NamedSections(ACTUATOR, are_placed=True),
        'the actuators by name; records have their order'),
    Key(EMERGENCY_STOPS, GROUPS, 'groups of actuators that stop together, by name', None,
        'all, by request alone', of=lambda run: run.emergency_stops or None),
    Key(CONTROLLERS, ControllerSections(), 'nodes, besides the actuators, that every tick waits '
        'for; or by name sections with a `class` that the run makes and calls', [],
        of=lambda run: NamedControllers(run.controllers, run.called)),
    Key(ROBOTS, Value('sections by name', refuse_nested),
        'several robots by name, each from a run file of its own', None, in_text=InText.NEVER),
    Key('leg', LegConfig.KEYS, 'a body of the kind leg', None, in_text=InText.NEVER),
    Key(BODY, _BODY, 'what several actuators move together', None,
        of=lambda run: run.only_body),
    Key('bodies', NamedSections(_BODY, are_placed=True),
        'several bodies by name, instead of `body`', None, instead_of=('leg', BODY),
        of=lambda run: run.bodies if run.bodies and run.only_body is None else None)))
"""Every key of a run file, and of a resolved text."""
