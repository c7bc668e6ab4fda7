"""Rows of "Places for extensions": their cases, and what is not of the plant, made in copies."""

import importlib
import re

import isa_ros
from isa_ros.core.signals import Records
from isa_ros.requests import fill_command
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.source import ScheduledSource
import pytest
from tests.docs.patched_copy import files_of, names_of, PatchedCopy, rows_of_the_page
from tests.ros.conftest import domain  # noqa: F401

CASES = {
    'part of the plant, such as a friction buffer at each end':
        'test_kernel_extensions.test_a_part_of_the_plant_is_a_file_and_its_term',
    'control block': 'test_kernel_extensions.test_a_control_block_is_a_file_a_kind_and_a_branch',
    'middleware of the bench': 'test_places.test_a_middleware_is_a_file_and_a_line',
    'condition of the protection': 'test_kernel_extensions.test_a_condition_is_a_row_and_a_line',
    'key of a run file': 'test_extensions.test_a_key_of_a_run_file_is_a_row',
    'sensor': 'test_kernel_extensions.test_a_sensor_is_a_channel_and_a_row_of_the_sample',
    'sensor on a link of the leg': 'test_extensions.test_a_sensor_on_a_link_is_of_five_files',
    'bus': 'test_extensions.test_a_bus_is_a_file_and_a_row',
    'body': 'test_physical_places.test_a_kind_of_bodies_is_a_class_and_a_row',
    'supply': 'test_physical_places.test_a_supply_is_two_files',
    'load of one actuator': 'test_kernel_extensions.test_a_load_is_a_set_a_force_and_values',
    'wire of a link': 'test_kernel_extensions.test_a_wire_is_its_values_and_a_name',
    'topic of an actuator': 'test_places.test_a_topic_of_an_actuator_is_one_file',
    'object on a bus': 'test_places.test_an_object_with_a_source_is_one_word',
    'option of a run': 'test_places.test_an_option_of_a_run_is_a_field',
    'output of a run': 'test_places.test_an_output_of_a_run_is_a_sink',
    'fault of the device': 'test_places.test_a_fault_is_a_mark',
    'source of commands': 'test_places.test_a_source_of_commands_is_a_class',
    'quantity that values of a model scale with': 'test_places.test_a_quantity_is_a_function',
}
"""Case by row: a test of this folder that makes the extension in a copy."""


def test_every_row_of_the_page_has_a_case() -> None:
    assert set(CASES) == set(rows_of_the_page())
    for case in CASES.values():
        module, _, name = case.partition('.')
        assert callable(getattr(importlib.import_module(f'tests.docs.{module}'), name))


@pytest.mark.slow
def test_a_topic_of_an_actuator_is_one_file(copied: PatchedCopy) -> None:
    """Bag and replay have it."""
    path = 'msg_adapters/actuator_messages.py'
    copied.replace(path, "    ('valve', joint_state.TYPE),\n",
                   "    ('valve', joint_state.TYPE),\n    ('wear', joint_state.TYPE),\n")
    copied.replace(path, "        'valve': joint_state.valve(name, sample),\n",
                   "        'valve': joint_state.valve(name, sample),\n"
                   "        'wear': joint_state.references(name, sample),\n")
    others = {'run/row_messages.py', 'run/rare_messages.py'}     # of slower messages, and texts
    assert names_of(copied.touched) == files_of('topic of an actuator') - others
    assert copied.python(
        'import isa_ros; from isa_ros.bag.reader import Bag; from isa_ros.replay.replay import '
        "replay; bag = Bag(isa_ros.load('rig_linear').simulate(0.002).save('bag')); "
        "print(bag.types['/ram/wear'], replay(bag).is_equal)") == (
            'sensor_msgs/msg/JointState True\n')


@pytest.mark.slow
def test_an_object_with_a_source_is_one_word(copied: PatchedCopy) -> None:
    """Its unit, type and place follow; the table of a bus shows it."""
    copied.replace(
        'isa_ros/fieldbus/device/manufacturer_area.py', "{'temperature': 'Oil in the actuator'}",
        "{'temperature': 'Oil in the actuator', 'age': 'Age of this sample'}")
    assert names_of(copied.touched) <= files_of('object on a bus') and len(copied.touched) == 1
    assert 'Age of this sample' in copied.isa('bus', 'describe', 'rig_linear', '--table')


def test_an_option_of_a_run_is_a_field(copied: PatchedCopy) -> None:
    """The command has it."""
    path = 'isa_ros/run/options.py'
    flag = '    is_synced: bool = field(default=False'
    copied.replace(path, flag, '    is_tried: bool = field(default=False, metadata=_option(\n'
                   f"        Kind.FLAG, 'only an example', name='tried'))\n{flag}")
    assert names_of(copied.touched) == files_of('option of a run') - {'run/session.py'}
    assert re.search(r'--tried +only an example', copied.isa('bringup', '--help'))


def test_an_output_of_a_run_is_a_sink() -> None:
    """It takes the rows of each instant."""
    simulation = isa_ros.load('rig_linear').simulation()
    seen: list[tuple[int, float]] = []

    class Place(RowSink):
        """Keeps the place of the first actuator."""

        def take(self, tick: int, rows: Rows) -> None:
            """Keep it."""
            seen.append((tick, float(rows.samples['position'][0])))
    simulation.loop.sinks = (Place(),)
    simulation.loop.run(3)
    assert [tick for tick, _ in seen] == [0, 1, 2, 3]
    assert seen[-1][1] == simulation.samples['ram'].position


