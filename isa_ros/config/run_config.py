"""The resolved configuration of one run: every parameter filled in, immutable, loss-free text."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
import hashlib
import math
import re
from typing import Any

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.recording import read_record, RecordConfig
from isa_ros.config.sections import (
    as_tree, build, build_one_of, names_at, Place, refuse_unknown, section_at, written)
from isa_ros.config.yaml_text import dump, parse, Tree
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.timebase import refuse_grid
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad
from isa_ros.surroundings.leg.sheet import JOINTS, LegSheet, linkage_record
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.supply import SupplySheet


COORDINATOR = 'coordinator'
"""Name of the coordinator's node; participants must have other names."""

ALL = 'all'
"""Stands for every actuator of a run."""

NAME_RULE = 'must be small letters, digits and single underscores'
_NAME = re.compile(r'[a-z](?:_?[a-z0-9])*')

KEYS = ('name', 'source', 'step_ns', 'controller_offset_ns', 'tick_timeout_s', 'supply',
        'actuators')
ACTUATOR_KEYS = ('model', 'preset', 'initial_position', 'sheet')
LEG_KEYS = ('model', 'joints', 'start', 'sheet')
LATER = {'controllers': 'none', 'record': 'everything'}
"""Sections that the first resolved configurations did not have, and their values there."""


@dataclass(frozen=True, kw_only=True)
class Times(Parameters):
    """Timing of the lockstep."""

    step_ms: float = parameter('macro step H', 'ms', gt=0.0, le=100.0)
    controller_offset_ms: float = parameter(
        'offset of the samples of the REU from the ticks', 'ms', ge=0.0, le=100.0)
    tick_timeout_s: float = parameter(
        'host time after which a participant counts as lost', 's', gt=0.0, le=3600.0)


@dataclass(frozen=True, kw_only=True)
class LegStart(Parameters):
    """Pose of the leg at t = 0, and the time until which its slider is held there."""

    haa_deg: float = parameter('hip abduction', 'deg', ge=-180.0, le=180.0)
    hfe_deg: float = parameter('hip flexion', 'deg', ge=-180.0, le=180.0)
    kfe_deg: float = parameter('knee flexion', 'deg', ge=-180.0, le=180.0)
    foot_height_mm: float = parameter('foot above the ground', 'mm', ge=-100.0, le=5000.0)
    release_s: float = parameter('slider held until then; 0: free', 's', ge=0.0, le=1e6)

    def angle(self, joint: str) -> float:
        """Return the angle of a joint of `JOINTS`, rad."""
        return math.radians(getattr(self, f'{joint}_deg'))


@dataclass(frozen=True)
class LegConfig:
    """The shared load: a leg, the actuator of each joint, and the leg's start."""

    model: str
    sheet: LegSheet
    joints: tuple[tuple[str, str], ...]
    """(joint, actuator) in the order of `JOINTS`."""
    start: LegStart

    def position_of(self, joint: str) -> float:
        """Return the position of a joint's actuator at the leg's start, m or rad  (L2)."""
        linkage = linkage_record(getattr(self.sheet, joint))
        return float(actuator_coordinate(self.start.angle(joint), linkage)[0])


@dataclass(frozen=True)
class ActuatorConfig:
    """One actuator with its whole data sheet."""

    name: str
    model: str
    preset: str
    sheet: ActuatorSheet
    load: LocalLoad | None
    """Its own load; None at a joint of the leg."""
    initial_position: float
    """m or rad."""


