"""The directory of an export: files of an earlier one may be replaced, and no others."""

from collections.abc import Collection, Mapping
import hashlib
import json
from pathlib import Path
import tempfile
from typing import Any

from isa_ros.core.atomic_file import replace_file
from isa_ros.errors import ConfigError

LIST = 'isa_export.json'
"""Names the files of the exports in a directory, with the sha256 of each."""


def refuse_foreign(out: Path, names: Collection[str]) -> None:
    """
    Refuse a directory in which files of these names cannot be written.

    Raises
    ------
    ConfigError
        It is a file or cannot be written, has files but none of an export, or one of the names
        is that of a file that is not as it was exported.

    """
    if out.exists() and not out.is_dir():
        raise ConfigError(f'{out} is a file, must be a directory')
    _try_to_write(out)
    there = sorted(path.name for path in out.iterdir()) if out.exists() else []
    if there and LIST not in there:
        raise ConfigError(f'{out} has files that are not of an export, such as {there[0]}; '
                          'nothing is written, must be a new or empty directory')
    known = _exported(out)
    for name in there:
        if name in names and known.get(name) != _digest((out / name).read_bytes()):
            raise ConfigError(f'{out / name} is not as it was exported; nothing is written, must '
                              'be moved or removed')


def write(out: Path, files: Mapping[str, bytes]) -> None:
    """
    Write files to a directory, which is made if it is not there; raises as `refuse_foreign`.

    Raises
    ------
    ConfigError
        A file cannot be written, too.

    """
    refuse_foreign(out, files)
    known = _exported(out) | {name: _digest(content) for name, content in files.items()}
    try:
        out.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            replace_file(out / name, content, is_durable=False)
        text = json.dumps({'files': known}, indent=1) + '\n'
        replace_file(out / LIST, text.encode(), is_durable=False)
    except OSError as error:
        raise ConfigError(f'{error.filename}: cannot be written, {error.strerror}') from error


def _try_to_write(out: Path) -> None:
    """Refuse a directory in which no file can be made: permissions alone do not say so."""
    nearest = next(place for place in (out, *out.absolute().parents) if place.exists())
    try:
        with tempfile.TemporaryFile(dir=nearest):
            pass
    except OSError as error:
        raise ConfigError(f'{out}: cannot be written, {error.strerror}') from error


def _exported(out: Path) -> dict[str, str]:
    """Return the files of earlier exports with their digests."""
    path = out / LIST
    if not path.exists():
        return {}
    try:
        tree: Any = json.loads(path.read_bytes())
        return {str(name): str(digest) for name, digest in tree['files'].items()}
    except (ValueError, TypeError, KeyError, AttributeError, OSError) as error:
        raise ConfigError(f'{path}: is not the list of an export; nothing is written') from error


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
