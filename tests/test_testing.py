"""`isa_ros.testing` in a user's project: a conftest.py, a test, a bag and tolerances."""

import os
from pathlib import Path
import re
import shutil
import struct

import isa_ros
from isa_ros.bag.provenance import installed_versions
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import parse
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import Rerun
from isa_ros.testing import _without_inner_frames, assert_replays
import pytest
from tests.bag.golden import GOLDEN, rewrite
from tests.docs.pages import example, text_of

pytest_plugins = ['pytester']

PAGE = text_of('reproduce')
EXAMPLE = next(block for block in re.findall(r'```python\n(.*?)```', PAGE, re.DOTALL)
               if 'assert_replays' in block)
BITWISE = "def test_it(assert_replays):\n    assert_replays('bags/drop')\n"
TOLERANT = BITWISE.replace("'bags/drop'", "'bags/drop', 'bags/tolerances.yaml'")
EFFORT_TICK = 21


@pytest.fixture(scope='module')
def here(tmp_path_factory) -> Path:
    """Return a bag that this machine recorded with these versions: a golden run anew."""
    golden = Bag(GOLDEN / 'rotor_step')
    directory = tmp_path_factory.mktemp('here') / 'drop'
    own = golden.provenance
    own = type(own)(run_of_text(own.configuration).to_yaml(), own.scenario, 0,
                    installed_versions())
    again = Rerun(golden)
    with BagWriter(directory, again.topics, own) as writer:
        again.simulate(writer)
    return directory


@pytest.fixture
def project(pytester, here):
    """
    Return a user's project with the plug-in.

    ``here`` has loaded numba before: pytester unloads what an inner run imports, and numba cannot
    be loaded twice.
    """
    pytester.makeconftest("pytest_plugins = ['isa_ros.testing']\n")
    pytester.mkdir('bags')
    return pytester


def test_a_bag_that_is_missing_is_one_line_without_the_frames_of_its_reader(project):
    """And a file: a user's own frames stay."""
    project.makepyfile(
        BITWISE, test_file="""
        def own(assert_reproduces):
            assert_reproduces('no.yaml', None, 'bags/drop')

        def test_it(assert_reproduces):
            own(assert_reproduces)
        """)
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(failed=2)
    text = '\n'.join(result.outlines)
    assert 'BagError: bags/drop' in text and 'isa_ros/bag' not in text
    assert text.count('def own(assert_reproduces)') == 1


@pytest.mark.parametrize('check', [
    "assert_no_trips('bags/drop')", "assert_replays('bags/drop')",
    "assert_reproduces('leg.yaml', None, 'bags/drop')"])
def test_a_bag_that_is_cut_short_passes_nothing(project, here, check):
    """Though all messages are there, but not the end behind them."""
    shutil.copytree(here, project.path / 'bags' / 'drop')
    file, = (project.path / 'bags' / 'drop').glob('*.mcap')
    os.truncate(file, file.stat().st_size - 8)
    assert Bag(file.parent).n_messages > 100
    name = check.partition('(')[0]
    project.makepyfile(f'def test_it({name}):\n    {check}\n')
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(['*BagError: bags/drop: is cut short, by a recorder that*'])


def test_a_file_that_is_missing_or_wrong_is_one_line_too(project, here):
    """Also where another library's error is behind it."""
    (project.path / 'wrong.yaml').write_text('a: [1\n')
    project.makepyfile(f"""
        import pytest

        @pytest.mark.parametrize('name', ['no.yaml', 'wrong.yaml'])
        def test_it(assert_replays, name):
            assert_replays({str(here)!r}, tolerances=name)
        """)
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(failed=2)
    text = '\n'.join(result.outlines)
    assert 'ConfigError: no.yaml: ' in text and 'ConfigError: wrong.yaml' in text
    assert 'yaml_text.py' not in text and 'composer.py' not in text and 'direct cause' not in text


@pytest.mark.parametrize(('module', 'is_hidden'), [('numpy.own', True), ('machine', False)])
def test_frames_of_a_user_behind_an_error_are_not_hidden(module, is_hidden):
    """Of the error that an error of a file comes from."""
    inner = {'__name__': 'isa_ros.own', 'ConfigError': ConfigError}
    outer = {'__name__': module}
    exec('def read(): raise ValueError("5")', outer)
    exec('def check(read):\n try:\n  read()\n except ValueError as error:\n'
         '  raise ConfigError("bad") from error', inner)
    with pytest.raises(ConfigError, match='bad') as found:
        _without_inner_frames(inner['check'])(outer['read'])
    assert (found.value.__suppress_context__ and found.value.__cause__ is None) is is_hidden


def test_an_error_of_a_users_controller_keeps_its_frames(project):
    project.makepyfile("""
        import isa_ros
        from isa_ros.errors import ConfigError

        class Own(isa_ros.Controller):
            def start(self, names):
                self.helped()

            def helped(self):
                raise ConfigError('a sign is wrong')

        def test_it(assert_reproduces):
            isa_ros.load('rig_rotary', duration=0.005).simulate().save('bags/own')
            assert_reproduces('rig_rotary', None, 'bags/own', controllers=(Own(),))
        """)
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(failed=1)
    assert "raise ConfigError('a sign is wrong')" in '\n'.join(result.outlines)


