"""`isa doctor`: what it finds in changed surroundings, and its exit code."""

from importlib.metadata import PackageNotFoundError
import json
import os
from pathlib import Path
import re
import resource
from types import SimpleNamespace

from isa_ros.cli.doctor import kernels, limits, middleware, software
from isa_ros.cli.doctor.finding import as_text, Finding, is_healthy, Verdict
from isa_ros.cli.main import main
import pytest

SETUP = (Path(__file__).parents[3] / 'setup.py').read_text(encoding='utf-8')


def by_name(findings: object) -> dict[str, Finding]:
    """Return findings by their names."""
    return {own.name: own for own in findings}  # type: ignore[attr-defined]


def test_the_command_prints_all_groups_and_writes_them(
        tmp_path: Path, capsys: pytest.CaptureFixture[str],
        monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', '77')
    monkeypatch.delenv('ROS_AUTOMATIC_DISCOVERY_RANGE', raising=False)
    path = tmp_path / 'host.json'
    assert main(['doctor', '--json', str(path)]) == 0
    printed = capsys.readouterr().out
    assert re.search(r'^software  isa_ros +\d', printed)
    assert re.search(r'ROS_DOMAIN_ID +77$', printed, re.MULTILINE)
    assert re.search(r'^0 problems, \d+ notes?$', printed.splitlines()[-1])
    tree = json.loads(path.read_text())
    assert {row['group'] for row in tree} == {'software', 'ROS', 'host', 'kernels'}
    assert {'memlock', 'rtprio', 'shared memory', 'library', 'cache', 'cc'} <= {
        row['name'] for row in tree}


def test_a_wrong_domain_is_a_problem_and_1(
        capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', '300')
    assert main(['doctor']) == 1
    printed = capsys.readouterr().out
    assert "problem: ROS_DOMAIN_ID: ROS_DOMAIN_ID = '300', must be an integer from 0" in printed
    assert '1 problem, ' in printed


def test_the_packages_are_those_of_setup() -> None:
    """Needed ones are its install_requires, others those of its extras for users."""
    required = SETUP.partition('install_requires=[')[2].partition(']')[0]
    assert set(software.NEEDED) == set(re.findall(r"'([\w-]+)>=", required))
    extras = SETUP.partition('extras_require={')[2].partition('},')[0]
    for name, (extra, _) in software.OPTIONAL.items():
        own = extras.partition(f"'{extra}': [")[2].partition(']')[0]
        assert f"'{name}>=" in own, name
    assert len(software.OPTIONAL) == len(re.findall('>=', extras))


def test_a_missing_package_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def version(name: str) -> str:
        if name in ('mcap', 'mujoco'):
            raise PackageNotFoundError(name)
        return '6.7'
    monkeypatch.setattr(software, 'version', version)
    found = by_name(software.software())
    assert found['mcap'].verdict is Verdict.PROBLEM and found['mcap'].advice == 'pip install mcap'
    assert found['mujoco'].verdict is Verdict.NOTE and '[mujoco]' in found['mujoco'].advice
    assert found['scipy'] == Finding('software', 'scipy', '6.7')
    assert found['Python'].verdict is Verdict.GOOD


def test_a_python_that_is_too_old_is_a_problem() -> None:
    assert software._python((3, 9, 18)).verdict is Verdict.PROBLEM
    assert software._python((3, 10, 0)).verdict is Verdict.GOOD


def test_without_ros_nodes_are_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulations in Python need none."""
    monkeypatch.setattr(middleware, 'find_spec', lambda name: None)
    found = by_name(middleware.middleware({}))
    assert found['rclpy'].verdict is Verdict.NOTE and 'middleware' not in found
    assert found['ROS_DOMAIN_ID'].found == '0'


def test_message_packages_that_nodes_may_use_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip('rclpy')
    monkeypatch.setattr(middleware, 'is_installed', lambda name: True)
    there = by_name(middleware.middleware({}))['simulation_interfaces']
    assert there == Finding('ROS', 'simulation_interfaces', 'installed')
    monkeypatch.setattr(middleware, 'is_installed', lambda name: False)
    found = by_name(middleware.middleware({}))
    missing = found['simulation_interfaces']
    assert (missing.found, missing.verdict) == ('not installed', Verdict.NOTE)
    assert missing.advice == ('only for the standard services that pause, step and reset a run: '
                              'apt install ros-jazzy-simulation-interfaces')


def test_discovery_that_is_off_is_a_problem() -> None:
    variable = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
    for value, verdict in (('OFF', Verdict.PROBLEM), ('SUBNET', Verdict.GOOD)):
        found = by_name(middleware.middleware({variable: value}))['discovery']
        assert (found.found, found.verdict) == (value, verdict)


def test_another_middleware_is_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    environment = pytest.importorskip('isa_ros.nodes.middleware.environment')
    monkeypatch.setattr(environment, 'middleware_name', lambda: 'rmw_zenoh_cpp')
    found = by_name(middleware.middleware({}))['middleware']
    assert (found.found, found.verdict) == ('rmw_zenoh_cpp', Verdict.NOTE)


def test_limits_are_those_of_this_process() -> None:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (613, before[1]))
    try:
        found = by_name(limits.limits())
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
    assert found['open files'].found == '613'
    assert limits.in_megabytes(3_400_000) == '3 MB'
    assert str(len(os.sched_getaffinity(0))) == found['cores'].found.partition(',')[0]


def test_one_core_is_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, 'sched_getaffinity', lambda process: {3})
    found = by_name(limits.limits())['cores']
    assert found.verdict is Verdict.NOTE and '--in-process' in found.advice


def test_real_time_that_is_refused_is_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    """The policy of this process stays what it was in both cases."""
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    try:
        assert limits.may_run_in_real_time() in (True, False)
        assert os.sched_getscheduler(0) == os.SCHED_BATCH
    finally:
        os.sched_setscheduler(0, *before)

    def refused(*_: object) -> None:
        raise PermissionError
    monkeypatch.setattr(os, 'sched_setscheduler', refused)
    assert not limits.may_run_in_real_time()
    assert limits.priority(False, '0').verdict is Verdict.NOTE
    assert limits.priority(True, '95').found == 'SCHED_FIFO is allowed, limit 95'


def test_shared_memory_is_that_of_its_directory(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        os, 'statvfs', lambda path: SimpleNamespace(f_frsize=4096, f_blocks=25_000))
    assert limits.shared(tmp_path).found == f'102 MB in {tmp_path} (isa_ros uses none)'
    assert limits.shared(tmp_path / 'absent').verdict is Verdict.NOTE


def test_the_library_of_kernels_is_named(tmp_path: Path) -> None:
    none = kernels.loaded_from(None)
    assert (none.found, none.verdict) == ('none', Verdict.NOTE)
    assert 'python -m scripts.make_kernels' in none.advice
    path = tmp_path / 'x86-64.so'
    path.write_bytes(bytes(3 << 20))
    assert kernels.loaded_from(path)[2:4] == (f'{path}, 3 MB', Verdict.GOOD)


def test_the_kernels_of_a_cache_are_counted(tmp_path: Path) -> None:
    assert kernels.kept_in(None).verdict is Verdict.PROBLEM
    assert kernels.kept_in(tmp_path).found == f'{tmp_path}, empty'
    for name, size in (('a', 1_500_000), ('b', 2_600_000)):
        (tmp_path / name).write_bytes(bytes(size))
    assert kernels.kept_in(tmp_path).found == f'{tmp_path}, 2 files, 4 MB'


def test_the_table_names_a_group_once_and_counts() -> None:
    findings = [Finding('a', 'x', '1'), Finding('a', 'y', '2', Verdict.NOTE, 'do this'),
                Finding('b', 'z', '3', Verdict.NOTE, 'do that')]
    assert as_text(findings).splitlines() == [
        'a  x  1', '   y  2  note', 'b  z  3  note', '', 'note: y: do this', 'note: z: do that',
        '', '0 problems, 2 notes']
    assert is_healthy(findings)
    assert not is_healthy([*findings, Finding('b', 'w', '4', Verdict.PROBLEM, 'mend')])
