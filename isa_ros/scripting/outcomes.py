"""Outcomes of the runs of a sweep, one after the other or by workers on all cores."""

from collections.abc import Callable, Iterator, Mapping, Sequence
import multiprocessing
from multiprocessing.connection import Connection, wait
from pathlib import Path
import pickle
import traceback
from typing import Any, NamedTuple

from isa_ros.errors import IsaError, one_line, RunError
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import Run

Measure = Callable[[Result], float]


class Failure(NamedTuple):
    """The reason why a run has no value of a measure."""

    measure: str
    """Name of the measure, '' where the run itself failed."""
    error: Exception
    where: str
    """File and line of the user's code that raised, '' for errors of isa_ros."""

    def __str__(self) -> str:
        named = f'measure {self.measure!r}: ' if self.measure else ''
        if isinstance(self.error, IsaError):
            return f'{named}{self.error}'
        text = one_line(f'{type(self.error).__name__}: {self.error}').removesuffix(': ')
        return f'{named}{text}{f" ({self.where})" if self.where else ""}'


class Outcome(NamedTuple):
    """What one run of a sweep gave."""

    run: int
    """Its index."""
    values: Mapping[str, float]
    """By measure."""
    failures: tuple[Failure, ...] = ()


def outcomes(
        runs: Sequence[Run], duration: float | None, measures: Mapping[str, Measure],
        n_workers: int) -> Iterator[Outcome]:
    """
    Yield the outcome of each run as it is ready, in any order.

    A run that diverges, a measure that raises and a worker that is killed are failures of their
    own runs only.
    """
    if n_workers == 1:
        return (_outcome(k, run, duration, measures) for k, run in enumerate(runs))
    return _parallel(runs, duration, measures, n_workers)


def _outcome(
        k: int, run: Run, duration: float | None, measures: Mapping[str, Measure]) -> Outcome:
    try:
        result = run.simulate(duration)
    except IsaError as error:
        return Outcome(k, {}, (Failure('', error, ''),))
    values, failures = {}, []
    for name, measure in measures.items():
        try:
            values[name] = float(measure(result))
        except Exception as error:  # the user's code: it may raise anything, other runs are done
            failures.append(Failure(name, error, _place_of(error)))
    return Outcome(k, values, tuple(failures))


def _place_of(error: Exception) -> str:
    """Return file and line of the innermost frame below this module's call of a measure."""
    frames = traceback.extract_tb(error.__traceback__)[1:]
    return f'{Path(frames[-1].filename).name}:{frames[-1].lineno}' if frames else ''


def _parallel(
        runs: Sequence[Run], duration: float | None, measures: Mapping[str, Measure],
        n_workers: int) -> Iterator[Outcome]:
    """Yield the outcomes as they arrive; worker w of n does the runs w, w + n, w + 2 n, ..."""
    _load_kernels(runs)
    context: Any = multiprocessing.get_context(
        'fork' if 'fork' in multiprocessing.get_all_start_methods() else 'spawn')
    workers, ends = [], []
    for w in range(n_workers):
        ours, theirs = context.Pipe(duplex=False)
        workers.append(context.Process(
            target=_work, args=(runs, duration, measures, w, n_workers, theirs), daemon=True))
        workers[-1].start()
        theirs.close()
        ends.append(ours)
    missing = [list(range(w, len(runs), n_workers)) for w in range(n_workers)]
    try:
        while any(not end.closed for end in ends):
            for end in wait([end for end in ends if not end.closed]):
                assert isinstance(end, Connection)
                w = ends.index(end)
                try:
                    outcome = end.recv()
                except EOFError:
                    end.close()
                    workers[w].join()
                    yield from (_lost(k, workers[w].exitcode) for k in missing[w])
                    continue
                missing[w].remove(outcome.run)
                yield outcome
    finally:
        for worker in workers:
            worker.terminate()
            worker.join()


def _load_kernels(runs: Sequence[Run]) -> None:
    """Load the kernels once, before the fork; a run that cannot start fails in its worker."""
    try:
        runs[0].simulation().step()
    except IsaError:
        return


def _lost(k: int, exit_code: int | None) -> Outcome:
    return Outcome(k, {}, (Failure(
        '', RunError(f'a worker of the sweep ended with exit code {exit_code}'), ''),))


def _work(
        runs: Sequence[Run], duration: float | None, measures: Mapping[str, Measure], first: int,
        stride: int, end: Connection) -> None:
    """Send the outcome of each run of a worker's share when it is ready."""
    for k in range(first, len(runs), stride):
        outcome = _outcome(k, runs[k], duration, measures)
        end.send(outcome._replace(failures=tuple(map(_sendable, outcome.failures))))
    end.close()


def _sendable(failure: Failure) -> Failure:
    """Return a failure that survives the way to another process, at worst as a `RunError`."""
    try:
        pickle.loads(pickle.dumps(failure.error))
    except Exception:  # what pickle and the constructor of a user's error raise is theirs
        name = type(failure.error).__name__
        return failure._replace(error=RunError(f'{name}: {one_line(str(failure.error))}'))
    return failure
