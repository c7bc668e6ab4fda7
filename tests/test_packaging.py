"""Installation: one version, existing entry points, pinned requirements."""

from importlib import import_module
from pathlib import Path
import re
import shutil
import subprocess
import sys
import tarfile
from xml.etree import ElementTree
import zipfile

import isa_ros
from isa_ros.cli.main import main
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
import pytest
from scripts import pin_requirements
from scripts.check_environments import DOORS
from scripts.environments.environment import needed
from scripts.environments.interpreters import PYTHONS
import yaml

ROOT = Path(__file__).parents[1]
SETUP = (ROOT / 'setup.py').read_text(encoding='utf-8')
KEYS = {'pillow': 'python3-pil', 'PyYAML': 'python3-yaml'}
"""Keys of rosdep that are not the name of the package."""
ENTRY_POINTS = re.findall(r"'(\w+) = ([\w.]+):(\w+)'", SETUP)


def test_the_version_is_the_same_for_python_and_ros() -> None:
    assert ElementTree.parse(ROOT / 'package.xml').findtext('version') == isa_ros.__version__
    assert not re.search(r'\d+\.\d+\.\d+', SETUP)  # it has none of its own
    built = subprocess.run(
        [sys.executable, 'setup.py', '--version'], cwd=ROOT, check=True, capture_output=True,
        text=True, timeout=60)
    assert built.stdout == f'{isa_ros.__version__}\n'


def test_the_version_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(['--version'])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f'isa_ros {isa_ros.__version__}\n'


def test_the_executables_of_the_interface_are_there() -> None:
    assert [name for name, _, _ in ENTRY_POINTS] == [
        'actuator', 'isa_v2', 'isa_v5', 'smart_manifold', 'coordinator', 'isa']


@pytest.mark.parametrize('name, module, function', ENTRY_POINTS)
def test_an_executable_can_be_called(name: str, module: str, function: str) -> None:
    if '.nodes.' in module:
        pytest.importorskip('rclpy')
    assert callable(getattr(import_module(module), function))


@pytest.mark.parametrize('file', [
    'requirements.txt', 'requirements-test.txt', 'requirements-bench.txt',
    'requirements-docs.txt'])
def test_requirements_are_pinned(file: str) -> None:
    """The same clone gives the same environment; ROS only there, never in setup.py."""
    lines = [line for line in (ROOT / file).read_text(encoding='utf-8').splitlines()
             if line and not line.startswith('#')]
    assert lines and all(re.match(r'[\w.-]+==[\d.]+(; python_version [<>]=? "[\d.]+")?$', line)
                         for line in lines)
    assert 'ros-jazzy' not in SETUP


def test_pyproject_holds_no_metadata() -> None:
    """A literal requires-python in [project] breaks colcon."""
    text = (ROOT / 'pyproject.toml').read_text(encoding='utf-8')
    assert '[project' not in text and '[build-system]' in text


@pytest.mark.slow
def test_an_installed_package_finds_its_data(tmp_path: Path) -> None:
    """A wheel contains the models, and share/isa_ros the configurations."""
    pytest.importorskip('setuptools', minversion='70.1')  # the first one that makes wheels
    subprocess.run(
        [sys.executable, '-m', 'pip', 'install', '--quiet', '--no-deps', '--no-build-isolation',
         '--no-index', '--disable-pip-version-check', '--ignore-installed',  # keeps the clone's
         '--prefix', str(tmp_path / 'prefix'),
         str(copy_of_clone(tmp_path))], check=True, capture_output=True, timeout=120)
    purelib = next((tmp_path / 'prefix').glob('lib/python3*/site-packages'))
    program = (
        'from isa_ros.config.runs.run_file import load_run\n'
        'from isa_ros.config.paths import find\n'
        'from isa_ros.paper.printed import cell\n'
        'import isa_ros; print(isa_ros.__file__, load_run(find("leg", "config")).name, '
        'cell("table_5", "L_m", "Value").number)')
    result = subprocess.run(
        [sys.executable, '-c', program], cwd=tmp_path, check=True, capture_output=True, text=True,
        env={'PYTHONPATH': str(purelib), 'PATH': '', 'HOME': str(tmp_path)}, timeout=120)
    assert result.stdout == f'{purelib}/isa_ros/__init__.py leg 1.745\n'
    assert {path.name for path in purelib.iterdir() if path.is_dir()} == {
        'isa_ros', 'msg_adapters', *(path.name for path in purelib.glob('*.dist-info'))}
    scripts = {path.name for path in (tmp_path / 'prefix' / 'bin').iterdir()}
    assert {name for name, _, _ in ENTRY_POINTS} <= scripts
    # Of the script for colcon and pip's own of that name, pip's has the interpreter.
    isa = (tmp_path / 'prefix' / 'bin' / 'isa').read_text()
    assert isa.startswith(f'#!{sys.executable}\n')


