"""A library of an actuator: without dependencies, refusing what is wrong, safe in threads."""

import ctypes
from itertools import pairwise
import os
import re
import subprocess
import sys
import threading

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.integration import state_name, STATE_SIZE
from isa_ros.config.assembly import timing_of
from isa_ros.core.device import MODES
from isa_ros.core.elf import symbols
from isa_ros.core.fields import units_of
from isa_ros.core.objects import own_target, TARGETS
from isa_ros.core.signals import (
    COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT,
    LOAD_PORT, SAMPLE, SAMPLE_FIELDS)
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
from isa_ros.export.library import compiler_of, FLAGS, kernels_of, library, names_of, processor_of
import numpy as np
import pytest
from tests.export.libraries import BEHIND, Instance, Loaded, sealed, written

pytestmark = pytest.mark.slow

NO_INSTANCE, NOT_FINITE, BEYOND_RANGE, UNKNOWN_KIND, UNKNOWN_MODE, WRONG_MODE = range(-1, -7, -1)
PRESSURES, WRONG_SIZE, WRONG_STATE = -7, -8, -9
FUNCTIONS = (
    'about', 'applied', 'create', 'fed', 'field', 'field_count', 'find', 'load_position',
    'message', 'parameter', 'parameter_count', 'reply', 'restore', 'sample', 'save', 'size',
    'start', 'state_size', 'tick', 'time_ns')
WARNINGS = ('-Wall', '-Wextra', '-Wpedantic', '-Werror')


@pytest.fixture(scope='module')
def own():
    """Return an ISA v5 whose load is that of the caller."""
    return exported(choose('isa_v5', {'reu.force.kp': 9.5e-08}))


@pytest.fixture(scope='module')
def path(own, tmp_path_factory):
    """Return the path of its library."""
    return written(own, tmp_path_factory.mktemp('isa_v5'))


@pytest.fixture(scope='module')
def loaded(path):
    """Return its functions."""
    return Loaded(path, 'isa_v5')


@pytest.fixture(scope='module')
def limiting(tmp_path_factory):
    """Return the functions of one whose setpoints are limited to their range."""
    own = exported(choose('isa_v5', {'beyond_range': 'limit'}), name='limiting')
    return Loaded(written(own, tmp_path_factory.mktemp('limiting')), 'limiting')


def port(**values):
    """Return a `LOAD_PORT` at mid stroke with a supply."""
    row = np.zeros((), LOAD_PORT)
    row['x0'], row['supply_pressure'] = 0.05, 20.7e6
    for name, value in values.items():
        row[name] = value
    return row


def command(kinds, **values):
    """Return a `COMMAND` that keeps its gains."""
    row = np.zeros((), COMMAND)
    row['kinds'], row['position'] = kinds, 0.05
    row['stiffness'] = row['damping'] = np.nan
    for name, value in values.items():
        row[name] = value
    return row


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


def test_what_it_is(loaded, own):
    class About(ctypes.Structure):
        _fields_ = [*((name, ctypes.c_char_p) for name in ('name', 'model', 'version', 'digest')),
                    ('step_ns', ctypes.c_int64), ('is_rotary', ctypes.c_int),
                    ('has_own_load', ctypes.c_int), ('start', ctypes.c_double * 4)]
    from isa_ros.core.version import VERSION
    about = ctypes.cast(loaded.call('about', result=ctypes.c_void_p),
                        ctypes.POINTER(About)).contents
    assert (about.name, about.model, about.version) == (b'isa_v5', b'isa_v5', VERSION.encode())
    assert about.digest.decode() == own.actuator.digest
    assert (about.step_ns, about.is_rotary, about.has_own_load) == (1_000_000, 0, 0)
    assert list(about.start) == [0.05, 0.0, 20.7e6, 0.0]
    assert Instance(loaded).save().tobytes()[-BEHIND:-8] == about.digest


