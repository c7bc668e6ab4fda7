"""`isa export`: what it writes, and what it refuses before that."""

from pathlib import Path
import re
import zipfile

from isa_ros.cli.main import main
from isa_ros.core import bitcode, compiler, kept_objects
from isa_ros.core.kernel_directory import CACHE
from isa_ros.export import kernels, library
from isa_ros.export.library import names_of
import pytest
from tests.locks import locked

ANNOUNCED = 'isa: machine code for x86-64 takes 10 to 30 s, once after an installation or an edit'


def refused(capsys, *arguments):
    """Return the line of a refusal."""
    try:
        assert main(['export', *map(str, arguments)]) == 2
    except SystemExit as ended:
        assert ended.code == 2
    printed = capsys.readouterr()
    assert printed.out == '' and printed.err.count('\n') == 1
    return printed.err


@pytest.mark.slow
def test_a_library_is_written(tmp_path, capsys, monkeypatch):
    """Numba compiles none of its kernels in this process; what is once made is kept."""
    from isa_ros.export.chosen import choose
    from isa_ros.export.exported import exported
    compiled = set()
    dispatcher_of = compiler.dispatcher_of
    monkeypatch.setattr(compiler, 'dispatcher_of', lambda own: (
        compiled.add(own.__name__), dispatcher_of(own))[1])
    out = tmp_path / 'made'
    arguments = ['export', 'rig_linear:ram', '--c', '--out', str(out), '--name', 'ram',
                 '--set', 'load.inertia=20', '--target', 'x86-64', '--load', 'own']
    assert CACHE is not None
    for announced in ([ANNOUNCED], []):
        with locked(CACHE):     # another process may make the same
            assert main(arguments) == 0
        printed = capsys.readouterr()
        assert printed.out.splitlines() == [str(out / 'ram.h'), str(out / 'libram.so')]
        assert printed.err.splitlines()[-1:] in ([], announced)
    assert not compiled & {'entry', 'start_actuator', 'group_tick', 'actuator_tick'}
    own = exported(choose('rig_linear'), name='ram')
    assert {path.name for path in out.iterdir()} == {*names_of(own), 'isa_export.json'}
    tables = (out / 'ram_tables.h').read_text()
    assert '{"load.inertia", "20", 20.0, "kg", ' in tables


@pytest.mark.slow
def test_units_are_written(tmp_path, capsys):
    out = tmp_path / 'made'
    assert main(['export', 'rig_linear', '--fmu', '--out', str(out), '--name', 'ram',
                 '--set', 'load.inertia=20', '--set', 'supply.pressure_mpa=18.5']) == 0
    names = ['ram_fmi2.fmu', 'ram_fmi3.fmu']
    assert capsys.readouterr().out.splitlines() == [str(out / name) for name in names]
    assert {path.name for path in out.iterdir()} == {*names, 'isa_export.json'}
    for name in names:
        with zipfile.ZipFile(out / name) as unit:
            text = unit.read('modelDescription.xml').decode()
            assert any(path.endswith('/ram.so') for path in unit.namelist())
        assert re.search(r'name="supply.pressure_mpa"[^/]*start="18.5"', text)
        assert re.search(r'name="load.inertia"[^/]*start="20.0"', text)


def test_a_circuit_is_refused_for_a_unit(tmp_path, capsys):
    line = refused(capsys, 'pump_station:left', '--fmu', '--out', tmp_path / 'out')
    assert line.startswith('isa: left: its supply station is a circuit, must be constant or ')
    assert not (tmp_path / 'out').exists()


