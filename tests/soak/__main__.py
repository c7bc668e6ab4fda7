"""
One soak test with chosen figures; only its output is kept.

    python -m tests.soak killed --runs 10 --seconds 600 --seed 1 [--in-process]
    python -m tests.soak long --seconds 3600
"""

import argparse
from pathlib import Path
import tempfile

import pytest
from tests.ros.domains import held_domain, observing
from tests.ros.started import RIG
from tests.soak.killed import killed_runs
from tests.soak.long_run import long_run


def main() -> None:
    """Run one of them."""
    parser = argparse.ArgumentParser(prog='python -m tests.soak', description=__doc__)
    parser.add_argument('name', choices=('killed', 'long'))
    parser.add_argument('--seconds', type=float, default=600.0,
                        help='simulated time before which a run is killed, or of the long run')
    parser.add_argument('--runs', type=int, default=10)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--in-process', action='store_true')
    parser.add_argument('--config', type=Path, default=RIG)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory, pytest.MonkeyPatch.context() as patch, \
            held_domain(patch), observing(patch) as observer:
        if options.name == 'long':
            print(long_run(Path(directory), options.seconds))
            return
        more = ('--in-process',) if options.in_process else ()
        for killed in killed_runs(
                observer, options.config, more, options.seconds, options.runs, options.seed,
                Path(directory)):
            print(killed, flush=True)


if __name__ == '__main__':
    main()
