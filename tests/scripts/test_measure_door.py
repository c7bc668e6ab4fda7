"""Bodies behind the door are as exact as docs/door.md says."""

import numpy as np
import pytest
from scripts.measure_door import (
    BOUND, crane_errors, errors, GIVEN, leg_errors, LOOK_AHEAD, means, PAGE)


def test_errors_are_shares_of_the_reference() -> None:
    reference = np.array([[3.0, -2.0], [-4.0, 0.0]])
    found = errors(reference + [[0.0, 0.4], [0.5, 0.0]], reference)
    assert found.rms == pytest.approx([0.5 / 5.0, 0.4 / 2.0])
    assert found.largest == pytest.approx([0.125, 0.2])
    assert found.peak == pytest.approx([-0.125, -0.2])


def test_means_of_short_ticks_are_those_of_long_ones() -> None:
    """A tick of 0.2 ms is one mean, one of 1 ms five, two of 0.1 ms make one."""
    fifths = np.arange(5.0)[:, np.newaxis]
    assert means([fifths], 1e-3).tolist() == fifths.tolist()
    assert means([fifths, fifths + 10.0], 2e-4).tolist() == [[2.0], [12.0]]
    assert means([fifths, fifths + 10.0], 1e-4).tolist() == [[7.0]]


@pytest.mark.slow
def test_the_leg_behind_the_door_drops_as_the_leg() -> None:
    """
    Knee, shipped cell: 0.2 % rms, 1.5 % of the peak at most, as the issue asks; 0.13 and 1.1 here.

    Against its own port with the same ticks the joints are as close; HAA, which bears 3.6 Nm rms,
    to the step of a converter, 0.5 %. Without a look-ahead the knee is off by more than 1 %, so
    the bound is one of the port.
    """
    found = {port: (own, apart) for port, own, apart in leg_errors({}, (LOOK_AHEAD, GIVEN))}
    own, apart = found[LOOK_AHEAD]
    assert own.rms[2] < 2e-3 and own.largest[2] < 1.5e-2
    assert (apart.rms < [1e-2, 2e-3, 2e-3]).all() and apart.largest.max() < 1.5e-2
    assert found[GIVEN][0].rms[2] > 1e-2
    assert 0.0 < found['own, compiled'][0].rms[2] < 2e-3


@pytest.mark.long
def test_the_crane_in_mujoco_is_within_its_bounds() -> None:
    """1.2, 0.25 and 2.5 % rms with RK4 at a fifth of the tick; 1.00, 0.18, 2.35 here."""
    pytest.importorskip('mujoco', reason='no wheel for this Python')
    (_, found), = crane_errors(None, [BOUND])
    assert (found.rms < [1.2e-2, 2.5e-3, 2.5e-2]).all()


def test_the_page_has_the_tables_of_the_script() -> None:
    """Each part has the bound's row, and the page names the command."""
    page = PAGE.read_text(encoding='utf-8')
    assert 'python -m scripts.measure_door --write' in page
    assert '| shipped | 1 | look-ahead | RK4, 0.2 ms |' in page
    assert '| shipped | own, compiled |' in page and '| mj_forward |' in page
