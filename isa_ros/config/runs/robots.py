"""
Several robots in one run: each from a run file of its own, in a namespace.

::

    name: pair
    robots:
      r1: {file: leg}                                         # beside this file, or shipped
      r2: {file: leg, actuators: {kfe: {preset: table_4}}}    # other values, by its file's keys

The actuator ``kfe`` of the robot ``r1`` is ``r1/kfe``, its body ``r1``, its supply ``r1/supply``,
and its actuators are a group of emergency stops, ``r1``, or its groups are ``r1/GROUP``. A
controller of its file with a class is ``r1/NAME`` and sees no other robot. The run
file itself may have actuators and bodies beside them. Its ``supply`` or ``emergency_stops`` stand
instead of those of the robots, and one of its ``supplies`` feeds those of their actuators that it
names. What belongs to the whole run, as ``step_ms``, it gives for all, or the robots agree on it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from isa_ros.config.models.links import LINK
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.body_config import BODY
from isa_ros.config.runs.controller_config import CONTROLLERS
from isa_ros.config.runs.emergency_stops import EmergencyStopConfig, KEY as EMERGENCY_STOPS
from isa_ros.config.runs.run_config import refuse_nested, ROBOTS, RUN, RunConfig
from isa_ros.config.runs.run_reading import Origins, run_of
from isa_ros.config.runs.supplies import SUPPLY
from isa_ros.config.text.names import placed, refuse_bad_name
from isa_ros.config.text.sections import (
    names_at, overlaid, Place, refuse_unknown, section_at)
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.errors import ConfigError

Sections = dict[str, Any]
"""The tree of a file, or a part of it."""
FILE = 'file'
_OF_ROBOT = (SUPPLY, 'supplies', 'actuators', 'leg', BODY, 'bodies', EMERGENCY_STOPS, LINK,
             CONTROLLERS)
"""Keys of a robot's file that may stand beside ``file``."""
_HANDED_DOWN = ('step_ms', 'controller_offset_ms', LINK)
"""Keys of the run file that each robot is checked with."""
_OF_RUN = {'step_ns': 'step_ms', 'controller_offset_ns': 'controller_offset_ms',
           **{key: key for key in ('tick_timeout_s', 'seed', 'accept', 'start_time_s', 'record',
                                   'publish', CONTROLLERS)}}
"""Keys of a resolved text for the whole run, with those of a run file."""


class RobotFile(NamedTuple):
    """The file of one robot."""

    name: str
    """Of the robot."""
    tree: Sections
    place: Place
    changes: Sections
    """Other values than those of the file, by its keys."""


def robot_files(
        tree: Any, place: Place, keys: Sequence[str], directory: str) -> Iterator[RobotFile]:
    """
    Yield the files that a section ``robots`` names.

    ``keys`` may stand beside ``file``. A file is one beside that of the section, or else as
    `isa_ros.config.paths.find` in ``directory``.

    Raises
    ------
    ConfigError
        A name, a key or a file is refused, or there is none.

    """
    robots = section_at(tree, place)
    if not robots:
        raise ConfigError(f'{place} is empty, must name at least one robot')
    for name, given in robots.items():
        below = place / name
        refuse_bad_name(name, f'{below}: the name')
        section = dict(section_at(given, below))
        refuse_unknown(section, (FILE, *keys), below)
        if FILE not in section:
            raise ConfigError(below.has(f'lacks {FILE}'))
        file = section.pop(FILE)
        if not isinstance(file, str):
            raise ConfigError(f'{below / FILE} = {file!r}, must be the name of a file')
        try:
            beside = place.folder / file
            path = beside if beside.is_file() else find(file, directory)
        except ConfigError as error:
            raise ConfigError(f'{below / FILE}: {error}') from error
        yield RobotFile(name, read(path), Place.of(path), section)


