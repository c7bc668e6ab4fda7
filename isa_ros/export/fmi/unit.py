"""Units of an actuator with its supply: description and library in one archive a version."""

from collections.abc import Mapping, Sequence
import hashlib
from importlib.resources import files
from io import BytesIO
from typing import NamedTuple
import zipfile

from isa_ros.core.objects import Target
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.export.chosen import ChosenActuator
from isa_ros.export.exported import Called, Exported, exported
from isa_ros.export.fmi import tables
from isa_ros.export.fmi.description import About, description, Version
from isa_ros.export.fmi.supply import supplied, UnitSupply
from isa_ros.export.fmi.table import variables
from isa_ros.export.fmi.tuned import tuned, TunedValue
from isa_ros.export.fmi.variables import Variable
from isa_ros.export.header import filled
from isa_ros.export.kernels import objects_of
from isa_ros.export.library import built, processor_of, texts

PLATFORMS: Mapping[str, Mapping[Version, str]] = {
    'x86_64': {Version.FMI2: 'linux64', Version.FMI3: 'x86_64-linux'},
    'aarch64': {Version.FMI2: 'linux-aarch64', Version.FMI3: 'aarch64-linux'}}
"""Folder of the library by processor and version; the second version has no name for aarch64."""
SHARED = ('types.h', 'unit.h', 'inside.h', 'unit.c', 'step.c', 'state.c')
SHIMS: Mapping[Version, Sequence[str]] = {
    Version.FMI2: ('fmi2.h', 'fmi2.c'),
    Version.FMI3: ('fmi3.h', 'fmi3.c', 'fmi3_absent.c')}
"""What is of one version alone."""
_FLAGS = ('-std=c11', '-O2', '-fPIC', '-fvisibility=hidden', '-ffp-contract=off', '-shared',
          '-Wl,--no-undefined', '-Wl,-z,noexecstack', '-Wl,--version-script=exports.map')
_DATE = (1980, 1, 1, 0, 0, 0)    # of all files, so that equal units are equal bytes
_TOKEN_DIGITS = 32


class UnitParts(NamedTuple):
    """An actuator, its supply, and the variables of their unit."""

    own: Exported
    supply: UnitSupply
    may_change: Sequence[TunedValue]
    table: Sequence[Variable]

    @property
    def files(self) -> dict[str, Version]:
        """Return the versions by the names of their files."""
        return {f'{self.own.word}_fmi{version.value[0]}.fmu': version for version in Version}

    @property
    def kernels(self) -> tuple[tuple[Called, ...], ...]:
        """Return the kernels of each object: of the actuator, and of the supply."""
        return self.own.kernels, self.supply.kernels


class UnitContent(NamedTuple):
    """What both versions of a unit are made of."""

    parts: UnitParts
    token: str
    sources: Mapping[str, str]
    """Texts of C by file."""
    objects: tuple[bytes, ...]
    """Kernels of the actuator, and of the supply."""
    processor: str


def parts_of(chosen: ChosenActuator, name: str | None = None) -> UnitParts:
    """
    Return the parts of an actuator's unit; ``name`` is that of the library.

    Raises
    ------
    ConfigError
        As `isa_ros.export.exported.word_of`, or its supply is a circuit.

    """
    own, supply = exported(chosen, name=name), supplied(chosen)
    may_change = tuned(own)
    return UnitParts(own, supply, may_change,
                     variables(chosen, supply.config, own.start[0], may_change))


def units(parts: UnitParts, target: Target, compiler: str = 'cc') -> dict[str, bytes]:
    """Return the files of a unit, one a version, by name; raises as `made` and `archive`."""
    own = made(parts, target)
    return {name: archive(own, version, compiler) for name, version in parts.files.items()}


def made(parts: UnitParts, target: Target) -> UnitContent:
    """
    Return what the units are made of for a kind of processor.

    Raises
    ------
    RunError
        As `isa_ros.export.kernels.objects_of`.

    """
    own, supply, may_change, table = parts
    objects = objects_of(parts.kernels, target)
    of_library = texts(own)
    sources = {
        f'{own.word}.c': of_library[f'{own.word}.c'] + filled(
            _source('constants.c'), {'NAME': own.word}),
        **{file: of_library[file] for file in (f'{own.word}.h', f'{own.word}_tables.h')},
        **{file: _source(file) for names in (SHARED, *SHIMS.values()) for file in names},
        'tables.c': tables.source(own, supply, table, may_change)}
    text = ''.join((*sources.values(), tables.header(own, supply, table, '')))
    token = hashlib.sha256(b''.join((*objects, text.encode()))).hexdigest()[:_TOKEN_DIGITS]
    sources['tables.h'] = tables.header(own, supply, table, token)
    return UnitContent(parts, token, sources, objects, processor_of(target))


def _source(name: str) -> str:
    return (files('isa_ros.export.fmi') / 'sources' / name).read_text(encoding='utf-8')


def archive(own: UnitContent, version: Version, compiler: str = 'cc') -> bytes:
    """
    Return the bytes of a unit, a .fmu; equal ones for equal parts and the same compiler.

    Raises
    ------
    ConfigError
        As `isa_ros.export.library.built`.

    """
    actuator = own.parts.own
    word, config, run = actuator.word, actuator.chosen.config, actuator.chosen.run
    step = actuator.step_ns / NS_PER_SECOND
    about = About(config.name, word, own.token,
                  f'actuator {config.name} of {run.source}, model {config.model}, with its '
                  f'supply; its tick is {step:g} s'
                  + ''.join(f'; assumed: {own}' for own in actuator.chosen.assumptions), step)
    found = BytesIO()
    with zipfile.ZipFile(found, 'w', zipfile.ZIP_DEFLATED) as file:
        for path, content in (
                ('modelDescription.xml', description(about, own.parts.table, version)),
                (f'binaries/{PLATFORMS[own.processor][version]}/{word}.so',
                 library(own, version, compiler))):
            file.writestr(zipfile.ZipInfo(path, _DATE), content, zipfile.ZIP_DEFLATED)
    return found.getvalue()


def library(own: UnitContent, version: Version, compiler: str = 'cc') -> bytes:
    """Return the shared library of a unit; raises as `archive`."""
    objects = {f'kernels_{k}.o': content for k, content in enumerate(own.objects)}
    exports = f'{{ global: fmi{version.value[0]}*; local: *; }};\n'
    files = {name: text.encode() for name, text in own.sources.items()} | objects | {
        'exports.map': exports.encode()}
    others = {file for other, shim in SHIMS.items() if other is not version for file in shim}
    sources = [name for name in own.sources if name.endswith('.c') and name not in others]
    return built(f'{own.parts.own.word}.so', files, [*_FLAGS, *sources, *objects], own.processor,
                 compiler)
