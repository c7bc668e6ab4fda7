"""Independent calls in two worker processes."""

from collections.abc import Callable, Sequence
from concurrent.futures import as_completed, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
import multiprocessing
import signal
from typing import TypeVar

from isa_ros.errors import RunError
from isa_ros.text.progress import Progress

WORKERS = 2
T = TypeVar('T')


def in_workers(
        calls: Sequence[Callable[[], T]], progress: Progress | None = None) -> list[T]:
    """
    Return the results of ``calls`` in their order; the first ones start first.

    Calls, results and errors cross between processes.

    Raises
    ------
    RunError
        A worker process was lost.

    """
    before = multiprocessing.active_children()
    # Spawned, not forked: the threads of numba and matplotlib do not survive a fork.
    with ProcessPoolExecutor(
            min(WORKERS, len(calls)), multiprocessing.get_context('spawn'),
            _leave_interrupts_to_the_parent) as executor:
        try:
            return _gathered([executor.submit(call) for call in calls], progress)
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                if process not in before:
                    process.terminate()
            raise


def _leave_interrupts_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _gathered(futures: Sequence['Future[T]'], progress: Progress | None) -> list[T]:
    for done, future in enumerate(as_completed(futures), 1):
        try:
            future.result()
        except BrokenProcessPool as error:
            raise RunError(f'validate: a worker process was lost: {error}') from error
        if progress is not None:
            progress(done, len(futures))
    return [future.result() for future in futures]
