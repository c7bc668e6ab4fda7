"""Altered saved states are read as they were stored, or refused in one line."""

from collections.abc import Callable

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core import saved_state
from isa_ros.core.saved_state import RunState
import pytest
from tests.fuzz.property import Broken
from tests.fuzz.state_door import fuzz_contents, fuzz_texts, Saved

CASES, MANY = 1500, 50_000
FUZZERS = pytest.mark.parametrize('fuzz', [fuzz_texts, fuzz_contents])


@pytest.fixture(scope='module')
def saved() -> Saved:
    return Saved(load_run(find('rig_rotary.yaml', CONFIG)))


@pytest.mark.parametrize('fuzz, most', [(fuzz_texts, 1.0), (fuzz_contents, 0.9)])
def test_what_is_altered_is_read_as_stored_or_refused(
        fuzz: Callable[..., int], most: float, saved: Saved) -> None:
    """A run must go on from some altered contents: otherwise nothing behind reading is tested."""
    assert 0 < fuzz(saved, CASES, 1) <= most * CASES


@pytest.mark.long
@FUZZERS
def test_every_one_of_many_cases_is_read_or_refused(
        fuzz: Callable[..., int], saved: Saved) -> None:
    print(f'{fuzz.__name__}: {fuzz(saved, MANY, 1_000_000)} of {MANY} refused')


class Anything:
    """Equal to every checksum."""

    def __eq__(self, other: object) -> bool:
        return True


@pytest.mark.parametrize('fuzz, plant', [
    (fuzz_texts, lambda patch: patch.setattr(saved_state, '_checksum', lambda tree: Anything())),
    (fuzz_texts, lambda patch: patch.setattr(saved_state, 'ConfigError', ZeroDivisionError)),
    (fuzz_contents, lambda patch: patch.setattr(
        saved_state, 'first_not_finite', lambda *given: None)),
    (fuzz_contents, lambda patch: patch.setattr(
        RunState, 'rows_of_requests', lambda self, n: saved_state.restored_rows(
            self.requests, saved_state.COMMAND, n, 0, 'requests')))],
    ids=['checksum', 'error', 'finite', 'requests'])
def test_a_guard_that_is_missing_is_found(
        fuzz: Callable[..., int], plant: Callable[[pytest.MonkeyPatch], None], saved: Saved,
        monkeypatch: pytest.MonkeyPatch) -> None:
    plant(monkeypatch)
    with pytest.raises(Broken):
        fuzz(saved, CASES, 1)