class FileOf:
    """
    Which file has the values at a key of a run: its own, or that of a robot.

    ``tree`` is that of the run file at ``place``, whose name is ``source``.
    """

    def __init__(self, tree: Tree, place: Place, source: str) -> None:
        self._source = source
        self._robots = {own.name: own for own in robot_files(
            tree[ROBOTS], place / ROBOTS, _OF_ROBOT, CONFIG)} if ROBOTS in tree else {}

    def __call__(self, key: str) -> str:
        """Return the name of the file; values beside the name of a robot's are in the run's."""
        head, _, rest = key.partition('.')
        name, _, below = rest.partition('.')
        robot, _, part = name.partition('/')
        own = self._robots.get(robot)
        if own is None or not (part or head == 'bodies'):
            return self._source
        ways = ([('leg',), (BODY,), (head, part)] if head == 'bodies' else
                [(head, part), *([(SUPPLY,)] if head == 'supplies' else [])])
        steps = below.removeprefix('sheet.').split('.')
        return self._source if any(
            _has(own.changes, [*way, *steps]) for way in ways) else own.place.file


def _has(tree: Any, steps: Sequence[str]) -> bool:
    """Return whether a section has a value at the first of these steps, or at all of them."""
    for step in steps:
        if not isinstance(tree, dict):
            return True
        if step not in tree:
            return False
        tree = tree[step]
    return True


def agreed(
        trees: Mapping[str, Sections], keys: Mapping[str, str], own: Sections,
        place: Place) -> Sections:
    """
    Return the values of ``keys`` on which the trees of all robots agree.

    ``keys`` have the names that ``own``, the file with the robots, has for them: what it gives
    itself is left out.

    Raises
    ------
    ConfigError
        Two robots have different values.

    """
    found: Sections = {}
    for key, word in keys.items():
        if key in own or word in own:
            continue
        (first, tree), *others = trees.items()
        for other, its in others:
            if its.get(key) != tree.get(key):
                raise ConfigError(
                    f'{place}: {key} = {tree.get(key)} of {first} and {its.get(key)} of {other}, '
                    f'must be one for all; give {word} in {place.file}')
        if key in tree:
            found[key] = tree[key]
    return found


def run_with_robots(tree: Tree, place: Place) -> tuple[RunConfig, Origins]:
    """
    Return the run of a file's tree with its robots, and what it was built from; as `run_of`.

    Raises
    ------
    ConfigError
        As `run_of`, also for the file of a robot, or the robots do not fit together.

    """
    if ROBOTS not in tree:
        return run_of(tree, place)
    origins: Origins = {}
    parts: dict[str, Sections] = {}
    called: Sections = {}
    for name, run, its in _robots(tree, place / ROBOTS):
        parts[name] = RUN.tree(replace(run, called=()))
        called |= {own.name: own.section for own in run.called}
        origins = {**origins, **its}
    own: Sections = {
        key: value for key, value in tree.items() if key not in (ROBOTS, LINK)}
    link = section_at(tree.get(LINK, {}), place / LINK)
    joined = agreed(parts, _OF_RUN, own, place / ROBOTS) | own
    joined['actuators'] = {
        name: section | {LINK: link | section.get(LINK, {})} if link and isinstance(section, dict)
        else section for name, section in _own(own, 'actuators', place).items()}
    joined['bodies'] = _own(own, 'bodies', place)
    if SUPPLY not in own:
        joined['supplies'] = _own(own, 'supplies', place)
        _feed(joined['supplies'], parts, place / 'supplies')
    if EMERGENCY_STOPS not in own:
        joined[EMERGENCY_STOPS] = {str(own.get('name')): {
            'actuators': list(joined['actuators'])}} if joined['actuators'] else {}
    for key in ('actuators', 'bodies', *(() if EMERGENCY_STOPS in own else (EMERGENCY_STOPS,))):
        for part in parts.values():
            _add(joined[key], part.get(key, {}), place / key)
    if called:
        joined[CONTROLLERS] = _with_sections(joined.get(CONTROLLERS, []), place / CONTROLLERS)
        _add(joined[CONTROLLERS], called, place / CONTROLLERS)
    run, its = run_of({key: value for key, value in joined.items() if value != {}}, place)
    return run, {**its, **origins}


