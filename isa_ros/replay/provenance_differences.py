"""Differences between the provenance of two runs: configuration, scenario, versions."""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.bag.provenance import (
    BODY, CONFIGURATION, have_comparable_kernels, KERNELS, Provenance, SCENARIO, VERSION,
    versions_of)
from isa_ros.bag.reader import Bag
from isa_ros.config.differences import (
    configuration_differences, DifferingKey, section_differences)
from isa_ros.config.text.yaml_text import parse, Tree

_DIGESTS = (f'{CONFIGURATION}.sha256', f'{SCENARIO}.sha256')   # of texts compared by key


class Records(NamedTuple):
    """Provenance as a bag has it, perhaps of another version; ``name`` is for messages."""

    name: str
    attachments: Mapping[str, bytes]
    record: Mapping[str, str]

    def section(self, attachment: str) -> Tree:
        """Return an attached YAML text, empty if it is missing."""
        text = self.attachments.get(attachment, b'{}').decode('utf-8', 'replace')
        return parse(text, f'{self.name}: {attachment}')


def records_of_bag(bag: Bag) -> Records | None:
    """Return the records of a bag, None for that of another recorder."""
    return Records(str(bag.path), *bag.provenance_records) if bag.has_provenance else None


def records_of(provenance: Provenance, name: str) -> Records:
    """Return the records that the bag of a run would have."""
    return Records(name, provenance.attachments(), provenance.record())


def provenance_differences(
        expected: Records | None, actual: Records | None) -> list[DifferingKey] | None:
    """
    Return the keys in which the provenance of two runs differs, None if neither has one.

    What external bodies say of themselves comes first, then keys of the configuration, those of
    the scenario after ``scenario.``, versions and other entries of the record.

    Raises
    ------
    ConfigError
        A configuration or scenario is not a YAML section.

    """
    if expected is None or actual is None:
        texts = [None if records is None else 'present' for records in (expected, actual)]
        return None if expected is actual else [DifferingKey('provenance', texts[0], texts[1])]
    found = configuration_differences(
        expected.section(CONFIGURATION), actual.section(CONFIGURATION))
    found += [key._replace(key=f'scenario.{key.key}') for key in section_differences(
        expected.section(SCENARIO), actual.section(SCENARIO))]
    left_out = set(_DIGESTS)
    if not have_comparable_kernels(versions_of(expected.record), versions_of(actual.record)):
        left_out.add(VERSION + KERNELS)
    other = [key for key in section_differences(expected.record, actual.record)
             if key.key not in left_out]
    bodies = [key for key in other if key.key.startswith(BODY)]
    return [*bodies, *found, *(key for key in other if key not in bodies)]
