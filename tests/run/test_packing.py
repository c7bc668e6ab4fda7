"""From rows to messages: which there are, in what order, and what they say."""

from diagnostic_msgs.msg import DiagnosticStatus
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core import bound
from isa_ros.core.device import ENABLED, IMPEDANCE
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_GAINS, HAS_SETPOINT
from isa_ros.run import packing
from isa_ros.run.output import packer_of
from isa_ros.run.pack_kernel import pack
from isa_ros.run.packing import Packer
from isa_ros.run.row_messages import Names
from isa_ros.surroundings.messages import JointStates
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import PublishedRows, Rows
from msg_adapters import event
from msg_adapters.actuator_messages import TOPICS
from msg_adapters.applied_parameters import tuned_values
from msg_adapters.cdr_reader import decode, message_class
import numpy as np
import pytest
from rcl_interfaces.msg import ParameterEvent
from sensor_msgs.msg import JointState
from tests.run.packed import everything, HELD, MAIN, named, some_rows, T_NS, TICK_NS
from tests.runs import hip_and_knee

LEG = load_run(find('leg.yaml', CONFIG))
SUFFIXES = ('applied_parameters', 'applied_setpoint', 'device', 'joint_states', 'load_cell',
            'pressure_a', 'pressure_b', 'references', 'valve')


def applied(rows: PublishedRows, row: int, kinds: int = HAS_SETPOINT, **values: float) -> None:
    """Let a command have taken effect on one actuator."""
    rows.applied[row]['kinds'] = kinds
    for name, value in values.items():
        rows.applied[row][name] = value


def stamp_ns(message: JointState) -> int:
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


@pytest.fixture
def rows() -> PublishedRows:
    """Return the rows of a hip and a knee."""
    return some_rows()


@pytest.fixture
def packer(rows: PublishedRows) -> Packer:
    """Return what packs them, on one supply."""
    return Packer(Names([('hip', True), ('knee', False)], [HELD]), rows)


def test_a_leg_has_every_topic_in_canonical_order():
    """Sorted by name, with the types of interface.md."""
    surroundings = surroundings_of(LEG)
    packer = packer_of(LEG, Rows(3, surroundings).published)
    assert [topic.name for topic in packer.topics] == [
        '/clock', '/coordinator/applied_parameters', '/coordinator/events',
        '/coordinator/ground_contact', '/coordinator/supply_pressure', '/diagnostics',
        *(f'/{name}/{suffix}' for name in ('haa', 'hfe') for suffix in SUFFIXES),
        '/joint_states', *(f'/kfe/{suffix}' for suffix in SUFFIXES)]
    types = {topic.name: topic.type_name for topic in packer.topics}
    assert types['/clock'] == 'rosgraph_msgs/msg/Clock'
    assert types['/coordinator/events'] == 'rcl_interfaces/msg/Log'
    assert types['/coordinator/ground_contact'] == 'geometry_msgs/msg/WrenchStamped'
    assert types['/coordinator/supply_pressure'] == 'sensor_msgs/msg/FluidPressure'
    assert types['/joint_states'] == 'sensor_msgs/msg/JointState'
    assert [types[f'/kfe/{suffix}'] for suffix in SUFFIXES] == [type_ for _, type_ in TOPICS]
    assert [topic.name for topic in packer.surroundings] == [
        '/coordinator/applied_parameters', '/coordinator/ground_contact',
        '/coordinator/supply_pressure', '/diagnostics', '/joint_states']


def test_messages_come_in_the_order_of_the_topics(packer, rows):
    """Whatever the order of the sources; what is new in between as well."""
    applied(rows, 1)
    packer.pack(T_NS, TICK_NS, {0: {'force.kp': 1e-7}}, {'supply.pressure_mpa': 10.0})
    messages = named(packer, packer.all_messages([event.pack(T_NS, 'step 1')]))
    assert [name for name, _ in messages] == sorted(name for name, _ in messages)
    assert [name for name, _ in messages] == [
        topic.name for topic in packer.topics
        if topic.name not in ('/diagnostics', '/hip/applied_setpoint', '/hip/device',
                              '/knee/applied_parameters', '/knee/device')]
    types = {topic.name: topic.type_name for topic in packer.topics}
    for name, data in messages:
        decode(data, message_class(types[name]))


