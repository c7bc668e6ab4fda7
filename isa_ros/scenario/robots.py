"""
A scenario of several robots: each has one of its own, in its namespace.

::

    name: hop
    robots:
      r1: {file: drop}                                  # a file beside this one, or shipped
      r2: {file: drop, leg: {foot_height_mm: 50.0}}     # other values, by the keys of its file

What the scenario itself has stands beside that of the robots. Its duration is theirs, if it has
none; figures are those of a run of one robot.
"""

from typing import Any

from isa_ros.config.paths import SCENARIOS
from isa_ros.config.runs.body_config import BODY
from isa_ros.config.runs.controller_config import CONTROLLERS
from isa_ros.config.runs.emergency_stops import ALL
from isa_ros.config.runs.robots import agreed, robot_files, Sections
from isa_ros.config.runs.run_config import ROBOTS
from isa_ros.config.text.names import placed
from isa_ros.config.text.sections import overlaid, Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.errors import ConfigError
from isa_ros.scenario.fault_reading import TARGETS
from isa_ros.surroundings.emergency_line import EMERGENCY_STOP

_BY_NAME = ('tracks', 'loads', 'bodies', CONTROLLERS)
_LISTS = ('faults', 'changes')
_OF_RUN = ('duration_s', 'beyond_range')
_LEG = 'leg'


def with_robots(tree: Tree, place: Place) -> Tree:
    """
    Return the tree of a scenario with those of its robots, which have the names of the run.

    Raises
    ------
    ConfigError
        A file cannot be read or has an unknown key, or the robots do not agree on the duration.

    """
    if ROBOTS not in tree:
        return tree
    own: Sections = {key: value for key, value in tree.items() if key != ROBOTS}
    keys = (*_OF_RUN, *_BY_NAME, *_LISTS, _LEG)
    parts: dict[str, Sections] = {}
    for robot in robot_files(tree[ROBOTS], place / ROBOTS, keys, SCENARIOS):
        refuse_unknown(robot.tree, ('name', 'figure', *keys), robot.place)
        parts[robot.name] = _in_namespace(
            overlaid(robot.tree, robot.changes), place / ROBOTS / robot.name, robot.name)
    joined = agreed(parts, {key: key for key in _OF_RUN}, own, place / ROBOTS) | own
    for part in parts.values():
        for key in _BY_NAME:
            if key in part:
                joined[key] = overlaid(part[key], section_at(joined.get(key, {}), place / key))
        for key in _LISTS:
            if key in part:
                joined[key] = [*part[key], *_list(joined.get(key, []), place / key)]
    return joined


def _in_namespace(tree: Sections, place: Place, robot: str) -> Sections:
    """Return a scenario with the names of the parts of a robot in its namespace."""
    found: Sections = {key: tree[key] for key in _OF_RUN if key in tree}
    for key in _BY_NAME:
        found[key] = {placed(robot, name): value
                      for name, value in section_at(tree.get(key, {}), place / key).items()}
    if _LEG in tree:
        found['bodies'] = {robot: tree[_LEG]}
    for key in _LISTS:
        found[key] = [_target_there(section_at(one, place / key), robot)
                      for one in _list(tree.get(key, []), place / key)]
    return found


def _target_there(fault: Tree, robot: str) -> Tree:
    """Return a fault whose target is the one of this name of a robot."""
    def there(key: str, value: Any) -> Any:
        if key not in TARGETS or not isinstance(value, str):
            return value
        is_whole = (key, value) in ((EMERGENCY_STOP, ALL), (BODY, BODY))
        return robot if is_whole else placed(robot, value)
    return {key: there(key, value) for key, value in fault.items()}


def _list(value: Any, place: Place) -> list[Any]:
    if not isinstance(value, list):
        raise ConfigError(f'{place} = {value!r}, must be a list of faults')
    return value