def test_a_sourced_workspace_has_isa_on_its_path(tmp_path: Path) -> None:
    """As colcon installs it: to PREFIX/bin, which it adds to PATH, and executable."""
    pytest.importorskip('setuptools')
    subprocess.run(
        [sys.executable, 'setup.py', '--quiet', 'install_data', '--install-dir',
         str(tmp_path / 'prefix')], cwd=copy_of_clone(tmp_path), check=True, capture_output=True,
        timeout=120)
    result = subprocess.run(
        [tmp_path / 'prefix' / 'bin' / 'isa', '--help'], check=True, capture_output=True,
        text=True, timeout=120, env={
            'PATH': str(Path(sys.executable).parent), 'PYTHONPATH': str(ROOT),
            'HOME': str(tmp_path)})
    assert result.stdout.startswith('usage: isa ')


def copy_of_clone(tmp_path: Path) -> Path:
    """Return a copy of the build's inputs, since the build writes beside its sources."""
    copy = tmp_path / 'clone'
    copy.mkdir()
    for name in ('isa_ros', 'msg_adapters', 'benchmarks', 'scripts', 'bin', 'config', 'launch',
                 'layouts', 'rviz', 'urdf', 'resource'):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns('__pycache__'))
    for name in ('setup.py', 'setup.cfg', 'pyproject.toml', 'package.xml', 'README.md', 'LICENSE'):
        if (ROOT / name).is_file():
            shutil.copy(ROOT / name, copy / name)
    return copy


def built(command: str, copy: Path) -> Path:
    """Return what a command of setup.py, as pip gives it, makes of a copy of the clone."""
    subprocess.run(
        [sys.executable, 'setup.py', '--quiet', command, '--dist-dir', 'made'], cwd=copy,
        check=True, capture_output=True, timeout=120)
    made, = (copy / 'made').iterdir()
    return made


SHARED = ('config', 'launch', 'layouts', 'rviz', 'urdf')


@pytest.mark.slow
def test_a_wheel_has_the_share_and_no_command_but_that_of_its_entry_point(tmp_path: Path) -> None:
    """An installer may put a file `bin/isa` over the one with the interpreter."""
    pytest.importorskip('setuptools', minversion='70.1')
    wheel = built('bdist_wheel', copy_of_clone(tmp_path))
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        metadata = archive.read(next(
            name for name in names if name.endswith('dist-info/METADATA'))).decode()
    data = f'isa_ros-{isa_ros.__version__}.data/data/'
    inside = {name.removeprefix(data) for name in names if name.startswith(data)}
    assert {name.removeprefix('share/isa_ros/') for name in inside} >= set(shared())
    assert [name for name in inside if not name.startswith('share/')] == []
    assert set(re.findall('^Provides-Extra: (.+)$', metadata, re.MULTILINE)) == {
        *DOORS, 'test'}
    assert set(needed(wheel, 'canopen')) == {'canopen>=2.3', 'msgpack>=1.0', 'python-can>=4.3'}


@pytest.mark.slow
def test_a_source_archive_has_all_that_a_wheel_is_made_of(tmp_path: Path) -> None:
    archive = built('sdist', copy_of_clone(tmp_path))
    with tarfile.open(archive) as file:
        names = {name.partition('/')[2] for name in file.getnames()}
    assert names >= {*shared(), 'bin/isa', 'setup.py', 'setup.cfg', 'pyproject.toml', 'LICENSE',
                     'README.md', 'package.xml', 'resource/isa_ros', 'isa_ros/py.typed',
                     'isa_ros/vendor/uplot/LICENSE', 'msg_adapters/cdr.py'}


def shared() -> list[str]:
    """Return the files below share/isa_ros, whose folders are those of the checkout."""
    return [str(path.relative_to(ROOT)) for folder in SHARED
            for path in sorted((ROOT / folder).rglob('*.*')) if '__pycache__' not in path.parts]


