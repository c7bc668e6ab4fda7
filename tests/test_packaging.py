"""Installation: one version, existing entry points, pinned requirements."""

from importlib import import_module
from pathlib import Path
import re
import shutil
import subprocess
import sys
from xml.etree import ElementTree

import isa_ros
from isa_ros.cli.main import main
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
import pytest
from scripts import pin_requirements

ROOT = Path(__file__).parents[1]
SETUP = (ROOT / 'setup.py').read_text(encoding='utf-8')
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
