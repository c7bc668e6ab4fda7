"""Rows of "Places for extensions" about what actuators meet: a body, a supply, a load, a wire."""

import importlib
from pathlib import Path
import re
import textwrap

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
    'body': 'test_places.test_a_kind_of_bodies_is_a_class_and_a_row',
    'supply': 'test_places.test_a_supply_is_two_files',
    'load of one actuator': 'test_kernel_extensions.test_a_load_is_a_set_a_force_and_values',
    'wire of a link': 'test_places.test_a_wire_is_its_values_and_a_name',
    'topic of an actuator': 'test_places.test_a_topic_of_an_actuator_is_one_file',
    'object on a bus': 'test_places.test_an_object_with_a_source_is_one_word',
    'option of a run': 'test_places.test_an_option_of_a_run_is_a_field',
    'output of a run': 'test_places.test_an_output_of_a_run_is_a_sink',
    'fault of the device': 'test_places.test_a_fault_is_a_mark',
    'source of commands': 'test_places.test_a_source_of_commands_is_a_class',
    'quantity that values of a model scale with': 'test_places.test_a_quantity_is_a_function',
}
"""Case by row: a test of this folder that makes the extension in a copy."""

RAIL = textwrap.dedent('''\
    """A mass on a rail between two cylinders, with a spring."""

    from dataclasses import dataclass
    from typing import Any, ClassVar

    from isa_ros.config.runs.body_config import BodyConfig, Made
    from isa_ros.config.text.key_tables import KeyTable
    from isa_ros.config.text.keys import Key, NAME, ParameterSet
    from isa_ros.config.text.sections import Place, Section
    from isa_ros.core.fields import Field, record_type, units_of
    from isa_ros.core.parameter import parameter, Parameters
    from isa_ros.core.units import MILLI
    from isa_ros.surroundings.messages import JointStates
    import numpy as np

    FIELDS = (Field('place', 'm', 'of the mass'), Field('speed', 'm/s', 'of the mass'))


    @dataclass(frozen=True, kw_only=True)
    class RailSheet(Parameters):
        """The mass, its spring and its start."""

        mass_kg: float = parameter('moving mass', 'kg', gt=0.0, le=1e3)
        stiffness: float = parameter('of the spring', 'N/m', ge=0.0, le=1e6)
        start_mm: float = parameter('place at t = 0, spring at rest', 'mm', ge=0.0, le=70.0)


    class Rail:
        """The body."""

        units = units_of(FIELDS)

        def __init__(self, sheet: RailSheet, rows: Any, step: float) -> None:
            self.rows, self._sheet, self._step = np.array(rows), sheet, step
            self.sample = np.zeros(1, record_type(FIELDS))
            self.sample['place'] = sheet.start_mm * MILLI

        def starts(self, starts: Any) -> None:
            starts['position'][self.rows] = self.sample['place']

        def ports(self, ports: Any) -> None:
            for row in self.rows:
                ports[row]['x0'], ports[row]['v0'] = self.sample[0]
                ports[row]['inverse_mass'] = 1.0 / self._sheet.mass_kg

        def advance(self, replies: Any) -> None:
            x, v = self.sample[0]
            force = replies['mean_forces'][self.rows].mean(axis=1).sum()
            force -= self._sheet.stiffness * (x - self._sheet.start_mm * MILLI)
            v += self._step * force / self._sheet.mass_kg
            self.sample[0] = x + self._step * v, v

        def snapshot(self) -> bytes:
            return self.sample.tobytes()

        def restore(self, snapshot: bytes) -> None:
            self.sample[:] = np.frombuffer(snapshot, self.sample.dtype)


    @dataclass(frozen=True, kw_only=True)
    class RailConfig(BodyConfig):
        """A rail as a body of a run."""

        kind: ClassVar[str] = 'rail'
        KEYS: ClassVar[KeyTable] = KeyTable((
            Key('left', NAME, 'the actuator on the left', of=lambda own: own.joints[0][1]),
            Key('right', NAME, 'the actuator on the right', of=lambda own: own.joints[1][1]),
            Key('sheet', ParameterSet(RailSheet), 'mass and spring')))
        sheet: RailSheet
        fields = FIELDS

        @classmethod
        def of(cls, name: str, values: dict[str, Any], place: Place, step_ns: int,
               is_checked: bool) -> tuple[BodyConfig, Section]:
            return cls(name=name, sheet=values['sheet'], joints=(
                ('left', values['left']), ('right', values['right']))), {}

        def position_of(self, joint: str) -> float:
            return self.sheet.start_mm * MILLI

        def messages(self, step_ns: int) -> tuple[JointStates, ...]:
            return JointStates(
                f'/{self.prefix}rail', ['rail'], ['place'], ['speed'], []),

        def body(self, made: Made) -> Rail:
            return Rail(self.sheet, made.rows, made.step_ns * 1e-9)
    ''')
