"""The times of a run on its grid."""

from pathlib import Path

from hypothesis import given, strategies as st
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.errors import ConfigError
import pytest
from tests.config.rig_file import rig


@pytest.mark.parametrize('step', ['0.1', '0.5', '2', '100'])
def test_macro_steps_on_the_grid_are_taken(tmp_path: Path, step: str) -> None:
    path = rig(tmp_path, step=step)
    if float(step) <= 0.12:
        with pytest.raises(ConfigError, match='controller_offset_ms = 0.12 ms, must be < step'):
            load_run(path)
    else:
        assert load_run(path).step_ns == round(float(step) * 1e6)


@pytest.mark.parametrize('step', ['0.25', '1.00001', '0.02', '0'])
def test_macro_steps_off_the_grid_are_refused(tmp_path: Path, step: str) -> None:
    """A tick holds five equal force windows of whole plant steps: 0.1 ms."""
    with pytest.raises(ConfigError, match='rig.yaml: step_ms = '):
        load_run(rig(tmp_path, step=step))


@given(tick=st.integers(0, 10**9))
def test_every_tick_is_found_from_its_seconds(tick: int) -> None:
    """t_k = k H is exact in nanoseconds, and in seconds to a double's rounding."""
    assert ticks_in(tick * 1_000_000 / 1e9, 1_000_000, 't') == tick
