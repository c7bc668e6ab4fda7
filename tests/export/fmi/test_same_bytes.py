"""A unit gives the bytes of the run, at every tick and in every output."""

from isa_ros.export.fmi.description import Version
import numpy as np
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import Unit  # noqa: E402
from tests.export.fmi.runs import inputs_of, OF_SUPPLY, RUNS, SAMPLED  # noqa: E402

pytestmark = pytest.mark.slow


def values(row, names):
    return np.array([row[name] for name in names.values()])


@pytest.mark.parametrize('version', Version)
@pytest.mark.parametrize('name', RUNS)
def test_every_output_of_every_tick_is_that_of_the_run(name, version, cases, tmp_path):
    case = cases(name)
    unit = Unit(case.paths[version], tmp_path / 'unit')
    has_port = case.chosen.config.load is None
    assert unit.numbers([*SAMPLED]).tobytes() == values(case.first[0], SAMPLED).tobytes()
    assert unit.numbers([*OF_SUPPLY]).tobytes() == values(case.first[1], OF_SUPPLY).tobytes()
    for k, tick in enumerate(case.ticks):
        unit.set(dict(inputs_of(tick, has_port)))
        unit.step()
        assert unit.numbers([*SAMPLED]).tobytes() == values(tick.sample, SAMPLED).tobytes(), k
        assert unit.numbers([*OF_SUPPLY]).tobytes() == values(tick.supply, OF_SUPPLY).tobytes(), k
    assert len(case.ticks) == 300 and unit.messages == []
    unit.close()