class Texts(ctypes.Structure):
    """A parameter or a signal, as far as both have the same fields."""

    _fields_ = [('texts', ctypes.c_char_p * 3)]


class Parameter(ctypes.Structure):
    """A parameter."""

    _fields_ = [('name', ctypes.c_char_p), ('value', ctypes.c_char_p),
                ('number', ctypes.c_double), ('unit', ctypes.c_char_p),
                ('range', ctypes.c_char_p), ('source', ctypes.c_char_p),
                ('meaning', ctypes.c_char_p)]


def parameter(address):
    """Return the parameter at an address."""
    return ctypes.cast(address, ctypes.POINTER(Parameter)).contents


def test_parameters_are_those_of_isa_params(loaded, own):
    from isa_ros.config.listing import describe
    listed = describe('isa_v5', values={'reu.force.kp': 9.5e-08}).split('\n\n')
    table = next(text for text in listed if text.startswith('actuators.isa_v5.parameters'))
    rows = [line.split()[:2] for line in table.splitlines()[2:]]
    count = loaded.call('parameter_count')
    found = [parameter(loaded.call('parameter', k, result=ctypes.c_void_p))
             for k in range(count)]
    assert [one.name.decode() for one in found] == [row[0] for row in rows]
    for one, row in zip(found, rows):
        assert one.value.decode().split() == [] or one.value.decode().startswith(row[1])
    assert loaded.call('parameter', count, result=ctypes.c_void_p) is None
    assert loaded.call('parameter', -1, result=ctypes.c_void_p) is None


def test_parameters_by_name(loaded):
    def named(name):
        return loaded.call('find', name, result=ctypes.c_void_p)
    kp = parameter(named(b'reu.force.kp'))
    assert (kp.name, kp.value, kp.number, kp.source) == (
        b'reu.force.kp', b'9.5e-08', 9.5e-08, b'--set')
    bore = parameter(named(b'plant.drive.bore_mm'))
    assert (bore.number, bore.unit, bore.source) == (21.5, b'mm', b'paper Table 2')
    assert bore.range.startswith(b'> 0') and b'piston' in bore.meaning
    assert np.isnan(parameter(named(b'plant.kind')).number)
    assert parameter(named(b'reu.force.kv')).unit == b'output per m/s'
    for name in (b'plant.drive.bore', b'plant.drive.bore_mmm', b'', None):
        assert named(name) is None


def test_signals_have_names_and_units(loaded):
    units = units_of(SAMPLE_FIELDS)
    assert loaded.call('field_count') == len(SAMPLE_FIELDS) == SAMPLE.itemsize // 8
    for k, field in enumerate(SAMPLE_FIELDS):
        address = loaded.call('field', k, result=ctypes.c_void_p)
        texts = ctypes.cast(address, ctypes.POINTER(Texts)).contents.texts
        assert [text.decode() for text in texts] == [
            field.name, units[field.name], field.meaning]
    for k in (-1, len(SAMPLE_FIELDS)):
        assert loaded.call('field', k, result=ctypes.c_void_p) is None


def test_an_instance_needs_its_memory(loaded):
    size = loaded.size('size')
    memory = np.zeros(size + 64, np.uint8)
    begin = -memory.ctypes.data % 16

    def created(at, given):
        return loaded.call('create', memory[at:], ctypes.c_size_t(given),
                           result=ctypes.c_void_p)
    assert created(begin, size) == memory[begin:].ctypes.data
    assert created(begin, size - 1) is None and created(begin + 8, size) is None
    assert loaded.call('create', None, ctypes.c_size_t(size), result=ctypes.c_void_p) is None


