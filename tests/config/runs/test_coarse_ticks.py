"""Ticks too long for the impacts of a leg on its ground are reported before the run."""

import isa_ros
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.scenario.scenario import idle
import pytest


def leg(ground: str, step_ms: float) -> RunConfig:
    """Return the shipped leg on a material, with another tick."""
    return isa_ros.load('leg').replace({'leg.ground': ground, 'step_ms': step_ms}).configuration


def coarse_ticks(run: RunConfig) -> tuple[str, ...]:
    """Return the lines on impacts that are printed before a run."""
    return tuple(line for line in idle(run).warnings if 'an impact lasts' in line)


def test_metal_at_a_millisecond_names_stiffness_tick_and_remedy() -> None:
    line, = coarse_ticks(leg('metal', 1.0))
    assert line == (
        'leg.yaml: on the ground of the leg, stiffness = 1e+08 N/m^1.5, an impact lasts 1.8 ms, '
        '1.8 ticks of step_ms = 1: its peak forces may be several percent wrong; use step_ms: 0.2 '
        '(docs/impacts.md)')


@pytest.mark.parametrize(('ground', 'step_ms'), [
    ('rubber', 1.0), ('wood', 1.0), ('metal', 0.5), ('metal', 0.2)])
def test_what_the_page_has_within_about_a_percent_says_nothing(
        ground: str, step_ms: float) -> None:
    assert coarse_ticks(leg(ground, step_ms)) == ()


@pytest.mark.parametrize(('stiffness', 'step_ms', 'remedy'), [
    (4e7, 1.0, 0.5), (3e8, 0.5, 0.2), (1e9, 0.2, None), (1e9, 1.0, 0.1)])
def test_the_tick_that_is_enough_follows_from_the_ground(stiffness, step_ms, remedy) -> None:
    lines = coarse_ticks(isa_ros.load('leg').replace({
        'leg.parameters.ground.stiffness': stiffness, 'step_ms': step_ms}).configuration)
    assert len(lines) == (remedy is not None)
    assert all(f'use step_ms: {remedy:g} (' in line for line in lines)


@pytest.mark.parametrize('name', shipped(CONFIG))
def test_no_shipped_run_is_reported(name: str) -> None:
    assert coarse_ticks(load_run(shipped(CONFIG)[name])) == ()


def test_a_run_in_memory_warns_before_it_begins() -> None:
    run = isa_ros.load('leg').replace({'leg.ground': 'metal'})
    with pytest.warns(UserWarning, match='an impact lasts 1.8 ms, 1.8 ticks of step_ms = 1'):
        run.simulate(0.001)