@pytest.mark.slow
def test_a_fault_is_a_mark(copied: PatchedCopy) -> None:
    """A parameter that is marked can change in a run, by its key and in its unit."""
    copied.replace('isa_ros/surroundings/accumulator.py',
                   "'relief flow per pressure above opening', 'l/min/MPa', gt=0.0",
                   "'relief flow per pressure above opening', "
                   "'l/min/MPa', changeable=True, gt=0.0")
    assert len(copied.touched) == 1
    program = (
        "import isa_ros; run = isa_ros.load('rig_linear').replace({'supply': dict(kind="
        "'accumulator', pressure_mpa=20.0, return_pressure_mpa=0.0, gas_volume_l=1.0, "
        'precharge_mpa=10.0, polytropic_exponent=1.2, line_volume_l=0.5, bulk_modulus=1e9, '
        'pump_flow_lpm=20.0, pump_lag_s=0.05, pump_band_mpa=1.0, relief_mpa=15.0, '
        'relief_lpm_per_mpa=1.0)}); s = run.simulation(); '
        "s.tune('supply', {'relief_lpm_per_mpa': 50.0}); "
        'o = run.simulation(); [(s.step(), o.step()) for _ in range(50)]; '
        "print(s.supply_samples['supply'].pressure < o.supply_samples['supply'].pressure - 1e4)")
    assert copied.python(program) == 'True\n'


def test_a_source_of_commands_is_a_class() -> None:
    """It commands a tick by its own rule, here that of a function."""
    simulation = isa_ros.load('rig_linear').simulation()

    def push(tick: int, out: Records) -> None:
        """Command the third tick."""
        if tick == 2:
            fill_command('ram', isa_ros.Setpoint(0.03), out[0])
    simulation.loop.source = ScheduledSource(push)
    simulation.loop.run(2)
    assert simulation.applied['kinds'][0] == 0
    simulation.loop.advance()
    assert simulation.applied['kinds'][0] and simulation.applied['position'][0] == 0.03


@pytest.mark.slow
def test_a_quantity_is_a_function(copied: PatchedCopy) -> None:
    """Values of a model name it, and scale with it."""
    scales, model = 'isa_ros/actuator/scales.py', 'isa_ros/config/data/models/isa_v5.yaml'
    function = 'def _swept_volume('
    copied.replace(scales, function, 'def _half_stroke(sheet: ActuatorSheet, supply: float) -> '
                   f'float:\n    return 0.5 * sheet.plant.drive.stroke\n\n\n{function}')
    copied.replace(scales, "'stroke': _stroke,", "'stroke': _stroke, 'half_stroke': _half_stroke,")
    copied.replace(model, 'stop_low: {value: 0.005, scales_with: stroke,',
                   'stop_low: {value: 0.005, scales_with: half_stroke,')
    assert names_of(copied.touched) == files_of('quantity that values of a model scale with') - {
        'docs/own_cylinder.md'} and len(copied.touched) == 2
    assert re.search(r'stop_low .*scales with half_stroke', copied.isa('params', 'isa_v5'))


_NAMED_PIPES = '''"""Pipes, with a word before each message."""

from pathlib import Path

from benchmarks.peers import multiprocessing_pipes
from benchmarks.peers.peer_end import PeerEnd

_WORD = b'tick'


class Worded:
    """An end that adds the word and takes it off."""

    def __init__(self, end: PeerEnd) -> None:
        self._end = end
        self.close = end.close

    def send(self, message: bytes) -> None:
        self._end.send(_WORD + message)

    def receive(self, timeout_s: float) -> bytes | None:
        message = self._end.receive(timeout_s)
        return message and message.removeprefix(_WORD)


def coordinator_end(directory: Path, n_workers: int) -> PeerEnd:
    return Worded(multiprocessing_pipes.coordinator_end(directory, n_workers))


def worker_end(directory: Path, index: int) -> PeerEnd:
    return Worded(multiprocessing_pipes.worker_end(directory, index))
'''
_OVER_PIPES = """
from pathlib import Path
from benchmarks.peers.catalogue import peer
from benchmarks.peers.transport import run_over
from isa_ros.bag.reader import Bag
from isa_ros.bench.rigs import request_of
from isa_ros.bench.spec import PROCESSES, Spec
from isa_ros.processes.stopping import StopRequest
from isa_ros.replay.replay import replay
from isa_ros.run.session import prepare
session = prepare(request_of(Spec('2', PROCESSES, 5), Path('.')))
with StopRequest() as should_stop:
    run_over(peer('worded'), session, None, should_stop)
print(replay(Bag(session.out)).is_equal)
"""


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.usefixtures('domain')
def test_a_middleware_is_a_file_and_a_line(copied: PatchedCopy) -> None:
    """A run over it gives a bag that replays."""
    copied.add('benchmarks/peers/worded_pipes.py', _NAMED_PIPES)
    copied.replace('benchmarks/peers/catalogue.py', "    Peer('zeromq',",
                   "    Peer('worded', 'pipes with a word', 'worded_pipes', ''),\n"
                   "    Peer('zeromq',")
    assert len(copied.touched) == 2
    assert copied.python(_OVER_PIPES).splitlines()[-1] == 'True'
