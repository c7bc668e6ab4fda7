"""The plant's fixed step against scipy's adaptive one, on smooth pieces and across kinks."""

from isa_ros.analysis.accuracy import agreement
import pytest
from tests.sheets import MODELS

FLOOR = 1e-9  # error of scipy's tolerance, if a state has been larger before
SMOOTH, SINE, STEPS = agreement.PIECES
parametrized = pytest.mark.parametrize(
    ('model', 'load'), [(model, load) for model in MODELS for load in agreement.LOADS])


def relative(model: str, load: str, piece: agreement.Piece, h: float = 20e-6) -> dict[str, float]:
    """Return the relative difference of every state of one piece."""
    return {found.state: found.relative for found in agreement.compare(model, load, piece, h)}


@parametrized
def test_a_smooth_piece_is_exact_to_nine_digits(model, load):
    """
    Pressures and positions; 2e-11 by physics.md.

    RK4 has an error of (p_c h)^4/120 of a jump at the pole p_c = 2000/s, so its integral
    lacks 1e-11 s of the jump: of 0.4 of the current over 10 ms, 4e-10.
    """
    found = relative(model, load, SMOOTH)
    for state in ('plant.chambers.p_a', 'plant.chambers.p_b', 'plant.mechanics.position',
                  'load.position'):
        assert found[state] < 4e-10, state


@parametrized
def test_smooth_differences_fall_with_the_fourth_power_of_the_step(model, load):
    """A tenth of the step: 1e-4 of every state's difference, down to scipy's own error."""
    coarse, fine = (relative(model, load, SMOOTH, h) for h in (20e-6, 2e-6))
    for state, difference in coarse.items():
        assert fine[state] < 1e-3 * difference + FLOOR, state


@pytest.mark.parametrize('load', agreement.LOADS)
@pytest.mark.parametrize('model', ['smart_manifold', 'isa_v5'])
def test_null_and_dual_gain_point_leave_a_millionth_of_the_pressure(model, load):
    """
    A slope that jumps by J within a step causes an error of up to J h^2/8.

    At null a land of 0.19 m3/s per m of spool closes as another opens, at 4.5 mm/s of spool
    speed; on some 15 ml of oil that is J = 7e10 Pa/s2 and 3.5 Pa, at the dual-gain point 5.25
    times as much: 1e-6 of the supply pressure.
    """
    found = relative(model, load, SINE)
    assert found['plant.chambers.p_a'] < 1e-6
    assert found['plant.chambers.p_b'] < 1e-6
    assert found['load.position'] < 1e-6


@pytest.mark.parametrize('piece', [SINE, STEPS], ids=lambda piece: piece.name)
@parametrized
def test_differences_across_kinks_are_those_of_the_step(model, load, piece):
    """A tenth of the step: 1/100 of the error of a kink, 1/10 of that of a jump."""
    coarse, fine = (max(relative(model, load, piece, h).values()) for h in (20e-6, 2e-6))
    assert FLOOR < fine < 0.1 * coarse


def test_all_pieces_and_states_are_reported():
    """The sensor force and every state, on each load."""
    found = agreement.agreement('isa_v5')
    names = {difference.name for difference in found}
    assert len(names) == len(found)
    assert {f'{piece.name}, {load}: sensor force'
            for piece in agreement.PIECES for load in agreement.LOADS} <= names
