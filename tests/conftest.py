"""Settings of all tests, and a check that each leaves the environment unchanged."""

from collections.abc import Iterator
import os

from hypothesis import settings
import pytest
from tests.approximation import refusing_approx

# The first call of a kernel compiles it, which would exceed a deadline; the same examples on
# every run, so that a failure is reproducible.
settings.register_profile('isa_ros', deadline=None, derandomize=True)
settings.load_profile('isa_ros')

# pytest changes the first at every phase of a test, the first import of a kernel sets the second.
_CHANGING = ('PYTEST_CURRENT_TEST', 'NUMBA_CACHE_DIR')


@pytest.fixture(autouse=True)
def approx_states_its_tolerance() -> Iterator[None]:
    """Refuse `pytest.approx` with a default tolerance that is wider than the number."""
    with pytest.MonkeyPatch.context() as patch:  # its own: a test's ends before others look
        patch.setattr(pytest, 'approx', refusing_approx)
        yield


def _environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name not in _CHANGING}


@pytest.fixture(autouse=True)
def same_environment() -> Iterator[None]:
    """Fail a test that leaves the environment changed for the processes of later ones."""
    before = _environment()
    yield
    assert _environment() == before
