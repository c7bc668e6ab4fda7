"""The time of a step of a unit, beside that of a tick of the library in C."""

from time import perf_counter

from isa_ros.core.objects import own_target
from isa_ros.export.chosen import choose
from isa_ros.export.fmi.description import Version
from isa_ros.export.fmi.unit import archive, made, parts_of
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import Unit  # noqa: E402
from tests.export.libraries import Instance, Loaded, written  # noqa: E402

pytestmark = pytest.mark.slow
TICKS, ROUNDS = 500, 9
MOST = 2.0    # times; it is 1.1 on idle cores, with the calls from Python on both sides


def fastest(calls):
    """Return the least time of each call, s, in turn: others on the host only add to it."""
    found = [[] for _ in calls]
    for _ in range(ROUNDS):
        for call, times in zip(calls, found):
            begin = perf_counter()
            for _ in range(TICKS):
                call()
            times.append((perf_counter() - begin) / TICKS)
    return [min(times) for times in found]


def test_a_step_of_one_tick_takes_about_as_long_as_a_tick_of_the_library(tmp_path):
    parts = parts_of(choose('isa_v5', load='own'))
    (tmp_path / 'unit.fmu').write_bytes(archive(made(parts, own_target()), Version.FMI3))
    unit = Unit(tmp_path / 'unit.fmu', tmp_path / 'unit')
    library = Instance(Loaded(written(parts.own, tmp_path / 'library'), parts.own.word))
    assert library.start() == 0
    step, tick = fastest([unit.step, lambda: library.loaded.call(
        'tick', library.memory, None, None, None)])
    print(f'a step of the unit {1e6 * step:.1f} us, a tick of the library {1e6 * tick:.1f} us')
    assert library.t_ns == 1e9 * round(unit.reached, 6) == 1e6 * TICKS * ROUNDS
    assert step < MOST * tick
