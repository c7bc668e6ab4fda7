"""The page about exported actuators: its program, its commands and its figures are true."""

from pathlib import Path
import re
import shutil
import subprocess

from isa_ros.core.objects import own_target
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
from isa_ros.export.library import names_of
import pytest
from tests.export.libraries import Loaded, written

PAGE = (Path(__file__).parents[2] / 'docs' / 'export.md').read_text()

pytestmark = pytest.mark.slow


@pytest.fixture(scope='module')
def path(tmp_path_factory):
    """Return the path of the page's library."""
    return written(exported(choose('isa_v5')), tmp_path_factory.mktemp('my_actuator'))


def test_the_program_of_the_page_runs(path):
    program, = re.findall(r'```c\n(.*?)```', PAGE, re.DOTALL)
    (path.parent / 'page.c').write_text(program)
    subprocess.run(['cc', '-std=c99', '-Wall', '-Wextra', '-Wpedantic', '-Werror', 'page.c',
                    '-L.', '-lisa_v5', '-Wl,-rpath,$ORIGIN', '-o', 'page'],
                   cwd=path.parent, check=True)
    done = subprocess.run([path.parent / 'page'], capture_output=True, text=True)
    assert done.returncode == 0 and re.fullmatch(r'-?\d[\d.e-]* N\n', done.stdout)


def test_the_first_lines_are_those_of_the_example(path):
    command = re.search(r'^    (cc -std=c99 example\.c .*)$', PAGE, re.MULTILINE)[1]
    done = subprocess.run(command, shell=True, cwd=path.parent, check=True, capture_output=True,
                          text=True)
    for line in done.stdout.splitlines()[:4]:
        assert f'    {line}\n' in PAGE


def test_the_lines_for_cmake(path, tmp_path):
    if shutil.which('cmake') is None:
        pytest.skip('cmake is not installed')
    lines, = re.findall(r'```cmake\n(.*?)```', PAGE, re.DOTALL)
    (path.parent / 'CMakeLists.txt').write_text(
        'cmake_minimum_required(VERSION 3.10)\nproject(my C)\n'
        f'add_executable(my_program example.c)\n{lines}')
    for command in (['-S', path.parent, '-B', tmp_path], ['--build', tmp_path]):
        subprocess.run(['cmake', *command], check=True, capture_output=True)
    done = subprocess.run([tmp_path / 'my_program'], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith('isa_v5, model isa_v5, isa_ros ')


def test_all_files_are_listed():
    listed = set(re.findall(r'`([\w.]+\.(?:h|c|cpp|o|so|map|json))`', PAGE))
    assert listed == {*names_of(exported(choose('isa_v5'))), 'isa_export.json'}


def test_all_codes_are_explained(path):
    codes = re.findall(r'^  (ISA_[A-Z_]+) = -\d', (path.parent / 'isa_v5.h').read_text(),
                       re.MULTILINE)
    assert len(codes) == 9
    for code in codes:
        assert f'`{code}`' in PAGE


def test_sizes(path):
    loaded = Loaded(path, 'isa_v5')
    assert f'{round(loaded.size("state_size") / 1000)} kB, and `isa_v5_restore`' in PAGE
    assert f'you give it, {round(loaded.size("size") / 1000)} kB, aligned' in PAGE
    assert own_target().name in PAGE