def depended() -> set[str]:
    """Return the names that package.xml depends on, to run or to test."""
    root = ElementTree.parse(ROOT / 'package.xml').getroot()
    return {str(element.text) for tag in ('exec_depend', 'test_depend', 'depend', 'build_depend')
            for element in root.iter(tag)}


def test_what_setup_needs_has_a_key_of_rosdep_or_is_told() -> None:
    """A key of pip would stop `rosdep install` on Ubuntu 24.04."""
    needs = re.search(r'install_requires=\[(.*?)\]', SETUP, re.DOTALL)[1]
    names = set(re.findall(r"'(\w+)>=", needs))
    keys = {KEYS.get(name, f'python3-{name.lower()}'): name for name in names}
    without = {name for key, name in keys.items() if key not in depended()}
    assert without == {'lz4', 'mcap', 'zstandard'}
    page = (ROOT / 'docs' / 'installing.md').read_text(encoding='utf-8')
    assert 'apt install python3-lz4 python3-zstandard' in page and ' mcap ' in page
    assert [key for key in depended() if 'pip' in key] == []


def test_packages_of_ros_that_are_imported_are_depended_on() -> None:
    imported = {found[1] for folder in ('isa_ros', 'msg_adapters', 'launch')
                for path in (ROOT / folder).rglob('*.py')
                for found in re.finditer(
                    r'^\s*(?:from|import) (\w+)', path.read_text(), re.MULTILINE)}
    ros = {name for name in imported if name.endswith(('_msgs', '_interfaces')) or name in (
        'rclpy', 'launch', 'launch_ros', 'ament_index_python')}
    assert len(ros) > 10 and ros <= depended()


def test_an_extra_is_named_on_the_page_with_its_packages() -> None:
    page = (ROOT / 'docs' / 'installing.md').read_text(encoding='utf-8')
    rows = dict(re.findall(r'^\| `(\w+)` \| ([\w, -]+) \|', page, re.MULTILINE))
    declared = re.search(r'extras_require=\{(.*?)\},\n', SETUP, re.DOTALL)[1]
    extras = dict(re.findall(r"'(\w+)': \[(.*?)\]", declared))
    assert set(rows) == set(extras) - {'test'} == set(DOORS)
    for name, packages in rows.items():
        assert sorted(packages.split(', ')) == sorted(
            re.findall(r"'([\w-]+)>=", extras[name])), name


@pytest.mark.parametrize('name', ['apt', 'wheels'])
def test_a_workflow_runs_what_is_there(name: str) -> None:
    text = (ROOT / '.github' / 'workflows' / f'{name}.yml').read_text(encoding='utf-8')
    jobs = yaml.safe_load(text)['jobs']
    assert all(job['steps'] and job['timeout-minutes'] for job in jobs.values())
    scripts = re.findall(r'python -m (scripts\.\w+)', text)
    assert all((ROOT / f'{script.replace(".", "/")}.py').is_file() for script in scripts)
    for path in re.findall(r'(?:tests|\.ci)/[\w/]+', text):
        assert (ROOT / path).exists(), path
    assert set(re.findall(r'isa (\w+) ', text)) <= {'bringup', 'replay'}
    if name == 'wheels':
        assert jobs['environments']['strategy']['matrix']['python'] == list(PYTHONS)


def test_the_image_is_made_of_the_clone_and_of_what_the_page_installs() -> None:
    text = (ROOT / 'Dockerfile').read_text(encoding='utf-8')
    assert re.findall(r'^FROM (.+)$', text, re.MULTILINE) == ['ros:jazzy-ros-base']
    for part in ('python3-lz4', 'python3-zstandard', ' mcap', 'rosdep install', 'colcon build',
                 'COPY . src/isa_ros'):
        assert text.count(part) == 1, part


@pytest.mark.parametrize('python', pin_requirements.PYTHONS)
def test_what_the_requirements_need_is_pinned_too(python: str) -> None:
    """With every Python; where the wheels of ROS are installed, whose requirements are read."""
    known = pin_requirements.installed()
    if 'ros-jazzy-rclpy' not in known:
        pytest.skip('ROS is not from wheels')
    lines = [Requirement(line) for file in ('requirements.txt', 'requirements-test.txt')
             for line in (ROOT / file).read_text(encoding='utf-8').splitlines()
             if line and not line.startswith('#')]
    here = [line for line in lines if pin_requirements.applies(line, python, set())]
    names = [canonicalize_name(line.name) for line in here]
    assert len(names) == len(set(names))  # one version of each
    assert pin_requirements.needed(here, python, known) == set(names)
