"""A release: one version everywhere, the changelog's sections, and refusals without a trace."""

import datetime
from pathlib import Path
import shutil

import isa_ros
from isa_ros.core.version import RELEASES, VERSION
from isa_ros.errors import ConfigError
import pytest
from scripts import release as script
from scripts.release import BAGS, CHANGES, MANIFEST, record, release, releases, ROOT, VERSION_FILE

DATE = datetime.date(2031, 4, 5)
LOG = """Changelog

Forthcoming
-----------
* New thing.
* Another.

0.3.0 (2030-01-02)
------------------
* Old thing.
"""


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """Return a clone with one release, and something forthcoming."""
    for path in (VERSION_FILE, MANIFEST):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    (tmp_path / CHANGES).write_text(LOG)
    return tmp_path


def texts(clone: Path) -> list[str]:
    return [(clone / path).read_text() for path in (CHANGES, VERSION_FILE, MANIFEST)]


def test_the_version_is_that_of_the_last_release_in_the_changelog() -> None:
    """Until the first one, 0.1.0."""
    assert RELEASES == releases((ROOT / CHANGES).read_text(encoding='utf-8'))
    assert VERSION == (RELEASES[0] if RELEASES else '0.1.0')


def test_every_release_has_a_bag_and_so_has_this_version() -> None:
    """Those are opened in tests/golden/test_releases.py."""
    stored = {path.name for path in (ROOT / BAGS).iterdir() if path.is_dir()}
    assert stored == {*RELEASES, VERSION, '0.1.0'}


def test_a_release_moves_the_version_everywhere(clone: Path) -> None:
    release('0.4.0', DATE, clone)
    changes, version, manifest = texts(clone)
    assert changes == LOG.replace(
        '-----------\n* New', '-----------\n\n0.4.0 (2031-04-05)\n------------------\n* New')
    names: dict[str, object] = {}
    exec(version, names)
    assert (names['VERSION'], names['RELEASES']) == ('0.4.0', ('0.4.0', '0.3.0'))
    assert '<version>0.4.0</version>' in manifest
    assert releases(changes) == ('0.4.0', '0.3.0')


def test_the_first_release_is_a_tuple_too(clone: Path) -> None:
    (clone / CHANGES).write_text(LOG.partition('0.3.0')[0])
    release('0.1.0', DATE, clone)
    names: dict[str, object] = {}
    exec((clone / VERSION_FILE).read_text(), names)
    assert names['RELEASES'] == ('0.1.0',)


@pytest.mark.parametrize('version, log, problem', [
    ('0.3.0', LOG, 'must be later than the last release, 0.3.0'),
    ('0.2.9', LOG, 'must be later than the last release, 0.3.0'),
    ('0.4', LOG, 'must be three numbers'),
    ('0.04.0', LOG, 'must be three numbers'),
    ('0.4.0', LOG.replace('* New thing.\n* Another.\n', ''), 'nothing is forthcoming'),
])
def test_what_is_no_release_is_refused_without_a_trace(
        clone: Path, version: str, log: str, problem: str) -> None:
    (clone / CHANGES).write_text(log)
    before = texts(clone)
    with pytest.raises(ConfigError, match=problem):
        release(version, DATE, clone)
    assert texts(clone) == before


def test_versions_are_ordered_by_their_numbers(clone: Path) -> None:
    """0.10.0 is later than 0.9.0."""
    (clone / CHANGES).write_text(LOG.replace('0.3.0', '0.9.0'))
    release('0.10.0', DATE, clone)
    assert releases((clone / CHANGES).read_text()) == ('0.10.0', '0.9.0')


def test_the_bag_of_a_release_has_its_version(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another one than is imported is refused: it would be in the bag."""
    monkeypatch.setattr(script, 'DURATION_S', 0.004)
    bag = isa_ros.bag.reader.Bag(record(VERSION, tmp_path))
    assert (bag.provenance.versions['isa_ros'], bag.end_ns) == (VERSION, 4_000_000)
    with pytest.raises(ConfigError, match='must be 7.0.0'):
        record('7.0.0', tmp_path)
