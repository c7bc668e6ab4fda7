"""Public records: fetched whole, with their licence, or not at all; mappings for them."""

from hashlib import sha256
from pathlib import Path

from isa_ros.analysis.measured.mapping import load_mapping
from isa_ros.analysis.measured.measurement import read_measurement
from isa_ros.errors import ConfigError
import pytest
from scripts import fetch_records
from scripts.fetch_records import fetch, PublicFile, RECORDS

MAPPINGS = Path(__file__).parents[2] / 'config' / 'measurements'
PRESS = """Header Size:  7
Version:  2
Sampling Interval:  0.001
Sampling Rate:  1000
Sample Count:  3
Device Serial Number:  0
Sample Number, Date/Time, CHANNEL0, CHANNEL1, CHANNEL2, Events
         1,   06/29/2022 04:05:36.674 PM, -0.0209, -0.0166, 0.0169, DAQ Start
         2,   06/29/2022 04:05:36.675 PM, -0.0221, -0.0175, 0.0167
"""


@pytest.fixture
def host(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return a host with one record, whose path has spaces."""
    folder = tmp_path / 'host' / 'owner' / 'name' / 'abc'
    folder.mkdir(parents=True)
    (folder / 'LICENSE').write_text('MIT')
    (folder / 'a file.txt').write_text(PRESS)
    monkeypatch.setattr(fetch_records, 'RECORDS', {'press.txt': PublicFile(
        'owner/name', 'abc', 'a file.txt', sha256(PRESS.encode()).hexdigest())})
    return (tmp_path / 'host').as_uri()


def test_a_record_comes_with_its_licence(tmp_path: Path, host: str) -> None:
    """And once: what is there is not fetched again."""
    path = fetch('press.txt', tmp_path / 'out', host)
    assert path.read_text() == PRESS
    assert (tmp_path / 'out' / 'press.LICENSE').read_text() == 'MIT'
    assert fetch('press.txt', tmp_path / 'out', 'file:///none') == path


def test_another_file_is_refused(
        tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch) -> None:
    own = fetch_records.RECORDS['press.txt']._replace(digest='0' * 64)
    monkeypatch.setattr(fetch_records, 'RECORDS', {'press.txt': own})
    with pytest.raises(ConfigError, match='press.txt: sha256 .*, must be 0000'):
        fetch('press.txt', tmp_path / 'out', host)
    assert not (tmp_path / 'out').exists()


def test_what_cannot_be_fetched_is_one_line(tmp_path: Path, host: str) -> None:
    with pytest.raises(ConfigError, match='LICENSE: '):
        fetch('press.txt', tmp_path, 'file:///none')
    with pytest.raises(ConfigError, match='no such record; did you mean press.txt'):
        fetch('pres.txt', tmp_path, host)


def test_every_record_is_of_a_commit_with_a_digest() -> None:
    for own in RECORDS.values():
        assert len(own.commit) == 40 and len(own.digest) == 64 and own.path.endswith('.txt')


def test_the_mappings_read_the_form_of_the_records(tmp_path: Path) -> None:
    (tmp_path / 'press.txt').write_text(PRESS)
    found = read_measurement(
        tmp_path / 'press.txt', load_mapping(MAPPINGS / 'mts_damper.yaml'), False).signals
    assert found['position'].values[0] == pytest.approx(0.074791, abs=1e-9)
    assert found['position_command'].values[1] == pytest.approx(0.075167, abs=1e-9)
    assert found['force'].values[0] == pytest.approx(-162.79039, abs=1e-5)
    assert found['force'].t.tolist() == [0.0, 0.001]
    told = read_measurement(
        tmp_path / 'press.txt', load_mapping(MAPPINGS / 'mts_damper_command.yaml'), False)
    assert told.signals['position'].values[1] == found['position_command'].values[1]
    (tmp_path / 'rotary.txt').write_text(
        'Time\tAngle\tPG_1\tPG_2\tF\n1\t7\t8\t9\tVar\n2\t6\t5\t4\n')
    raw = read_measurement(tmp_path / 'rotary.txt', load_mapping(MAPPINGS / 'rotary.yaml'), True)
    assert raw.signals['pressure_b'].values.tolist() == [9.0, 4.0]
