"""Controllers of a run: nodes that every tick waits for, and those that the run itself calls."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from isa_ros.config.runs.external_config import imported_factory, is_path
from isa_ros.config.runs.one_robot import of_its_robot, one_robot
from isa_ros.config.text.keys import ANY_NAME, Key, KeyDifference, Leaf, of_type, ValueKind
from isa_ros.config.text.names import parted, refuse_bad_name
from isa_ros.config.text.sections import names_at, Place, section_at
from isa_ros.controller import Controller
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError, IsaError
from isa_ros.surroundings.callers import cause_of

CONTROLLERS = 'controllers'
"""Key of a run file, and of a scenario."""
CLASS = 'class'
"""Key of a section."""


@frozen(kw_only=True)
class ControllerConfig:
    """A controller that the run makes and calls: the section of its name."""

    name: str
    maker: str
    """``module:Class``; its `Controller.of` makes it."""
    values: Mapping[str, Any]
    """The other keys, for the class to check."""

    @property
    def section(self) -> dict[str, Any]:
        """Return its section."""
        return {CLASS: self.maker, **self.values}

    @property
    def label(self) -> str:
        """Return the key of its section."""
        return f'{CONTROLLERS}.{self.name}'

    @property
    def called(self) -> str:
        """Return how messages call it: its key and its class."""
        return f'{self.label}: {self.maker.partition(":")[2]}'

    def made(self, run: Any) -> Controller:
        """
        Return a new controller for a `RunConfig`: each simulation has its own.

        In a namespace it is made for the robot of this name alone, and sees no other.

        Raises
        ------
        ConfigError
            Its class cannot be imported, or refuses its values; or there is no such robot.

        """
        where, robot = f'{run.source}: {self.label}', parted(self.name)[0]
        made: object = imported_factory(self.maker, f'{where}.{CLASS}', CLASS)
        if not (isinstance(made, type) and issubclass(made, Controller)):
            raise ConfigError(
                f'{where}.{CLASS} = {self.maker}: must be a class derived from '
                'isa_ros.Controller')
        alone = one_robot(run, robot, where) if robot else run
        try:
            own = made.of(alone, self.values, where)
        except IsaError:
            raise
        except (Exception, SystemExit) as error:
            raise ConfigError(f'{where}: {cause_of(error)}') from error
        return of_its_robot(own, self.name, run, where)


class NamedControllers(NamedTuple):
    """The controllers of a file, as far as it has them."""

    nodes: Sequence[str] = ()
    called: Sequence[ControllerConfig] = ()


class ControllerSections(ValueKind):
    """A list of nodes; or sections by name, of which an empty one is a node."""

    words = 'list of names, or sections by name'

    def read(self, tree: Any, place: Place) -> NamedControllers:
        """Return the controllers; as `ValueKind.read`."""
        if isinstance(tree, list):
            return NamedControllers(tuple(names_at(tree, place)))
        return NamedControllers(
            tuple(name for name, below in section_at(tree, place).items() if not below),
            controllers_at({name: below for name, below in tree.items() if below}, place))

    def tree(self, value: NamedControllers) -> Any:
        """Return the list, or the sections."""
        if not value.called:
            return list(value.nodes)
        return {name: {} for name in value.nodes} | {
            own.name: own.section for own in value.called}

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return a row for each section, whose values are those of its class."""
        return {name: Key(name, ValueKind(), '') for name in tree}

    def leaves(self, value: NamedControllers, key: str, row: Key) -> Iterator[Leaf]:
        """Yield the nodes, and each value of the others."""
        if value.nodes or not value.called:
            yield Leaf(key, NamedControllers(value.nodes), row)
        for own in value.called:
            yield from _leaves(own.section, f'{key}.{own.name}')


def _leaves(tree: Any, key: str) -> Iterator[Leaf]:
    below = (((f'.{name}', value) for name, value in tree.items()) if isinstance(tree, dict) else
             ((f'[{k}]', value) for k, value in enumerate(tree)) if isinstance(tree, list) else
             None)
    if below is None:
        yield Leaf(key, tree, Key(key.rpartition('.')[2], ANY_NAME, ''))
        return
    for end, value in below:
        yield from _leaves(value, f'{key}{end}')


def controllers_at(
        tree: Any, place: Place, before: Sequence[ControllerConfig] = ()
        ) -> tuple[ControllerConfig, ...]:
    """
    Return the controllers of sections by name; values there win over those ``before``.

    Raises
    ------
    ConfigError
        A section is malformed, or has no class.

    """
    found = {own.name: own for own in before}
    for name, own in section_at(tree, place).items():
        below = place / name
        refuse_bad_name(name, f'{below}: the name', is_placed=True)
        values = dict(section_at(own, below))
        known = found.get(name)
        if known is not None:
            values = {**known.section, **values}
        if CLASS not in values:
            raise ConfigError(f'{below} lacks {CLASS}, module:Class of the controller')
        maker = of_type(values.pop(CLASS), str, below / CLASS)
        if not is_path(maker):
            raise ConfigError(
                f'{below / CLASS} = {maker!r}, must be module:Class, as my_trot:MyTrot')
        found[name] = ControllerConfig(name=name, maker=maker, values=values)
    return tuple(found.values())
