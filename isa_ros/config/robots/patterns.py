"""Sections by name in which ``*`` stands for any letters, so that equal legs are written once."""

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from typing import Any

from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import listed
from isa_ros.errors import ConfigError

ANY = '*'


def matching(pattern: str, names: Sequence[str], place: Place) -> list[str]:
    """
    Return the names that a pattern means: itself if it has no ``*``.

    Raises
    ------
    ConfigError
        It means none of them.

    """
    if ANY not in pattern:
        return [pattern]
    found = [name for name in names if fnmatchcase(name, pattern)]
    if not found:
        raise ConfigError(f'{place / pattern} means none of {listed(list(names))}')
    return found


def sections_by_name(tree: Tree, names: Sequence[str], place: Place) -> dict[str, Tree]:
    """
    Return the sections of ``tree`` by name, with its patterns replaced by what they mean.

    Later sections replace single keys of earlier ones. A name without ``*`` may be none of
    ``names``.
    """
    found: dict[str, Tree] = {}
    for key, below in tree.items():
        for name in matching(key, names, place):
            found[name] = {**found.get(name, {}), **section_at(below, place / key)}
    return found


def numbers_by_name(
        tree: Tree, names: Sequence[str], place: Place) -> dict[str, Any]:
    """Return the values of ``tree`` by name, each one of ``names``; as `sections_by_name`."""
    found: dict[str, Any] = {}
    for key, value in tree.items():
        for name in matching(key, names, place):
            refuse_unknown([name], names, place)
            found[name] = value
    return found


def names_in(patterns: Iterable[str], names: Sequence[str], place: Place) -> list[str]:
    """Return the names that a list of names and patterns means, each one of ``names``."""
    found = dict.fromkeys(
        name for pattern in patterns for name in matching(pattern, names, place))
    refuse_unknown(found, names, place)
    return list(found)
