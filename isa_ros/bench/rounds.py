"""Do the runs of all groups, one after another, in rounds of alternating order."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import subprocess
import tempfile

from isa_ros.bench.child import last_line, run_module
from isa_ros.bench.spec import Failed, Measured, Spec
from isa_ros.errors import RunError
from isa_ros.text.progress import Progress

RUN_TIMEOUT_S = 180.0   # for one run including its start-up


class Outcomes:
    """Results of the runs of every spec."""

    def __init__(self, results: Mapping[Spec, Sequence[Measured | Failed]]) -> None:
        self._results = results

    def of(self, spec: Spec) -> list[Measured]:
        """Return the measured values of a spec's runs, without failed runs."""
        return [each for each in self._results.get(spec, ()) if isinstance(each, Measured)]

    @property
    def runs(self) -> list[tuple[Spec, Measured]]:
        """Return every run that did not fail, with its spec."""
        return [(spec, each) for spec, results in self._results.items()
                for each in results if isinstance(each, Measured)]

    def reason(self, spec: Spec) -> str:
        """Return why a spec has no measured values; '' if it has some."""
        if self.of(spec):
            return ''
        reasons = [
            each.reason for each in self._results.get(spec, ()) if isinstance(each, Failed)]
        return reasons[0] if reasons else 'not run'


def order_of(specs: Sequence[Spec]) -> list[Spec]:
    """
    Return the runs in the order of measurement: every second round is reversed.

    A machine that becomes slower over time then affects the first spec as much as the last one.
    Specs with fewer rounds are in the middle rounds.
    """
    runs: list[Spec] = []
    n_rounds = max((spec.rounds for spec in specs), default=0)
    for round_ in range(n_rounds):
        here = [spec for spec in specs
                if 0 <= round_ - (n_rounds - spec.rounds) // 2 < spec.rounds]
        runs += here[::-1] if round_ % 2 else here
    return runs


def outcomes(specs: Sequence[Spec], progress: Progress | None = None) -> Outcomes:
    """
    Do every run of ``specs`` in its own process.

    A failed run of a peer is a result; a failed run of this package ends the bench.

    Raises
    ------
    RunError
        A run could not be completed.

    """
    results: dict[Spec, list[Measured | Failed]] = {spec: [] for spec in specs}
    runs = order_of(specs)
    for done, spec in enumerate(runs):
        if progress is not None:
            progress(done, len(runs), str(spec))
        results[spec].append(_outcome(spec))
    if progress is not None:
        progress(len(runs), len(runs), '')
    return Outcomes(results)


def _outcome(spec: Spec) -> Measured | Failed:
    result = measured(spec)
    if isinstance(result, Failed) and not spec.is_over_peer:
        raise RunError(f'{spec}: {result.reason}')
    return result


def measured(spec: Spec) -> Measured | Failed:
    """Do one run in its own process."""
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        result = Path(directory) / 'result.json'
        try:
            ended = run_module(
                f'{__package__}.measure', [spec.to_json(), str(result)], RUN_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return Failed(f'not finished after {RUN_TIMEOUT_S:g} s')
        if ended.returncode or not result.exists():
            return Failed(last_line(ended))
        return Measured.from_json(result.read_text(encoding='utf-8'))
