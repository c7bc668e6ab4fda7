"""Shipped files are found by name from anywhere, and a user's own file comes first."""

from pathlib import Path

from isa_ros.config import paths
from isa_ros.errors import ConfigError
import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize('name', ['leg', 'leg.yaml'])
def test_a_shipped_file_is_found_from_anywhere(
        name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert paths.find(name, paths.CONFIG) == ROOT / 'config' / 'leg.yaml'
    assert paths.find('drop', paths.SCENARIOS) == ROOT / 'config' / 'scenarios' / 'drop.yaml'


def test_a_file_of_the_user_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'leg.yaml').write_text('name: mine\n', encoding='utf-8')
    assert paths.find('leg.yaml', paths.CONFIG) == Path('leg.yaml')


def test_an_unknown_file_is_answered_with_the_shipped_ones() -> None:
    with pytest.raises(
            ConfigError, match='zzz: no such file; shipped: cooled_station.yaml, .*hyq_leg'):
        paths.find('zzz', paths.CONFIG)


@pytest.mark.parametrize(('name', 'nearest'), [('legs.yaml', 'leg.yaml'), ('cranne', 'crane')])
def test_a_file_with_a_slip_is_answered_with_the_nearest(name: str, nearest: str) -> None:
    with pytest.raises(
            ConfigError, match=f'^{name}: no such file; did you mean {nearest}( or .*)?[?]$'):
        paths.find(name, paths.CONFIG)


def test_names_that_would_do_as_well_are_named() -> None:
    others = {'models': ['isa_v2', 'isa_v5'], 'legs': ['hyq']}
    with pytest.raises(ConfigError, match='^isav5: no such file; did you mean isa_v5 or isa_v2.$'):
        paths.find('isav5', paths.CONFIG, others)
    with pytest.raises(ConfigError, match=r'winch\.yaml; models: isa_v2, isa_v5; legs: hyq$'):
        paths.find('zzz', paths.CONFIG, others)


def test_a_name_is_suggested_as_it_was_written() -> None:
    for ending in ('', '.yaml'):
        with pytest.raises(ConfigError) as caught:
            paths.find(f'hyq_lag{ending}', paths.CONFIG)
        names = str(caught.value).partition('; did you mean ')[2].rstrip('?').split(' or ')
        assert names[0] == f'hyq_leg{ending}'
        assert [name.endswith('.yaml') for name in names] == [bool(ending)] * len(names)


@pytest.mark.parametrize(('folder', 'name'), [
    ('.', 'my_ram'), ('.', 'my_rm.yaml'), ('own', 'own/my_ram'), ('own', 'own/my_ramm.yaml')])
def test_a_file_of_the_user_is_suggested_with_its_ending_and_folder(
        folder: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path(folder, 'my_ram.yaml')
    path.parent.mkdir(exist_ok=True)
    path.touch()
    with pytest.raises(ConfigError) as caught:
        paths.find(name, paths.CONFIG)
    assert str(caught.value).startswith(f'{name}: no such file; did you mean {path}')


def test_an_installed_share_directory_is_found(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As after `colcon build` and sourcing: the package is not in a clone."""
    package = tmp_path / 'lib' / 'python3' / 'site-packages' / 'isa_ros' / 'config' / 'paths.py'
    config = tmp_path / 'ws' / 'share' / 'isa_ros' / 'config'
    package.parent.mkdir(parents=True)
    config.mkdir(parents=True)
    (config / 'mine.yaml').touch()
    monkeypatch.setattr(paths, '__file__', str(package))
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'{tmp_path / "other"}:{tmp_path / "ws"}')
    assert paths.find('mine', paths.CONFIG) == config / 'mine.yaml'
    assert ROOT not in paths.share_directories()
