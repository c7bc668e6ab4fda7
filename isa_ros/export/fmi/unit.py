"""Units of an actuator with its supply: description and library in one archive a version."""

from collections.abc import Mapping, Sequence
import hashlib
from importlib.resources import files
from io import BytesIO
from pathlib import Path
import subprocess
import tempfile
from typing import NamedTuple
import zipfile

from isa_ros.core.kernel import entry_of
from isa_ros.core.kinds import kind_of
from isa_ros.core.objects import object_of, Target
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import Chosen
from isa_ros.export.exported import Exported, exported
from isa_ros.export.fmi import tables
from isa_ros.export.fmi.description import About, description, Version
from isa_ros.export.fmi.supply import Supplied, supplied
from isa_ros.export.fmi.table import variables
from isa_ros.export.fmi.variables import Variable
from isa_ros.export.library import compiler_of, kernels_of, texts

PLATFORMS: Mapping[str, Mapping[Version, str]] = {
    'x86_64': {Version.FMI2: 'linux64', Version.FMI3: 'x86_64-linux'},
    'aarch64': {Version.FMI2: 'linux-aarch64', Version.FMI3: 'aarch64-linux'}}
"""Folder of the library by processor and version; the second version has no name for aarch64."""
SHARED = ('unit.h', 'inside.h', 'unit.c', 'step.c', 'state.c')
_FLAGS = ('-std=c11', '-O2', '-fPIC', '-fvisibility=hidden', '-ffp-contract=off', '-shared',
          '-Wl,--no-undefined', '-Wl,-z,noexecstack', '-Wl,--version-script=exports.map')
_DATE = (1980, 1, 1, 0, 0, 0)    # of all files, so that equal units are equal bytes
_TOKEN_DIGITS = 32


class Made(NamedTuple):
    """What both versions of a unit are made of."""

    own: Exported
    supply: Supplied
    table: Sequence[Variable]
    token: str
    sources: Mapping[str, str]
    """Texts of C by file."""
    objects: tuple[bytes, bytes]
    """Kernels of the actuator, and of the supply."""
    processor: str


def made(chosen: Chosen, target: Target, name: str | None = None) -> Made:
    """
    Return what the units of an actuator are made of; ``name`` is that of the library.

    Raises
    ------
    ConfigError
        As `isa_ros.export.exported.word_of`, or its supply is a circuit.

    """
    own, supply = exported(chosen, name=name), supplied(chosen)
    table = variables(chosen, supply.config, own.start[0])
    objects = kernels_of(own, target), object_of({
        one.name: entry_of(one.function, kind_of(one.memory))
        for one in (*supply.before, *supply.after)}, target)
    of_library = texts(own)
    sources = {
        **{file: of_library[file] for file in (
            f'{own.word}.h', f'{own.word}.c', f'{own.word}_tables.h')},
        **{file: _source(file) for file in (*SHARED, *map(_shim, Version))},
        'tables.c': tables.source(supply, table)}
    text = ''.join((*sources.values(), tables.header(own, supply, table, '')))
    token = hashlib.sha256(b''.join((*objects, text.encode()))).hexdigest()[:_TOKEN_DIGITS]
    sources['tables.h'] = tables.header(own, supply, table, token)
    return Made(own, supply, table, token, sources, objects, target.triple.partition('-')[0])


def _source(name: str) -> str:
    return (files('isa_ros.export.fmi') / 'sources' / name).read_text(encoding='utf-8')


def _shim(version: Version) -> str:
    """Return the name of the source of a version."""
    return f'fmi{version.value[0]}.c'


def archive(own: Made, version: Version, compiler: str = 'cc') -> bytes:
    """
    Return the bytes of a unit, a .fmu; equal ones for equal parts and the same compiler.

    Raises
    ------
    ConfigError
        There is no such C compiler, or it fails, with its first line.

    """
    word, config = own.own.word, own.own.chosen.config
    step = own.own.step_ns / NS_PER_SECOND
    about = About(config.name, word, own.token,
                  f'actuator {config.name} of {own.own.chosen.run.source}, model {config.model}, '
                  f'with its supply; its tick is {step:g} s', step)
    found = BytesIO()
    with zipfile.ZipFile(found, 'w', zipfile.ZIP_DEFLATED) as file:
        for path, content in (
                ('modelDescription.xml', description(about, own.table, version)),
                (f'binaries/{PLATFORMS[own.processor][version]}/{word}.so',
                 library(own, version, compiler))):
            file.writestr(zipfile.ZipInfo(path, _DATE), content, zipfile.ZIP_DEFLATED)
    return found.getvalue()


def library(own: Made, version: Version, compiler: str = 'cc') -> bytes:
    """Return the shared library of a unit; raises as `archive`."""
    path = compiler_of(compiler, own.processor)
    others = {_shim(other) for other in Version if other is not version}
    with tempfile.TemporaryDirectory() as directory:
        place = Path(directory)
        for name, text in own.sources.items():
            (place / name).write_text(text, encoding='utf-8')
        objects = [f'kernels_{k}.o' for k in range(len(own.objects))]
        for name, content in zip(objects, own.objects):
            (place / name).write_bytes(content)
        (place / 'exports.map').write_text(
            f'{{ global: fmi{version.value[0]}*; local: *; }};\n', encoding='utf-8')
        sources = [name for name in own.sources if name.endswith('.c') and name not in others]
        done = subprocess.run([path, *_FLAGS, '-o', 'library.so', *sources, *objects], cwd=place,
                              capture_output=True, text=True)
        if done.returncode:
            lines = done.stderr.splitlines() or [f'exit code {done.returncode}']
            first = next((line for line in lines if 'error' in line), lines[0])
            raise ConfigError(f'{own.own.word}: {compiler} cannot build its library: {first}')
        return (place / 'library.so').read_bytes()
