"""A body of any simulator: its actuators, and the Python that makes it."""

from collections.abc import Mapping, Sequence
from importlib import import_module
import os
import sys
from typing import Any, ClassVar
from weakref import WeakSet

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.ratings import ratings_of
from isa_ros.config.runs.body_config import BODY, BodyConfig, BodyFactory, BodyInputs
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import Key, NAMES, TEXT
from isa_ros.config.text.names import parted
from isa_ros.config.text.sections import Place, Section
from isa_ros.core.changeable import sound
from isa_ros.core.fields import Field
from isa_ros.core.frozen import frozen
from isa_ros.core.signals import START
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, IsaError
from isa_ros.plant.plant import plant_record
from isa_ros.surroundings.body import Body
from isa_ros.surroundings.callers import cause_of
from isa_ros.surroundings.kept_ports import (
    GivenBody, port_fields, port_message, RecordedBody, zeros_given)
from isa_ros.surroundings.mechanism import Mechanism, Mounting
from isa_ros.surroundings.mechanism_body import MechanismBody
from isa_ros.surroundings.messages import BodyMessage
import numpy as np

_USED: WeakSet[Any] = WeakSet()
"""What factories have returned."""


@frozen(kw_only=True)
class ExternalConfig(BodyConfig):
    """
    A body that Python makes: ``body`` of `isa_ros.scripting.run.Run.simulate`, or ``class``.

    Its load ports are recorded, and are inputs of a replay.
    """

    kind: ClassVar[str] = 'external'
    is_given: ClassVar[bool] = True
    KEYS: ClassVar[KeyTable] = KeyTable((
        Key('actuators', NAMES, 'the actuators that move it, in the order of its rows',
            of=lambda own: [actuator for _, actuator in own.joints]),
        Key('class', TEXT, 'module:factory that makes it; a run in Python may give another', None,
            of=lambda own: own.maker)))
    maker: str | None = None
    """``module:factory``."""

    @classmethod
    def of(cls, name: str, values: dict[str, Any], place: Place, step_ns: int,
           is_checked: bool) -> tuple[BodyConfig, Mapping[str, Section]]:
        """Return the body; as `BodyConfig.of`."""
        actuators, maker = values['actuators'], values['class']
        if not actuators:
            raise ConfigError(f'{place / "actuators"} is empty, must name at least one actuator')
        if maker is not None and not is_path(maker):
            raise ConfigError(
                f'{place / "class"} = {maker!r}, must be module:factory, as crane:crane')
        if twice := next((own for own in actuators if actuators.count(own) > 1), None):
            raise ConfigError(f'{place / "actuators"} has {twice!r} twice, must have it once')
        joints = tuple((parted(own)[1], own) for own in actuators)
        if len(dict(joints)) < len(joints):
            raise ConfigError(f'{place / "actuators"} = {", ".join(actuators)}: two have the same '
                              'name in their namespaces, which the columns of a body do not have')
        return cls(name=name, joints=joints, maker=maker), {}

    @property
    def called(self) -> str:
        """Return how messages call it."""
        return 'the external body' if self.name == BODY else f'the external body {self.name}'

    def key_of(self, joint: str) -> str:
        """Return the list of its actuators."""
        return f'{self.label}.actuators'

    @property
    def fields(self) -> Sequence[Field]:
        """Return the ports, which every external body has in its sample."""
        return port_fields(len(self.joints))

    def messages(self, step_ns: int) -> Sequence[BodyMessage]:
        """Return the port of each actuator."""
        return [port_message(actuator, j) for j, (_, actuator) in enumerate(self.joints)]

    def refuse_absent(self, file: str) -> None:
        """Refuse a body without ``class``, or whose class cannot be imported."""
        if self.maker is None:
            raise ConfigError(
                f'{file}: {self.label} is external and has no class: only a run in Python can '
                'make it, by simulate(body=...); or give class: module:factory')
        self._imported(file)

    def _imported(self, file: str) -> BodyFactory:
        assert self.maker is not None
        return imported_factory(self.maker, f'{file}: {self.label}.class')

    def body(self, made: BodyInputs) -> Body:
        """Return what the factory makes, with its ports in its sample; as `BodyConfig.body`."""
        factory = made.factory
        if factory is None:
            self.refuse_absent(made.file)
            factory = self._imported(made.file)
        mounting = Mounting(
            [joint for joint, _ in self.joints], np.array(made.rows, np.int64),
            np.array([own.initial_position for own in made.actuators]),
            [own.sheet.is_rotary for own in made.actuators], made.step_ns / NS_PER_SECOND,
            made.seed)
        try:
            given = factory(mounting)
        except IsaError:
            raise
        except (Exception, SystemExit) as error:
            raise ConfigError(f'{self.label}: its factory: {cause_of(error)}') from error
        if isinstance(given, GivenBody):
            return given
        self._refuse_again(given)
        own = MechanismBody(given, mounting) if isinstance(given, Mechanism) else given
        if not hasattr(own, 'ports'):
            raise ConfigError(
                f'{self.label}: its factory returned a {type(own).__name__}, must be an '
                'isa_ros.Body or an isa_ros.Mechanism')
        recorded = RecordedBody(own, self.name, mounting.names, made.step_ns)
        self._refuse_start(recorded, made)
        return recorded

    def _refuse_again(self, given: object) -> None:
        """Refuse an object that another simulation has: it is no longer at t = 0."""
        try:
            is_used = given in _USED
            _USED.add(given)
        except TypeError:   # without hash or weak references
            return
        if is_used:
            raise ConfigError(
                f'{self.label}: its factory returned the same {type(given).__name__} twice, must '
                'make a new one at t = 0 for every simulation')

    def _refuse_start(self, body: Body, made: BodyInputs) -> None:
        """Refuse a start outside the stroke of an actuator."""
        starts = np.zeros(max(made.rows) + 1, START)
        body.starts(starts)
        for row, own in zip(made.rows, made.actuators):
            refuse_start(own, float(starts[row]['position']), f'{self.label}: ')