RUN_RAIL = """
from pathlib import Path
import isa_ros
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.config.differences import configuration_differences
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import dump, parse
from isa_ros.replay.replay import replay
tree = {
    'name': 'slide', 'supply': {
        'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
    'body': {'kind': 'rail', 'left': 'pull', 'right': 'push', 'sheet': {
        'mass_kg': 40.0, 'stiffness': 2e5, 'start_mm': 40.0}},
    'actuators': {'push': {'model': 'isa_v5'}, 'pull': {'model': 'isa_v5'}}}
run = isa_ros.load(tree, {'name': 'push', 'duration_s': 0.03, 'tracks': {
    'push': [{'t_s': 0.0, 'position': 0.04, 'effort': 500.0}]}})
Path('slide.yaml').write_text(dump(tree))
text = run.configuration.to_yaml()
assert run_of_text(text) == run.configuration
result = run.simulate()
bag = result.save('rail')
assert result['body.place'][-1] > 0.0401 and result.units['body.speed'] == 'm/s'
assert (read_signals(bag)['body.place'] == result['body.place']).all()
print(sorted(name for name in Bag(bag).types if 'rail' in name), replay(Bag(bag)).is_equal)
heavy = run.replace({'body.sheet.mass_kg': 50.0})
heavy.simulate().save('heavy')
print(*configuration_differences(parse(text, ''), parse(heavy.configuration.to_yaml(), '')))
"""


@pytest.fixture
def copied(tmp_path: Path) -> PatchedCopy:
    """Return a copy of the package."""
    return PatchedCopy(tmp_path)


def test_every_row_of_the_page_has_a_case() -> None:
    assert set(CASES) == set(rows_of_the_page())
    for case in CASES.values():
        module, _, name = case.partition('.')
        assert callable(getattr(importlib.import_module(f'tests.docs.{module}'), name))


@pytest.mark.slow
def test_a_kind_of_bodies_is_a_class_and_a_row(copied: PatchedCopy) -> None:
    """Run file, simulation, bag, replay, lists, comparison and diagnostics use its class."""
    copied.add('isa_ros/config/runs/rail_config.py', RAIL)
    kinds = 'isa_ros/config/runs/body_kinds.py'
    copied.replace(kinds, '    RobotConfig,\n)}', '    RobotConfig,\n    RailConfig,\n)}')
    copied.replace(kinds, 'import LegConfig\n', 'import LegConfig\n'
                   'from isa_ros.config.runs.rail_config import RailConfig\n')
    assert len(copied.touched) == 2
    assert names_of(copied.touched) - {'config/runs/rail_config.py'} <= files_of('body')
    topics, compared = copied.python(RUN_RAIL).splitlines()
    assert topics == "['/rail'] True"
    assert compared == (
        "DifferingKey(key='body.sheet.mass_kg', expected=40.0, actual=50.0, unit='kg')")
    listed = copied.isa('params', 'slide.yaml')
    assert re.search(r'^mass_kg +40 +kg ', listed, re.M)
    assert 'equal' in copied.isa('replay', 'rail')


_FALLING = '''@dataclass(frozen=True, kw_only=True)
class FallingSupply(Parameters):
    """A bottle without a pump: its pressure falls at a constant rate."""

    pressure_mpa: float = parameter('gauge pressure at t = 0', 'MPa', gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter('gauge return pressure', 'MPa', ge=0.0, le=5.0)
    lasts_s: float = parameter('time until it is empty', 's', gt=0.0, le=1e4)
    return_line: ReturnLine = nested(HeldReturn())
    dump: NoneDump = nested(NoneDump())


SupplySheet = ConstantSupply | AccumulatorSupply | CircuitSupply | FallingSupply
'''
_FALLS = """
import isa_ros
from isa_ros.config.runs.run_reading import run_of_text
run = isa_ros.load('rig_linear').replace({'supply': {
    'kind': 'falling', 'pressure_mpa': 20.0, 'return_pressure_mpa': 0.0, 'lasts_s': 2.0}})
assert run_of_text(run.configuration.to_yaml()) == run.configuration
result = run.simulate(0.1)
print(f"{result['supply.pressure'][0] * 1e-6:.3f} {result['supply.pressure'][-1] * 1e-6:.3f}")
"""


