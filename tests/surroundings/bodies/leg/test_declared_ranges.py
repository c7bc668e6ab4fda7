"""
The parameters of leg, joints and ground at the ends of their declared ranges.

Each shipped leg falls 5 mm with its actuators, with one parameter or a random pair of them at
an end: for 50 ms everything stays finite, or one line names what is refused and its bound.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields
import random

from isa_ros.config.paths import find, SCENARIOS
from isa_ros.config.text.yaml_text import read
from isa_ros.core.parameter import Parameters
from isa_ros.errors import IsaError, SimulationDiverged
from isa_ros.scripting.run import load, Run
from isa_ros.surroundings.bodies.leg.sheet import JOINTS
import numpy as np
import pytest
from tests.legs import leg_sheet

DURATION = 0.05    # s
SMALLEST = 1e-9    # of a parameter that must be > 0
PAIRS = 30
CONFIGS = {'leg': 'hyq_real', 'hyq_leg': 'hyq'}


def ends(sheet: Parameters, path: str = '') -> Iterator[tuple[str, float]]:
    """Yield the dotted path of every number below a sheet with each end of its range."""
    for f in fields(sheet):
        value = getattr(sheet, f.name)
        if isinstance(value, Parameters):
            yield from ends(value, f'{path}{f.name}.')
            continue
        bounds = f.metadata['bounds']
        yield f'{path}{f.name}', bounds['ge'] if 'ge' in bounds else bounds['gt'] + SMALLEST
        yield f'{path}{f.name}', bounds['le']


def singles(model: str) -> list[dict[str, float]]:
    """Return every change of one parameter of a leg."""
    return [{path: value} for path, value in ends(leg_sheet(model))]


def pairs(model: str) -> list[dict[str, float]]:
    """Return random changes of two parameters of links and ground: joints' mostly do not close."""
    found = [each for each in ends(leg_sheet(model)) if each[0].split('.')[0] not in JOINTS]
    return [dict(random.Random(seed).sample(found, 2)) for seed in range(PAIRS)]


def drop(config: str) -> Run:
    """Return a drop of a shipped leg from 5 mm, let go at once."""
    scenario = read(find('drop', SCENARIOS))
    return load(config, scenario | {'leg': {'foot_height_mm': 5.0, 'release_s': 0.0}})


def outcome(run: Run, changes: Mapping[str, float]) -> str:
    """Return the line with which the run is refused; '' for one that stays finite."""
    try:
        result = run.replace(
            {f'leg.parameters.{path}': value for path, value in changes.items()}
        ).simulate(DURATION)
    except SimulationDiverged:
        raise
    except IsaError as error:
        return str(error)
    for name, column in result.items():
        assert np.isfinite(column).all(), name
    return ''


@pytest.mark.slow
@pytest.mark.parametrize('chosen', [singles, pairs])
@pytest.mark.parametrize('config', CONFIGS)
def test_every_leg_of_its_ranges_runs_or_is_refused_by_name(config, chosen):
    """
    A refusal has the joint or section that was changed, and what must hold.

    It may concern a joint as a whole: its lever over its range, or where its actuator starts.
    """
    run, refused = drop(config), 0
    changed = chosen(CONFIGS[config])
    for changes in changed:
        line = outcome(run, changes)
        if line:
            refused += 1
            assert 'must ' in line, line
            assert any(path.split('.')[-2] in line for path in changes), line
    assert refused < len(changed) / 2


def test_the_ranges_have_ends_on_both_sides():
    """Every number of a leg is bounded below and above: 57 of the HyQ-REAL, 114 ends."""
    found = list(ends(leg_sheet('hyq_real')))
    assert len(found) == 2 * len({path for path, _ in found})
    assert all(np.isfinite(value) for _, value in found)
