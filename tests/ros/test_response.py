"""`isa bode` and `isa step` through running nodes agree with the bare actuator."""

import json
import math
from pathlib import Path
import subprocess
import sys

import numpy as np
import pytest

pytestmark = pytest.mark.ros
ROOT = Path(__file__).parents[2]
COMMON = ('smart_manifold', '--preset', 'table_4')
HOLD_S = 1e-3           # a setpoint is held for a tick
INTO_HOLD_S = 0.30e-3  # from the middle of the hold, 0.12 + 0.5 ms, to the conversion at 0.92
BARE_S = 0.1e-3         # half a period of the force block, in the bare measurement


def measured(path: Path, *arguments: str) -> dict:
    """Return the numbers of a command."""
    subprocess.run(
        [sys.executable, '-m', 'isa_ros', *arguments, '--json', str(path)], cwd=ROOT, check=True,
        capture_output=True, timeout=240)
    return json.loads(path.read_text())


@pytest.mark.parametrize('method', ['stepped', 'chirp'])
def test_a_bode_through_nodes_is_that_of_the_bare_actuator_behind_a_hold(
        domain: int, tmp_path: Path, method: str):
    band = (*COMMON, '--from', '10', '--to', '120', '--points', '5', '--method', method)
    nodes = measured(tmp_path / 'nodes.json', 'bode', *band, '--nodes')
    bare = measured(tmp_path / 'bare.json', 'bode', *band)
    f = np.array(bare['frequency_hz'])
    assert nodes['frequency_hz'] == pytest.approx(f, rel=1e-12)
    hold = np.sinc(f * HOLD_S)
    # Remaining: the samples' own quantisation and the images of the hold at 1 kHz - f, which
    # a loop 30 dB down there passes into the samples: 1 % of the gain; a deg for the same.
    assert np.array(nodes['gain']) / bare['gain'] == pytest.approx(hold, rel=0.01)
    later = 360.0 * f * (INTO_HOLD_S + BARE_S)
    assert np.array(nodes['phase_deg']) - bare['phase_deg'] == pytest.approx(later, abs=1.5)
    assert min(nodes['coherence']) > 0.99
    assert nodes['bandwidth_hz'] == pytest.approx(bare['bandwidth_hz'], rel=0.02)


def test_a_step_through_nodes_keeps_its_bag_and_its_figures(domain: int, tmp_path: Path):
    bag = tmp_path / 'bag'
    nodes = measured(tmp_path / 'nodes.json', 'step', *COMMON, '--nodes', '--bag', str(bag))
    bare = measured(tmp_path / 'bare.json', 'step', *COMMON)
    assert (bag / 'metadata.yaml').is_file()
    # straight lines between samples of 1 ms on a rise of 4 ms
    assert nodes['rise_time_s'] == pytest.approx(bare['rise_time_s'], abs=0.5e-3)
    # a peak between two samples: (w dt / 2)^2 / 2 with w = 2 pi 35 Hz is 0.6 % of the swing
    assert nodes['overshoot'] == pytest.approx(bare['overshoot'], abs=0.01)
    assert abs(nodes['steady_error']) < 0.2
    at_step = nodes['t_s'].index(0.0)
    assert nodes['reference'][at_step] == 0.0 and nodes['reference'][at_step + 1] == 17.0
    assert math.isclose(nodes['t_s'][-1], 0.5, rel_tol=1e-9)