@pytest.mark.parametrize('names', [
    Names([('knee', False), ('knee', False)], [HELD]),
    Names([('hip', False), ('knee', False)], [MAIN, ('main_return', HELD[1])]),
    Names([('hip', False), ('coordinator', False)], [HELD],
          {'body': [JointStates('/coordinator/valve', [], [], [], [])]})])
def test_a_topic_has_one_source(names):
    """The last: of the same name, and even of the same type."""
    of_body = some_rows(2, len(names.supplies))._replace(
        bodies={'body': np.zeros(1, [('height', '<f8')])})
    with pytest.raises(ValueError, match='a topic has two sources'):
        Packer(names, of_body)


def test_what_is_applied_is_said_at_its_own_actuator_and_tick_alone(packer, rows):
    """Each kind of a command is; the stamp is the start of the tick, the state's its end."""
    for kinds in (HAS_SETPOINT, HAS_ENABLE, HAS_GAINS):
        applied(rows, 1, kinds, position=0.03, is_enabled=1)
        packer.pack(T_NS, TICK_NS, {})
        said = everything(packer)
        assert '/hip/applied_setpoint' not in said
        message = decode(said['/knee/applied_setpoint'], JointState)
        assert (stamp_ns(message), message.position[0]) == (TICK_NS, 0.03)
        assert stamp_ns(decode(said['/knee/joint_states'], JointState)) == T_NS
    applied(rows, 1, 0)
    packer.pack(T_NS + 1, T_NS, {})
    assert '/knee/applied_setpoint' not in everything(packer)
    applied(rows, 0)
    packer.pack(T_NS + 2, T_NS + 1, {})
    said = everything(packer)
    assert '/hip/applied_setpoint' in said and '/knee/applied_setpoint' not in said


def test_an_applied_setpoint_holds_everything_in_force(packer, rows):
    values = {'position': 0.5, 'velocity': 1.0, 'effort': 2.0, 'stiffness': 300.0,
              'damping': 20.0, 'is_enabled': 1}
    applied(rows, 0, **values)
    packer.pack(T_NS, TICK_NS, {})
    message = decode(everything(packer)['/hip/applied_setpoint'], JointState)
    assert list(message.position) == [0.5, 300.0, 20.0, 1.0, 0.0, 0.0, 1.0]
    assert (message.velocity[0], message.effort[0]) == (1.0, 2.0)


def test_parameters_are_said_where_they_changed(packer):
    """Stamped with the tick from which they are in force; at the next instant no more."""
    packer.pack(T_NS, TICK_NS, {1: {'force.kp': 9e-8, 'force.kf': 0.002}})
    said = everything(packer)
    assert '/hip/applied_parameters' not in said
    data = said['/knee/applied_parameters']
    assert tuned_values(data, 'knee') == {'force.kp': 9e-8, 'force.kf': 0.002}
    stamp = decode(data, ParameterEvent).stamp
    assert (stamp.sec, stamp.nanosec) == (0, TICK_NS)
    packer.pack(T_NS + 1, T_NS, {})
    assert '/knee/applied_parameters' not in everything(packer)


def test_several_events_of_an_instant_keep_their_order(packer):
    packer.pack(T_NS, TICK_NS, {})
    events = [event.pack(T_NS, text) for text in ('step 1', 'resume', 'note a')]
    assert [data for name, data in named(packer, packer.all_messages(events))
            if name == '/coordinator/events'] == events


def test_the_numbers_of_each_row_are_in_its_own_messages(packer, rows):
    packer.pack(T_NS, TICK_NS, {})
    said = everything(packer)
    for row, name in enumerate(('hip', 'knee')):
        state = decode(said[f'/{name}/joint_states'], JointState)
        assert (state.position[0], state.velocity[0], state.effort[0]) == tuple(
            rows.samples[row].item()[:3])


def test_one_actuator_is_said_as_its_node_publishes_it(packer, rows):
    """In the order of its topics; None where there is nothing new."""
    applied(rows, 0)
    packer.pack(T_NS, TICK_NS, {1: {'force.kp': 9e-8}})
    said = everything(packer)
    for row, name in enumerate(('hip', 'knee')):
        assert packer.of_actuator(row) == [said.get(f'/{name}/{suffix}') for suffix, _ in TOPICS]
    assert packer.of_actuator(0)[0] is None and packer.of_actuator(0)[1] is not None
    assert packer.of_actuator(1)[0] is not None and packer.of_actuator(1)[1] is None


