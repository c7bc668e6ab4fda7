"""CSV files, MCAP and sqlite3 bags give the same numbers; damage is one line."""

from pathlib import Path
import sqlite3

from isa_ros.analysis.measured.bag_file import read_fields
from isa_ros.analysis.measured.csv_file import read_columns
from isa_ros.analysis.measured.mapping import load_mapping
from isa_ros.analysis.measured.measurement import read_measurement
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError, ConfigError
import numpy as np
import pytest
from tests.bag.golden import GOLDEN, rewrite

BAG = GOLDEN / 'rotor_step'
WANTED = {'/rotor/valve': ['position[0]', 'effort[0]'], '/rotor/load_cell': ['wrench.torque.z']}


def csv(tmp_path: Path, text: str) -> Path:
    path = tmp_path / 'data.csv'
    path.write_text(text)
    return path


@pytest.mark.parametrize('text, skip', [
    ('t,x\n0,1.5\n2,-3.25\n', 0), ('t;x\n0;1,5\n2;-3,25\n', 0), ('t\tx\n0\t1.5\n2\t-3.25', 0),
    ('head\nmore\n"t", "x"\n0, 1.5\n2, -3.25\n', 2), ('# c\n\nt x\n0 1.5\n\n2 -3.25\n', 0),
    ('\ufefft,x\n0,1.5,DAQ start\n2,-3.25\n', 0)])
def test_columns_are_read_by_name_and_number(tmp_path: Path, text: str, skip: int) -> None:
    found = read_columns(csv(tmp_path, text), ['x', 1], skip, 'map')
    assert found['x'].tolist() == [1.5, -3.25] and found[1].tolist() == [0.0, 2.0]


def test_a_file_without_names_has_numbers(tmp_path: Path) -> None:
    found = read_columns(csv(tmp_path, '1,2\n3,4\n'), [2], 0, 'map')
    assert found[2].tolist() == [2.0, 4.0]


@pytest.mark.parametrize('text, wanted, expected', [
    ('t,x\n0,a\n', 'x', "data.csv: line 2, column x: 'a', must be a number"),
    ('t,x\n0,1\n3\n', 'x', 'data.csv: line 3: 1 cells, the head has 2'),
    ('t,x\n', 'x', 'data.csv: has no rows'), ('\n', 'x', 'data.csv: has no rows'),
    ('t,xx\n0,1\n', 'x', "map: column 'x' is unknown; "),
    ('1,2\n', 3, 'map: column 3, must be 1 to 2'), ('1,2\n', 0, 'map: column 0, must be 1')])
def test_what_is_no_number_has_its_line(
        tmp_path: Path, text: str, wanted: str | int, expected: str) -> None:
    with pytest.raises((BagError, ConfigError)) as refused:
        read_columns(csv(tmp_path, text), [wanted], 0, 'map')
    assert expected in str(refused.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='none.csv: No such file'):
        read_columns(tmp_path / 'none.csv', ['x'], 0, 'map')


@pytest.fixture
def sqlite(tmp_path: Path) -> Path:
    """Return the bag of the rotor as rosbag2 stores it with sqlite3."""
    path = tmp_path / 'bag' / 'bag_0.db3'
    path.parent.mkdir()
    bag = Bag(BAG)
    with sqlite3.connect(path) as database:
        database.execute('CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, '
                         'serialization_format TEXT, offered_qos_profiles TEXT)')
        database.execute('CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, '
                         'timestamp INTEGER, data BLOB)')
        numbers = {topic: k for k, topic in enumerate(bag.types, start=1)}
        database.executemany('INSERT INTO topics VALUES (?, ?, ?, "cdr", "")', [
            (numbers[topic], topic, bag.types[topic]) for topic in numbers])
        database.executemany(
            'INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)',
            [(numbers[m.topic], m.t_ns + 5_000_000_000, m.data) for m in bag.messages()])
    database.close()
    return path.parent


def test_both_kinds_of_bags_give_the_same_numbers(sqlite: Path) -> None:
    """Those of the signals of isa_ros; times are from the first message on."""
    one, other = read_fields(BAG, WANTED), read_fields(sqlite, WANTED)
    assert list(one) == ['/rotor/valve position[0]', '/rotor/valve effort[0]',
                         '/rotor/load_cell wrench.torque.z']
    for name, (t, values) in one.items():
        assert np.array_equal(other[name][0], t) and np.array_equal(other[name][1], values)
    t, spool = one['/rotor/valve position[0]']
    assert (len(t), t[0], t[-1]) == (151, 0.0, 0.15) and np.ptp(spool) > 1e-5


