"""
Other values in files: dotted keys and values, as ``--set KEY=VALUE`` or from a program.

Keys are those of a run file, ``actuators.kfe.preset``, and behind ``scenario.`` those of the
scenario's file, ``scenario.tracks.kfe[1].t_s``; values have the units of the files.
"""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from itertools import takewhile
import re
from typing import Any, NamedTuple

from isa_ros.config.text.yaml_text import parse, Tree
from isa_ros.core.suggest import shortened
from isa_ros.errors import ConfigError

SCENARIO = 'scenario.'
"""Prefix of the keys of the scenario's file."""

KIND = 'kind'
BARE = ('none', 'off', 'held', 'rigid')
"""Kinds of sections without values of their own."""

Values = Mapping[str, Any]
"""Values by dotted key, in the order in which they are set."""

_STEP = re.compile(r'(?P<key>[^.\[\]]+)(?P<places>(?:\[\d+\])*)')
_PLACE = re.compile(r'\[(\d+)\]')


class Changes(NamedTuple):
    """Values of a run file and, without the prefix, of the scenario's file."""

    run: Values
    scenario: Values


def assigned(text: str, where: str) -> tuple[str, Any]:
    """
    Return key and value of a text KEY=VALUE; the value is read as in a file.

    ``where`` is the option with the text.

    Raises
    ------
    ConfigError
        There is no key, or the value is not one of YAML.

    """
    key, sign, value = text.partition('=')
    if not key or not sign:
        raise ConfigError(f'{where} {shortened(repr(text))}, must be KEY=VALUE')
    tree = parse(f'value: {value}', f'{where} {shortened(text)}')
    if list(tree) != ['value']:
        raise ConfigError(f'{where} {shortened(repr(text))}, must have one value')
    return key, tree['value']


def values_of(texts: Sequence[str], where: str) -> Values:
    """Return the values of several texts, the last one of a key; as `assigned`."""
    values: dict[str, Any] = {}
    for text in texts:
        key, value = assigned(text, where)
        values.pop(key, None)
        values[key] = value
    return values


def changes_of(texts: Sequence[str], where: str = '--set') -> Changes:
    """Return the values of several texts by the file they belong to; as `assigned`."""
    values = values_of(texts, where)
    return Changes(
        {key: value for key, value in values.items() if not key.startswith(SCENARIO)},
        {key.removeprefix(SCENARIO): value for key, value in values.items()
         if key.startswith(SCENARIO)})


def changed(tree: Tree, values: Values, where: str) -> Tree:
    """Return the tree with other values; as `replaced`."""
    for key, value in values.items():
        tree = replaced(tree, key, value, where)
    return tree


def replaced(tree: Tree, key: str, value: Any, where: str) -> Tree:
    """
    Return the tree with one value, or a whole section, replaced or added.

    Missing sections on the path are added; key and value are checked when the tree is read. A key
    with dots that a section has, such as one in the ``set`` of a fault, is found as it is written.
    A kind that has no values leaves none of those that another kind had in its section.
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
    while True:
        steps = _as_written(below, steps)
        if len(steps) == 1:
            break
        below = _entered(below, steps[0], steps[1], f'{where}: {key}')
        steps = steps[1:]
    _entered(below, steps[-1], None, f'{where}: {key}')
    if steps[-1] == KIND and value in BARE:
        below.clear()
    below[steps[-1]] = deepcopy(value)
    return changed


def _as_written(below: Any, steps: Sequence[str | int]) -> list[str | int]:
    """Return the steps with those joined that are one key of a section; the longest one wins."""
    names = list(takewhile(lambda step: isinstance(step, str), steps))
    for count in range(len(names), 1, -1):
        joined = '.'.join(map(str, names[:count]))
        if isinstance(below, dict) and joined in below:
            return [joined, *steps[count:]]
    return list(steps)


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
