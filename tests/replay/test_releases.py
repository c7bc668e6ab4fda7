"""Which release replays a bag: named with the commands, for a bag that this version does not."""

from pathlib import Path

from isa_ros.bag.provenance import installed_versions, KERNELS
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.core.version import VERSION
from isa_ros.replay import releases
from isa_ros.replay.releases import release_that_replays
from isa_ros.run.provenance import recorded_versions
import pytest
from tests.bag.golden import GOLDEN, rewrite

BAG = Path('/data/a run')


@pytest.fixture(autouse=True)
def with_releases(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pretend that there were two before this one."""
    monkeypatch.setattr(releases, 'RELEASES', (VERSION, '0.0.9', '0.0.8'))


def test_that_of_an_older_release_is_named_with_its_commands() -> None:
    text = release_that_replays(BAG, {'isa_ros': '0.0.9'})
    assert text == (
        'recorded by isa_ros 0.0.9, which replays it; in a clone: git worktree add '
        "../isa_ros-0.0.9 0.0.9 && ../isa_ros-0.0.9/isa replay '/data/a run'")


def test_a_bag_of_this_version_has_no_other() -> None:
    assert release_that_replays(BAG, recorded_versions()) == ''
    assert release_that_replays(BAG, installed_versions()) == ''  # without a digest of kernels


@pytest.mark.parametrize('versions, named', [
    ({**recorded_versions(), KERNELS: '0' * 16}, f'isa_ros {VERSION} '),
    ({'isa_ros': '0.0.7'}, 'isa_ros 0.0.7 '), ({}, 'a version that is not recorded ')])
def test_one_between_two_releases_is_said_to_be_that(
        versions: dict[str, str], named: str) -> None:
    if KERNELS in versions and KERNELS not in recorded_versions():
        pytest.skip('kernels are not compiled')
    text = release_that_replays(BAG, versions)
    assert text.startswith(f'recorded by {named}with other equations')
    assert f'the releases are {VERSION}, 0.0.9, 0.0.8)' in text


def test_before_the_first_release_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(releases, 'RELEASES', ())
    assert 'there is no release yet' in release_that_replays(BAG, {'isa_ros': '0.0.9'})


def test_replay_names_it_where_a_key_is_unknown(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bag = rewrite(
        Bag(GOLDEN / 'rotor_step'), tmp_path / 'bag', versions={'isa_ros': '0.0.8'},
        configuration=lambda text: text + 'magic: 3\n')
    assert main(['replay', str(bag)]) == 2
    error = capsys.readouterr().err
    assert 'magic is unknown here; recorded by isa_ros 0.0.8, which replays it; in a cl' in error
    assert error.endswith('; `isa report` and isa_ros.read show what it recorded\n')


def test_replay_names_it_where_a_message_differs(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """And does not where all are equal."""
    golden, versions = Bag(GOLDEN / 'rotor_step'), {'isa_ros': '0.0.9'}
    equal = rewrite(golden, tmp_path / 'equal', versions=versions)
    assert main(['replay', str(equal)]) == 0
    assert 'which replays it' not in capsys.readouterr().out
    other = rewrite(
        golden, tmp_path / 'other', versions=versions,
        change=lambda topic, sequence, data: data[:-1] + bytes([data[-1] ^ 64])
        if topic == '/rotor/valve' and sequence == 40 else data)
    assert main(['replay', str(other)]) == 1
    assert capsys.readouterr().out.splitlines()[-1].startswith(
        'recorded by isa_ros 0.0.9, which replays it; ')