def test_nothing_outside_its_memory_is_written(loaded):
    size = loaded.size('size')
    memory = np.full(size + 4096, 0x5a, np.uint8)
    begin = 1024 + -memory[1024:].ctypes.data % 16
    own = memory[begin:begin + size]
    loaded.call('create', own, ctypes.c_size_t(size), result=ctypes.c_void_p)
    for k in range(50):
        given = port(x0=0.05 + 1e-5 * k)
        assert loaded.call('tick', own, given, None, None) == 0
    assert (memory[:begin] == 0x5a).all() and (memory[begin + size:] == 0x5a).all()


def test_no_instance(loaded):
    assert loaded.call('tick', None, None, None, None) == NO_INSTANCE
    assert loaded.call('start', None, None) == NO_INSTANCE
    state = np.zeros(loaded.size('state_size'), np.uint8)
    size = ctypes.c_size_t(len(state))
    instance = Instance(loaded)
    for name in ('save', 'restore'):
        assert loaded.call(name, None, state, size) == NO_INSTANCE
        assert loaded.call(name, instance.memory, None, size) == NO_INSTANCE
    for name in ('sample', 'reply', 'fed', 'applied'):
        assert loaded.call(name, None, result=ctypes.c_void_p) is None
    assert loaded.call('time_ns', None, result=ctypes.c_int64) == 0
    assert np.isnan(loaded.call('load_position', None, result=ctypes.c_double))


def started(chosen, *start):
    """Return the actuator in Python, started."""
    actuator = SmartActuator(chosen.config, timing_of(chosen.run))
    actuator.start(*start)
    return actuator


def test_starts(loaded):
    instance = Instance(loaded)
    before = instance.save().tobytes()
    for k in range(4):
        numbers = [0.05, 10.0, 20e6, 1e5]
        numbers[k] = [np.nan, np.inf, -np.inf, np.nan][k]
        assert instance.start(*numbers) == NOT_FINITE
    assert instance.start(-1e-9, 0.0, 20e6, 0.0) == BEYOND_RANGE
    assert instance.start(0.1 + 1e-9, 0.0, 20e6, 0.0) == BEYOND_RANGE
    for force in (-5500.0, 7988.0, 1e9, -1e300):
        assert instance.start(0.05, force, 20e6, 0.0) == BEYOND_RANGE
    assert instance.start(0.05, 0.0, 20e6, -101326.0) == BEYOND_RANGE
    assert instance.start(0.05, 0.0, -101326.0, -101325.0) == BEYOND_RANGE
    assert instance.start(0.05, 0.0, 1e5, 1.1e5) == PRESSURES
    assert instance.save().tobytes() == before
    assert instance.start(0.1, 0.0, 1e5, 1e5) == 0 and instance.start(0.0, 0.0, 2e7, 0.0) == 0
    assert instance.start(0.02, 500.0, 18e6, 2e5) == 0
    expected = started(choose('isa_v5', {'reu.force.kp': 9.5e-08}), 0.02, 500.0, 18e6, 2e5)
    assert instance.save().tobytes()[:-BEHIND] == expected.snapshot()
    assert instance.sample.tobytes() == expected.sample.tobytes()
    given = port(x0=0.02, supply_pressure=18e6, return_pressure=2e5)
    assert instance.tick(given) == 0
    expected.tick(given)
    assert instance.sample.tobytes() == expected.sample.tobytes()


def test_a_start_with_a_force_stays_at_rest_where_its_load_is(loaded):
    """The load is behind the spring of the sensor; the first tick has the force that is held."""
    stiffness = parameter(loaded.call(
        'find', b'plant.mechanics.sensor_stiffness', result=ctypes.c_void_p)).number
    instance, jolted = Instance(loaded), Instance(loaded)
    for each in (instance, jolted):
        assert each.start(0.03, 700.0, 20.7e6, 0.0) == 0
    place = instance.load_position
    assert place == 0.03 - 700.0 / stiffness and 0.03 - place > 1e-6
    assert instance.tick(port(x0=place)) == jolted.tick(port(x0=0.03)) == 0
    assert abs(instance.reply['mean_forces'][0] - 700.0) < 10.0
    assert abs(jolted.reply['mean_forces'][0] - 700.0) > 200.0
    assert instance.load_position == place


