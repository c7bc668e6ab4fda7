"""An actuator as a shared library of C: its kernels, and the text beside them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import re
import shutil
import subprocess
import tempfile

from isa_ros.core.objects import Target, TARGETS
from isa_ros.errors import ConfigError
from isa_ros.export.exported import Exported
from isa_ros.export.header import filled, header, source
from isa_ros.export.kernels import objects_of
from isa_ros.export.tables import tables

EXAMPLES = ('example.c', 'example.cpp')
FLAGS = ('-std=c11', '-O2', '-fPIC', '-fvisibility=hidden', '-ffreestanding',
         '-fno-stack-protector', '-shared', '-nostdlib', '-Wl,--no-undefined',
         '-Wl,-z,noexecstack')
"""Of the compiler, to make a library that needs no other."""
_FUNCTION = re.compile(r'^ISA_EXPORT .*\bISA\((\w+)\)', re.MULTILINE)


def kernels_of(own: Exported, target: Target) -> bytes:
    """
    Return the object of the kernels of an actuator; those of all are the same.

    Raises
    ------
    RunError
        As `isa_ros.export.kernels.objects_of`.

    """
    return objects_of((own.kernels,), target)[0]


def texts(own: Exported) -> Mapping[str, str]:
    """Return the text files of an actuator's library by their names, examples among them."""
    word, config = own.word, own.chosen.config
    about = f'the actuator {config.name} of {own.chosen.run.source}, model {config.model}'
    code = filled(source('actuator.c'), {'NAME': word})
    return {
        f'{word}.h': header(word, about, own.chosen.assumptions), f'{word}.c': code,
        f'{word}_tables.h': tables(own), f'{word}.map': _symbols(word, code),
        **{name: filled(source(name), {'NAME': word}) for name in EXAMPLES}}


def _symbols(word: str, code: str) -> str:
    """Return the list of what is seen of a library, for its linker."""
    names = ' '.join(f'{word}_{name};' for name in _FUNCTION.findall(code))
    return f'{{ global: {names} local: *; }};\n'


def names_of(own: Exported) -> Sequence[str]:
    """Return the names of all files of an actuator's library."""
    word = own.word
    return (f'{word}.h', f'{word}.c', f'{word}_tables.h', f'{word}.map', f'{word}_kernels.o',
            f'lib{word}.so', *EXAMPLES)


def library(own: Exported, target: Target, compiler: str = 'cc') -> Mapping[str, bytes]:
    """
    Return the files of an actuator's library by name.

    Raises
    ------
    ConfigError
        There is no such C compiler, or it fails, with its first line.
    RunError
        As `kernels_of`.

    """
    word = own.word
    files = {name: text.encode() for name, text in texts(own).items()}
    files[f'{word}_kernels.o'] = kernels_of(own, target)
    name = f'lib{word}.so'
    files[name] = built(
        name, files, [*FLAGS, f'-Wl,--version-script={word}.map', f'-Wl,-soname,{name}',
                      f'{word}.c', f'{word}_kernels.o'], processor_of(target), compiler)
    return files


def built(
        name: str, files: Mapping[str, bytes], arguments: Sequence[str], processor: str,
        compiler: str) -> bytes:
    """
    Return the library that a C compiler makes of files, which its arguments name.

    Raises
    ------
    ConfigError
        As `compiler_of`; or the compiler fails, with its first error.

    """
    found = compiler_of(compiler, processor)
    with tempfile.TemporaryDirectory() as directory:
        for own, content in files.items():
            Path(directory, own).write_bytes(content)
        done = subprocess.run(
            [found, '-o', name, *arguments], cwd=directory, capture_output=True, text=True)
        if done.returncode:
            lines = done.stderr.splitlines() or [f'exit code {done.returncode}']
            first = next((line for line in lines if 'error' in line), lines[0])
            raise ConfigError(f'{name}: {compiler} cannot build it: {first}')
        return Path(directory, name).read_bytes()


def processor_of(target: Target) -> str:
    """Return the processor of a target, as compilers name it."""
    return target.triple.partition('-')[0]


def compiler_of(name: str, processor: str) -> str:
    """
    Return the path of a C compiler for a processor, the first word of its targets' triples.

    Raises
    ------
    ConfigError
        There is none, or it is for another processor.

    """
    found = shutil.which(name)
    if found is None:
        raise ConfigError(f'--compiler {name}: no such C compiler, which builds the library')
    done = subprocess.run([found, '-dumpmachine'], capture_output=True, text=True)
    machine = done.stdout.strip()
    if done.returncode or machine.partition('-')[0] != processor:
        raise ConfigError(f'--compiler {name} is for {machine or "no known processor"}, must be '
                          f'a C compiler for {processor}')
    return found


def target_of(name: str) -> Target:
    """
    Return a target by its name.

    Raises
    ------
    ConfigError
        There is none of this name.

    """
    if name not in TARGETS:
        raise ConfigError(f'--target {name}, valid: {", ".join(TARGETS)}')
    return TARGETS[name]
