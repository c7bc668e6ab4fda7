"""Names of runs, actuators, supplies and controllers; they must also be valid in ROS."""

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
_NAME = re.compile(r'[a-z](?:_?[a-z0-9])*')


def refuse_bad_name(name: Any, where: str) -> None:
    """
    Refuse a name that ROS does not allow for a node.

    Raises
    ------
    ConfigError
        It is not text, has characters other than small letters, digits and single underscores, or
        more than `LONGEST`.

    """
    if not isinstance(name, str) or not _NAME.fullmatch(name) or len(name) > LONGEST:
        raise ConfigError(f'{where} = {shortened(repr(name))}, {NAME_RULE}')


def name_of(tree: Tree, key: str, place: Place) -> str:
    """Return a name that ROS can use; small letters, digits and single underscores."""
    if key not in tree:
        raise ConfigError(place.has(f'lacks {key}'))
    refuse_bad_name(tree[key], str(place / key))
    return str(tree[key])
