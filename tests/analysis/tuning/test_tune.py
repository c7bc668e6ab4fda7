"""`isa tune`: margin and bandwidth as wanted, measured again from the file it writes."""

import json
import math
from pathlib import Path
from types import SimpleNamespace

from isa_ros.analysis.response.bode import Bode, bode
from isa_ros.analysis.response.rig import Choice, rig
from isa_ros.analysis.response.sweep import FrequencySweep
from isa_ros.analysis.tuning import tune
from isa_ros.analysis.tuning.design import Gains
from isa_ros.analysis.tuning.tune import (
    factors, held, NODES, schedule_through, STROKES, with_gains)
from isa_ros.cli import main as cli
from isa_ros.config.text.yaml_text import dump
from isa_ros.reu.block import Pid
import numpy as np
import pytest
from tests.sheets import actuator_sheet

MARGIN, BANDWIDTH = 60.0, 40.0      # the command's defaults
CYLINDER = {
    'name': 'press', 'step_ms': 1.0, 'controller_offset_ms': 0.12, 'tick_timeout_s': 5.0,
    'supply': {'kind': 'constant', 'pressure_mpa': 14.0, 'return_pressure_mpa': 0.0},
    'actuators': {'ram': {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'parameters': {
        'plant': {'drive': {'bore_mm': 40.0, 'rod_mm': 25.0, 'stroke_mm': 200.0},
                  'sensors': {'force_range': 20000.0}},
        'reu': {'position': {'force_out': 17590.0, 'force_in': 10720.0}}}}}}
"""Bore 40 mm, rod 25 mm, 14 MPa: A_A P_S = 17.6 kN, A_B P_S = 10.7 kN; the valve of the ISA v5."""


def measured(file: Path, share: float, factor: float) -> Bode:
    """Return the loop of a written file at a share of the stroke, as `isa bode` measures it."""
    sheet = rig(Choice(name=str(file), loop='force')).config.sheet
    unit = math.radians(1.0) if sheet.is_rotary else 1e-3
    bench = rig(Choice(
        name=str(file), loop='force', position=share * sheet.plant.drive.stroke / unit))
    return bode(bench, FrequencySweep(low=5.0 * factor, high=250.0 * factor, points=24), 'closed')


def is_as_wanted(found: Bode, margin: float, bandwidth: float) -> bool:
    """Return whether a loop is quiet, within 5 deg and within 10 % of what was wanted."""
    assert found.margins.phase is not None and found.bandwidth is not None
    return (abs(found.margins.phase - margin) <= 5.0
            and abs(found.bandwidth / bandwidth - 1.0) <= 0.1 and not found.rest.hunts)


def tuned(tmp_path: Path, name: str, *arguments: str) -> Path:
    """Tune and return the file that is written."""
    out = tmp_path / 'tuned.yaml'
    assert cli.main(['tune', name, *arguments, '--out', str(out)]) == 0
    return out


@pytest.mark.slow
def test_the_manifold_is_tuned_written_and_as_wanted(tmp_path: Path, capsys):
    """The file is a run that bring-up takes; the places in between are as wanted too."""
    numbers = tmp_path / 'tuned.json'
    out = tuned(tmp_path, 'smart_manifold', '--json', str(numbers))
    printed, found = capsys.readouterr().out, json.loads(numbers.read_text())
    assert found['is_reached'] and len(found['places']) == len(STROKES)
    assert all(f'{place["phase_margin_deg"]:.1f}' in printed for place in found['places'])
    comment = [line[2:] for line in out.read_text().splitlines() if line.startswith('# ')]
    assert comment[1:] == printed.splitlines()[:len(comment) - 1]
    block = rig(Choice(name=str(out), loop='force')).config.sheet.reu.force
    assert isinstance(block, Pid) and (block.kp, block.ki, block.kf) == tuple(
        found['force'][key] for key in ('kp', 'ki', 'kf'))
    for share in (0.15, 0.5, 0.85):
        assert is_as_wanted(measured(out, share, 1.0), MARGIN, BANDWIDTH), share


@pytest.mark.slow
def test_what_cannot_be_reached_is_one_line_with_what_can(tmp_path: Path, capsys):
    """The spool of the ISA v5 has 104 Hz: a loop of 150 Hz has no margin left."""
    out = tmp_path / 'tuned.yaml'
    assert cli.main(['tune', 'isa_v5', '--bandwidth', '150', '--strokes', '50',
                     '--out', str(out)]) == 1
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith('not reached: 60 deg and 150 Hz; farthest ')
    assert last.endswith(' Hz at 50 mm; no file is written') and not out.exists()


def test_a_loop_that_hunts_behind_a_load_holding_valve_is_told_how_to_be_tuned():
    own = rig(Choice(name='rig_counterbalance', loop='force'))
    assert held(own) == ('; its poppet opens and shuts: tune with '
                         '--set plant.holding_a.stuck_open=1')
    assert held(rig(Choice(name='rig_hoses', loop='force'))) == ''


@pytest.mark.long
@pytest.mark.parametrize(('name', 'margin', 'bandwidth'), [
    ('isa_v2', 60.0, 40.0), ('isa_v2', 60.0, 80.0), ('isa_v5', 60.0, 40.0),
    ('isa_v5', 50.0, 55.0), ('smart_manifold', 60.0, 40.0), ('smart_manifold', 50.0, 60.0),
    ('press.yaml', 60.0, 40.0), ('press.yaml', 50.0, 25.0)])
