"""The options of a run: one declaration for the command line, ROS parameters and launch files."""

from dataclasses import fields
from pathlib import Path
import subprocess
import sys

from isa_ros.bag.storage import Storage
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.errors import ConfigError
from isa_ros.run.option import COMPRESSIONS, Option
from isa_ros.run.options import (
    launched_elsewhere, launched_parameters, OPTIONS, Request, request_of_arguments,
    request_of_parameters)
import pytest

ROOT = Path(__file__).parents[2]
LEG = find('leg', CONFIG)
BY_FIELD = {option.field: option for option in OPTIONS}
DEFAULTS = {option.parameter: option.parameter_default for option in OPTIONS
            if option.is_parameter} | {'config_file': 'leg'}
TEXTS = {option.name: option.launch_text for option in OPTIONS}


def option_of(field: str) -> Option:
    """Return the option of a field of `Request`."""
    return BY_FIELD[field]


def test_the_ros_parameters_of_the_coordinator_keep_their_names():
    assert set(DEFAULTS) == {
        'config_file', 'scenario_file', 'out', 'duration', 'real_time_factor', 'controllers',
        'paused', 'restore', 'save', 'overwrite', 'compression', 'split_mb', 'in_process',
        'join_timeout_s', 'sync', 'set', 'seed', 'start_time', 'fail_on_trip'}


def test_the_launch_file_has_every_option_as_an_argument():
    assert TEXTS == {
        'config': 'leg.yaml', 'scenario': '', 'out': '', 'duration': '0.0',
        'in_process': 'false', 'real_time_factor': '0.0', 'paused': 'false', 'compression': '',
        'split_mb': '-1.0', 'namespace': '', 'overwrite': 'false', 'elsewhere': '',
        'controller': '', 'join_timeout': '30.0', 'restore': '', 'save': '', 'sync': 'false',
        'fail_on_trip': 'false',
        'set': '', 'seed': '-1', 'start_time': '-1'}


def test_every_field_with_an_option_is_of_the_request():
    assert set(BY_FIELD) == {f.name for f in fields(Request)} - {'is_alone', 'laps'}


def test_parameters_that_are_not_set_ask_for_the_defaults():
    assert request_of_parameters(DEFAULTS) == Request(config=LEG)


def test_parameters_that_are_set_ask_for_what_the_command_line_asks_for():
    by_parameters = request_of_parameters({
        'config_file': 'leg', 'scenario_file': 'drop', 'out': 'bag', 'duration': 0.5,
        'real_time_factor': 2.0, 'controllers': ['sway', 'hold'], 'paused': True,
        'restore': 'a.json', 'save': 'b.json', 'overwrite': True, 'compression': 'lz4',
        'split_mb': 3.0, 'in_process': True, 'join_timeout_s': 7.0, 'sync': True,
        'fail_on_trip': True,
        'set': ['supply.pressure_mpa=14.0'], 'seed': 7, 'start_time': 9}, is_alone=True)
    by_arguments = request_of_arguments({
        'config': 'leg', 'scenario': 'drop', 'out': Path('bag'), 'duration': 0.5,
        'real_time_factor': 2.0, 'controller': ['sway', 'hold'], 'paused': True,
        'restore': Path('a.json'), 'save': Path('b.json'), 'overwrite': True,
        'compression': 'lz4', 'split_mb': 3.0, 'in_process': True, 'join_timeout': 7.0,
        'elsewhere': (), 'sync': True, 'fail_on_trip': True,
        'set': ['supply.pressure_mpa=14.0'], 'seed': 7, 'start_time': 9}, is_alone=True)
    assert by_parameters == by_arguments == Request(
        config=LEG, scenario=find('drop', SCENARIOS), out=Path('bag'), duration_s=0.5,
        real_time_factor=2.0, controllers=('sway', 'hold'), is_paused=True,
        restore=Path('a.json'), save=Path('b.json'), overwrite=True, compression='lz4',
        split_mb=3.0, is_synced=True, fail_on_trip=True, in_process=True, join_timeout_s=7.0,
        is_alone=True,
        changes=('supply.pressure_mpa=14.0',), seed=7, start_time_s=9)
    assert by_arguments.all_changes == (
        'supply.pressure_mpa=14.0', 'seed=7', 'start_time_s=9')


@pytest.mark.parametrize('field, given, expected', [
    ('split_mb', 0.0, 0.0), ('split_mb', -2.0, None), ('duration_s', 0.0, None),
    ('duration_s', -1.0, -1.0), ('seed', 0, 0), ('seed', -1, None),
    ('join_timeout_s', 0.0, 0.0), ('controllers', None, ())])
