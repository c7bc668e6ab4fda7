"""Settings of all tests, which of them run, and checks of what each leaves unchanged."""

from collections.abc import Generator, Iterator
import gc
import os
import signal
from typing import Any

from hypothesis import settings
from isa_ros.core.openblas import without_threads
import pytest
from tests.approximation import refusing_approx
from tests.garbage import uncollected
from tests.quick import is_quick, left_out

# The first call of a kernel compiles it, which would exceed a deadline; the same examples on
# every run, so that a failure is reproducible.
settings.register_profile('isa_ros', deadline=None, derandomize=True)
settings.load_profile('isa_ros')

_CHANGING = ('PYTEST_CURRENT_TEST',)  # at every phase of a test
_NO_DOMAIN = 'none: tests.ros.domains.held_domain'


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options that `./isa test` passes on."""
    parser.addoption('--long', action='store_true', help='run the tests marked long, no others')
    parser.addoption('--quick', action='store_true', help='run what tests/quick.py says')


def pytest_configure() -> None:
    """
    Set what workers and processes that tests start have.

    A ROS_DOMAIN_ID that is refused, as a test that starts nodes holds a domain of its own; and no
    threads for matrices: other workers have the cores.
    """
    os.environ['ROS_DOMAIN_ID'] = _NO_DOMAIN
    without_threads()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Distribute files, in the order of `long_files_first`."""
    from tests.scheduling import ByFile
    config.option.loadscopereorder = False
    return ByFile(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Generator[None, object, object]:
    """
    Collect 12,000 tests in two thirds of the time; of all, workers rewrite each file once.

    Tests and modules stay: the collections of garbage that follow leave them out.
    """
    with uncollected():
        config = session.config
        if _is_worker(config) and config.args == config.getini('testpaths'):
            from tests.scheduling import import_share
            import_share(config)
        found = yield
        gc.freeze()
        return found


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the long tests, or all others; a worker's tests are sorted for the scheduler."""
    chosen, others = [], []
    names = left_out() if config.getoption('--quick') else None
    for item in items:
        is_long = item.get_closest_marker('long') is not None
        is_chosen = is_long == config.getoption('--long') and (
            names is None or is_quick(item, names))
        (chosen if is_chosen else others).append(item)
    if others:
        config.hook.pytest_deselected(items=others)
        items[:] = chosen
    if _is_worker(config):
        from tests.scheduling import long_files_first
        long_files_first(items)


def _is_worker(config: pytest.Config) -> bool:
    return hasattr(config, 'workerinput')


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


@pytest.fixture
def heard_hang_up() -> Iterator[None]:
    """Let SIGHUP end what a test starts; a suite under nohup ignores it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.fixture(scope='session')
def window() -> Iterator[Any]:
    """Return a window of a browser, which all tests of this process use."""
    from tests.browser import chromium
    with chromium() as own:
        yield own


@pytest.fixture
def browser(window: Any) -> Iterator[Any]:
    """Return the window, which shows nothing and has reported nothing, as it does afterwards."""
    yield window
    window.visit('about:blank', is_drawn=False)
    window.log()


@pytest.fixture(scope='session', autouse=True)
def large_kernels_of_tests() -> Iterator[None]:
    """Have large kernels of tests lowered, as those of the package are."""
    from isa_ros.core.large_kernels import PACKAGES
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr('isa_ros.core.large_kernels.PACKAGES', [*PACKAGES, 'tests'])
        yield


@pytest.fixture(scope='session')
def compiled_kernels() -> None:
    """Wait until the kernels are compiled."""
    from tests.kernels import compile_kernels
    compile_kernels()


@pytest.fixture(autouse=True)
def kernels_compiled_once(request: pytest.FixtureRequest) -> None:
    """Let one of several workers compile; a process alone compiles what its tests need."""
    if not _is_worker(request.config):
        return
    from tests.scheduling import needs_kernels
    if needs_kernels(request.node):
        request.getfixturevalue('compiled_kernels')