def with_a_code_more(topic: str, sequence: int, data: bytes) -> bytes:
    """Change the last number of one message by less than the tolerances below."""
    if (topic, sequence) != ('/rotor/load_cell', EFFORT_TICK):
        return data
    value, = struct.unpack('<d', data[-8:])
    return data[:-8] + struct.pack('<d', value + 0.05)


def of_page(start: str) -> str:
    """Return the YAML block of the page that begins with a text."""
    return example('reproduce', start)


def test_the_example_of_the_page_fails_as_the_page_says(project) -> None:
    """Each of its two tests for its own reason, with the lines that the page shows."""
    (project.path / 'my_ram.yaml').write_text(of_page('name: my_ram'))
    (project.path / 'my_step.yaml').write_text(of_page('name: my_step'))
    isa_ros.load('my_ram.yaml', 'my_step.yaml').simulate().save('bags/step')
    project.makepyfile(test_my_ram=EXAMPLE.replace("pytest_plugins = ['isa_ros.testing']", ''))
    project.runpytest_inprocess('-q').assert_outcomes(passed=2)
    shown = re.search(r'^    (key +in the bag .*)\n    (.*)$', PAGE, re.MULTILINE)
    before, after = shown[2].split()[1:3]
    text = (project.path / 'my_ram.yaml').read_text()
    (project.path / 'my_ram.yaml').write_text(
        text.replace(f'inertia: {before}', f'inertia: {after}'))
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines([
        'E*AssertionError: bags/step: not reproduced by my_ram.yaml, scenario my_step',
        f'E*{shown[1]}', f'E*{shown[2]}', 'E*differ: tick *', 'E*/ram/joint_states *',
        'FAILED test_my_ram.py::test_my_files_still_give_this_step*'])


def test_the_tolerances_of_the_page_fit_its_example(project) -> None:
    (project.path / 'tolerances.yaml').write_text(of_page('# tolerances'))
    bag = isa_ros.load(
        parse(of_page('name: my_ram'), 'my_ram.yaml'), duration=0.01).simulate().save('bags/ram')
    assert_replays(bag, 'tolerances.yaml')
    (project.path / 'tolerances.yaml').write_text(
        of_page('# tolerances').replace('/ram/joint', '/arm/joint'))
    with pytest.raises(ConfigError, match='^tolerances.yaml: /arm/joint_states: no such topic'):
        assert_replays(bag, 'tolerances.yaml')


def test_every_bit_counts_without_tolerances(project, here) -> None:
    shutil.copytree(here, project.path / 'bags' / 'drop')
    project.makepyfile(test_it=BITWISE)
    project.runpytest_inprocess('-q').assert_outcomes(passed=1)
    shutil.rmtree(project.path / 'bags' / 'drop')
    rewrite(Bag(here), project.path / 'bags' / 'drop', with_a_code_more)
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([
        '*bags/drop: differ: tick 21 (t = 0.021000 s), /rotor/load_cell, wrench.torque.z: *',
        '*No tolerances were given, so every bit must be equal*'
        'Versions and topics are those of the bag.*'])


def test_tolerances_by_signal_admit_what_they_say(project, here) -> None:
    rewrite(Bag(here), project.path / 'bags' / 'drop', with_a_code_more)
    project.makepyfile(test_it=TOLERANT)
    for bound, outcome in ((0.06, {'passed': 1}), (0.04, {'failed': 1})):
        (project.path / 'bags' / 'tolerances.yaml').write_text(
            f'/rotor/load_cell: {{wrench.torque.z: {bound}}}\n')
        result = project.runpytest_inprocess('-q')
        result.assert_outcomes(**outcome)
        result.stdout.no_fnmatch_line('*No tolerances were given*')


def test_other_versions_are_named_where_bits_differ(project, here) -> None:
    there = installed_versions() | {'numpy': '1.0'}
    rewrite(Bag(here), project.path / 'bags' / 'drop', with_a_code_more, versions=there)
    project.makepyfile(test_it=BITWISE)
    result = project.runpytest_inprocess('-q')
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([
        f'*numpy is {installed_versions()["numpy"]} here, was 1.0',
        '*No tolerances were given*Versions or topics differ as listed.*'])


def test_other_versions_alone_are_no_failure(project, here) -> None:
    rewrite(Bag(here), project.path / 'bags' / 'drop', versions={'numpy': '1.0'})
    project.makepyfile(test_it=BITWISE)
    project.runpytest_inprocess('-q').assert_outcomes(passed=1)


def test_function_may_be_imported(project, here) -> None:
    shutil.copytree(here, project.path / 'bags' / 'drop')
    project.makepyfile(test_it=(
        'from isa_ros.testing import assert_replays\n\n\n'
        "def test_it():\n    assert_replays('bags/drop')\n"))
    project.runpytest_inprocess('-q').assert_outcomes(passed=1)
