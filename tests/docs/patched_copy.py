"""A copy of the package in which an extension is made: what it takes, and whether it runs."""

from collections.abc import Callable, Iterable
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

from isa_ros.core.kernel_library import MAKERS

ROOT = Path(__file__).parents[2]
_SKIPPED = shutil.ignore_patterns('*.pyc.*', '.*')   # what another process is writing
_COPIED = ('isa_ros', 'msg_adapters', 'benchmarks', 'config', 'docs', 'scripts', 'urdf')


class PatchedCopy:
    """The package below a directory; ``touched`` are the files changed or added, sorted."""

    def __init__(self, directory: Path, source: Path = ROOT) -> None:
        self.root = directory / 'patched'
        """Of the copy."""
        for name in _COPIED:
            shutil.copytree(source / name, self.root / name, ignore=_SKIPPED)
        shutil.copy(source / 'package.xml', self.root)
        shutil.copy(source / 'pyproject.toml', self.root)
        self._touched: set[str] = set()

    def reworded(self, directory: Path) -> 'PatchedCopy':
        """
        Return a copy of this one in which all lines and docstrings are others.

        Of what makes machine code they stay: with another source of it all is made anew.
        """
        other = PatchedCopy(directory, self.root)
        makers = {other.root / 'isa_ros' / 'core' / f'{name}.py' for name in MAKERS}
        for path in {*other.root.rglob('*.py')} - makers:
            words = re.sub(r'"""(?=[A-Z])', '"""Edited: ', path.read_text(encoding='utf-8'))
            path.write_text(f'# A remark.\n\n{words}', encoding='utf-8')
        return other

    @property
    def touched(self) -> list[str]:
        """Return the paths of all files that differ from the package's by hand."""
        return sorted(self._touched)

    def touched_by(self, extension: Callable[['PatchedCopy'], None]) -> list[str]:
        """Make an extension, beside those made before, and return the paths that it touches."""
        before, self._touched = self._touched, set()
        extension(self)
        own = self.touched
        self._touched |= before
        return own

    def replace(self, path: str, old: str, new: str) -> None:
        """Replace a text that a file has exactly once."""
        text = (self.root / path).read_text(encoding='utf-8')
        found = text.count(old)
        if found != 1:
            raise ValueError(f'{path} has {found} times, must have once: {old!r}')
        (self.root / path).write_text(text.replace(old, new), encoding='utf-8')
        self._touched.add(path)

    def add(self, path: str, text: str) -> None:
        """Add a file that does not exist yet."""
        with (self.root / path).open('x', encoding='utf-8') as file:
            file.write(text)
        self._touched.add(path)

    def read(self, path: str) -> str:
        """Return the text of a file."""
        return (self.root / path).read_text(encoding='utf-8')

    def isa(self, *arguments: str) -> str:
        """Return what `isa` prints."""
        return self._run('-m', 'isa_ros', *arguments)

    def python(self, program: str, **environment: str) -> str:
        """Return what a Python program prints, with variables of the environment."""
        return self._run('-c', program, **environment)

    def script(self, path: str) -> str:
        """Return what a script of the copy prints."""
        return self._run(path)

    def _run(self, *arguments: str, **environment: str) -> str:
        done = subprocess.run(
            [sys.executable, *arguments], cwd=self.root, capture_output=True, text=True,
            check=False, env={**os.environ, **environment, 'PYTHONPATH': os.pathsep.join(
                [str(self.root), os.environ.get('PYTHONPATH', '')])})
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


def rows_of_the_page() -> dict[str, str]:
    """Return what the table says by what is new."""
    page = (ROOT / 'docs' / 'architecture.md').read_text(encoding='utf-8')
    table = page.partition('## Places for extensions')[2]
    rows = [line.strip('| ').split(' | ') for line in table.splitlines() if line.startswith('|')]
    return {row[0]: ' '.join(row[1:]) for row in rows[2:]}


def files_of(row: str) -> set[str]:
    """Return the files that the page names for a row."""
    return set(re.findall(r'`([a-z_]+/[a-z_/]+(?:\.py|\.yaml)?)`', rows_of_the_page()[row]))


def names_of(touched: Iterable[str]) -> set[str]:
    """Return touched files as the page names them; of data, their folder."""
    return {re.sub(r'(config/data/\w+)/.*', r'\1', path.removeprefix('isa_ros/'))
            for path in touched}
