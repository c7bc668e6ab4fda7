"""
Fetch public measurements, all under the MIT licence, for docs/real_data.md.

    python -m scripts.fetch_records DIRECTORY [NAME ...]

A file is taken from a commit of its public repository and refused unless its sha256 is the one
below. Nothing of them is part of isa_ros; the licence of each repository is fetched with it.
"""

from hashlib import sha256
from pathlib import Path
import sys
from typing import NamedTuple
from urllib.error import URLError
from urllib.parse import quote
from urllib.request import urlopen

from isa_ros.core.atomic_file import replace_file
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError

HOST = 'https://raw.githubusercontent.com'
TIMEOUT_S = 30.0
_MTS = ('DanielMaurelE/vRTHS_AMBC_MRdamper', '08753ffd7abd5b19053f7e79149c3a68f49bf73c')
_ROTARY = ('vtnsi/actuator_dataset', 'f9926eb53e1c324d7ffafc4536f2494b7508d7ed')


class PublicFile(NamedTuple):
    """One file of a repository at a commit."""

    repository: str
    commit: str
    path: str
    digest: str
    """sha256."""


RECORDS = {
    'mts_damper.txt': PublicFile(
        *_MTS, 'Cap6_ModeloActuador/Preprocesamiento/Datos/0A.txt',
        '7ac3fd85ba301805323fc8f20a967ff3e989babcbcd9719b9bf5aa9d734168d1'),
    'rotary_1.txt': PublicFile(
        *_ROTARY, 'Data/Act_1/Base_000_100_508_9-11-2019-8-55-09 AM.txt',
        '55ad4c1c8da285e8529b035fbde05b50b649b4f27c52e3188b6b4f45625da272'),
    'rotary_2.txt': PublicFile(
        *_ROTARY, 'Data/Act_2/Base_000_100_824_9-11-2019-10-54-16 AM.txt',
        '8ef0364153c85c7f9110a3e9fdf870cb03e3a7da27de3c21fc2745027018aed7')}
"""By the name that a file gets: a servo-hydraulic press with a damper; two rotary actuators."""


def fetch(name: str, directory: Path, host: str = HOST) -> Path:
    """
    Return a record in a directory, fetched unless it is there.

    Raises
    ------
    ConfigError
        There is no such record, it cannot be fetched, or it is another file.

    """
    if name not in RECORDS:
        raise ConfigError(f'{name}: no such record; {alternatives(name, RECORDS)}')
    own, path = RECORDS[name], directory / name
    if path.exists() and _digest(path.read_bytes()) == own.digest:
        return path
    licence = _read(f'{host}/{own.repository}/{own.commit}/LICENSE')
    data = _read(f'{host}/{own.repository}/{own.commit}/{quote(own.path)}')
    if _digest(data) != own.digest:
        raise ConfigError(f'{name}: sha256 {_digest(data)}, must be {own.digest}')
    directory.mkdir(parents=True, exist_ok=True)
    replace_file(directory / f'{path.stem}.LICENSE', licence, is_durable=False)
    replace_file(path, data, is_durable=False)
    return path


def _read(url: str) -> bytes:
    try:
        with urlopen(url, timeout=TIMEOUT_S) as answer:
            data: bytes = answer.read()
            return data
    except (URLError, OSError) as error:
        raise ConfigError(f'{url}: {getattr(error, "reason", error)}') from None


def _digest(data: bytes) -> str:
    return sha256(data).hexdigest()


def main() -> int:
    """Fetch the records of the command line, or all."""
    if len(sys.argv) < 2:
        print(f'usage: python -m scripts.fetch_records DIRECTORY [{" | ".join(RECORDS)}]',
              file=sys.stderr)
        return 2
    try:
        for name in sys.argv[2:] or RECORDS:
            print(fetch(name, Path(sys.argv[1])))
    except ConfigError as error:
        print(f'fetch_records: {error}', file=sys.stderr)
        return error.exit_code
    return 0


if __name__ == '__main__':
    sys.exit(main())
