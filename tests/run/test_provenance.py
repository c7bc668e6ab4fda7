"""The digest of the kernels of a tick in the provenance of a bag."""

from importlib import import_module
import re

from isa_ros.bag.provenance import KERNELS, VERSION
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.core import kernel, kernel_key
from isa_ros.core.kernel_key import digest_of, kernel_digest
from isa_ros.run import provenance
from isa_ros.run.provenance import provenance_of, recorded_versions, tick_digest
from isa_ros.scenario.scenario import idle
import pytest

KERNELS_OF_TICK = list(provenance._kernels())


def fresh_digests(monkeypatch) -> dict[str, bytes]:
    """Return the digest of each kernel of a tick with the values of now, by name."""
    monkeypatch.setattr(kernel_key, '_read_once', kernel_key._read)
    return {f'{each.py_func.__module__}.{each.__name__}': kernel_digest(each)
            for each in KERNELS_OF_TICK}


def naming(module: str, name: str) -> set[str]:
    """Return the kernels that name a value of a module, or call a kernel that does."""
    found: set[str] = set()
    reached = [(import_module(module), name)]
    for owner, word in reached:
        alias = owner.__name__.rpartition('.')[2]
        for each in KERNELS_OF_TICK:
            place = import_module(each.py_func.__module__)
            is_meant = (vars(place).get(word) is vars(owner)[word]
                        or vars(place).get(alias) is owner)
            full = f'{place.__name__}.{each.__name__}'
            if is_meant and word in each.py_func.__code__.co_names and full not in found:
                found.add(full)
                reached.append((place, each.__name__))
    return found


@pytest.mark.parametrize(('module', 'name', 'value'), [
    ('isa_ros.core.timebase', 'PLANT_STEP_NS', 10_000), ('isa_ros.plant.energy', '_LN_2', 0.7),
    ('isa_ros.plant.friction', 'stribeck', None)])
def test_an_edit_changes_the_digests_of_what_uses_it(monkeypatch, module, name, value):
    before, owner = fresh_digests(monkeypatch), import_module(module)
    old, expected = vars(owner)[name], naming(module, name)
    for place in {import_module(each.py_func.__module__) for each in KERNELS_OF_TICK} | {owner}:
        if vars(place).get(name) is old:    # imported by name
            monkeypatch.setattr(place, name, value)
    after = fresh_digests(monkeypatch)
    changed = {kernel for kernel in before if before[kernel] != after[kernel]}
    assert changed == expected
    assert 'isa_ros.actuator.kernel.actuator_tick' in changed


def test_the_digest_of_the_tick_is_among_the_versions_of_a_bag():
    assert re.fullmatch('[0-9a-f]{16}', tick_digest())
    record = provenance_of(idle(load_run(shipped(CONFIG)['rig_rotary.yaml']))).record()
    assert record[VERSION + KERNELS] == tick_digest() == digest_of(KERNELS_OF_TICK).hex()[:16]


def test_without_compiling_there_is_no_digest(monkeypatch):
    """Kernels are plain functions then, and not found by their type."""
    monkeypatch.setattr(kernel, 'IS_COMPILED', False)
    assert KERNELS not in recorded_versions()