def test_a_parameter_means(field, given, expected):
    """0 MB is one file, below is not set; what is set and wrong is refused by the run."""
    assert option_of(field).of_parameter(given) == expected


def test_a_launch_file_hands_texts_on_as_parameters_of_their_type():
    """The files are handed on by `run_processes`, the namespace by launch."""
    assert launched_parameters(TEXTS) == {
        'out': '', 'duration': 0.0, 'in_process': False, 'real_time_factor': 0.0,
        'paused': False, 'compression': '', 'split_mb': -1.0, 'overwrite': False,
        'join_timeout_s': 30.0, 'restore': '', 'save': '', 'sync': False, 'seed': -1,
        'start_time': -1, 'fail_on_trip': False}
    given = launched_parameters(TEXTS | {
        'duration': '2', 'in_process': 'True', 'paused': '1', 'compression': 'zstd',
        'controller': 'sway,hold', 'elsewhere': 'hip,knee'})
    assert given['duration'] == 2.0 and isinstance(given['duration'], float)
    assert (given['in_process'], given['paused'], given['compression']) == (True, True, 'zstd')
    assert given['controllers'] == ['sway', 'hold'] and 'elsewhere' not in given
    assert launched_elsewhere(TEXTS | {'elsewhere': 'hip,knee'}) == ('hip', 'knee')


@pytest.mark.parametrize(('name', 'text', 'message'), [
    ('in_process', 'maybe', 'in_process:=maybe, must be true or false'),
    ('paused', '', 'paused:=, must be true or false'),
    ('duration', 'long', 'duration:=long, must be a number'),
    ('seed', '1.5', 'seed:=1.5, must be a whole number')])
def test_a_launch_file_refuses_a_text_of_another_kind(name, text, message):
    with pytest.raises(ConfigError, match=f'^{message}$'):
        launched_parameters(TEXTS | {name: text})


@pytest.mark.parametrize('field, help_, description', [
    ('duration_s', 'simulated time (default: that of the scenario, else until Ctrl-C)',
     'simulated time, s; 0: that of the scenario, else until Ctrl-C'),
    ('compression', 'of the chunks of the bag (default: that of CONFIG, else none)',
     'of the chunks of the bag: none, lz4, zstd; empty: that of the run file, else none'),
    ('controllers', 'a node of yours; the run waits for it at every tick; may be repeated',
     'a node of yours; the run waits for it at every tick; a list of names, in a launch file '
     'separated by commas'),
    ('changes', 'another value in CONFIG, by its key and in its unit, as isa params shows them; '
     'keys of the scenario begin with scenario.',
     'another value in the run file, by its key and in its unit, as isa params shows them; keys '
     'of the scenario begin with scenario.; a list of KEY=VALUE, in a launch file separated by '
     'commas'),
    ('join_timeout_s', 'longest wait for participants (default: 30 s)',
     'longest wait for participants, s')])
def test_help_says_unit_and_default_in_each_place(field, help_, description):
    option = option_of(field)
    assert (option.argument_help, option.description) == (help_, description)


@pytest.mark.parametrize('text', ['left', '/left', 'robot_1/left/'])
def test_a_namespace_may_have_slashes_around_it(text):
    assert option_of('namespace').of_argument(text) == text.strip('/')


@pytest.mark.parametrize('text', ['1eft', 'a//b', 'my-leg', '~/a', 'a__b', '{ns}'])
def test_a_namespace_that_ros_does_not_accept_is_refused(text):
    with pytest.raises(ConfigError, match='^namespace = .*, must be names of letters'):
        option_of('namespace').of_argument(text)


def test_the_compressions_are_those_of_a_run_file():
    declared = next(f for f in fields(Storage) if f.name == 'compression')
    assert declared.metadata['names'] == COMPRESSIONS


def test_the_options_import_neither_ros_nor_numba():
    program = (
        f'import sys; sys.path.insert(0, {str(ROOT)!r})\n'
        'import isa_ros.run.options\n'
        'print(sorted({"numba", "numpy", "rclpy", "yaml"} & set(sys.modules)))\n')
    result = subprocess.run(
        [sys.executable, '-S', '-c', program], capture_output=True, text=True, timeout=60)
    assert (result.stdout, result.stderr) == ('[]\n', '')


def test_a_namespace_too_long_for_topics_is_refused():
    """A topic of DDS has at most 255 letters, with the names that follow."""
    assert option_of('namespace').of_argument('n' * 100) == 'n' * 100
    with pytest.raises(ConfigError, match='has 101 letters, must have at most 100'):
        option_of('namespace').of_argument('n' * 101)