def _robots(tree: Tree, place: Place) -> Iterator[tuple[str, RunConfig, Origins]]:
    """Yield name and run of each robot, its parts in a namespace of this name."""
    handed = {key: tree[key] for key in _HANDED_DOWN if key in tree}
    for robot in robot_files(tree[ROBOTS], place, _OF_ROBOT, CONFIG):
        if ROBOTS in robot.tree:
            refuse_nested(robot.tree[ROBOTS], robot.place / ROBOTS)
        run, origins = run_of(robot.tree, robot.place)      # its errors name its file
        if changes := overlaid(handed, robot.changes):
            below = replace(place / robot.name, folder=robot.place.folder)
            run, origins = run_of(overlaid(robot.tree, changes), below)
        yield robot.name, _in_namespace(run, robot.name), {
            _key_in(key, robot.name): section for key, section in origins.items()}


def _in_namespace(run: RunConfig, robot: str) -> RunConfig:
    """Return the run of a robot with the names of its parts in its namespace."""
    def all_there(names: Sequence[str]) -> tuple[str, ...]:
        return tuple(placed(robot, name) for name in names)
    return replace(
        run,
        actuators=tuple(replace(own, name=placed(robot, own.name)) for own in run.actuators),
        bodies=tuple(own.in_namespace(robot) for own in run.bodies),
        called=tuple(replace(own, name=placed(robot, own.name)) for own in run.called),
        supplies=tuple(replace(own, name=placed(robot, own.name), feeds=all_there(own.feeds))
                       for own in run.supplies),
        emergency_stops=tuple(
            replace(own, name=placed(robot, own.name), actuators=all_there(own.actuators))
            for own in run.emergency_stops) or (EmergencyStopConfig(
                robot, all_there([own.name for own in run.actuators])),))


def _key_in(key: str, robot: str) -> str:
    """Return the key of a sheet in the text of the run, from that in the text of a robot."""
    head, _, rest = key.partition('.')
    return f'bodies.{robot}.{rest}' if head == BODY else f'{head}.{placed(robot, rest)}'


def _with_sections(controllers: Any, place: Place) -> Sections:
    """Return controllers as sections, of which those of nodes are empty."""
    if isinstance(controllers, list):
        return {name: {} for name in names_at(controllers, place)}
    return dict(section_at(controllers, place))


def _own(own: Sections, key: str, place: Place) -> Sections:
    return dict(section_at(own.get(key, {}), place / key))


def _add(section: Sections, others: Sections, place: Place) -> None:
    """Add the parts of a robot to those of the run file, which have other names."""
    for name, other in others.items():
        if name in section:
            raise ConfigError(f'{place / name}: the name is that of a part of a robot; other '
                              f'values of it stand below {ROBOTS}')
        section[name] = other


def _feed(supplies: Sections, parts: Mapping[str, Sections], place: Place) -> None:
    """Add the supplies of the robots, for the actuators that none of the run file feeds."""
    fed = {name for key, own in supplies.items()
           for name in _names(section_at(own, place / key).get('feeds', []), place / key)}
    for part in parts.values():
        for name, own in part['supplies'].items():
            if feeds := _without(own['feeds'], fed):
                _add(supplies, {name: {**own, 'feeds': feeds}}, place)


def _names(feeds: Any, place: Place) -> list[str]:
    """Return the actuators that a supply of a file feeds, in a list or in lists by manifold."""
    if isinstance(feeds, dict):
        return [name for key, own in feeds.items() for name in names_at(own, place / key)]
    return names_at(feeds, place)


def _without(feeds: Any, fed: set[str]) -> Any:
    """Return them without those that are fed; empty if that is all."""
    if isinstance(feeds, dict):
        left = {key: _without(own, fed) for key, own in feeds.items()}
        return {key: own for key, own in left.items() if own}
    return [name for name in feeds if name not in fed]
