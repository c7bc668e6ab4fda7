"""Waiting at memory."""

from collections.abc import Callable
from pathlib import Path
import threading
import time
from typing import NamedTuple

from isa_ros.core.bound import Bound
from isa_ros.core.kernel import kernel
from isa_ros.core.system_calls import system_calls, SystemCalls, wait_while
import numpy as np

LONG_S = 60     # by far longer than a busy host keeps a thread waiting


class Sleeping(NamedTuple):
    """Memory of `call_wait`."""

    system: SystemCalls
    numbers: np.ndarray


@kernel
def call_wait(own):
    return 1 if wait_while(own.system, own.numbers[0], own.numbers[1]) else 0


def sleep_at(address: int, seen: int, longest_s: int | None = None) -> tuple[bool, float]:
    """Wait while a number is what was seen; return whether it changed, and for how long."""
    system = system_calls()
    if longest_s is not None:
        system.longest[:2] = longest_s, 0
    bound = Bound(call_wait, Sleeping(system, np.array([address, seen], np.int64)))
    begin = time.monotonic()
    return bool(bound.run()), time.monotonic() - begin


def is_woken(address: int, seen: int, wake: Callable[[], object]) -> bool:
    """Return whether a call wakes a thread that sleeps at an address."""
    found: list[tuple[bool, float]] = []
    thread = threading.Thread(target=lambda: found.append(sleep_at(address, seen, LONG_S)))
    thread.start()
    system_call = Path(f'/proc/self/task/{thread.native_id}/syscall')
    deadline = time.monotonic() + LONG_S
    while f' {address:#x} ' not in system_call.read_text():
        assert time.monotonic() < deadline
    wake()
    thread.join()
    changed, spent_s = found[0]
    return changed and spent_s < LONG_S
