"""Rows of "Places for extensions" of docs/architecture.md, each made in a copy of the package."""

import re
import textwrap

import pytest
from tests.docs.patched_copy import files_of, names_of, PatchedCopy

_SEED = "    Key('seed', Value("
_KEY = f"""    number('room_celsius', 'Celsius', 'the air around the run', 20.0, ge=-50.0),
{_SEED}"""
_RUNS = """
import isa_ros
from isa_ros.config.differences import configuration_differences, key_differences
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.errors import ConfigError
rig = isa_ros.load('rig_linear')
assert rig.configuration.room_celsius == 20.0
warm = rig.replace({'room_celsius': 30}).configuration
text = warm.to_yaml()
assert run_of_text(text) == warm and warm.digest != rig.configuration.digest
print(*configuration_differences(parse(text, ''), parse(rig.configuration.to_yaml(), '')))
older = parse(text.replace('room_celsius: 30.0\\n', ''), '')
print(*key_differences(older, Place('old')))
try:
    rig.replace({'room_celsius': -60})
except ConfigError as error:
    print(error)
"""


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
        "    'toy': Bus('toy', 'nobody', (BusArgument('place', 'any'),)),\n"
        "    SERIAL: Bus('serial.line'")
    assert len(copied.touched) == 2
    assert copied.python(_OPENS) == "nowhere ('nowhere', 2, 5)\nno such place\n"
    assert 'serve nobody' in ' '.join(copied.isa('bus', '--help').split())


def with_inclinometer(copied: PatchedCopy) -> None:
    """Add the angle of the calf in the plane of the leg, with a key, a topic and a field."""
    leg = 'isa_ros/surroundings/bodies/leg/'
    copied.replace(f'{leg}inertial.py', '\n\n\n@kernel\ndef read_imu(', textwrap.dedent('''


        @kernel
        def calf_angle(states):
            """Return the angle between calf and hip, rad, of one `LEG_STATE`, (1,)."""
            return states[0].q_hfe + states[0].q_kfe


        @kernel
        def read_imu(''').rstrip(' '))
    path = f'{leg}stepping.py'
    copied.replace(path, 'import read_imu\n', 'import calf_angle, read_imu\n')
    copied.replace(path, '    """Of the units, (u, 6)."""\n',
                   '    """Of the units, (u, 6)."""\n    angles: np.ndarray\n')
    copied.replace(path, '    clock = own.clock[0]\n    for k in range(len(own.imus)):\n',
                   '    clock = own.clock[0]\n    for k in range(len(own.angles)):\n'
                   '        own.angles[k] = calf_angle(own.states)\n'
                   '    for k in range(len(own.imus)):\n')
    copied.replace(path, 'len(own.imus) > 0:', 'len(own.imus) + len(own.angles) > 0:')
    path = f'{leg}leg.py'
    copied.replace(path, 'units: Sequence[InertialUnit] = ()) -> None:',
                   'units: Sequence[InertialUnit] = (), has_calf: bool = False) -> None:')
    copied.replace(path, 'sample_fields([unit.name for unit in units])',
                   'sample_fields([unit.name for unit in units], has_calf)')
    copied.replace(path, 'self._motion.nbytes:].view(\n            np.float64).reshape(-1, AXES)',
                   'self._motion.nbytes:].view(\n            np.float64)[:AXES * len(units)]'
                   '.reshape(-1, AXES)\n'
                   '        self._angles = self._sample.view(np.uint8).view(np.float64)['
                   'self._sample.nbytes // 8 - has_calf:]')
    copied.replace(path, 'self._periods, self._readings)',
                   'self._periods, self._readings, self._angles)')
    copied.replace(path, 'sample_fields(names: Sequence[str])',
                   'sample_fields(names: Sequence[str], has_calf: bool = False)')
    copied.replace(path, 'zip(fields_of_unit(name), readings)))',
                   'zip(fields_of_unit(name), readings)),\n'
                   "        *[Field('calf_angle', 'rad', 'to the hip')] * has_calf)")
    path = f'{leg}messages.py'
    copied.replace(path, 'Sequence[InertialUnit]) -> tuple[BodyMessage, ...]:',
                   'Sequence[InertialUnit],\n                 has_calf: bool = False)'
                   ' -> tuple[BodyMessage, ...]:')
    copied.replace(path, '        *(_inertial(prefix, unit) for unit in units))',
                   '        *(_inertial(prefix, unit) for unit in units),\n'
                   "        *[JointStates(f'/{prefix}calf_angle', ['calf'], ['calf_angle'], [],"
                   ' [])] * has_calf)')
    path = 'isa_ros/config/runs/leg_config.py'
    copied.replace(path, "        Key('parameters', Layer(LegSheet),",
                   "        Key('calf_angle', FLAG, 'inclinometer of the calf', False),\n"
                   "        Key('parameters', Layer(LegSheet),")
    copied.replace(path, 'ANY_NAME, InText,', 'ANY_NAME, FLAG, InText,')
    copied.replace(path, 'imus: tuple[ImuConfig, ...] = ()\n',
                   'imus: tuple[ImuConfig, ...] = ()\n    calf_angle: bool = False\n')
    copied.replace(path, "imu in values['imus'].items()))\n",
                   "imu in values['imus'].items()),\n"
                   "                  calf_angle=values['calf_angle'])\n")
    copied.replace(path, 'sample_fields([imu.name for imu in self.imus])',
                   'sample_fields([imu.name for imu in self.imus], self.calf_angle)')
    copied.replace(path, 'self._units(step_ns, seed=0))', 'self._units(step_ns, seed=0), '
                   'self.calf_angle)')
    copied.replace(path, 'units=self._units(made.step_ns, made.seed))',
                   'units=self._units(made.step_ns, made.seed), has_calf=self.calf_angle)')


@pytest.mark.slow
def test_a_sensor_on_a_link_is_of_five_files(copied: PatchedCopy) -> None:
    """Beside an inertial unit: file, field, unit, topic, bag and replay have it."""
    with_inclinometer(copied)
    assert names_of(copied.touched) == files_of('sensor on a link of the leg')
    topic, unit, error = copied.python(
        'import isa_ros; from isa_ros.bag.reader import Bag; '
        "run = isa_ros.load('leg').replace({'leg.calf_angle': True, 'leg.imus.trunk.link': "
        "'slider_link'}); result = run.simulate(0.02); "
        "print(Bag(result.save('bag')).types['/calf_angle'], result.units['body.calf_angle'], "
        "abs(result['body.calf_angle'] - result['body.position'][:, 1:].sum(axis=1)).max())"
        ).split()
    assert (topic, unit, float(error)) == ('sensor_msgs/msg/JointState', 'rad', 0.0)
    assert 'equal' in copied.isa('replay', 'bag')
