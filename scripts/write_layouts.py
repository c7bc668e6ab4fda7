"""
Write layouts/*, for Lichtblick, Foxglove and PlotJuggler, from the run files that they are of.

    python -m scripts.write_layouts                        # those that are shipped
    python -m scripts.write_layouts my_press.yaml --out .  # of a run of yours, in this directory
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
import sys

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import IsaError
from scripts.layouts import lichtblick, plotjuggler
from scripts.layouts.content import pages_of

LAYOUTS = Path(__file__).resolve().parents[1] / 'layouts'
SHIPPED = ('leg', 'rig_rotary', 'quadruped')


def texts(name: str) -> Iterator[tuple[str, str]]:
    """Yield the name and content of each file for a run file, the user's or a shipped one."""
    run = load_run(find(name, CONFIG))
    pages = pages_of(run)
    stem = Path(name).stem
    yield f'{stem}.lichtblick.json', lichtblick.text(pages, [own.name for own in run.actuators])
    for version in (3, 4):
        yield f'{stem}.pj{version}.xml', plotjuggler.text(pages, version)


def main(arguments: Sequence[str]) -> int:
    """Write the files and return the exit code."""
    parser = argparse.ArgumentParser(prog='python -m scripts.write_layouts')
    parser.add_argument('run', nargs='*', default=SHIPPED, help='a run file, or a shipped one')
    parser.add_argument('--out', type=Path, default=LAYOUTS, metavar='DIR')
    given = parser.parse_args(arguments)
    try:
        files = [file for name in given.run for file in texts(name)]
        for name, text in files:
            (given.out / name).write_text(text, encoding='utf-8')
    except IsaError as error:
        print(f'write_layouts: {error}', file=sys.stderr)
        return error.exit_code
    except OSError as error:
        print(f'write_layouts: {given.out}: {error.strerror}', file=sys.stderr)
        return 3
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
