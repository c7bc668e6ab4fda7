"""Pages of a bag that plays and of a run that lives, and what a user does on them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import Queue
import threading

from isa_ros.config.paths import CONFIG, find
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.view.playing import Player
from isa_ros.view.running import view_run
from isa_ros.view.server import serving
from tests.browser import Browser

CLOCK = "return parseFloat(document.getElementById('clock').textContent)"


@contextmanager
def played(bag: Path) -> Iterator[str]:
    """Play a bag meanwhile; yield the address of its page."""
    player, ended = Player(bag, Path()), threading.Event()
    thread = threading.Thread(target=player.play, args=(ended.is_set,))
    with serving(player.hub, 0) as url:
        thread.start()
        try:
            yield url
        finally:
            ended.set()
            thread.join()


def click(browser: Browser, name: str) -> None:
    browser.run(f"document.getElementById('{name}').click()")


def choose(browser: Browser, name: str, value: object) -> None:
    browser.run(
        'const own = document.getElementById(arguments[0]); own.value = arguments[1];'
        'for (const kind of ["input", "change"]) own.dispatchEvent(new Event(kind))',
        name, str(value))


@contextmanager
def lived(out: Path, **more: object) -> Iterator[tuple[str, Callable[[], None]]]:
    """Run a rig meanwhile; yield the address of its page, and what waits for the run's end."""
    given = {'config': find('rig_linear', CONFIG), 'out': out, 'real_time_factor': 1.0, **more}
    session = prepare(Request(**given))
    told: 'Queue[str]' = Queue()
    ended = threading.Event()

    def run() -> None:
        with suppress(Interrupted):
            view_run(session, 0, Path(), told.put, None, ended.is_set)
    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield told.get(timeout=120.0), thread.join
    finally:
        ended.set()
        thread.join()