@pytest.mark.slow
def test_a_supply_is_two_files(copied: PatchedCopy) -> None:
    """Its kind is in run files, resolved texts and lists, and its pressure at the valves."""
    path, kernel = 'isa_ros/surroundings/supply.py', 'isa_ros/surroundings/supply_tick.py'
    copied.replace(
        path, 'SupplySheet = ConstantSupply | AccumulatorSupply | CircuitSupply\n', _FALLING)
    copied.replace(
        path, '                          dump_fields(sheet.dump, self._step))], tick.IDEAL)\n',
        '                          dump_fields(sheet.dump, self._step), self._step * MPA *\n'
        "                          sheet.pressure_mpa / getattr(sheet, 'lasts_s', math.inf))],\n"
        '                        tick.IDEAL)\n')
    copied.replace(path, 'from dataclasses import dataclass\n',
                   'from dataclasses import dataclass\nimport math\n')
    copied.replace(
        kernel, "    ('dump_valve', DUMP)])", "    ('dump_valve', DUMP), ('fall', 'f8')])")
    copied.replace(kernel, '        lower(ideal[0], state)\n',
                   '        lower(ideal[0], state)\n        state.pressure -= ideal[0].fall\n')
    assert names_of(copied.touched) == files_of('supply') and len(copied.touched) == 2
    assert copied.python(_FALLS) == '20.000 19.000\n'
    assert 'lasts_s' in copied.isa(
        'params', 'rig_linear', '--set', 'supply.kind=falling', '--set',
        'supply.lasts_s=1.0')


@pytest.mark.slow
def test_a_wire_is_its_values_and_a_name(copied: PatchedCopy) -> None:
    """Links may have its kind, and its load is checked."""
    copied.add('isa_ros/config/data/wires/canfd.yaml', '\n'.join([
        "bit_rate_mbit: {value: 5.0, source: 'derived, CAN FD'}",
        'actuator_bits: {value: 600.0, source: assumed}',
        'frame_bits: {value: 0.0, source: assumed}',
        'frame_capacity_bits: {value: 0.0, source: assumed}', '']))
    copied.replace('isa_ros/actuator/link.py', "'can', 'serial')", "'can', 'serial', 'canfd')")
    assert names_of(copied.touched) == files_of('wire of a link') and len(copied.touched) == 2
    listed = copied.isa('params', 'rig_linear', '--set', 'link.kind=canfd', '--set',
                        'link.cycle_ms=0.2')
    assert re.search(r'^wire of links: canfd\nparameter.*\nbit_rate_mbit +5 ', listed, re.M)
    assert copied.python(
        "import isa_ros; run = isa_ros.load('rig_linear').replace({'link': {'kind': 'canfd', "
        "'cycle_ms': 1.0}}); print(run.simulate(0.002)['ram.link.age'].shape)") == '(3,)\n'


@pytest.mark.slow
def test_a_topic_of_an_actuator_is_one_file(copied: PatchedCopy) -> None:
    """Bag and replay have it."""
    path = 'msg_adapters/actuator_messages.py'
    copied.replace(path, "    ('valve', joint_state.TYPE),\n",
                   "    ('valve', joint_state.TYPE),\n    ('wear', joint_state.TYPE),\n")
    copied.replace(path, "        'valve': joint_state.valve(name, sample),\n",
                   "        'valve': joint_state.valve(name, sample),\n"
                   "        'wear': joint_state.references(name, sample),\n")
    others = {'run/packing.py', 'run/rare_messages.py'}     # of slower messages, and texts
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
from benchmarks.peers.link import Link

_WORD = b'tick'


class Worded:
    """An end that adds the word and takes it off."""

    def __init__(self, end: Link) -> None:
        self._end = end
        self.close = end.close

    def send(self, message: bytes) -> None:
        self._end.send(_WORD + message)

    def receive(self, timeout_s: float) -> bytes | None:
        message = self._end.receive(timeout_s)
        return message and message.removeprefix(_WORD)


def coordinator_end(directory: Path, n_workers: int) -> Link:
    return Worded(multiprocessing_pipes.coordinator_end(directory, n_workers))


def worker_end(directory: Path, index: int) -> Link:
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
