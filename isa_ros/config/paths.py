"""
Paths of shipped files: in a clone beside the package, installed under share/isa_ros.

A name on the command line is the user's own file if that exists, else a shipped one.
"""

from collections.abc import Mapping, Sequence
from itertools import chain
import os
from pathlib import Path
import sys
from types import MappingProxyType

from isa_ros.core.suggest import near_names
from isa_ros.errors import ConfigError

_SHARE = Path('share') / 'isa_ros'
CONFIG = 'config'
SCENARIOS = 'config/scenarios'
CONTROLLERS = 'config/controllers'


def share_directories() -> list[Path]:
    """Return the directories that may hold config/, layouts/, rviz/, urdf/, the nearest first."""
    package = Path(__file__).resolve().parents[1]
    found = [package.parent] if (package.parent / 'package.xml').is_file() else []
    # A merged or isolated colcon install, and a wheel: PREFIX/lib/python3.x/site-packages.
    prefixes = [Path(p) for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]
    prefixes += [*package.parents[2:5], Path(sys.prefix)]
    for prefix in prefixes:
        if (prefix / _SHARE).is_dir() and prefix / _SHARE not in found:
            found.append(prefix / _SHARE)
    return found


def shipped(directory: str) -> dict[str, Path]:
    """Return the shipped YAML files of a directory below the share by name, sorted."""
    files: dict[str, Path] = {}
    for share in share_directories():
        for path in (share / directory).glob('*.yaml'):
            files.setdefault(path.name, path)
    return dict(sorted(files.items()))


def find_drawing(name: str) -> Path:
    """
    Return a shipped file below ``urdf``, ``rviz`` or ``layouts``, such as ``rviz/leg.rviz``.

    Raises
    ------
    ConfigError
        The file does not exist.

    """
    for share in share_directories():
        if (share / name).is_file():
            return share / name
    raise ConfigError(f'{name}: no such shipped file')


def drawings(directory: str) -> list[str]:
    """Return the names of the shipped files below ``urdf`` or ``rviz``, sorted."""
    return sorted({path.name for share in share_directories()
                   for path in (share / directory).glob('*.*')})


def find(
        name: str, directory: str, others: Mapping[str, Sequence[str]] = MappingProxyType({}),
        ) -> Path:
    """
    Return the user's file ``name``, or else the shipped file of that name.

    The ending .yaml may be left out for shipped files. ``others`` are names by what they are, as
    models, that would have done as well: for the message, as the user's own files are.

    Raises
    ------
    ConfigError
        Neither file exists.

    """
    path = Path(name)
    if path.exists():
        return path
    files = shipped(directory)
    for known in (name, f'{name}.yaml'):
        if known in files:
            return files[known]
    written = files if name.endswith('.yaml') else [known.removesuffix('.yaml') for known in files]
    own = map(str, path.parent.glob('*.yaml'))
    near = near_names(name, chain(own, written, *others.values()))
    lists = {'shipped': tuple(files), **others}
    raise ConfigError(f'{name}: no such file; ' + (
        f'did you mean {near}?' if near else
        '; '.join(f'{what}: {", ".join(known) or "none"}' for what, known in lists.items())))