def test_times_begin_with_the_first_message_of_all(tmp_path: Path) -> None:
    """The load cell of this bag is 10 ms late."""
    bag = rewrite(
        Bag(BAG), tmp_path / 'late', lambda topic, sequence, data: None
        if topic == '/rotor/load_cell' and sequence < 10 else data)
    found = read_fields(bag, WANTED)
    assert found['/rotor/load_cell wrench.torque.z'][0][0] == pytest.approx(0.01, abs=1e-12)
    assert found['/rotor/valve position[0]'][0][0] == 0.0


@pytest.mark.parametrize('wanted, expected', [
    ({'/rotor/valv': ['position[0]']}, 'has no messages of /rotor/valv; did you mean /rotor/v'),
    ({'/rotor/valve': ['position[7]']}, 'message 1 has no number position[7]; did you mean posit'),
    ({'/rotor/valve': ['header.frame_id']}, 'message 1 has no number header.frame_id')])
def test_a_topic_or_field_that_is_not_there_is_named(
        wanted: dict[str, list[str]], expected: str) -> None:
    with pytest.raises(ConfigError) as refused:
        read_fields(BAG, wanted)
    assert expected in str(refused.value)


@pytest.mark.parametrize('name', ['bag.mcap', 'bag.db3'])
def test_a_damaged_bag_is_one_line(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b'no bag at all' * 9)
    with pytest.raises(BagError, match=f'{name}: cannot be read: '):
        read_fields(tmp_path / name, WANTED)
    (tmp_path / 'empty').mkdir()
    with pytest.raises(BagError, match='has neither .mcap nor .db3 files'):
        read_fields(tmp_path / 'empty', WANTED)


def test_a_measurement_is_in_si_over_its_true_time(tmp_path: Path) -> None:
    """Sign, scale, offset, unit and delay; the clock is 1000 ppm fast."""
    path = csv(tmp_path, 't,x\n100,2\n1101,4\n')
    (tmp_path / 'map.yaml').write_text(
        'time: {column: t, unit: ms}\nclock_ppm: 1000\nsignals: {position: {column: x, unit: mm, '
        'sign: -1, scale: 10, offset: 50, delay_ms: 1001}}\n')
    found = read_measurement(path, load_mapping(tmp_path / 'map.yaml'), is_rotary=False)
    assert found.signals['position'].values.tolist() == pytest.approx(
        [0.03, 0.01], rel=1e-12, abs=0.0)
    assert found.signals['position'].t.tolist() == pytest.approx([-1.0, 0.0], abs=1e-12)
    assert (found.name, list(found.outputs), list(found.commands)) == (
        'data.csv', ['position'], [])


@pytest.mark.parametrize('text, mapping, expected', [
    ('t,x\n0,1\n0,2\n', 'time: {column: t}', 'the time does not rise after sample 1, t = 0 s'),
    ('t,x\n0,1\n1,nan\n', 'time: {column: t}',
     'position: sample 2 is nan, in SI nan, must be finite'),
    ('t,x\n0,1\n1,2\n', 'skip_lines: 0', 'lacks time, either column and unit or rate_hz')])
def test_times_rise_and_numbers_are_finite(
        tmp_path: Path, text: str, mapping: str, expected: str) -> None:
    (tmp_path / 'map.yaml').write_text(
        f'{mapping}\nsignals: {{position: {{column: x, unit: mm}}}}\n')
    with pytest.raises((BagError, ConfigError)) as refused:
        read_measurement(csv(tmp_path, text), load_mapping(tmp_path / 'map.yaml'), False)
    assert expected in str(refused.value)


def test_a_mapping_for_the_other_kind_of_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / 'map.yaml').write_text('signals: {position: {column: x, unit: mm}}\n')
    with pytest.raises(ConfigError, match='lacks topic and field, the measurement is a bag'):
        read_measurement(BAG, load_mapping(tmp_path / 'map.yaml'), True)
    (tmp_path / 'map.yaml').write_text('signals: {spool: {topic: /x, field: y, unit: m}}\n')
    with pytest.raises(ConfigError, match='lacks column, the measurement is a CSV file'):
        read_measurement(csv(tmp_path, '1,2\n'), load_mapping(tmp_path / 'map.yaml'), True)
