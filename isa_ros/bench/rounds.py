"""Do the runs of all groups, one after the other, in rounds of alternating order."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import subprocess
import tempfile

from isa_ros.bench.child import last_line, run_module
from isa_ros.bench.peers.catalogue import PEERS
from isa_ros.bench.spec import Failed, Measured, Spec
from isa_ros.errors import RunError
from isa_ros.text.progress import Progress

RUN_TIMEOUT_S = 180.0   # of one run, start-up included


class Outcomes:
    """What the runs of every spec told."""

    def __init__(self, told: Mapping[Spec, Sequence[Measured | Failed]]) -> None:
        self._told = told

    def of(self, spec: Spec) -> list[Measured]:
        """Return what the runs of a spec told, those that failed left out."""
        return [each for each in self._told.get(spec, ()) if isinstance(each, Measured)]

    @property
    def runs(self) -> list[tuple[Spec, Measured]]:
        """Return every run that told something, with its spec."""
        return [(spec, each) for spec, told in self._told.items()
                for each in told if isinstance(each, Measured)]

    def reason(self, spec: Spec) -> str:
        """Return why a spec has nothing to tell; '' where it has."""
        if self.of(spec):
            return ''
        reasons = [each.reason for each in self._told.get(spec, ()) if isinstance(each, Failed)]
        return reasons[0] if reasons else 'not run'


def order_of(specs: Sequence[Spec]) -> list[Spec]:
    """
    Return the runs in their order: every other round backwards.

    A machine that grows slower over the whole time then slows the first spec as much as the
    last one. Specs of fewer rounds are in the middle ones.
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
    Do every run of ``specs`` in a process of its own.

    A peer that fails has told so; a run of this package that fails ends the bench.

    Raises
    ------
    RunError
        A run could not be completed.

    """
    told: dict[Spec, list[Measured | Failed]] = {spec: [] for spec in specs}
    runs = order_of(specs)
    for done, spec in enumerate(runs):
        if progress is not None:
            progress(done, len(runs), str(spec))
        told[spec].append(_outcome(spec))
    if progress is not None:
        progress(len(runs), len(runs), '')
    return Outcomes(told)


def _outcome(spec: Spec) -> Measured | Failed:
    peer = next((one for one in PEERS if one.name == spec.way), None)
    if peer is not None and not peer.is_installed:
        return Failed('not installed')
    result = measured(spec)
    if isinstance(result, Failed) and peer is None:
        raise RunError(f'{spec}: {result.reason}')
    return result


def measured(spec: Spec) -> Measured | Failed:
    """Do one run in a process of its own."""
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        result = Path(directory) / 'result.json'
        try:
            ended = run_module(
                f'{__package__}.measure', [spec.to_json(), str(result)], RUN_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return Failed(f'not done after {RUN_TIMEOUT_S:g} s')
        if ended.returncode or not result.exists():
            return Failed(last_line(ended))
        return Measured.from_json(result.read_text(encoding='utf-8'))
