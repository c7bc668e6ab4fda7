"""What is checked of a request before anything is started."""

from collections.abc import Callable
import gc
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.saved_state import RunState
from isa_ros.errors import BagError, ConfigError
from isa_ros.replay.replay import replay
from isa_ros.run.options import Request
from isa_ros.run.session import prepare, Session
from isa_ros.run.without_ros import run_without_ros
import pytest
from tests.bag.recorded import record
from tests.ros.domains import held_domain

RIG = find('rig_rotary.yaml', CONFIG)


def state_at(tick: int, directory: Path) -> Path:
    """Return a state file of the rig, of nothing but its tick."""
    path = directory / 'state.json'
    path.write_text(RunState(tick=tick, load=b'', participants=[], requests=b'').to_json(
        load_run(RIG).digest, {}))
    return path


def test_a_state_beyond_the_end_is_refused(tmp_path: Path):
    state = state_at(50, tmp_path)
    request = Request(config=RIG, out=tmp_path / 'bag', restore=state, duration_s=0.05)
    with pytest.raises(ConfigError, match=(
            f'^--restore {state}: t = 0.05 s, must be before the end of the run, 0.05 s$')):
        prepare(request)
    assert not (tmp_path / 'bag').exists()


def test_a_state_before_the_end_is_taken(tmp_path: Path):
    request = Request(
        config=RIG, out=tmp_path / 'bag', restore=state_at(49, tmp_path), duration_s=0.05)
    state = prepare(request).state
    assert state is not None and state.tick == 49


def test_a_saved_state_is_not_overwritten_unasked(tmp_path: Path):
    state = state_at(3, tmp_path)
    before = state.read_bytes()
    with pytest.raises(ConfigError, match=f'^--save {state}: already exists; --overwrite'):
        prepare(Request(config=RIG, out=tmp_path / 'bag', save=state))
    prepare(Request(config=RIG, out=tmp_path / 'bag', save=state, overwrite=True))
    assert state.read_bytes() == before


def test_a_directory_is_no_place_for_a_state(tmp_path: Path):
    with pytest.raises(ConfigError, match='^--save'):
        prepare(Request(config=RIG, out=tmp_path / 'bag', save=tmp_path, overwrite=True))


@pytest.mark.parametrize('overwrite', [False, True])
def test_a_directory_without_a_bag_is_never_replaced(tmp_path: Path, overwrite: bool):
    """And nobody is told that --overwrite would do it."""
    (tmp_path / 'mine.txt').touch()
    with pytest.raises(BagError) as refused:
        prepare(Request(config=RIG, out=tmp_path, overwrite=overwrite))
    assert str(refused.value) == (
        f'{tmp_path} exists and is not a bag (no metadata.yaml), so it is not overwritten')


@pytest.mark.parametrize('overwrite', [False, True])
def test_a_stranger_beside_a_bag_is_refused_before_anything_starts(
        tmp_path: Path, overwrite: bool):
    record(tmp_path / 'bag', 3)
    (tmp_path / 'bag' / 'thesis.mcap').write_bytes(b'data')
    with pytest.raises(BagError, match='thesis.mcap not listed in metadata.yaml, so nothing'):
        prepare(Request(config=RIG, out=tmp_path / 'bag', overwrite=overwrite))
    assert sorted(path.name for path in (tmp_path / 'bag').iterdir()) == [
        'bag_0.mcap', 'metadata.yaml', 'thesis.mcap']


def test_a_continued_run_and_its_replay_begin_with_every_device(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Nothing changes then, and no second ends: without it `~/device` is not known for long."""
    whole, rest = tmp_path / 'whole', tmp_path / 'rest'
    state = tmp_path / 'state.json'
    in_process = ['bringup', str(RIG), '--in-process', '--duration', '0.03']
    with held_domain(monkeypatch):
        assert main([*in_process, '--out', str(whole), '--save', str(state)]) == 0
        assert main([*in_process[:-1], '0.06', '--out', str(rest), '--restore', str(state)]) == 0
    ticks = [message.sequence for message in Bag(rest).messages()
             if message.topic.endswith('/device')]
    assert ticks == [next(Bag(rest).messages()).sequence]
    assert replay(Bag(rest)).is_equal


@pytest.mark.parametrize('is_alone', [True, False])
def test_a_run_without_ros_freezes_the_objects_of_a_program_of_its_own(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_alone: bool):
    """Before its first tick; from Python, the objects are another program's."""
    seen: list[str] = []
    monkeypatch.setattr(gc, 'freeze', lambda: seen.append('frozen'))

    def opened(session: Session):
        seen.append('begun')
        return own(session)
    own: Callable[[Session], object] = Session.opened_source
    monkeypatch.setattr(Session, 'opened_source', opened)
    run_without_ros(prepare(Request(
        config=RIG, out=tmp_path / 'bag', duration_s=0.002, is_alone=is_alone)),
        None, lambda: False)
    assert seen == ['frozen', 'begun'][not is_alone:]