def imported_factory(maker: str, where: str, what: str = 'function') -> BodyFactory:
    """
    Return the factory ``module:factory``, of an installed module or a file in this folder.

    ``what`` it should be, for messages.

    Raises
    ------
    ConfigError
        There is none; ``where`` says who names it.

    """
    if not is_path(maker):
        raise ConfigError(f'{where} = {maker!r}, must be module:factory, as crane:crane')
    module, _, name = maker.partition(':')
    if (here := os.getcwd()) not in sys.path:
        sys.path.append(here)
    try:
        found = import_module(module)
    except ImportError as error:
        raise ConfigError(f'{where} = {maker}: {error}') from error
    except (Exception, SystemExit) as error:
        raise ConfigError(f'{where} = {maker}: {cause_of(error)}') from error
    if not hasattr(found, name):
        raise ConfigError(f'{where} = {maker}: {module} has no {what} {name}')
    factory = getattr(found, name)
    if not callable(factory):
        raise ConfigError(
            f'{where} = {maker}: {name} is of type {type(factory).__name__}, must be a {what}')
    checked: BodyFactory = factory
    return checked


def held_forces(own: ConfiguredActuator) -> tuple[float, float]:
    """Return the forces, N | Nm, between which an actuator holds with its relief valves closed."""
    plant = plant_record(sound(own.sheet.plant))[0]
    opening = ratings_of(plant).opening_pressure
    return float(-opening * plant.chambers.area_b), float(opening * plant.chambers.area_a)


def refuse_force(own: ConfiguredActuator, force: float) -> None:
    """Raise `ConfigError` if the relief valves would open under a force, N | Nm."""
    low, high = held_forces(own)
    if not low <= force <= high:
        unit = 'Nm' if own.sheet.is_rotary else 'N'
        raise ConfigError(
            f'{own.name} starts with a force of {force:g} {unit}, must be {low:.4g} to '
            f'{high:.4g} {unit}, at which its relief valves open')


def refuse_start(own: ConfiguredActuator, place: float, where: str = '') -> None:
    """Raise `ConfigError` if an actuator starts outside its stroke; ``place`` in m or rad."""
    stroke = own.sheet.plant.drive.stroke
    if not 0.0 <= place <= stroke:
        unit = 'rad' if own.sheet.is_rotary else 'm'
        raise ConfigError(
            f'{where}{own.name} starts at {place:g} {unit}, must be within its stroke, 0 to '
            f'{stroke:g} {unit}')


def at_rest(mounting: Mounting) -> Body:
    """Return a body at rest at zero, of which only the form of its sample is wanted."""
    return GivenBody(mounting.rows, zeros_given(len(mounting.rows)))


def is_path(maker: str) -> bool:
    """Return whether a text is module:name."""
    module, colon, name = maker.partition(':')
    return bool(colon) and name.isidentifier() and all(
        part.isidentifier() for part in module.split('.'))
