"""
Names of runs, actuators, bodies, supplies and controllers; they must also be valid in ROS.

The name of an actuator, a body, a supply or a group of emergency stops may begin with a namespace
and a slash: the actuator ``r1/kfe`` is the node ``/r1/kfe``.
"""

import re

from typing import Any

from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import shortened
from isa_ros.errors import ConfigError

COORDINATOR = 'coordinator'
"""Name of the coordinator's node; participants must have other names."""

LONGEST = 100   # letters; a topic of DDS has at most 255 with namespace and what follows the name
NAME_RULE = f'must be small letters, digits and single underscores, at most {LONGEST}'
PLACED_RULE = f'{NAME_RULE}; or NAMESPACE/NAME'
_NAME = re.compile(r'[a-z](?:_?[a-z0-9])*')


def refuse_bad_name(name: Any, where: str, *, is_placed: bool = False) -> None:
    """
    Refuse a name that ROS does not allow for a node.

    ``is_placed``: it may begin with a namespace and a slash.

    Raises
    ------
    ConfigError
        It is not text, has characters other than small letters, digits and single underscores, or
        more than `LONGEST`; or its namespace is that of the coordinator's topics.

    """
    words = name.split('/') if isinstance(name, str) else []
    if not 0 < len(words) <= 1 + is_placed or len(name) > LONGEST or not all(
            map(_NAME.fullmatch, words)):
        raise ConfigError(
            f'{where} = {shortened(repr(name))}, {PLACED_RULE if is_placed else NAME_RULE}')
    if words[:-1] == [COORDINATOR]:
        raise ConfigError(f'{where} = {name!r}: the namespace is reserved for the coordinator')


def parted(name: str) -> tuple[str, str]:
    """Return the namespace of a name, '' for none, and the name in it."""
    namespace, _, own = name.rpartition('/')
    return namespace, own


def placed(namespace: str, name: str) -> str:
    """Return a name in a namespace, '' for none; inverse of `parted`."""
    return f'{namespace}/{name}' if namespace else name


def flat(name: str) -> str:
    """Return a name without its slash, for files and for drivers that have no namespaces."""
    return name.replace('/', '_')


def name_of(tree: Tree, key: str, place: Place) -> str:
    """Return a name that ROS can use; small letters, digits and single underscores."""
    if key not in tree:
        raise ConfigError(place.has(f'lacks {key}'))
    refuse_bad_name(tree[key], str(place / key))
    return str(tree[key])
