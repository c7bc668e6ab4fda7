"""Objects and libraries of kernels: nothing undefined, the same bytes as from Python."""

import ctypes
import math
import re
import subprocess

from isa_ros.core.bound import Bound, table_of
from isa_ros.core.elf import Symbol, symbols, undefined_symbols
from isa_ros.core.kernel import entry_of, kernel
from isa_ros.core.kinds import kind_of
from isa_ros.core.objects import (
    _kernel_name, assembled, bitcode_of, ENTRY, library_of, object_of, own_target, Target, TARGETS)
from isa_ros.errors import ConfigError
import llvmlite.binding as llvm
import numpy as np
import pytest
from tests.core.test_bound import count, expected, memory, move, Rows
from tests.core.test_kernel_library import pick
from tests.objects import made_object

MACHINES = {'x86-64': 62, 'x86-64-v3': 62, 'aarch64': 183}      # numbers of ELF's header


@kernel
def call_all(own):
    """Call what machine code has as calls of C; copy and clear rows."""
    numbers = own.numbers
    total = 0.0
    for k in range(8):
        value = numbers[k]
        total += math.frexp(value)[0] + math.floor(value) + value % 0.37 + math.sqrt(abs(value))
    numbers[8] = total
    for k in range(64):
        numbers[64 + k] = numbers[k]
    numbers[:64] = 0.0
    return -7


def numbers():
    """Return a memory of distinct numbers."""
    return Rows(np.linspace(-3.1, 8.3, 128))


@pytest.fixture(scope='module')
def entries():
    """Return three entries by the names they get."""
    return {'isa_move': entry_of(move, kind_of(memory())),
            'isa_count': entry_of(count, kind_of(Rows(np.zeros(1, np.int64)))),
            'isa_call': entry_of(call_all, kind_of(numbers()))}


def loaded(out, name):
    """Return a function of a library that takes a memory."""
    function = getattr(ctypes.CDLL(str(out)), name)
    function.restype = ctypes.c_int64
    function.argtypes = [ctypes.c_void_p]
    return lambda own: function(table_of(own).ctypes.data)


@pytest.mark.parametrize('name', TARGETS)
def test_only_the_entries_are_seen(entries, name):
    code = made_object(entries, TARGETS[name])
    assert code[:6] == b'\x7fELF\x02\x01' and code[18] == MACHINES[name]
    seen = {symbol.name for symbol in symbols(code) if not symbol.is_local}
    assert seen == {
        *entries, 'floor', 'ceil', 'rint', 'fmod', 'numba_frexp', 'memset', 'memcpy', 'memmove',
        'numba_attempt_nocopy_reshape', 'NRT_MemInfo_call_dtor', 'isa_counted'}
    assert undefined_symbols(code) == []


def test_what_is_within_has_the_name_of_its_kernel_and_its_place():
    """The names of numba have numbers of what else the process has compiled."""
    code = made_object({'isa_pick': entry_of(pick, kind_of(Rows(np.array([1]))))}, own_target())
    names = [symbol.name for symbol in symbols(code) if symbol.is_local]
    own = {name.rpartition('.')[0] for name in names if re.fullmatch(r'[a-z_.]+\.\d+', name)}
    assert own == {f'{pick.__module__}.pick', 'constant'}
    assert not any('_ZN' in name or '.const' in name for name in names)
    mangled = '_ZN7isa_ros5plant5spool10stop_spoolB4v120B64c8tJTIeFIjxB2IKSgIE6RecordILi1EEd'
    assert _kernel_name(mangled) == 'isa_ros.plant.spool.stop_spool'
    assert _kernel_name('NRT_incref') == 'NRT_incref'


def test_instructions_of_another_processor_are_refused():
    """LLVM would end the process."""
    code = llvm.parse_assembly(
        f'declare i64 @llvm.x86.rdtsc()\ndefine i64 @{ENTRY}(ptr %table) {{\n'
        '%time = call i64 @llvm.x86.rdtsc()\nret i64 %time }').as_bitcode()
    assert undefined_symbols(object_of({'isa_time': code}, TARGETS['x86-64'])) == []
    with pytest.raises(ConfigError, match='object of isa_time: undefined llvm.x86.rdtsc, must'):
        object_of({'isa_time': code}, TARGETS['aarch64'])


@pytest.mark.parametrize('name', ['x86-64', own_target().name])
def test_a_library_gives_the_same_bytes(entries, name, tmp_path):
    out = tmp_path / 'lib.so'
    library_of([made_object(entries, TARGETS[name])], out)
    own, other = numbers(), numbers()
    assert loaded(out, 'isa_call')(own) == Bound(call_all, other).run() == -7
    assert own.numbers.tobytes() == other.numbers.tobytes()
    assert not own.numbers[:64].any() and own.numbers[72] not in (0.0, numbers().numbers[72])
    masses = memory()
    found = [loaded(out, 'isa_move')(masses) for _ in range(6)]
    places, sums = expected(6)
    assert found == [0, 0, 1, 1, 1, 2]
    assert masses.masses['x'].tolist() == places and masses.table[:, 2].tolist() == sums


def test_a_library_depends_on_nothing(entries, tmp_path):
    out = tmp_path / 'lib.so'
    library_of([made_object(entries, own_target())], out)
    dynamic = subprocess.run(['readelf', '-d', out], capture_output=True, text=True, check=True)
    assert 'NEEDED' not in dynamic.stdout and 'TEXTREL' not in dynamic.stdout
    exported = subprocess.run(['nm', '-D', out], capture_output=True, text=True, check=True)
    assert sorted(line.split()[-1] for line in exported.stdout.splitlines()) == sorted(entries)


