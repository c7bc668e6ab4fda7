"""
Pin all packages that a requirements file needs: `python scripts/pin_requirements.py FILE ...`.

Above the line `MADE`, a file names what is needed, by hand. Below it this script writes what
those need in turn, with the versions of the environment that runs it. Where another Python needs
another version, because the installed one does not support it, the pin with its marker is kept.
"""

from importlib.metadata import Distribution, distributions
from pathlib import Path
import re
import sys

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

MADE = '# All that these need, made by scripts/pin_requirements.py.'
PYTHONS = ('3.10', '3.11', '3.12', '3.13', '3.14')
_OLDER = re.compile(r'; python_version < "([0-9.]+)"$')


def environment(python: str) -> dict[str, str]:
    """Return the markers of CPython on x86-64 Linux, for which the wheels of ROS are made."""
    return {
        'python_version': python, 'python_full_version': f'{python}.0', 'os_name': 'posix',
        'implementation_name': 'cpython', 'platform_python_implementation': 'CPython',
        'sys_platform': 'linux', 'platform_system': 'Linux', 'platform_machine': 'x86_64'}


def installed() -> dict[str, Distribution]:
    """Return the distributions of this environment by name."""
    return {canonicalize_name(found.metadata['Name']): found for found in distributions()}


def applies(requirement: Requirement, python: str, extras: set[str]) -> bool:
    """Return whether a requirement is needed with a Python."""
    marker = requirement.marker
    return marker is None or any(
        marker.evaluate({**environment(python), 'extra': extra}) for extra in (extras or {''}))


def needed(direct: list[Requirement], python: str, known: dict[str, Distribution]) -> set[str]:
    """Return the names of all packages that some requirements need with a Python."""
    done: set[tuple[str, str]] = set()
    left = [(canonicalize_name(own.name), extra) for own in direct if applies(own, python, set())
            for extra in {'', *own.extras}]
    while left:
        name, extra = left.pop()
        if (name, extra) in done:
            continue
        done.add((name, extra))
        if name in known:
            for text in known[name].requires or []:
                own = Requirement(text)
                if applies(own, python, {extra}):
                    left += [(canonicalize_name(own.name), more) for more in {'', *own.extras}]
    return {name for name, _ in done}


def supports(found: Distribution, python: str) -> bool:
    """Return whether an installed distribution may be installed with a Python."""
    return SpecifierSet(found.metadata.get('Requires-Python', '')).contains(f'{python}.99')


def marker(pythons: list[str]) -> str:
    """Return the marker of some of `PYTHONS`, which are its first ones or its last ones."""
    if pythons == list(PYTHONS):
        return ''
    if pythons[-1] == PYTHONS[-1]:
        return f'; python_version >= "{pythons[0]}"'
    above = PYTHONS[PYTHONS.index(pythons[-1]) + 1]
    return f'; python_version < "{above}"'


def pinned(path: Path, others: set[str]) -> str:
    """Return the text of a requirements file with all its pins, without those of others."""
    by_hand, _, before = path.read_text(encoding='utf-8').partition(MADE)
    direct = [Requirement(line.partition(' #')[0]) for line in by_hand.splitlines()
              if line and not line.startswith('#')]
    named = {canonicalize_name(own.name) for own in direct} | others
    older = {canonicalize_name(Requirement(line).name): line for line in before.splitlines()
             if _OLDER.search(line)}
    known = installed()
    lines, missing = [], []
    needs = {python: needed(direct, python, known) for python in PYTHONS}
    for name in sorted(set().union(*needs.values()) - named):
        pythons = [python for python in PYTHONS
                   if name in needs[python] and name in known and supports(known[name], python)]
        rest = [python for python in PYTHONS if name in needs[python] and python not in pythons]
        if pythons:
            lines.append(f'{name}=={known[name].version}{marker(pythons)}')
        if rest and name in older:
            lines.append(older[name])
        elif rest:
            missing.append(f'{name} for Python {", ".join(rest)}')
    if missing:
        sys.exit(f'{path}: pin below {MADE!r}, with a marker like python_version < "3.11": '
                 + '; '.join(missing))
    return f'{by_hand.rstrip()}\n\n{MADE}\n' + '\n'.join(lines) + '\n'


def names(path: Path) -> set[str]:
    """Return the names of all packages in a requirements file."""
    return {canonicalize_name(Requirement(line).name)
            for line in path.read_text(encoding='utf-8').splitlines()
            if line and not line.startswith('#')}


def main(paths: list[Path]) -> None:
    """Write the files; what an earlier one pins, a later one does not repeat."""
    others: set[str] = set()
    for path in paths:
        path.write_text(pinned(path, others), encoding='utf-8')
        others |= names(path)


if __name__ == '__main__':
    main([Path(name) for name in sys.argv[1:]])