def test_what_is_refused(tmp_path, capsys):
    out = tmp_path / 'out'
    for arguments, line in (
            (('isa_v6', '--c'), 'isa: isa_v6: no such file; did you mean isa_v5 or isa_v2?'),
            (('leg:kf', '--c'), "isa: 'kf' is not an actuator of leg; did you mean kfe?\n"),
            (('isa_v5', '--c', '--compiler', 'no-cc'), 'isa: --compiler no-cc: no such C compi'),
            (('isa_v5', '--c', '--target', 'arm'), 'isa: --target arm, valid: x86-64-v3, '),
            (('isa_v5', '--c', '--name', 'A'), "isa: --name 'A', must be "),
            (('isa_v5', '--c', '--name', 'int'), 'isa: --name int is a word or a type of C or '),
            (('isa_v5', '--fmu', '--name', 'class'), 'isa: --name class is a word or a type of'),
            (('isa_v5', '--c', '--load', 'none'), 'isa export: argument --load: invalid choice'),
            (('isa_v5', '--c', '--set', 'load'), "isa: --set 'load', must be KEY=VALUE\n"),
            (('isa_v5', '--c', '--fmu'), 'isa export: argument --fmu: not allowed with'),
            (('isa_v5',), 'isa export: one of the arguments --c --fmu')):
        assert refused(capsys, *arguments, '--out', out).startswith(line)
    assert 'required: --out' in refused(capsys, 'isa_v5', '--c')
    assert not out.exists()


def test_a_directory_that_takes_no_file(capsys):
    assert refused(capsys, 'isa_v5', '--c', '--out', '/proc/out').startswith(
        'isa: /proc/out: cannot be written, ')


def test_foreign_files_stay(tmp_path, capsys):
    (tmp_path / 'mine.txt').write_text('mine')
    line = refused(capsys, 'isa_v5', '--c', '--out', tmp_path)
    assert line.startswith(f'isa: {tmp_path} has files that are not of an export, such as mine')
    assert [path.name for path in Path(tmp_path).iterdir()] == ['mine.txt']
    assert 'is a file, must be a directory' in refused(
        capsys, 'isa_v5', '--c', '--out', tmp_path / 'mine.txt')


def test_what_is_assumed_is_told_before_anything_is_compiled(tmp_path, capsys, monkeypatch):
    """Once, with its values; and machine code is announced, if it is not kept."""
    done, said = [], []
    monkeypatch.setattr(kernels, 'are_lowered', lambda groups, target: done.append(
        [[own.function.__name__ for own in group] for group in groups]) or len(done) > 1)
    monkeypatch.setattr(library, 'library', lambda *given: said.append(
        capsys.readouterr().err.splitlines()) or {})
    for name in ('first', 'second'):
        assert main(['export', 'cylinder', '--c', '--out', str(tmp_path / name), '--target',
                     'x86-64', '--set', 'plant.drive.bore_mm=50']) == 0
    assumed = (
        'isa: cylinder: assumed plant.drive.rod_mm = 25, plant.drive.stroke_mm = 200, '
        'plant.drive.rated_pressure_mpa = 20.7, plant.valve.flow.rated_flow_lpm = 20, '
        'plant.valve.flow.rated_current_ma = 10; --set gives the values of your data sheets')
    assert said == [[assumed, ANNOUNCED], [assumed]] and capsys.readouterr().err == ''
    assert done == [[['start_actuator', 'group_tick']]] * 2


@pytest.mark.parametrize(('ended', 'how'), [
    ('os.kill(os.getpid(), 9)', 'was ended by SIGKILL'),
    ('sys.exit("first\\nno way")', 'ended with exit code 1: no way')])
@pytest.mark.parametrize('form', ['--c', '--fmu'])
def test_a_process_that_makes_nothing_is_one_line(
        tmp_path, capsys, monkeypatch, ended, how, form):
    """Nothing is written or kept."""
    monkeypatch.setattr(bitcode, '_PROGRAM', f'import os; {ended}')
    monkeypatch.setattr(kept_objects, 'CACHE', tmp_path / 'kept')
    monkeypatch.setattr(kept_objects, 'READ', (tmp_path / 'kept',))
    assert main(['export', 'isa_v5', form, '--target', 'x86-64', '--out',
                 str(tmp_path / 'out')]) == 3
    printed = capsys.readouterr()
    assert printed.out == '' and printed.err.splitlines()[:-1] == [ANNOUNCED]
    assert re.fullmatch(
        rf'isa: machine code: its process \d+ {how}', printed.err.splitlines()[-1])
    assert list(tmp_path.iterdir()) == []
