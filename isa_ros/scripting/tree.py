"""Replace values of a tree by dotted key: ``actuators.kfe.preset``, ``tracks.kfe[1].t_s``."""

from copy import deepcopy
import re
from typing import Any

from isa_ros.config.yaml_text import Tree
from isa_ros.errors import ConfigError

_STEP = re.compile(r'(?P<key>[^.\[\]]+)(?P<places>(?:\[\d+\])*)')
_PLACE = re.compile(r'\[(\d+)\]')


def replaced(tree: Tree, key: str, value: Any, where: str) -> Tree:
    """
    Return the tree with one value, or a whole section, replaced or added.

    Missing sections on the path are added; key and value are checked when the tree is read.
    ``where`` is the file's name.

    Raises
    ------
    ConfigError
        The key is malformed, its path contains a value, or an index is beyond a list.

    """
    steps: list[str | int] = []
    for part in key.split('.'):
        match = _STEP.fullmatch(part)
        if match is None:
            raise ConfigError(
                f'{where}: key {key!r} is malformed, must be like actuators.kfe.preset or '
                'tracks.kfe[1].position')
        steps += [match['key'], *map(int, _PLACE.findall(match['places']))]
    changed = deepcopy(tree)
    below: Any = changed
    for done, step in enumerate(steps[:-1]):
        below = _entered(below, step, steps[done + 1], f'{where}: {key}')
    _entered(below, steps[-1], None, f'{where}: {key}')
    below[steps[-1]] = deepcopy(value)
    return changed


def _entered(below: Any, step: str | int, following: str | int | None, where: str) -> Any:
    """Return the value at one step of the path; add an empty section if there is none."""
    if isinstance(step, int):
        if not isinstance(below, list) or step >= len(below):
            n = len(below) if isinstance(below, list) else 0
            raise ConfigError(f'{where}: [{step}] does not exist, the number of entries is {n}')
        return below[step]
    if not isinstance(below, dict):
        raise ConfigError(f'{where}: {step} is below a value, must be below a section')
    if step not in below and following is not None and not isinstance(following, int):
        below[step] = {}
    return below.get(step)
