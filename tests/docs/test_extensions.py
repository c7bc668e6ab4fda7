"""Rows of "Places for extensions" of docs/architecture.md, each made in a copy of the package."""

from pathlib import Path
import re

import pytest
from tests.docs.patched_copy import PatchedCopy

_CONDITION = '''    Condition(
        'undervoltage', 'The supply sags below what the pumps need.',
        'supply pressure', 'Pa', 'opening_pressure',
        ErrorCode(0xFF10, MANUFACTURER, 'manufacturer: undervoltage'),
        LevelDefaults(
            'pressure over the opening of the relief valves', 1.0, warning=0.0, trip=0.0,
            delay_ms=0.0, reaction='disable'),
        is_above=False),
)
"""All conditions;'''
_MEASURED = '    values[BIT.spool_deviation] = spool_deviation(state, protection.evidence)\n'
_TRIPS = """
import isa_ros
from isa_ros.fieldbus.device.devices import devices_of
import isa_ros.fieldbus.lines
run = isa_ros.load('rig_linear').replace({
    'actuators.ram.parameters.reu.protection.undervoltage.trip': 0.99})
simulation = run.simulation()
for _ in range(2):
    sample = simulation.step()['ram']
print(isa_ros.conditions(sample['trips']))
device, = devices_of(run.configuration)
device.take_sample(sample, 0)
print(*(f'{one.code:04X} {one.register:02X}' for one in device.emergencies()))
"""
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
_CHANNEL = """

@dataclass(frozen=True, kw_only=True)
class TachometerChannel(Channel):

    sigma: float = _sigma('m/s | rad/s', 1.0)
    bias: float = _bias('m/s | rad/s', 10.0)
    drift_per_s: float = _drift('m/s2 | rad/s2', 1.0)


CHANNEL_ERRORS = """
_SENSES = """
import isa_ros
run = isa_ros.load('rig_linear', duration=0.05).replace({
    'actuators.ram.parameters.plant.sensors.tachometer.bias': 1.0})
result = run.simulate()
difference = result['ram.tachometer'][1:] - result['ram.velocity'][1:]
print(result.units['ram.tachometer'], abs(difference - 1.0).max() < 0.1)
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


@pytest.mark.slow
def test_a_condition_is_a_row_and_a_line(copied: PatchedCopy) -> None:
    """Sheet, bit, words, error on a bus and pages are made from the row."""
    copied.replace(
        'isa_ros/core/conditions.py', ')\n"""All conditions;', _CONDITION)
    copied.replace(
        'isa_ros/reu/protection.py', _MEASURED,
        f'{_MEASURED}    values[BIT.undervoltage] = supply_pressure\n')
    assert len(copied.touched) == 2
    parameters = copied.isa('params', 'isa_v5')
    assert 'reu.protection.undervoltage.reaction ' in parameters
    assert copied.python(_TRIPS) == "['undervoltage']\nFF10 81\n"
    assert '0x2024 ' in copied.isa('bus', 'describe', 'rig_linear', '--table')
    copied.script('scripts/write_protection.py')
    assert '\n| 13 | `undervoltage` | supply pressure |' in copied.read('docs/protection.md')
    copied.script('scripts/write_objects.py')
    assert '\n| `undervoltage` | 0xFF10 | 0x81 |' in copied.read('docs/objects.md')


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


@pytest.mark.slow
def test_a_sensor_is_a_channel_and_a_row_of_the_sample(copied: PatchedCopy) -> None:
    """Its errors, noise, parameters and faults; result, units and pages."""
    signals, sensors = 'isa_ros/core/signals.py', 'isa_ros/plant/sensors.py'
    last = '])\n"""The last readings of the channels'
    copied.replace(signals, last, f"    ('tachometer', 'f8'),\n{last}")
    last = ')\n"""The values one actuator reports'
    copied.replace(
        signals, last, f"    Field('tachometer', 'm/s | rad/s', 'as sensed'),\n{last}")
    copied.replace('isa_ros/plant/channels.py', '\nCHANNEL_ERRORS = ', _CHANNEL)
    last = '    temperature: TemperatureSensor ='
    copied.replace(
        sensors, last, '    tachometer: channels.TachometerChannel = section('
        f'channels.TachometerChannel)\n{last}')
    for old, new in (
            ('    if not own.errors.are_ideal:\n', 'measured.tachometer = at.velocity'),
            ('    channels.disturb(', 'exact[6] = measured.tachometer'),
            ('\n\n@kernel\ndef read(', 'measured.tachometer = shown[6]')):
        copied.replace(sensors, old, f'    {new}\n{old}')
    copied.replace(
        'isa_ros/actuator/kernel.py', '    sample.current = measured.current\n',
        '    sample.current = measured.current\n    sample.tachometer = measured.tachometer\n')
    assert len(copied.touched) == 4
    assert copied.python(_SENSES) == 'm/s True\n'
    parameters = copied.isa('params', 'isa_v5')
    assert 'plant.sensors.tachometer.stuck ' in parameters
    copied.script('scripts/write_signals.py')
    assert '\n| `tachometer` | m/s or rad/s | as sensed |' in copied.read('docs/signals.md')


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
