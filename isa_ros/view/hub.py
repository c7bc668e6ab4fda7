"""
Between a run and its pages: frames to each page, orders of all pages to the run.

A page that is slow, or closed, never holds the run up: its oldest frames are dropped.
"""

from collections.abc import Mapping
import json
from queue import Empty, Full, Queue, SimpleQueue
from threading import Condition, Event
from typing import Any

from isa_ros.view.orders import Order

MOST_VIEWERS = 4
"""A browser has six connections to one server, and needs some for its orders."""
_WAITING = 30       # frames that wait for one page: a second


class Viewer:
    """The frames for one page."""

    def __init__(self) -> None:
        self._frames: 'Queue[bytes | None]' = Queue(_WAITING)

    def put(self, frame: bytes | None) -> None:
        """Add a frame, or the end (None); drop the oldest if the page does not take them."""
        while True:
            try:
                self._frames.put_nowait(frame)
                return
            except Full:
                try:
                    self._frames.get_nowait()
                except Empty:
                    pass

    def get(self) -> bytes | None:
        """Wait for the next frame and return it; None: the end."""
        return self._frames.get()


class Hub:
    """
    All pages of a run or a bag.

    ``page`` is what a page gets first, for JSON: title, groups of diagrams, scene, controls.
    """

    def __init__(self, page: Mapping[str, Any]) -> None:
        self.page = json.dumps(page, separators=(',', ':'), allow_nan=False).encode()
        """What a page gets first."""
        self.orders: 'SimpleQueue[Order]' = SimpleQueue()
        """Orders that are not carried out yet."""
        self.was_opened = Event()
        """Set once the first page takes frames."""
        self._viewers: list[Viewer] = []
        self._lock = Condition()
        self._is_over = False

    @property
    def has_viewers(self) -> bool:
        """Return whether a page is open."""
        return bool(self._viewers)

    def opened(self) -> Viewer | None:
        """Return the frames for one more page; None: there are `MOST_VIEWERS`, or it is over."""
        with self._lock:
            if self._is_over or len(self._viewers) >= MOST_VIEWERS:
                return None
            viewer = Viewer()
            self._viewers.append(viewer)
        self.was_opened.set()
        return viewer

    def close(self, viewer: Viewer) -> None:
        """Forget a page."""
        with self._lock:
            self._viewers.remove(viewer)
            self._lock.notify_all()

    def send(self, frame: bytes | None) -> None:
        """Send a frame to all pages, or the end (None)."""
        with self._lock:
            viewers = [*self._viewers]
            self._is_over = frame is None
        for viewer in viewers:
            viewer.put(frame)

    def wait_until_left(self, seconds: float) -> None:
        """Wait until no page takes frames, at most so long."""
        with self._lock:
            self._lock.wait_for(lambda: not self._viewers, seconds)

    def taken(self) -> list[Order]:
        """Return the orders since the last call."""
        found = []
        while True:
            try:
                found.append(self.orders.get_nowait())
            except Empty:
                return found
