"""
One measured run in its own process: `python -m ... STARTED SPEC RESULT`.

STARTED is the monotonic clock at the start of the process, RESULT the file to write. Only a few
modules are imported before the clock is read.
"""

from collections.abc import Sequence
import os
from pathlib import Path
import sys
import tempfile
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from isa_ros.bench.spec import Measured, Spec
    from isa_ros.run.options import Request
    from isa_ros.run.session import Report


def main(arguments: Sequence[str]) -> int:
    """Run, write the measured values, and return the exit code."""
    entered = time.monotonic()
    started, spec_text, result = arguments
    from isa_ros.bench.spec import Spec
    from isa_ros.errors import IsaError
    try:
        measured = measure(Spec.from_json(spec_text), float(started), entered)
    except IsaError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    Path(result).write_text(measured.to_json(), encoding='utf-8')
    return 0


def measure(spec: 'Spec', started: float, entered: float) -> 'Measured':
    """
    Do the run of ``spec`` in this process and return its measured values.

    ``started`` and ``entered``: monotonic clock at the start of this process and at `main`.
    """
    from isa_ros.bench.rigs import request_of
    from isa_ros.bench.spec import IMPORTS, INTERPRETER
    from isa_ros.bench.watch import Watch
    watch = Watch(
        {INTERPRETER: entered - started, IMPORTS: time.monotonic() - entered}, started)
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        _run(spec, watch.request(request_of(spec, Path(directory))), watch.report)
    return watch.measured(spec.ticks)


def _run(spec: 'Spec', request: 'Request', report: 'Report') -> None:
    if spec.is_over_peer:
        from importlib import import_module
        import_module('benchmarks.peers.transport').bench_over(spec.way, request, report)
        return
    from isa_ros.nodes.bringup import bringup
    bringup(request, report)


if __name__ == '__main__':
    code = main(sys.argv[1:])
    sys.stdout.flush()
    sys.stderr.flush()
    # Skips the shutdown of the middlewares, which may be slow and is not measured.
    os._exit(code)
