"""The times of a run on its grid."""

from pathlib import Path

from hypothesis import given, strategies as st
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.core.timebase import PLANT_STEP_NS
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


@pytest.mark.parametrize('step', ['0.25', '1.00001', '1.0000001', '0.02', '0'])
def test_macro_steps_off_the_grid_are_refused(tmp_path: Path, step: str) -> None:
    """A tick holds five equal force windows of whole plant steps: 0.1 ms."""
    with pytest.raises(ConfigError, match='rig.yaml: step_ms = '):
        load_run(rig(tmp_path, step=step))


STEP_NS = 1_000_000


def run_of(tmp_path: Path, **times_ns: int) -> RunConfig:
    """Return the run of a text with these times, which have the unit ns there."""
    path = tmp_path / 'resolved.yaml'
    path.write_text(load_run(rig(tmp_path)).to_yaml(), encoding='utf-8')
    return load_run(path, times_ns)


@pytest.mark.parametrize('offset_ns', [0, PLANT_STEP_NS, STEP_NS - PLANT_STEP_NS])
def test_an_offset_within_the_step_is_taken(tmp_path: Path, offset_ns: int) -> None:
    """A controller samples at k step + offset: from the tick itself to the last plant step."""
    assert run_of(tmp_path, controller_offset_ns=offset_ns).controller_offset_ns == offset_ns


@pytest.mark.parametrize(('offset_ns', 'bound'), [
    (STEP_NS, '< step_ns = 1000000 ns'), (STEP_NS + PLANT_STEP_NS, '< step_ns'),
    (-PLANT_STEP_NS, '>= 0 ns'), (PLANT_STEP_NS + 1, 'a multiple of the plant step 20000 ns')])
def test_an_offset_outside_the_step_or_between_plant_steps_is_refused(
        tmp_path: Path, offset_ns: int, bound: str) -> None:
    """At a whole step it would be the next tick's, whose command it must not yet have."""
    expected = f'controller_offset_ns = {offset_ns} ns, must be {bound}'
    with pytest.raises(ConfigError, match=expected):
        run_of(tmp_path, controller_offset_ns=offset_ns)


@pytest.mark.parametrize('step_ns', [0, -100_000, 90_000, 100_100_000])
def test_a_step_without_five_windows_of_plant_steps_is_refused(
        tmp_path: Path, step_ns: int) -> None:
    """Five windows of whole plant steps: multiples of 0.1 ms up to 100 ms."""
    with pytest.raises(ConfigError, match=r'resolved.yaml: step_ns = .* ns, must be'):
        run_of(tmp_path, step_ns=step_ns, controller_offset_ns=0)


@pytest.mark.parametrize('step_ns', [100_000, 700_000, 100_000_000])
def test_both_ends_of_the_range_are_taken(tmp_path: Path, step_ns: int) -> None:
    """The largest step is one that may be."""
    assert run_of(tmp_path, step_ns=step_ns, controller_offset_ns=0).step_ns == step_ns


@given(tick=st.integers(0, 10**9))
def test_every_tick_is_found_from_its_seconds(tick: int) -> None:
    """t_k = k H is exact in nanoseconds, and in seconds to a double's rounding."""
    assert ticks_in(tick * 1_000_000 / 1e9, 1_000_000, 't') == tick
