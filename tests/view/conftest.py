"""A browser for the tests of pages."""

from collections.abc import Iterator

import pytest
from tests.browser import Browser, chromium


@pytest.fixture(scope='session')
def window() -> Iterator[Browser]:
    """Return a window that all tests of this process use."""
    with chromium() as own:
        yield own


@pytest.fixture
def browser(window: Browser) -> Iterator[Browser]:
    """Return the window, which shows nothing and has reported nothing, as it does afterwards."""
    yield window
    window.visit('about:blank', is_drawn=False)
    window.log()
