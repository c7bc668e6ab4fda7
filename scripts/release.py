"""
Make a release: `python -m scripts.release 0.2.0 [YYYY-MM-DD]`, then commit and tag it.

The entries below "Forthcoming" in CHANGELOG.rst become those of the release, the version moves in
isa_ros/core/version.py and package.xml, and a small bag is recorded that later versions open in
the tests.
"""

import argparse
import datetime
from pathlib import Path
import re
import subprocess
import sys

import isa_ros
from isa_ros.errors import ConfigError

ROOT = Path(__file__).resolve().parents[1]
BAGS = Path('tests') / 'golden' / 'releases'
CHANGES, VERSION_FILE, MANIFEST = (
    Path('CHANGELOG.rst'), Path('isa_ros') / 'core' / 'version.py', Path('package.xml'))
RUN, SCENARIO, DURATION_S = 'leg', 'drop', 0.03

_NUMBER = re.compile(r'(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)')
_FORTHCOMING = 'Forthcoming\n-----------\n'
_SECTION = re.compile(r'^(\d+\.\d+\.\d+) \(\d{4}-\d\d-\d\d\)\n-+$', re.MULTILINE)


def releases(changes: str) -> tuple[str, ...]:
    """Return the versions that a changelog has, the last one first."""
    return tuple(_SECTION.findall(changes))


def release(version: str, date: datetime.date, root: Path) -> None:
    """
    Move a clone to a version; nothing is written if it is refused.

    Raises
    ------
    ConfigError
        The version is not one, not later than the last release, or nothing is forthcoming.

    """
    changes = (root / CHANGES).read_text(encoding='utf-8')
    known = releases(changes)
    if not _NUMBER.fullmatch(version):
        raise ConfigError(f'version {version!r}, must be three numbers: 0.2.0')
    if known and _ordered(version) <= _ordered(known[0]):
        raise ConfigError(f'version {version}, must be later than the last release, {known[0]}')
    head, found, rest = changes.partition(_FORTHCOMING)
    if not found or not rest.lstrip().startswith('* '):
        raise ConfigError(f'{CHANGES}: nothing is forthcoming, so there is nothing to release')
    title = f'{version} ({date.isoformat()})'
    (root / CHANGES).write_text(
        f'{head}{_FORTHCOMING}\n{title}\n{"-" * len(title)}\n{rest}', encoding='utf-8')
    _replace(root / VERSION_FILE, r"^VERSION = '.*'$", f"VERSION = '{version}'")
    _replace(root / VERSION_FILE, r'^RELEASES: tuple\[str, \.\.\.\] = .*$',
             f'RELEASES: tuple[str, ...] = {(version, *known)!r}')
    _replace(root / MANIFEST, r'<version>.*</version>', f'<version>{version}</version>')


def record(version: str, root: Path) -> Path:
    """Record the bag of a version, which must be the one that is imported; return it."""
    if isa_ros.__version__ != version:
        raise ConfigError(f'isa_ros {isa_ros.__version__} is imported, must be {version}')
    run = isa_ros.load(RUN, SCENARIO, duration=DURATION_S, compression='zstd')
    return run.simulate().save(root / BAGS / version, overwrite=True)


def _ordered(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split('.')))


def _replace(path: Path, pattern: str, text: str) -> None:
    """Replace the one place in a file that a pattern finds."""
    changed, count = re.subn(
        pattern, text, path.read_text(encoding='utf-8'), flags=re.MULTILINE)
    if count != 1:
        raise ConfigError(f'{path}: {pattern} is there {count} times, must be once')
    path.write_text(changed, encoding='utf-8')


def main() -> int:
    """Make the release of the command line and print what is left to do."""
    parser = argparse.ArgumentParser(description='Make a release.')
    parser.add_argument('version', help='such as 0.2.0')
    parser.add_argument(
        'date', nargs='?', type=datetime.date.fromisoformat, default=datetime.date.today())
    options = parser.parse_args()
    try:
        release(options.version, options.date, ROOT)
        # In a process of its own: here isa_ros was imported with the version before.
        subprocess.run(
            [sys.executable, '-c', 'import sys; from scripts.release import record, ROOT; '
             'print(record(sys.argv[1], ROOT))', options.version], cwd=ROOT, check=True)
    except ConfigError as error:
        print(f'release: {error}', file=sys.stderr)
        return error.exit_code
    print(f'now: git add -A; git commit -m "release {options.version}"; '
          f'git tag {options.version}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
