"""Altered run files, scenarios and models are read or refused in one line."""

from isa_ros.config.text import key_tables, keys, parameter_sets
from isa_ros.core import parameter
import pytest
from tests.fuzz.property import Broken
from tests.fuzz.yaml_door import fuzz

CASES, MANY = 1500, 60_000


def test_every_file_is_read_or_refused_in_one_line():
    """Most are refused; some have only lost a key with a default."""
    assert CASES // 2 < fuzz(CASES, 1) < CASES


@pytest.mark.long
def test_every_one_of_many_files_is_read_or_refused():
    fuzz(MANY, 2)


def accept(self, tree, place):
    """Return a value of any type."""
    return tree


def unchecked(patch):
    """Accept every number."""
    for module in (parameter_sets, parameter):
        patch.setattr(module, 'check', lambda where, value, declared: None)


def any_kind(patch):
    """Look a kind up without a check."""
    for module in (keys, key_tables):
        patch.setattr(module, 'of_kind', lambda kind, kinds, place: kinds[kind])


@pytest.mark.parametrize('plant', [
    lambda patch: patch.setattr(keys.Value, 'read', accept),
    any_kind,
    unchecked,
    lambda patch: patch.setattr(key_tables, 'section_at', lambda tree, place: tree)])
def test_a_guard_that_is_missing_is_found(plant, monkeypatch):
    """Types of names, kinds and sections, and numbers that are not finite."""
    plant(monkeypatch)
    with pytest.raises(Broken):
        fuzz(CASES, 1)