def test_two_objects_in_a_library(entries, tmp_path):
    out = tmp_path / 'lib.so'
    library_of([made_object({name: entry}, own_target()) for name, entry in entries.items()], out)
    calls = Rows(np.zeros(1, np.int64))
    assert loaded(out, 'isa_count')(calls) == 0 and calls.numbers[0] == 1


def test_symbols_of_an_object():
    code = assembled('declare double @f(double)\n define internal void @own() { ret void }\n'
                     'define double @g(double %x) { call void @own() \n'
                     ' %y = call double @f(double %x) ret double %y }', TARGETS['x86-64'])
    found = {symbol.name: symbol for symbol in symbols(code)}
    assert found['f'] == Symbol('f', False, False) and found['g'] == Symbol('g', False, True)
    assert found['own'] == Symbol('own', True, True)
    assert undefined_symbols(code) == ['f']


def test_a_linker_links_too(entries, tmp_path):
    """That of a cross compiler comes without the compiler."""
    out = tmp_path / 'lib.so'
    library_of([made_object({'isa_count': entries['isa_count']}, own_target())], out, 'ld')
    given = Rows(np.array([3]))
    assert loaded(out, 'isa_count')(given) == Bound(count, Rows(np.array([3]))).run()
    assert b'lib.so' in out.read_bytes()


@kernel
def take_sine(own):
    """Call a function that no object has."""
    own.numbers[0] = math.sin(own.numbers[0])
    return 0


def test_undefined_symbols_are_refused():
    with pytest.raises(ConfigError, match=r'^object of isa_sine: undefined sin, must have none$'):
        made_object({'isa_sine': entry_of(take_sine, kind_of(numbers()))}, own_target())


@kernel
def swap(own):
    """Swap two numbers of a table."""
    rows = own.numbers.reshape(2, 2)
    rows[0, 1], rows[1, 0] = rows[1, 0], rows[0, 1]
    return 5


@pytest.mark.parametrize('name', TARGETS)
def test_another_shape_of_an_array_is_for_all_targets(name, tmp_path):
    """Also once the compiling processor's machine code was made."""
    given = Rows(np.array([1.0, 2.0, 3.0, 4.0]))
    assert (Bound(swap, given).run(), given.numbers.tolist()) == (5, [1.0, 3.0, 2.0, 4.0])
    code = made_object({'isa_swap': entry_of(swap, kind_of(given))}, TARGETS[name])
    assert undefined_symbols(code) == []
    if TARGETS[name].triple == own_target().triple:
        library_of([code], tmp_path / 'lib.so')
        assert loaded(tmp_path / 'lib.so', 'isa_swap')(given) == 5
        assert given.numbers.tolist() == [1.0, 2.0, 3.0, 4.0]


@kernel
def share_array(own):
    """Hold a view in a way that counts who refers to it, with an instruction of this processor."""
    half = own.numbers.copy()
    own.numbers[:64] = half[32:96]
    return len(half)


def test_undefined_symbols_of_bitcode_are_refused():
    code = bitcode_of(entry_of(take_sine, kind_of(numbers())))
    with pytest.raises(ConfigError, match=r'^object of a, b: undefined sin, must have none$'):
        object_of({'a': code, 'b': code}, own_target())


@pytest.mark.parametrize('name', ['x86-64', 'aarch64'])
def test_kernels_that_allocate_are_refused(name):
    """LLVM ends the process where another processor lacks an instruction."""
    with pytest.raises(ConfigError, match=r'^object of isa_half: undefined .+, must have none$'):
        made_object({'isa_half': entry_of(share_array, kind_of(numbers()))}, TARGETS[name])


def test_without_a_compiler(tmp_path):
    out = tmp_path / 'lib.so'
    with pytest.raises(ConfigError, match=r'lib\.so: no C compiler none-such to link it with$'):
        library_of([], out, compiler='none-such')


def test_a_linker_that_fails(entries, tmp_path):
    other = next(target for target in TARGETS.values() if target.triple != own_target().triple)
    with pytest.raises(ConfigError, match=r'lib\.so: cc cannot link it: .+$'):
        library_of([made_object({'isa_count': entries['isa_count']}, other)], tmp_path / 'lib.so')


def test_the_own_target(monkeypatch):
    from isa_ros.core.objects import llvm
    features = dict.fromkeys(('avx2', 'bmi', 'bmi2', 'f16c', 'fma', 'lzcnt', 'movbe'), True)
    monkeypatch.setattr(llvm, 'get_host_cpu_features', lambda: features)
    monkeypatch.setattr(llvm, 'get_process_triple', lambda: 'x86_64-unknown-linux-gnu')
    assert own_target().name == 'x86-64-v3'
    for feature in features:
        monkeypatch.setattr(llvm, 'get_host_cpu_features',
                            lambda left=feature: {**features, left: False})
        assert own_target().name == 'x86-64'
    monkeypatch.setattr(llvm, 'get_process_triple', lambda: 'aarch64-unknown-linux-gnu')
    assert own_target() == Target('aarch64', 'aarch64-unknown-linux-gnu', 'generic')
    monkeypatch.setattr(llvm, 'get_process_triple', lambda: 'riscv64-unknown-linux-gnu')
    with pytest.raises(ConfigError, match='processor riscv64: no target, valid: x86-64-v3'):
        own_target()
