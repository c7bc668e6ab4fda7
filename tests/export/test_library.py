"""A library of an actuator: its files need nothing, and are the same every time."""

import ctypes
import re
import subprocess

from isa_ros.config.assembly import group_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.bound import table_of
from isa_ros.core.elf import symbols
from isa_ros.core.objects import library_of, own_target, TARGETS
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
from isa_ros.export.library import compiler_of, FLAGS, kernels_of, library, names_of, processor_of
import numpy as np
import pytest
from tests.export.calls import command, port
from tests.export.libraries import Instance, Loaded, written

pytestmark = pytest.mark.slow
FUNCTIONS = (
    'about', 'applied', 'create', 'fed', 'field', 'field_count', 'find', 'load_position',
    'message', 'parameter', 'parameter_count', 'reply', 'restore', 'sample', 'save', 'size',
    'start', 'state_size', 'tick', 'time_ns')
WARNINGS = ('-Wall', '-Wextra', '-Wpedantic', '-Werror')


def test_a_library_has_the_functions_of_its_header_and_needs_nothing(path):
    listed = subprocess.run(['nm', '-D', path], capture_output=True, text=True, check=True)
    assert sorted(line.split()[1:] for line in listed.stdout.splitlines()) == [
        ['T', f'isa_v5_{name}'] for name in FUNCTIONS]
    text = (path.parent / 'isa_v5.h').read_text()
    assert set(re.findall(r'\bisa_v5_(\w+)\(', text)) == set(FUNCTIONS)
    needed = subprocess.run(['ldd', path], capture_output=True, text=True)
    assert 'statically linked' in needed.stdout + needed.stderr
    dynamic = subprocess.run(['readelf', '-dW', path], capture_output=True, text=True, check=True)
    assert 'NEEDED' not in dynamic.stdout and 'TEXTREL' not in dynamic.stdout
    assert 'libisa_v5.so' in dynamic.stdout


def test_a_library_has_no_memory_that_instances_share(path):
    """Only what the loader fills before the first call, and then protects."""
    sections = subprocess.run(['readelf', '-SW', path], capture_output=True, text=True).stdout
    writable = {line.split(']')[1].split()[0] for line in sections.splitlines()
                if re.search(r' WA ', line)}
    assert writable <= {'.data.rel.ro', '.dynamic', '.got', '.got.plt'}


def test_names_are_those_of_the_files(own, path):
    assert sorted(names_of(own)) == sorted(file.name for file in path.parent.iterdir())


@pytest.mark.parametrize('compiler', ['cc', 'clang'])
def test_the_source_has_no_warnings(path, tmp_path, compiler):
    if subprocess.run(['which', compiler], capture_output=True).returncode:
        pytest.skip(f'{compiler} is not installed')
    done = subprocess.run(
        [compiler, *FLAGS, *WARNINGS, '-o', tmp_path / 'lib.so', 'isa_v5.c', 'isa_v5_kernels.o'],
        cwd=path.parent, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, '')


def test_the_command_in_the_source_builds_the_library(path, tmp_path):
    text = (path.parent / 'isa_v5.c').read_text()
    given = re.search(r' \*   (cc .*?)\n \*/', text, re.DOTALL)[1].replace('\n *', ' ')
    made = tmp_path / 'libisa_v5.so'
    subprocess.run(given.replace('-o libisa_v5.so', f'-o {made}'), shell=True, check=True,
                   cwd=path.parent)
    one, other = Instance(Loaded(path, 'isa_v5')), Instance(Loaded(made, 'isa_v5'))
    for _ in range(5):
        assert one.tick(port(x0=0.0501)) == other.tick(port(x0=0.0501)) == 0
    assert one.save().tobytes() == other.save().tobytes()


@pytest.mark.parametrize('name', ['x86-64', 'aarch64'])
def test_kernels_of_every_target_need_nothing(own, name):
    found = list(symbols(kernels_of(own, TARGETS[name])))
    assert all(symbol.is_defined for symbol in found)
    assert {'kernel_group_tick', 'kernel_start_actuator'} <= {symbol.name for symbol in found}


@pytest.mark.parametrize('name', ['x86-64', own_target().name])
def test_its_tick_is_that_of_all_actuators_of_a_run(own, name, tmp_path):
    """Those of the leg, over 100 ticks with steps of their setpoints."""
    library_of([kernels_of(own, TARGETS[name])], tmp_path / 'lib.so')
    tick = ctypes.CDLL(str(tmp_path / 'lib.so'))['kernel_group_tick']
    tick.restype, tick.argtypes = ctypes.c_int64, [ctypes.c_void_p]
    groups = [group_of(load_run(find('leg', CONFIG))) for _ in range(2)]
    for k in range(100):
        found = []
        for group in groups:
            rows = group.ticked
            rows.ports['supply_pressure'] = 20.7e6
            rows.ports['x0'] = rows.memory.samples['position']
            rows.commands['kinds'] = HAS_SETPOINT if k % 20 == 0 else 0
            rows.commands['position'] = rows.memory.samples['position'] + 1e-3 * (k % 7 - 3)
            found.append(group.tick.run() if group is groups[0]
                         else tick(table_of(rows).ctypes.data))
        assert found == [0, 0], k
    first, second = (group.ticked.memory for group in groups)
    assert np.ptp(first.samples['spool']) > 0.0
    for name, rows, others in zip(first._fields, first, second):
        assert rows.tobytes() == others.tobytes(), name


def test_every_target_of_this_processor_gives_the_same_bytes(own, loaded, tmp_path):
    others = [target for target in TARGETS.values()
              if target.triple == own_target().triple and target != own_target()]
    for target in others:
        one = Instance(loaded)
        other = Instance(Loaded(written(own, tmp_path / target.name, target), 'isa_v5'))
        for k in range(100):
            given = port(x0=0.05 + 1e-4 * np.sin(0.1 * k)), command(HAS_SETPOINT, position=0.051)
            assert one.tick(*given) == other.tick(*given) == 0
        assert one.save().tobytes() == other.save().tobytes()
    assert others or not own_target().name.startswith('x86-64')


def test_an_export_is_the_same_every_time(own, path):
    again = library(exported(choose('isa_v5', {'reu.force.kp': 9.5e-08})), own_target())
    for name, content in again.items():
        assert (path.parent / name).read_bytes() == content, name


def test_compilers_that_are_refused():
    with pytest.raises(ConfigError, match='^--compiler none-such: no such C compiler'):
        compiler_of('none-such', 'x86_64')
    with pytest.raises(ConfigError, match='^--compiler cc is for .+, must be a C compiler for '
                                          'sparc$'):
        compiler_of('cc', 'sparc')
    with pytest.raises(ConfigError, match='^--compiler false is for no known processor'):
        compiler_of('false', 'x86_64')
    assert [processor_of(target) for target in TARGETS.values()] == ['x86_64', 'x86_64', 'aarch64']


def test_a_compiler_that_fails(own, tmp_path, monkeypatch):
    script = tmp_path / 'my-cc'
    script.write_text('#!/bin/sh\nif [ "$1" = -dumpmachine ]; then exec cc -dumpmachine; fi\n'
                      'echo "note" >&2; echo "x.c:1: error: no way" >&2; exit 3\n')
    script.chmod(0o755)
    with pytest.raises(ConfigError, match=r'^libisa_v5\.so: .*my-cc cannot build it: x\.c:1: '
                                          r'error: no way$'):
        library(own, own_target(), str(script))
