"""A bag of each release, from the state before the first one on, is of use to this version."""

from pathlib import Path
import shutil

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.core.version import VERSION
import pytest

HERE = Path(__file__).parent / 'releases'
BAGS = sorted(path.parent for path in HERE.glob('*/metadata.yaml'))
N_TICKS, LARGEST_BYTES = 30, 150_000

pytestmark = [
    pytest.mark.golden, pytest.mark.parametrize('bag', BAGS, ids=[bag.name for bag in BAGS])]


def test_it_says_which_release_recorded_it(bag: Path) -> None:
    read = Bag(bag)
    assert read.provenance.versions['isa_ros'] == bag.name
    assert (read.is_whole, read.end_ns) == (True, N_TICKS * 1_000_000)
    assert sum(path.stat().st_size for path in bag.iterdir()) < LARGEST_BYTES


def test_its_signals_are_read(bag: Path) -> None:
    """By name and unit, as its leg falls: the first and last position of its knee's rod, m."""
    result = isa_ros.read(bag)
    assert len(result.time) == N_TICKS + 1
    assert result.units['kfe.force'] == 'N'
    assert result['kfe.position'][0] == pytest.approx(0.05858589521, abs=1e-5)  # a count
    assert result['kfe.pressure_a'].max() < 20.7e6


def test_it_is_reported(
        bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(['report', str(bag), '--out', str(tmp_path / 'report.html')]) == 0
    assert (tmp_path / 'report.html').stat().st_size > 0


def test_it_is_compared_with_a_run_of_this_version(
        bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What differs is listed by key; here the supply's pressure, and so the messages."""
    run = isa_ros.load('leg', 'drop', duration=0.01).replace(
        {'supply.pressure_mpa': 15.0})
    other = run.simulate().save(tmp_path / 'other')
    assert main(['compare', str(bag), str(other)]) == 1
    assert any(line.split()[:3] == ['supplies.supply.pressure_mpa', '20.7', '15.0']
               for line in capsys.readouterr().out.splitlines())


def test_it_is_recovered_if_it_was_cut_short(
        bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cut = shutil.copytree(bag, tmp_path / 'cut')
    [file] = cut.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:-40])
    assert main(['recover', str(cut)]) == 0
    assert list(Bag(tmp_path / 'cut_recovered').messages()) == list(Bag(bag).messages())


def test_it_is_replayed_or_the_release_that_does_is_named(
        bag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """That of this version is replayed."""
    code = main(['replay', str(bag)])
    printed = ''.join(capsys.readouterr())
    if code:
        assert bag.name != VERSION
        assert f'recorded by isa_ros {bag.name}' in printed
    else:
        assert f'equal: {N_TICKS + 1} ticks' in printed
