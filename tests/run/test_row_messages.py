"""The messages of rows: which topics there are, and the columns of their values."""

from isa_ros.run.link_packing import LinkWords
from isa_ros.run.row_messages import n_columns, Names, sources
from isa_ros.surroundings.messages import JointStates
from isa_ros.tick.exchange import PublishedRows
from msg_adapters.template import Prepared
import numpy as np
from tests.run.packed import HELD, MAIN, some_rows

NAMES = Names([('hip', True), ('knee', False), ('toe', False)], [HELD, MAIN], heated=['knee'],
              linked=['knee', 'toe'], cushioned=['toe'])


def found(
        names: Names, rows: PublishedRows, is_run: bool = False) -> dict[str, Prepared | None]:
    """Return the messages by topic, in their order."""
    linked = [k for k, (name, _) in enumerate(names.actuators) if name in names.linked]
    links = LinkWords(linked, n_columns(rows), rows.sent, len(rows.samples))
    return {topic.name: message for topic, message in sources(names, rows, links, is_run)}


def test_each_actuator_has_the_topics_of_what_it_has() -> None:
    def own(row: int) -> set[str]:
        name, _ = NAMES.actuators[row]
        return {topic.name.removeprefix(f'/{name}/') for topic in NAMES.topics_of(row)}
    assert own(1) - own(0) == {'temperature', 'sent_setpoint'}
    assert own(2) - own(0) == {'cushion_pressure', 'sent_setpoint'}
    assert own(0) < own(1) and own(0) < own(2)


def test_the_topics_come_in_the_order_of_the_rows_and_the_run_is_last() -> None:
    rows = some_rows(3, 2)
    topics = list(found(NAMES, rows, is_run=True))
    assert topics[-3:] == ['/clock', '/coordinator/events', '/diagnostics']
    assert topics[:-3] == list(found(NAMES, rows))
    supplies = [topic for topic in topics[:-3] if topic.startswith('/coordinator/')]
    assert supplies == ['/coordinator/supply_pressure', '/coordinator/main_pressure',
                        '/coordinator/main_return_pressure', '/coordinator/applied_parameters']
    actuators = topics[:topics.index(supplies[0])]
    assert actuators == [topic.name for row in range(3) for topic in NAMES.topics_of(row)]


def test_columns_follow_each_other_over_all_rows() -> None:
    """Three actuators of one width, two supplies of four values, a body's sample of three."""
    rows = some_rows(3, 2)
    body = np.zeros(1, [('angle', float), ('rate', float), ('force', float)])
    rows = rows._replace(bodies={'door': body})
    names = NAMES._replace(bodies={'door': [
        JointStates('/door/states', ('door',), ('angle',), ('rate',), ('force',))]})
    fields = {topic: {column for column in message[1].values() if isinstance(column, int)}
              for topic, message in found(names, rows).items() if message is not None}
    pressures = {name: max(fields[f'/coordinator/{name}_pressure']) for name in (
        'supply', 'main', 'main_return')}
    first = pressures['supply']
    assert pressures == {'supply': first, 'main': first + 4, 'main_return': first + 5}
    hip, knee = (max(fields[f'/{name}/joint_states']) for name in ('hip', 'knee'))
    assert 3 * (knee - hip) == first
    assert sorted(fields['/door/states'])[-3:] == [first + 8, first + 9, first + 10]
    assert n_columns(rows) == first + 11


def test_a_rotary_actuator_shows_a_torque_and_late_subscribers_get_what_is_kept() -> None:
    messages = found(NAMES, some_rows(3, 2))
    paths = {name: {path for path in messages[f'/{name}/load_cell'][1] if 'wrench' in path}
             for name in ('hip', 'knee')}
    assert all('torque' in path for path in paths['hip']) and paths['hip']
    assert all('force' in path for path in paths['knee']) and paths['knee']
    kept = {topic.name.rpartition('/')[2] for topic in NAMES.topics_of(1) if topic.qos.is_kept}
    assert kept == {'applied_parameters', 'applied_setpoint', 'sent_setpoint', 'device'}
