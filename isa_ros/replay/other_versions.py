"""Keys of a resolved configuration that are unknown to this version, and keys it lacks."""

from collections.abc import Iterator
from dataclasses import fields
from typing import Any, get_type_hints, NamedTuple

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.recording import RecordConfig
from isa_ros.config.run_config import ACTUATOR_KEYS, KEYS, LATER, LEG_KEYS, LegStart
from isa_ros.config.sections import KIND_KEYS, members, Place
from isa_ros.config.yaml_text import Tree
from isa_ros.core.parameter import Parameters
from isa_ros.loads.sheets import LocalLoad
from isa_ros.surroundings.leg.sheet import LegSheet
from isa_ros.surroundings.supply import SupplySheet


class KeyDifference(NamedTuple):
    """One key that the text or this version does not have."""

    text: str
    is_obstacle: bool
    """Without it the run cannot be simulated."""


def key_differences(tree: Tree, place: Place) -> Iterator[KeyDifference]:
    """Yield the keys of a resolved configuration that are unknown here, and those it lacks."""
    yield from _section(tree, KEYS, (*LATER, 'leg'), place)
    for key, meant in LATER.items():
        if key not in tree:
            yield KeyDifference(f'{place / key} is missing in the bag, {meant} is meant', False)
    yield from _section(
        tree.get('record', {}), (), tuple(RecordConfig().to_tree()), place / 'record')
    yield from _set(SupplySheet, tree.get('supply'), place / 'supply')
    actuators = tree.get('actuators')
    for name, actuator in actuators.items() if isinstance(actuators, dict) else ():
        yield from _actuator(actuator, place / 'actuators' / name)
    if 'leg' in tree:
        yield from _leg(tree['leg'], place / 'leg')


def _actuator(tree: Any, place: Place) -> Iterator[KeyDifference]:
    yield from _section(tree, ACTUATOR_KEYS, ('load',), place)
    if isinstance(tree, dict):
        yield from _set(LocalLoad, tree.get('load'), place / 'load')
        yield from _set(ActuatorSheet, tree.get('sheet'), place / 'sheet')


def _leg(tree: Any, place: Place) -> Iterator[KeyDifference]:
    yield from _section(tree, LEG_KEYS, (), place)
    if isinstance(tree, dict):
        yield from _set(LegStart, tree.get('start'), place / 'start')
        yield from _set(LegSheet, tree.get('sheet'), place / 'sheet')


def _section(
        tree: Any, keys: tuple[str, ...], optional: tuple[str, ...], place: Place
        ) -> Iterator[KeyDifference]:
    """Compare the keys of a section; a value that is not a section is refused by `build`."""
    if not isinstance(tree, dict):
        return
    for key in tree:
        if key not in (*keys, *optional):
            yield KeyDifference(f'{place / key} is unknown here', True)
    for key in keys:
        if key not in tree:
            yield KeyDifference(f'{place / key} is missing in the bag', True)


def _set(hint: Any, tree: Any, place: Place) -> Iterator[KeyDifference]:
    """Compare the keys of a parameter set, or of the kind that its section selects."""
    if not isinstance(tree, dict):
        return
    rest = dict(tree)
    if not isinstance(hint, type):
        kinds = members(hint)
        named = [rest.pop(key) for key in KIND_KEYS if key in rest]
        if not named:
            yield KeyDifference(f'{place / "kind"} is missing in the bag', True)
        elif named[0] not in kinds:
            yield KeyDifference(f'{place}: the kind {named[0]!r} is unknown here', True)
        if not named or named[0] not in kinds:
            return
        hint = kinds[named[0]]
    yield from _parameters(hint, rest, place)


def _parameters(cls: type[Parameters], tree: Tree, place: Place) -> Iterator[KeyDifference]:
    hints = get_type_hints(cls)
    for key in tree:
        if key not in hints:
            yield KeyDifference(f'{place / key} is unknown here', True)
    for f in fields(cls):
        if f.name in tree:
            if 'doc' not in f.metadata:
                yield from _set(hints[f.name], tree[f.name], place / f.name)
        elif 'absent' in f.metadata:
            meant = f.metadata['absent']
            yield KeyDifference(
                f'{place / f.name} is missing in the bag, {meant} is meant', False)
        else:
            yield KeyDifference(f'{place / f.name} is missing in the bag', True)
