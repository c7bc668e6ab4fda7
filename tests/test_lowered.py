"""Large kernels of tests are lowered, and small ones are not."""

from isa_ros.core import kernel as kernels
from isa_ros.core.kernel import kernel, KernelEntry
from isa_ros.core.kinds import kind_of
import numpy as np
import pytest
from tests import lowered
from tests.lowered import is_large, large_kernels_lowered


@kernel
def third(x):
    return x / 3.0


def fill(x, table):
    """Fill a table with thirds; return the last one and how many."""
    for k in range(len(table)):
        table[k] = third(x + k)
    return table[-1], len(table)


@kernel
def lowered_thirds(x, table):
    """As `fill`."""
    for k in range(len(table)):
        table[k] = third(x + k)
    return table[-1], len(table)


@kernel
def compiled_thirds(x, table):
    """As `fill`."""
    for k in range(len(table)):
        table[k] = third(x + k)
    return table[-1], len(table)


@pytest.mark.parametrize(('own', 'many', 'is_lowered'), [
    (lowered_thirds, 2, True), (compiled_thirds, 3, False)], ids=['many', 'few'])
def test_a_kernel_of_many_gives_its_bytes_by_a_process(monkeypatch, own, many, is_lowered):
    asked = []
    made = lowered.objects_of_entries
    monkeypatch.setattr(lowered, 'objects_of_entries', lambda groups, target: (
        asked.extend(groups), made(groups, target))[1])
    monkeypatch.setattr(lowered, 'MANY', many)
    table, expected = np.zeros(5), np.zeros(5)
    with large_kernels_lowered():
        for x in (1.7, -0.3):
            assert own(x, table) == fill(x, expected)
            assert table.tobytes() == expected.tobytes()
    assert len(asked) == is_lowered
    assert kernels.call_in_library(KernelEntry(own, kind_of((1.7, table)), True)) is None


def test_the_step_of_the_plant_is_large():
    from isa_ros.actuator.integration import rk4_steps
    assert is_large(KernelEntry(rk4_steps, kind_of(()), True))