def test_the_load_moves_as_its_port_says(loaded):
    instance = Instance(loaded)
    assert instance.load_position == 0.05
    assert instance.tick(port(v0=0.02)) == 0
    assert abs(instance.load_position - 0.05002) < 1e-12
    assert instance.tick(port(x0=0.05002, a_bias=3.0)) == 0
    assert abs(instance.load_position - 0.0500215) < 1e-12


def test_only_a_load_of_its_own_needs_no_port(loaded, tmp_path):
    instance = Instance(loaded)
    before = bytes(instance.memory)
    assert instance.tick() == NO_INSTANCE and bytes(instance.memory) == before
    chosen = choose('rig_linear')
    own = Loaded(written(exported(chosen), tmp_path), 'isa_ram')
    ram, other = Instance(own), Instance(own)
    assert ram.start(0.04, 0.0, 17e6, 3e5) == other.start(0.04, 0.0, 17e6, 3e5) == 0
    assert ram.save().tobytes()[:-BEHIND] == started(chosen, 0.04, 0.0, 17e6, 3e5).snapshot()
    for _ in range(3):
        assert ram.tick() == other.tick(port(x0=9.0, supply_pressure=17e6,
                                             return_pressure=3e5)) == 0
    assert ram.sample['position'] == 0.04 and ram.save().tobytes() == other.save().tobytes()


def test_the_configured_start_may_be_beyond_the_stroke(tmp_path):
    """A body may push so; setpoints and starts of a caller may not be there."""
    own = exported(choose('isa_v5'))
    own.start['position'] = 0.1 + 1e-5
    instance = Instance(Loaded(written(own, tmp_path), 'isa_v5'))
    assert abs(instance.sample['position'] - (0.1 + 1e-5)) < 1e-6
    assert instance.start(*own.start[0].item()) == BEYOND_RANGE
    assert instance.tick(port(x0=0.1)) == 0


def test_the_configured_force_may_be_beyond_the_relief_valves(tmp_path):
    own = exported(choose('isa_v5'))
    own.start['force'] = 8100.0
    instance = Instance(Loaded(written(own, tmp_path), 'isa_v5'))
    assert instance.start(0.05, 8100.0, 20.7e6, 0.0) == 0
    assert instance.start(0.05, 8101.0, 20.7e6, 0.0) == BEYOND_RANGE
    assert instance.start(0.05, -5500.0, 20.7e6, 0.0) == BEYOND_RANGE


@pytest.mark.parametrize('given, code', [
    (command(128), UNKNOWN_KIND), (command(1 << 31), UNKNOWN_KIND),
    (command(HAS_ENABLE, is_enabled=2), UNKNOWN_KIND),
    (command(HAS_MODE, mode=0), UNKNOWN_MODE), (command(HAS_MODE, mode=7), UNKNOWN_MODE),
    (command(HAS_MODE, mode=-1), UNKNOWN_MODE), (command(HAS_MODE, mode=1 << 40), UNKNOWN_MODE),
    (command(HAS_MODE, mode=MODES.index('position')), UNKNOWN_MODE),
    (command(HAS_REFERENCE, mode=MODES.index('current'), reference=1e-3), WRONG_MODE),
    (command(HAS_REFERENCE, mode=MODES.index('impedance')), WRONG_MODE),
    (command(HAS_MODE | HAS_REFERENCE, mode=MODES.index('force')), WRONG_MODE),
    (command(HAS_MODE | HAS_REFERENCE, mode=MODES.index('current'), reference=0.0101),
     BEYOND_RANGE),
    (command(HAS_MODE | HAS_REFERENCE, mode=MODES.index('current'), reference=np.nan),
     NOT_FINITE),
    (command(HAS_SETPOINT, position=np.nan), NOT_FINITE),
    (command(HAS_SETPOINT, velocity=np.nan), NOT_FINITE),
    (command(HAS_SETPOINT, effort=np.nan), NOT_FINITE),
    (command(HAS_SETPOINT, effort=-np.inf), NOT_FINITE),
    (command(HAS_SETPOINT, position=0.1001), BEYOND_RANGE),
    (command(HAS_SETPOINT, position=-1e-6), BEYOND_RANGE),
    (command(HAS_SETPOINT, velocity=1.7), BEYOND_RANGE),
    (command(HAS_SETPOINT, effort=7501.0), BEYOND_RANGE),
    (command(HAS_SETPOINT, stiffness=-1.0), BEYOND_RANGE),
    (command(HAS_GAINS, damping=3e7), BEYOND_RANGE),      # a stiffness may be 5e7
    (command(HAS_GAINS, stiffness=np.inf), NOT_FINITE),
    (command(HAS_SETPOINT | HAS_MODE, mode=MODES.index('force'), effort=np.nan), NOT_FINITE),
])
def test_commands_that_are_refused(loaded, given, code):
    instance = Instance(loaded)
    for _ in range(3):
        instance.tick(port())
    before = bytes(instance.memory)
    assert instance.tick(port(), given) == code
    assert bytes(instance.memory) == before


