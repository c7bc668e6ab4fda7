"""What supplies, return lines and bodies of a run publish."""

from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.run.output import packer_of
from isa_ros.run.packing import Packer
from isa_ros.run.row_messages import Names
from isa_ros.surroundings.messages import JointStates
from isa_ros.surroundings.supply import ConstantSupply
from isa_ros.tick.exchange import Rows
from msg_adapters.cdr_reader import decode
import numpy as np
from sensor_msgs.msg import FluidPressure, JointState
from tests.run.packed import ATMOSPHERE, everything, HELD, MAIN, some_rows, T_NS, TICK_NS
from tests.runs import ACCUMULATOR, hip_and_knee, RETURN_LINE


def test_pressures_are_absolute():
    """Gauge + 101325 Pa, as sensor_msgs/FluidPressure demands."""
    rows = some_rows()
    packer = Packer(Names([('hip', True), ('knee', False)], [HELD]), rows)
    packer.pack(T_NS, TICK_NS, {})
    said = everything(packer)
    for row, name in enumerate(('hip', 'knee')):
        for chamber in 'ab':
            message = decode(said[f'/{name}/pressure_{chamber}'], FluidPressure)
            assert message.fluid_pressure == rows.samples[f'pressure_{chamber}'][row] + ATMOSPHERE
            assert message.header.frame_id == name
    supply = decode(said['/coordinator/supply_pressure'], FluidPressure)
    assert supply.fluid_pressure == rows.supplies['pressure'][0] + ATMOSPHERE
    assert supply.header.frame_id == 'world'


def test_only_a_return_line_with_a_volume_shows_its_pressure():
    """A return line that stays at tank pressure has nothing to show."""
    rows = some_rows(2, 2)
    packer = Packer(
        Names([('hip', True), ('knee', False)], [('held', HELD[1]), MAIN]), rows)
    packer.pack(T_NS, TICK_NS, {})
    said = everything(packer)
    pressures = {name: decode(data, FluidPressure).fluid_pressure for name, data in said.items()
                 if name.startswith('/coordinator/')}
    assert pressures == {
        '/coordinator/held_pressure': rows.supplies['pressure'][0] + ATMOSPHERE,
        '/coordinator/main_pressure': rows.supplies['pressure'][1] + ATMOSPHERE,
        '/coordinator/main_return_pressure': rows.supplies['return_pressure'][1] + ATMOSPHERE}


def test_the_return_lines_of_a_run_decide_which_pressures_there_are():
    """Of a constant supply and of a pump with an accumulator alike."""
    def topics(*sheets: ConstantSupply) -> list[str]:
        run = hip_and_knee([SupplyConfig(name, sheet, (fed,)) for (name, fed), sheet in zip(
            (('first', 'hip'), ('second', 'knee')), sheets)])
        packer = packer_of(run, Rows(2, surroundings_of(run)).published)
        return [topic.name for topic in packer.surroundings]

    held = ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5)
    line = ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5, return_line=RETURN_LINE)
    assert topics(held, ACCUMULATOR) == [
        '/coordinator/applied_parameters', '/coordinator/first_pressure',
        '/coordinator/second_pressure', '/diagnostics']
    assert topics(line, held) == [
        '/coordinator/applied_parameters', '/coordinator/first_pressure',
        '/coordinator/first_return_pressure', '/coordinator/second_pressure', '/diagnostics']


def test_a_body_shows_the_floats_of_its_sample():
    """By the columns of its own record type, arrays element by element."""
    messages = [JointStates('/body', ['a', 'b'], ['height', 'angle[1]'], [], [])]
    body = np.zeros(1, [('angle', '<f8', (2,)), ('height', '<f8')])
    packer = Packer(Names([('hip', True)], [HELD], {'cart': messages}),
                    some_rows(1)._replace(bodies={'cart': body}))
    body['angle'], body['height'] = (0.25, 0.5), 2.0
    packer.pack(T_NS, TICK_NS, {})
    assert list(decode(everything(packer)['/body'], JointState).position) == [2.0, 0.5]


def test_each_of_several_bodies_shows_its_own_floats():
    """At every packing anew, though their samples are not one memory."""
    names = {name: [JointStates(f'/{name}/joints', ['a'], ['angle[1]'], [], ['load'])]
             for name in ('left', 'right')}
    bodies = {name: np.zeros(1, [('angle', '<f8', (2,)), ('load', '<f8')]) for name in names}
    packer = Packer(Names([('hip', True)], [HELD], names),
                    some_rows(1)._replace(bodies=bodies))
    for scale in (1.0, 10.0):
        for k, body in enumerate(bodies.values(), start=1):
            body['angle'], body['load'] = (0.0, k * scale), -k * scale
        packer.pack(T_NS, TICK_NS, {})
        for k, name in enumerate(names, start=1):
            found = decode(everything(packer)[f'/{name}/joints'], JointState)
            assert (found.position[0], found.effort[0]) == (k * scale, -k * scale)
