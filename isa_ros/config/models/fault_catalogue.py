"""The named faults of the device that come with the package, as data."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import read
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError

ACTUATOR, SUPPLY = 'actuator', 'supply'
KINDS = (ACTUATOR, SUPPLY)
_FILES = [Path(__file__).parents[1] / 'data' / 'faults' / f'{name}.yaml'
          for name in ('device', 'parts')]
_KEYS = ('of', 'meaning', 'set', 'in_circuit', 'rig', 'unseen', 'unreported')
_NUMBER = {'doc': 'value', 'unit': '', 'bounds': {}}


class NamedFault(NamedTuple):
    """One fault of the catalogue."""

    name: str
    of: str
    """One of `KINDS`."""
    meaning: str
    values: Mapping[str, float]
    """By the keys of `isa params`, in their units; empty: only a circuit has it."""
    part: str
    """Of a circuit: the kind of the part that has the fault; '': none."""
    part_values: Mapping[str, float]
    """Of that part, likewise by key."""
    rig: str
    """Of `isa faults` with the parts that it needs; '': any actuator or pump may have it."""
    unseen: str
    """The reason why it may change no signal; '' for faults that do."""
    unreported: str
    """The reason why the device of `isa faults` reports nothing of it; '' for the others."""


@cache
def fault_catalogue() -> Mapping[str, NamedFault]:
    """Return the faults by name, in the order of the files."""
    return {name: _fault(name, tree, Place(file.name, name))
            for file in _FILES for name, tree in read(file).items()}


def common_faults() -> Mapping[str, NamedFault]:
    """Return those that any actuator or pump may have, without those of parts."""
    return {name: own for name, own in fault_catalogue().items() if not own.rig}


def _fault(name: str, tree: Any, place: Place) -> NamedFault:
    section = section_at(tree, place)
    refuse_unknown(section, _KEYS, place)
    check(str(place / 'of'), section.get('of'), {'names': KINDS})
    of_part = section_at(section.get('in_circuit', {}), place / 'in_circuit')
    part = next(iter(of_part), '')
    return NamedFault(
        name, str(section['of']), str(section['meaning']),
        {} if part and 'set' not in section else values_at(section.get('set'), place / 'set'),
        part, values_at(of_part[part], place / 'in_circuit' / part) if part else {},
        str(section.get('rig', '')), str(section.get('unseen', '')),
        str(section.get('unreported', '')))


def named_fault(name: str, place: Place) -> NamedFault:
    """
    Return a fault of the catalogue; ``place`` has the name.

    Raises
    ------
    ConfigError
        There is no such fault.

    """
    known = fault_catalogue()
    if name not in known:
        raise ConfigError(f'{place} = {name!r} is unknown; {alternatives(str(name), known)}')
    return known[name]


def values_at(value: object, place: Place) -> dict[str, Any]:
    """
    Return numbers, or words of a choice, by dotted keys; sections in it are parts of the keys.

    Raises
    ------
    ConfigError
        It is empty or not a section, a key stands twice, or a value is neither a finite number
        nor a word.

    """
    section = section_at(value, place)
    if not section:
        raise ConfigError(place.has('is empty, must have a key and its value'))
    found: dict[str, Any] = {}
    for key, one in section.items():
        if isinstance(one, dict):
            values = {f'{key}.{rest}': own for rest, own in values_at(one, place / key).items()}
        elif isinstance(one, str):
            values = {key: one}
        else:
            check(f'{place}.{key}', one, _NUMBER)
            values = {key: float(one)}  # type: ignore[arg-type]
        for name in values:
            if name in found:
                raise ConfigError(f'{place}.{name} stands twice')
        found |= values
    return found