def test_before_the_first_tick_the_command_is_that_of_the_start(loaded):
    instance = Instance(loaded)
    applied = instance.applied
    assert applied['kinds'] == HAS_SETPOINT | HAS_ENABLE
    assert applied['position'] == instance.sample['position'] and applied['is_enabled'] == 1
    assert instance.tick(port()) == 0 and instance.applied['kinds'] == 0


def test_what_a_mode_does_not_use_may_be_missing(loaded):
    instance = Instance(loaded)
    held = instance.sample['position']
    force = command(HAS_SETPOINT | HAS_MODE, mode=MODES.index('force'), effort=123.0,
                    position=np.nan, velocity=np.nan)
    assert instance.tick(port(), force) == 0
    applied = instance.applied
    assert (applied['position'], applied['velocity'], applied['effort']) == (held, 0.0, 123.0)


def test_setpoints_beyond_their_range_are_limited(limiting):
    instance = Instance(limiting)
    assert instance.tick(port(), command(
        HAS_SETPOINT, position=0.2, velocity=-9.0, effort=8000.0, stiffness=-5.0,
        damping=3000.0)) == 0
    applied = instance.applied
    assert (applied['position'], applied['effort']) == (0.1, 7500.0)
    assert (applied['stiffness'], applied['damping']) == (0.0, 3000.0)
    assert -1.7 < applied['velocity'] < -1.6
    assert instance.tick(port(), command(HAS_SETPOINT, position=np.inf)) == NOT_FINITE


def test_the_ends_of_a_range_are_in_it(loaded):
    instance = Instance(loaded)
    for position in (0.1, 0.0):
        assert instance.tick(port(), command(HAS_SETPOINT, position=position)) == 0
        assert instance.applied['position'] == position


@pytest.mark.parametrize('field', LOAD_PORT.names)
def test_ports_are_finite(loaded, field):
    instance = Instance(loaded)
    before = bytes(instance.memory)
    assert instance.tick(port(**{field: np.nan})) == NOT_FINITE
    assert instance.tick(port(**{field: -np.inf})) == NOT_FINITE
    assert bytes(instance.memory) == before
    assert instance.tick(port()) == 0


@pytest.mark.parametrize('given', [
    {'inverse_mass': -1e-9}, {'supply_pressure': -101326.0}, {'return_pressure': -1e6}])
def test_ports_that_no_load_or_supply_has(loaded, given):
    instance = Instance(loaded)
    before = bytes(instance.memory)
    assert instance.tick(port(**given)) == BEYOND_RANGE
    assert bytes(instance.memory) == before
    assert instance.tick(port(inverse_mass=0.02, return_pressure=-101325.0)) == 0


