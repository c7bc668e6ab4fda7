"""The values of a drive's linkage, over those of another one that it is like."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from isa_ros.config.models.catalogue import leg_names, leg_section
from isa_ros.config.text.sections import (
    merge, Place, refuse_unknown, Section, SourcedValue)
from isa_ros.config.text.yaml_text import Tree as YamlTree
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.leg.sheet import JOINTS


def linkage_section(
        own: YamlTree, values: Section, linkages: Mapping[str, Section], place: Place) -> Section:
    """
    Return the values of a drive's linkage, over those of the one that it is like.

    ``own`` are all keys of the drive, ``linkages`` those of the file that `like` may name.

    Raises
    ------
    ConfigError
        There is no such linkage, or it cannot be mirrored.

    """
    if 'like' not in own:
        if 'mirrored' in own:
            raise ConfigError(f'{place / "mirrored"} is not used: the drive is like no other')
        return values
    base = dict(_like(own['like'], linkages, place / 'like'))
    mirrored = own.get('mirrored', False)
    if not isinstance(mirrored, bool):
        raise ConfigError(f'{place / "mirrored"} = {mirrored!r}, must be true or false')
    return merge(_mirrored(base, place) if mirrored else base, values)


def _mirrored(base: Section, place: Place) -> Section:
    """Return a linkage of a joint whose angle is the negative one."""
    def negative(key: str) -> SourcedValue | None:
        entry = base.pop(key, None)
        if not isinstance(entry, SourcedValue) or not isinstance(entry.value, (int, float)):
            return None
        return replace(entry, value=-entry.value)
    sense, low, high = (negative(key) for key in ('sense', 'low_deg', 'high_deg'))
    if sense is None:
        raise ConfigError(
            f'{place / "mirrored"} is not used: the linkage has no sense that it changes')
    ends = {'sense': sense, 'low_deg': high, 'high_deg': low}
    return base | {key: entry for key, entry in ends.items() if entry is not None}


def _like(name: Any, linkages: Mapping[str, Section], place: Place) -> Section:
    """Return a linkage of the file, or LEG.JOINT of a packaged leg without its range."""
    if isinstance(name, str) and name in linkages:
        return linkages[name]
    leg, _, joint = str(name).partition('.')
    if leg in leg_names():
        section, _ = leg_section(leg, str(place))
        refuse_unknown([joint], JOINTS, Place(place.file, f'{place.key}.{leg}'))
        found = section[joint]
        assert isinstance(found, dict)
        return {key: value for key, value in found.items() if key not in ('low_deg', 'high_deg')}
    raise ConfigError(
        f'{place} = {name!r} is not a linkage of the file, nor LEG.JOINT of a packaged leg; '
        f'{alternatives(str(name), [*linkages, *(f"{own}.kfe" for own in leg_names())])}')
