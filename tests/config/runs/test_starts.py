"""Where a run begins: the pose of its leg, and the positions of its actuators."""

import math
from pathlib import Path

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
import pytest
from tests.config.rig_file import rig


def test_the_leg_puts_its_actuators_where_the_linkages_say() -> None:
    """
    Physics.md, section 2: knee extension 44.5 mm at -80 deg, piston = extension + 14.1 mm.

    The hip's slider-crank: L^2 = 356^2 + 45^2 - 2 356 45 cos(41.3 + 20 deg), x = L - 299 mm.
    """
    run = load_run(find('leg', CONFIG))
    positions = {a.name: a.initial_position for a in run.actuators}
    assert positions['kfe'] * 1e3 == pytest.approx(44.5 + 14.1, abs=0.05)  # 0.1 mm is printed
    length = math.sqrt(
        356.0**2 + 45.0**2 - 2.0 * 356.0 * 45.0 * math.cos(math.radians(41.3 + 20.0)))
    assert positions['hfe'] * 1e3 == pytest.approx(length - 299.0, rel=1e-12)


def test_initial_positions_are_si_and_mid_stroke_by_default(tmp_path: Path) -> None:
    ram = 'model: isa_v5, load: {kind: mass}, initial_position_mm: 30'
    run = load_run(rig(tmp_path, ram))
    assert run.actuator('ram').initial_position == pytest.approx(
        0.030, rel=1e-15, abs=0.0)
    assert run.actuator('rotor').initial_position == 0.5 * 1.745


def test_a_setpoint_may_be_due_every_tick(tmp_path: Path) -> None:
    """Shorter timeouts are refused, config/bad: one of a tick is met by a setpoint a tick."""
    ram = ('model: isa_v5, load: {kind: mass}, '
           'parameters: {reu: {protection: {setpoint_timeout_ms: 1}}}')
    run = load_run(rig(tmp_path, ram))
    assert run.step_ns == 1_000_000
    assert run.actuator('ram').sheet.reu.protection.setpoint_timeout_ms == 1.0
