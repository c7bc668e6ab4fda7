"""A headless Chromium for tests of pages, driven over WebDriver (W3C) without another package."""

from collections.abc import Iterator
from contextlib import contextmanager
import json
import os
from pathlib import Path
import re
import shutil
import subprocess
import time
from typing import Any
from urllib.request import Request, urlopen

import pytest

_PORT = re.compile(r'started successfully on port (\d+)')
_DEADLINE = 30.0    # s
_PROGRAMS = 'chromium', 'google-chrome'    # of Debian, and of the servers of CI
_ARGUMENTS = ('--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage',
              '--disable-background-networking', '--no-first-run')


class Browser:
    """One window."""

    def __init__(self, program: str, port: int) -> None:
        self._session = f'http://127.0.0.1:{port}/session'
        answer = self._call('POST', '', {'capabilities': {'alwaysMatch': {
            'browserName': 'chrome', 'goog:loggingPrefs': {'browser': 'ALL'},
            'goog:chromeOptions': {'binary': program,
                                   'args': [*_ARGUMENTS, '--window-size=1300,900']}}}})
        self._session += f'/{answer["sessionId"]}'

    def load(self, page: Path) -> None:
        """Load a file and wait until it is drawn."""
        self.visit(page.resolve().as_uri())

    def visit(self, address: str, *, is_drawn: bool = True) -> None:
        """Open an address and wait until its page is drawn, if it is one of ours."""
        self._call('POST', '/url', {'url': address})
        if not is_drawn:
            return
        self.wait('return document.body.dataset.ready !== undefined')

    def run(self, script: str, *arguments: Any) -> Any:
        """Return what a script returns."""
        return self._call('POST', '/execute/sync', {'script': script, 'args': arguments})

    def wait(self, script: str) -> None:
        """Wait until a script returns true."""
        end = time.monotonic() + _DEADLINE
        while not self.run(script):
            assert time.monotonic() < end, f'{script}: {self.log()}'

    def move(self, selector: str, x: int, y: int, then_to: int | None = None) -> None:
        """Move the mouse into an element, offsets from its centre; drag it if ``then_to``."""
        origin = self._call('POST', '/element', {'using': 'css selector', 'value': selector})
        steps: list[dict[str, Any]] = [
            {'type': 'pointerMove', 'duration': 0, 'origin': origin, 'x': x, 'y': y}]
        if then_to is not None:
            steps += [{'type': 'pointerDown', 'button': 0},
                      {'type': 'pointerMove', 'duration': 20, 'origin': origin, 'x': then_to,
                       'y': y},
                      {'type': 'pointerUp', 'button': 0}]
        self._call('POST', '/actions', {'actions': [
            {'type': 'pointer', 'id': 'mouse', 'parameters': {'pointerType': 'mouse'},
             'actions': steps}]})

    def resize(self, width: int, height: int) -> None:
        """Change the size of the window."""
        self._call('POST', '/window/rect', {'width': width, 'height': height})

    def screenshot(self) -> str:
        """Return what is in view, PNG in base 64."""
        return str(self._call('GET', '/screenshot'))

    def log(self) -> list[str]:
        """Return the messages of the console: errors of scripts, violations of the policy."""
        return [str(entry['message']) for entry in self._call(
            'POST', '/se/log', {'type': 'browser'})]

    def close(self) -> None:
        """End the browser."""
        self._call('DELETE', '')

    def _call(self, method: str, path: str, body: Any = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        request = Request(self._session + path, data, {'Content-Type': 'application/json'},
                          method=method)
        with urlopen(request, timeout=_DEADLINE) as answer:
            return json.loads(answer.read())['value']


@contextmanager
def chromium() -> Iterator[Browser]:
    """Yield a browser; skip where none is installed, which fails on a server of CI."""
    program = next(filter(None, map(shutil.which, _PROGRAMS)), None)
    if program is None or shutil.which('chromedriver') is None:
        reason = f'there is no chromedriver with {" or ".join(_PROGRAMS)}'
        if os.environ.get('CI'):
            pytest.fail(f'{reason}: pages are not tested')
        pytest.skip(reason)
    driver = subprocess.Popen(
        ['chromedriver', '--port=0'], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        assert driver.stdout is not None
        port = next(int(found[1]) for line in driver.stdout if (found := _PORT.search(line)))
        browser = Browser(program, port)
        try:
            yield browser
        finally:
            browser.close()
    finally:
        driver.terminate()
        driver.wait(_DEADLINE)
        if driver.stdout is not None:
            driver.stdout.close()
