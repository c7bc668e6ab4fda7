"""Unmodified masters, pysoem (SOEM) and KickCAT, in a namespace with a pair of interfaces."""

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest
from tests.fieldbus.ethercat.namespace import run

OP = 8
CYCLES = 200
KICKED = 1, 3, 12


@pytest.fixture(scope='module')
def kicked() -> Iterator[dict[int, Future[Any]]]:
    """Run KickCAT with so many slaves, side by side: it waits most of the time."""
    with ThreadPoolExecutor() as pool:
        yield {n: pool.submit(run, 'kick', str(n)) for n in KICKED}


@pytest.mark.parametrize(('n', 'filler'), [(1, 0), (3, 0), (12, 0), (12, 40)])
def test_soem_operates_slaves(n, filler):
    """Twelve slaves with 332 bytes each need three frames a cycle."""
    found = run('soem', str(n), str(filler))
    assert found['names'] == [f'toy {k}' for k in range(n)]
    assert found['ids'] == [[0xBAD, 1 + k, 1] for k in range(n)]
    assert found['counters'] == [found['expected']] == [3 * n]
    assert found['states'] == [[OP, 0]] * n
    ticks = {tick for tick, _ in found['inputs']}
    assert len(ticks) == 1 and ticks.pop() >= CYCLES - 1
    assert [position for _, position in found['inputs']] == [CYCLES - 2 + k for k in range(n)]


def test_soem_sees_a_clock_with_its_own_epoch_that_advances_by_ticks():
    found = run('soem', '3', '0')
    assert found['has_clocks']
    assert found['steps_ns'] == [1_000_000]
    assert abs(found['age_s']) < 60.0  # the time for starting up, on a busy host


def test_soem_reads_and_writes_objects():
    found = run('objects')
    assert found['name'] == 'toy 0'
    assert found['gain'] == 2.5
    assert found['is_text_back']
    assert found['identity'] == '0400' + 'ad0b0000' + 3 * '01000000'
    assert found['dictionary']['4120'] == ['identity', 5]
    assert len(found['dictionary']) == 16
    assert found['aborts'] == [0x06020000, 0x06090011, 0x06010001, 0x06010002, 0x06070013]
    assert found['file'] == 2


@pytest.mark.parametrize(
    'n', [KICKED[0], *(pytest.param(n, marks=pytest.mark.slow) for n in KICKED[1:])])
def test_kickcat_operates_slaves(n, kicked):
    found = kicked[n].result()
    assert found['sizes'] == [[6, 6]] * n
    assert found['identity'] == '0400' + 'ad0b0000' + 3 * '01000000'
    assert [position for _, position in found['inputs']] == [CYCLES - 2 + k for k in range(n)]
