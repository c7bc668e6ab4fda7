"""A unit gives the bytes of the run, at every tick and in every output."""

import isa_ros
from isa_ros.core.device import FIELDS
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


@pytest.mark.parametrize('name', ['own_load', 'port'])
def test_the_outputs_are_those_of_the_bag(name, cases, tmp_path):
    """What a bag has of every tick; what it has of changes alone is left out."""
    case = cases(name)
    bag = isa_ros.read(case.run.simulate().save(tmp_path / 'bag'))
    recorded = bag.log.samples[:, case.chosen.row]
    unit = Unit(case.paths[Version.FMI3], tmp_path / 'unit')
    found = [unit.numbers([*SAMPLED])]
    for tick in case.ticks:
        unit.set(dict(inputs_of(tick, name == 'port')))
        unit.step()
        found.append(unit.numbers([*SAMPLED]))
    own = dict(zip(SAMPLED, np.transpose(found)))
    names = [one for one in own if one not in (*FIELDS, 'largest_cavity')
             and not np.isnan(recorded[one]).any()]
    assert len(recorded) == 301 and len(names) >= 14
    for one in names:
        assert own[one].tobytes() == recorded[one].tobytes(), one