def test_forces_of_a_start_are_those_of_python(loaded, own):
    """The ends of the range that `Run.actuators` has; those of an ISA v5 are not symmetric."""
    from isa_ros.config.runs.external_config import held_forces, refuse_force
    config, instance = own.chosen.config, Instance(loaded)
    low, high = held_forces(config)
    assert (round(low), round(high)) == (-5499, 7987)
    for force, beyond in ((low, -np.inf), (high, np.inf)):
        refuse_force(config, force)
        assert instance.start(0.05, force, 20.7e6, 0.0) == 0
        outside = float(np.nextafter(force, beyond))
        assert instance.start(0.05, outside, 20.7e6, 0.0) == BEYOND_RANGE
        with pytest.raises(ConfigError, match='relief valves open'):
            refuse_force(config, outside)


def test_feeds_are_finite(loaded):
    instance = Instance(loaded)
    assert instance.tick(port(), feed=(1e9, 0.0, 0.0, 0.0, np.nan, 0.0)) == NOT_FINITE
    assert instance.tick(port(), feed=(1e9, 0.0, 0.0, 0.0, 1.0, 0.0)) == 0
    fed = instance.fed.tobytes()
    assert any(fed) and instance.tick(port()) == 0
    assert instance.fed.tobytes() == fed
    assert instance.tick(port(), feed=(1e9, 0.0, 0.0, 0.0, 1.0, 0.0)) == 0
    assert instance.fed.tobytes() != fed


def test_a_divergence_stays_until_the_next_start(loaded):
    instance = Instance(loaded)
    state = instance.save()
    code = instance.tick(port(x0=1e300))
    assert 0 < code <= STATE_SIZE
    message = loaded.message(code)
    assert re.fullmatch(r'[a-z_.0-9]+ is not finite: the model has diverged', message)
    t_ns = instance.t_ns
    assert instance.tick(port()) == code and instance.t_ns == t_ns
    size = ctypes.c_size_t(len(state))
    assert loaded.call('save', instance.memory, state.copy(), size) == NOT_FINITE
    assert instance.restore(state) == 0 and instance.tick(port()) == 0
    assert instance.tick(port(x0=1e300)) == code and instance.start() == 0
    assert instance.tick(port()) == 0


def test_the_state_that_diverged_is_named(loaded, own):
    """As the error of Python names it."""
    from isa_ros.errors import SimulationDiverged
    actuator = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    with pytest.raises(SimulationDiverged) as error:
        actuator.tick(port(x0=1e300))
    message = loaded.message(Instance(loaded).tick(port(x0=1e300)))
    assert message.startswith(error.value.field.removeprefix('isa_v5: ') + ' is not finite')


def test_codes_have_messages(loaded):
    messages = [loaded.message(code) for code in range(0, -10, -1)]
    assert len(set(messages)) == 10 and messages[0] == 'done'
    assert loaded.message(-10) == loaded.message(STATE_SIZE + 1) == 'unknown code'
    for k in (0, 1, STATE_SIZE - 1):
        assert loaded.message(1 + k) == f'{state_name(k)} is not finite: the model has diverged'