@dataclass(frozen=True)
class RunConfig:
    """Everything that defines a run, except the setpoints."""

    name: str
    step_ns: int
    controller_offset_ns: int
    tick_timeout_s: float
    supply: SupplySheet
    actuators: tuple[ActuatorConfig, ...]
    """In the order of the file, which is the order of every record."""
    leg: LegConfig | None
    controllers: tuple[str, ...] = ()
    """Names of the nodes, besides the actuators, that every tick waits for."""
    source: str = field(default='')
    """Name of the file it was read from, without its directory."""
    record: RecordConfig = RecordConfig()

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
        return replace(self, leg=leg, actuators=tuple(
            replace(a, initial_position=leg.position_of(joint_of[a.name]))
            if a.name in joint_of else a for a in self.actuators))

    def stored(
            self, compression: str | None, split_mb: float | None, where: str) -> 'RunConfig':
        """Return the run with storage values given at ``where``; as `RecordConfig.stored`."""
        return replace(self, record=self.record.stored(compression, split_mb, where))

    def to_yaml(self) -> str:
        """Return the resolved configuration as text, the exact inverse of `from_yaml`."""
        tree: Tree = {
            'name': self.name,
            'source': self.source,
            'step_ns': self.step_ns,
            'controller_offset_ns': self.controller_offset_ns,
            'tick_timeout_s': self.tick_timeout_s,
            'supply': as_tree(self.supply, SupplySheet),
            'record': self.record.to_tree(),
            'actuators': {a.name: _actuator_tree(a) for a in self.actuators},
            'controllers': list(self.controllers),
        }
        if self.leg is not None:
            tree['leg'] = {
                'model': self.leg.model,
                'joints': dict(self.leg.joints),
                'start': as_tree(self.leg.start),
                'sheet': as_tree(self.leg.sheet),
            }
        return dump(tree)

    @classmethod
    def from_yaml(cls, text: str, name: str = 'configuration.yaml') -> 'RunConfig':
        """
        Return the configuration of a resolved text; error messages begin with ``name``.

        Raises
        ------
        ConfigError
            The text is not an output of `to_yaml`.

        """
        tree, place = parse(text, name), Place(name)
        _exactly(tree, (*KEYS, *(key for key in (*LATER, 'leg') if key in tree)), place)
        actuators = section_at(tree['actuators'], place / 'actuators')
        step_ns, offset_ns = (
            _of(int, tree, key, place) for key in ('step_ns', 'controller_offset_ns'))
        refuse_grid(step_ns, offset_ns, name)
        for actuator in actuators:
            refuse_bad_name(actuator, f'{place / "actuators"}: the name')
        return cls(
            name=_of(str, tree, 'name', place), source=_of(str, tree, 'source', place),
            step_ns=step_ns, controller_offset_ns=offset_ns,
            tick_timeout_s=_of(float, tree, 'tick_timeout_s', place),
            supply=_set(SupplySheet, tree, 'supply', place),
            actuators=tuple(
                _read_actuator(key, section_at(below, place / 'actuators' / key),
                               place / 'actuators' / key)
                for key, below in actuators.items()),
            controllers=tuple(names_at(tree.get('controllers', []), place / 'controllers')),
            record=read_record(tree.get('record', {}), place / 'record'),
            leg=_read_leg(section_at(tree['leg'], place / 'leg'), place / 'leg')
            if 'leg' in tree else None)


def refuse_bad_name(name: str, where: str) -> None:
    """
    Refuse a name that ROS does not allow for a node.

    Raises
    ------
    ConfigError
        The name has other characters than small letters, digits and single underscores.

    """
    if not _NAME.fullmatch(name):
        raise ConfigError(f'{where} = {name!r}, {NAME_RULE}')


def _actuator_tree(actuator: ActuatorConfig) -> Tree:
    tree: Tree = {
        'model': actuator.model,
        'preset': actuator.preset,
        'initial_position': actuator.initial_position,
    }
    if actuator.load is not None:
        tree['load'] = as_tree(actuator.load, LocalLoad)
    tree['sheet'] = as_tree(actuator.sheet)
    return tree


def _read_actuator(name: str, tree: Tree, place: Place) -> ActuatorConfig:
    _exactly(tree, (*ACTUATOR_KEYS, 'load') if 'load' in tree else ACTUATOR_KEYS, place)
    return ActuatorConfig(
        name=name, model=_of(str, tree, 'model', place), preset=_of(str, tree, 'preset', place),
        sheet=_set(ActuatorSheet, tree, 'sheet', place),
        load=_set(LocalLoad, tree, 'load', place) if 'load' in tree else None,
        initial_position=_of(float, tree, 'initial_position', place))


def _read_leg(tree: Tree, place: Place) -> LegConfig:
    _exactly(tree, LEG_KEYS, place)
    joints = section_at(tree['joints'], place / 'joints')
    _exactly(joints, JOINTS, place / 'joints')
    return LegConfig(
        model=_of(str, tree, 'model', place),
        joints=tuple((joint, _of(str, joints, joint, place / 'joints')) for joint in JOINTS),
        start=build(LegStart, written(section_at(tree['start'], place), place / 'start'),
                    place / 'start'),
        sheet=_set(LegSheet, tree, 'sheet', place))


def _exactly(tree: Tree, keys: Sequence[str], place: Place) -> None:
    refuse_unknown(tree, keys, place)
    for key in keys:
        if key not in tree:
            raise ConfigError(place.has(f'lacks {key}'))


def _of(kind: type, tree: Tree, key: str, place: Place) -> Any:
    value = tree[key]
    if type(value) is not kind:
        raise ConfigError(f'{place / key} = {value!r}, must be of type {kind.__name__}')
    return value


def _set(hint: Any, tree: Tree, key: str, place: Place) -> Any:
    below = place / key
    return build_one_of(hint, written(section_at(tree[key], below), below), below)