def test_an_actuator_alone_says_what_it_says_among_others(packer, rows):
    """Its node has neither clock nor events."""
    applied(rows, 1)
    packer.pack(T_NS, TICK_NS, {})
    own = PublishedRows(rows.samples[1:], rows.applied[1:], np.zeros(0, SUPPLY_SAMPLE), {})
    alone = Packer(Names([('knee', False)]), own, is_run=False)
    alone.pack(T_NS, TICK_NS, {})
    assert [topic.name for topic in alone.topics] == [f'/knee/{suffix}' for suffix in SUFFIXES]
    assert alone.of_actuator(0) == packer.of_actuator(1)


def test_the_first_messages_are_of_t_0():
    """The state and the initial setpoint, both stamped 0; no parameter has changed."""
    run = hip_and_knee()
    group, surroundings = group_of(run), surroundings_of(run)
    group.start(surroundings.starts())
    packer = packer_of(run, PublishedRows(group.samples, group.applied, surroundings.supplies, {}))
    packer.pack(0, 0, group.tuned)
    parameters, setpoint, device, joint_states, *_ = packer.of_actuator(1)
    assert parameters is None
    assert stamp_ns(decode(joint_states, JointState)) == 0
    first = decode(setpoint, JointState)
    assert (first.name[0], stamp_ns(first), first.position[3]) == ('knee', 0, 1.0)
    assert decode(device, DiagnosticStatus).message.startswith('initialising, mode impedance')


def test_the_device_speaks_on_change_and_once_a_second(packer, rows):
    """From the rows alone, so that a restored run tells the same."""
    row = rows.samples[1]
    row['device_state'], row['device_mode'], row['state_since'] = ENABLED, IMPEDANCE, 6.5e-3
    said = []
    for t_ns in (TICK_NS, T_NS, T_NS + 1_000_000, 999_000_000, 10**9, 10**9 + 1_000_000):
        packer.pack(t_ns, t_ns - 1_000_000, {})
        found = everything(packer)
        said.append([name for name in ('hip', 'knee') if f'/{name}/device' in found])
    assert said == [['knee'], ['knee'], [], [], ['hip', 'knee'], []]
    packer.pack(T_NS, TICK_NS, {})
    status = decode(everything(packer)['/knee/device'], DiagnosticStatus)
    values = {entry.key: entry.value for entry in status.values}
    assert (status.level, status.name, values['since_s']) == (b'\0', 'knee', '0.006500')


def test_after_a_restored_state_every_device_speaks_once(packer):
    """And the diagnostics with them; without a change and between full seconds."""
    packer.rare.announce()
    said = []
    for t_ns in (T_NS, T_NS + 1_000_000):
        packer.pack(t_ns, t_ns - 1_000_000, {})
        found = everything(packer)
        said.append([name for name in ('/hip/device', '/knee/device', '/diagnostics')
                     if name in found])
    assert said == [['/hip/device', '/knee/device', '/diagnostics'], []]


def test_a_command_is_something_to_publish_when_it_is_sent_and_when_it_is_applied():
    """Behind a link these are different ticks; each actuator's is its own."""
    rows = some_rows()._replace(sent=np.zeros(2, COMMAND))
    packer = Packer(Names([('hip', True), ('knee', False)], [HELD], linked=['hip', 'knee']), rows)
    found = []
    for of_knee in ((0, 0), (HAS_SETPOINT, 0), (0, HAS_ENABLE)):
        rows.applied['kinds'][1], rows.sent['kinds'][1] = of_knee
        found.append([packer.has_applied(row) for row in (0, 1)])
    assert found == [[False, False], [False, True], [False, True]]


def test_compiled_packing_equals_its_python_source(rows, monkeypatch):
    """The same words, NaN and minus zero included."""
    rows.samples['velocity'] = np.nan, -0.0
    applied(rows, 1, position=0.3, stiffness=np.nan, is_enabled=1)

    def packed() -> list[tuple[int, bytes]]:
        packer = Packer(Names([('hip', True), ('knee', False)], [('supply', MAIN[1])]), rows)
        packer.pack(T_NS, TICK_NS, {})
        return list(packer.all_messages())
    compiled = packed()
    monkeypatch.setattr(bound, 'IS_COMPILED', False)
    monkeypatch.setattr(packing, 'pack', pack.py_func)
    assert packed() == compiled