def test_every_actuator_is_as_wanted_over_its_stroke(tmp_path: Path, name, margin, bandwidth):
    """Within 5 deg and 10 %, without ripple: at the tuned places and between them."""
    if name == 'press.yaml':
        (tmp_path / name).write_text(dump(CYLINDER))
        name = str(tmp_path / name)
    out = tuned(
        tmp_path, name, '--phase-margin', f'{margin:g}', '--bandwidth', f'{bandwidth:g}')
    found = {share: measured(out, share, bandwidth / BANDWIDTH)
             for share in (*STROKES, 0.15, 0.4, 0.6, 0.85)}
    for share, response in found.items():
        print(f'{share:4.0%} {response.margins.phase:.1f} deg {response.bandwidth:.1f} Hz, '
              f'ripple {response.rest.share:.2g}')
    assert all(is_as_wanted(found[share], margin, bandwidth) for share in STROKES)
    # Between two nodes the stiffness is a parabola, the schedule a line: up to 6 % of the gain,
    # which is as much bandwidth, beside what is left at the nodes.
    assert all(abs(response.bandwidth / bandwidth - 1.0) <= 0.16 and not response.rest.hunts
               for response in found.values())


def test_a_schedule_passes_through_the_values_at_the_strokes():
    """Five places, five nodes: exact up to the weight of the bends, 1e-3 squared."""
    values = np.array([0.4, 0.8, 1.0, 0.9, 0.5])
    nodes = schedule_through(STROKES, values)
    assert np.interp(STROKES, NODES, nodes) == pytest.approx(values, abs=1e-5)


def test_a_schedule_of_one_place_is_even():
    assert schedule_through((0.5,), np.array([3e-8])) * 1e8 == pytest.approx(
        np.full(5, 3.0), rel=1e-3)


def test_gains_are_those_of_mid_stroke_and_rounded():
    """K_i is the corner times K_p; four digits are written."""
    block = actuator_sheet('isa_v5').reu.force
    assert isinstance(block, Pid)
    kp = 1.23456e-8 * np.array([0.5, 0.75, 1.0, 0.75, 0.5])
    found = with_gains(block, Gains(kf=1.98765e-3, corner=20.0, kp=kp), NODES.tolist())
    assert (found.kp, found.ki, found.kf) == (1.235e-8, 2.469e-7, 1.988e-3)
    assert factors(found) == pytest.approx([0.5, 0.75, 1.0, 0.75, 0.5], abs=1e-4)
    assert found.limit == block.limit and found.compensation == block.compensation


@pytest.mark.parametrize(('arguments', 'expected'), [
    (['isa_v5', '--phase-margin', '90'], '--phase-margin = 90 deg, must be 20 to 85 deg'),
    (['isa_v5', '--bandwidth', '1000'], '--bandwidth = 1000 Hz, must be < 1000 Hz'),
    (['isa_v5', '--strokes', '50', '120'], '--strokes 120, must be 0 to 100 %'),
    (['isa_v5', '--variant', 'feedback_linearisation'], 'reu.force.kind must be pid to be tuned'),
    (['rig_rotary_position'], 'rotor: reu.force is off, and gains of another block are not tuned; '
     'isa bode --loop position and isa step --loop position measure what a gain does'),
    (['leg.yaml'], 'several actuators, --actuator must name one')])
def test_what_cannot_be_tuned_is_one_line_and_2(arguments, expected, capsys):
    assert cli.main(['tune', *arguments]) == 2
    printed = capsys.readouterr()
    assert expected in printed.err and printed.err.count('\n') == 1
    assert printed.out == ''


def test_a_schedule_that_extrapolates_is_kept_near_its_values():
    """Two places: the straight line through them would be negative at the other end."""
    values = np.array([1.0, 0.1])
    nodes = schedule_through((0.25, 0.5), values)
    assert nodes.min() == 0.05      # half of the smallest value; the line ends at -1.7
    steep = schedule_through((0.5, 0.75), np.array([0.1, 2.0]))
    assert steep.max() <= 4.0 and steep.min() == 0.05


def test_the_first_gains_keep_the_ratio_of_the_block(monkeypatch: pytest.MonkeyPatch):
    """Each start that hunts is tried again with K_p and K_i a third of what they were."""
    block = actuator_sheet('isa_v5').reu.force
    assert isinstance(block, Pid) and block.ki > 0.0
    tried = []

    def hunting(self, tried_block):
        tried.append((tried_block.kp, tried_block.ki))
        return SimpleNamespace(hunts=True, reached=())
    monkeypatch.setattr(tune._Bench, 'measured', hunting)
    bench = tune._Bench.__new__(tune._Bench)
    bench._rig = SimpleNamespace(
        config=SimpleNamespace(name='isa_v5', sheet=actuator_sheet('isa_v5')))
    with pytest.raises(tune.NotReached):
        bench.start(block)
    assert [ki / kp for kp, ki in tried] == pytest.approx(
        [block.ki / block.kp] * tune.STARTS, rel=1e-12)
    assert tried[-1][0] == pytest.approx(block.kp / 3.0 ** (tune.STARTS - 1), rel=1e-12, abs=0.0)
