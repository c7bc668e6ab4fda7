"""
Differences between a bag and this installation, one line each.

They are versions, the format of the provenance, and keys of the configuration. Differences
that prevent a simulation are found before it starts.
"""

from collections.abc import Iterator, Mapping, Sequence
import re
from typing import NamedTuple

from isa_ros.bag.provenance import (
    CONFIGURATION, FORMAT, have_comparable_kernels, KERNELS, PYTHON, versions_of, without_patch)
from isa_ros.bag.reader import Bag
from isa_ros.config.differences import key_differences
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.topic import Topic
from isa_ros.errors import BagError
from isa_ros.replay.releases import release_that_replays
from isa_ros.run.provenance import recorded_versions
from msg_adapters.definitions import definition

_NAMED = 3  # obstacles listed in the error message
_ACTUATOR = re.compile(r'actuators\.[^.]+\.')


class InstallationDifference(NamedTuple):
    """One difference."""

    text: str
    is_obstacle: bool
    """The run cannot be simulated by this installation."""


def differences(bag: Bag) -> list[InstallationDifference]:
    """
    Return the differences between the installation that recorded a bag and this one.

    Raises
    ------
    BagError
        The bag was not recorded by this package.
    ConfigError
        Its configuration is not a YAML section.

    """
    attachments, record = bag.provenance_records
    found = [InstallationDifference(line, False) for line in _changed_versions(record)]
    if record.get('format') != FORMAT:
        found.append(InstallationDifference(
            f'the format of the provenance is {record.get("format")!r}, here {FORMAT!r}', True))
    if CONFIGURATION in attachments:
        text = attachments[CONFIGURATION].decode('utf-8', 'replace')
        found += [InstallationDifference(*difference) for difference in key_differences(
            parse(text, CONFIGURATION), Place(CONFIGURATION))]
    return found


def obstacles(found: Sequence[InstallationDifference]) -> list[str]:
    """Return the lines that say why a bag cannot be simulated here, sorted; [] if it can."""
    return grouped([difference.text for difference in found if difference.is_obstacle])


def refuse_obstacles(bag: Bag, lines: Sequence[str]) -> None:
    """
    Refuse a bag that cannot be simulated here, for these reasons, if there are any.

    Raises
    ------
    BagError
        The message has the first few.

    """
    if lines:
        more = len(lines) - _NAMED
        reasons = '; '.join(lines[:_NAMED]) + (f'; and {more} more' if more > 0 else '')
        release = release_that_replays(bag.path, versions_of(bag.provenance_records[1]))
        raise BagError(f'{bag.path}: cannot be simulated by this version: {reasons}; '
                       f'{release and f"{release}; "}`isa report` and isa_ros.read show what it '
                       'recorded')


def grouped(lines: Sequence[str]) -> list[str]:
    """Return sorted lines, of those that differ by the actuator one that says of how many."""
    alike: dict[str, list[str]] = {}
    for line in lines:
        alike.setdefault(_ACTUATOR.sub('actuators.*.', line), []).append(line)
    return sorted(f'{line} ({len(own)} times)' if len(own) > 1 else own[0]
                  for line, own in alike.items())


class TopicDifferences(NamedTuple):
    """Topics that differ between a bag and this version."""

    lines: list[str]
    unconfirmed: list[str]
    """Topics of the bag that cannot be compared by this version."""
    compared: frozenset[str]


def topic_differences(bag: Bag, topics: list[Topic]) -> TopicDifferences:
    """Return the differences between the topics of a bag and those its run records here."""
    here = {topic.name: topic.type_name for topic in topics}
    lines, unconfirmed = [], []
    for topic, type_name in sorted(bag.types.items()):
        reason = None
        if topic not in here:
            reason = f'{topic} is unknown here'
        elif type_name != here[topic]:
            reason = f'{topic} is {type_name} in the bag, {here[topic]} here'
        elif bag.type_hashes[topic] not in ('', definition(type_name).type_hash):
            reason = f'{topic} is another {type_name} in the bag than here'
        if reason is not None:
            lines.append(f'{reason}, so it is not compared')
            unconfirmed.append(topic)
    lines += [f'{topic} is missing in the bag' for topic in sorted(set(here) - set(bag.types))]
    return TopicDifferences(
        lines, unconfirmed, frozenset(set(here) & set(bag.types) - set(unconfirmed)))


def _changed_versions(record: Mapping[str, str]) -> Iterator[str]:
    here, there = recorded_versions(), versions_of(record)
    if not have_comparable_kernels(here, there):
        here, there = ({name: value for name, value in versions.items() if name != KERNELS}
                       for versions in (here, there))
    if PYTHON in there:  # bags of before have its patch release too
        there[PYTHON] = without_patch(there[PYTHON])
    for name in [*there, *sorted(set(here) - set(there))]:
        if here.get(name) != there.get(name):
            yield (f'{name} is {here.get(name, "not known")} here, was '
                   f'{there.get(name, "not recorded")}')