def test_states_that_are_refused(loaded, own):
    """Another size, another time, numbers that no state has, and those of another actuator."""
    instance = Instance(loaded)
    for k in range(20):
        instance.tick(port(x0=0.05 + 1e-5 * k))
    state, before = instance.save(), bytes(instance.memory)
    assert instance.restore(state[:-1]) == WRONG_SIZE
    assert loaded.call('save', instance.memory, state.copy(), ctypes.c_size_t(8)) == WRONG_SIZE

    def changed(at, value):
        wrong = state.copy()
        wrong[at:at + 8] = np.frombuffer(np.array(value).tobytes(), np.uint8)
        return sealed(wrong)
    assert sealed(state).tobytes() == state.tobytes()
    for t_ns in (-1_000_000, 500_000, 2**32 * 1_000_000):
        assert instance.restore(changed(0, t_ns)) == WRONG_STATE
    assert instance.restore(changed(0, (2**32 - 1) * 1_000_000)) == 0
    assert instance.restore(state) == 0
    assert instance.restore(changed(8, np.nan)) == WRONG_STATE
    for at in (len(state) - 16, len(state) - 24, len(state) - 32):
        assert instance.restore(changed(at, 7)) == WRONG_STATE
    for at in (len(state) - 9, len(state) - BEHIND - own.actuator.tuning.nbytes):
        wrong = state.copy()
        wrong[at] ^= 1
        assert instance.restore(sealed(wrong)) == WRONG_STATE
    assert instance.restore(state) == 0 and bytes(instance.memory) == before


def test_damaged_states_are_refused(loaded):
    """Every single bit; two signs; two words that are exchanged."""
    instance = Instance(loaded)
    for k in range(20):
        instance.tick(port(x0=0.05 + 1e-5 * k))
    state, before = instance.save(), bytes(instance.memory)
    for at in range(len(state)):
        for bit in range(8):
            state[at] ^= 1 << bit
            assert instance.restore(state) == WRONG_STATE, (at, bit)
            state[at] ^= 1 << bit
    words = state.view(np.uint64)
    one, other = np.flatnonzero(words[1:-10])[[3, 40]] + 1
    assert words[one] != words[other]
    damaged = words.copy()
    damaged[[one, other]] ^= np.uint64(1 << 63)
    assert instance.restore(damaged.view(np.uint8)) == WRONG_STATE
    damaged = words.copy()
    damaged[[one, other]] = words[[other, one]]
    assert instance.restore(damaged.view(np.uint8)) == WRONG_STATE
    assert bytes(instance.memory) == before and instance.restore(state) == 0


def test_altered_states_are_refused_as_in_python(loaded, own):
    """A number of a state at a time; what is taken is taken by both."""
    actuator = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    instance = Instance(loaded)
    for k in range(20):
        given = port(x0=0.05 + 1e-5 * k)
        instance.tick(given)
        actuator.tick(given)
    state = instance.save()
    end = len(state) - BEHIND - actuator.tuning.nbytes
    odd = [np.array(value).tobytes() for value in (np.nan, -1, 8, 300, 2**31)]
    taken = 0
    for at in range(0, end, 8):
        for text in odd:
            wrong = state.copy()
            wrong[at:at + 8] = np.frombuffer(text, np.uint8)
            try:
                actuator.restore(wrong[:-BEHIND].tobytes())
                expected = 0
            except ConfigError:
                expected = WRONG_STATE
            assert instance.restore(sealed(wrong)) == expected, (at, text)
            taken += expected == 0
    assert 0 < taken < end


def test_threads_with_instances_of_their_own(loaded):
    """As many as cores and one more, on one library: each as if it were alone."""
    def run(k, samples):
        instance = Instance(loaded)
        for tick in range(200):
            assert instance.tick(port(x0=0.05 + 1e-4 * k + 1e-6 * tick)) == 0
        samples[k] = instance.save().tobytes()
    n = 1 + (os.cpu_count() or 1)
    alone, together = [None] * n, [None] * n
    for k in range(n):
        run(k, alone)
    switch = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        threads = [threading.Thread(target=run, args=(k, together)) for k in range(n)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(switch)
    assert together == alone and all(one != other for one, other in pairwise(alone))


def test_a_clear_request_is_merged(loaded):
    instance = Instance(loaded)
    assert instance.tick(port(), command(HAS_CLEAR_FAULT)) == 0
    assert instance.applied['kinds'] == HAS_CLEAR_FAULT
    assert instance.tick(port()) == 0 and instance.applied['kinds'] == 0
    assert instance.sample['refused_requests'] == 1.0


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
