"""Rows of "Places for extensions" of docs/architecture.md, each made in a copy of the package."""

from pathlib import Path
import re

import pytest
from tests.docs.patched_copy import PatchedCopy

_SEED = "    Key('seed', Value("
_KEY = f"""    number('room_celsius', 'Celsius', 'the air around the run', 20.0, ge=-50.0),
{_SEED}"""
_RUNS = """
import isa_ros
from isa_ros.config.differences import configuration_differences, key_differences
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.errors import ConfigError
rig = isa_ros.load('rig_linear')
assert rig.configuration.room_celsius == 20.0
warm = rig.replace({'room_celsius': 30}).configuration
text = warm.to_yaml()
assert RunConfig.from_yaml(text) == warm and warm.digest != rig.configuration.digest
print(*configuration_differences(parse(text, ''), parse(rig.configuration.to_yaml(), '')))
older = parse(text.replace('room_celsius: 30.0\\n', ''), '')
print(*key_differences(older, Place('old')))
try:
    rig.replace({'room_celsius': -60})
except ConfigError as error:
    print(error)
"""


@pytest.fixture
def copied(tmp_path: Path) -> PatchedCopy:
    """Return a copy of the package."""
    return PatchedCopy(tmp_path)


def test_a_text_that_is_not_there_once_is_refused(copied: PatchedCopy) -> None:
    with pytest.raises(ValueError, match='has 0 times, must have once'):
        copied.replace('package.xml', 'no such text', '')
    with pytest.raises(ValueError, match='times, must have once'):
        copied.replace('isa_ros/core/conditions.py', 'Condition(', '')
    with pytest.raises(FileExistsError):
        copied.add('package.xml', '')
    assert copied.touched == []


def test_a_key_of_a_run_file_is_a_row(copied: PatchedCopy) -> None:
    """And a field for its value: read, checked, written, compared, listed and on the page."""
    path = 'isa_ros/config/runs/run_config.py'
    copied.replace(path, _SEED, _KEY)
    field = '    seed: int = 0\n'
    copied.replace(path, field, f'{field}    room_celsius: float = 20.0\n')
    assert copied.touched == [path]
    compared, lacking, refused = copied.python(_RUNS).splitlines()
    assert compared == (
        "DifferingKey(key='room_celsius', expected=30.0, actual=20.0, unit='Celsius')")
    assert lacking == (
        "KeyDifference(text='old: room_celsius is missing in the bag, 20.0 is meant', "
        'is_obstacle=False)')
    assert refused == (
        'rig_linear.yaml: room_celsius = -60 Celsius, must be >= -50 Celsius (the air around the '
        'run)')
    listed = copied.isa('params', 'rig_linear', '--set', 'room_celsius=25')
    assert re.search(r'^room_celsius +25 +Celsius +--set +the air around the run$', listed, re.M)
    copied.script('scripts/write_run_file.py')
    assert ('\n| `room_celsius` | number, Celsius | 20.0 | the air around the run | yes |'
            in copied.read('docs/run_file.md'))


_TOY = '''
"""A bus that nobody is on."""


def toy_line(devices, place, step_ns):
    """Open nothing."""
    return place, len(devices), step_ns


def refuse_unusable(devices, place, step_ns):
    """Refuse a place."""
    if place == 'nowhere':
        raise ValueError('no such place')
'''
_OPENS = """
import isa_ros
from isa_ros.cli.bus_commands import bus_request_of
from isa_ros.cli.main import make_parser
from isa_ros.fieldbus.lines import line_of, refuse_unusable
options = make_parser().parse_args(['bus', 'toy', 'rig_linear', '--place', 'nowhere'])
options.is_alone = True
request = bus_request_of(options)
print(request.place, line_of(request)([1, 2], 5))
try:
    refuse_unusable(request, [], 5)
except ValueError as error:
    print(error)
"""


def test_a_bus_is_a_file_and_a_row(copied: PatchedCopy) -> None:
    """The row has its module and its arguments of the command line."""
    copied.add('isa_ros/fieldbus/toy.py', _TOY)
    copied.replace(
        'isa_ros/fieldbus/request.py', "    SERIAL: Bus('serial.line'",
        "    'toy': Bus('toy', 'nobody', (Argument('place', 'any'),)),\n"
        "    SERIAL: Bus('serial.line'")
    assert len(copied.touched) == 2
    assert copied.python(_OPENS) == "nowhere ('nowhere', 2, 5)\nno such place\n"
    assert 'serve nobody' in ' '.join(copied.isa('bus', '--help').split())
