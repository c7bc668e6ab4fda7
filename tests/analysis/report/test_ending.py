"""How a run ended, from its bag: at its end, by an error, cut off, cut short."""

from collections.abc import Callable
from pathlib import Path

from isa_ros.analysis.report.ending import ending
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.run.coordinator import ENDED
from msg_adapters import event
import pytest
from tests.bag.golden import GOLDEN, rewrite

BAG = Bag(GOLDEN / 'rotor_step')


def changed(folder: Path, change: Callable[[str, int, bytes], bytes | None]) -> Bag:
    return Bag(rewrite(BAG, folder / 'bag', change))


def test_a_run_that_came_to_its_end_has_no_remark() -> None:
    assert ending(BAG) == ''


@pytest.mark.parametrize(('text', 'remark'), [
    (f'{ENDED}knee: lost.', 'The run ended by an error: knee: lost.'),
    (f'{ENDED}x = nan', 'The run ended by an error: x = nan.'), ('pause', '')])
def test_the_event_of_an_error_is_told(tmp_path: Path, text: str, remark: str) -> None:
    """The golden bag has no events: its clock of tick 3 is one here."""
    topic = '/coordinator/events'
    own = Bag(rewrite(BAG, tmp_path / 'bag', lambda topic, sequence, data: (
        None if topic == '/clock' and sequence != 3
        else event.pack(3_000_000, text) if topic == '/clock' else data),
        without=(topic,), rename={'/clock': topic}))
    assert ending(own) == remark


def test_a_last_instant_without_diagnostics_is_told(tmp_path: Path) -> None:
    last = max(message.sequence for message in BAG.messages())
    own = changed(tmp_path, lambda topic, sequence, data: (
        None if topic == '/diagnostics' and sequence == last else data))
    assert ending(own) == 'The run was cut off: its last instant has no diagnostics.'


def test_without_diagnostics_at_all_nothing_is_known(tmp_path: Path) -> None:
    assert ending(changed(tmp_path, lambda topic, sequence, data: (
        None if topic == '/diagnostics' else data))) == ''


def test_a_bag_that_was_cut_short_is_told_first(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Also by the command, and at the top of its page."""
    file, = BAG.path.parent.glob('*.mcap') if BAG.path.is_file() else BAG.path.glob('*.mcap')
    own = tmp_path / 'bag'
    own.mkdir()
    data = file.read_bytes()
    (own / file.name).write_bytes(data[:len(data) * 3 // 4])
    remark = 'The bag was cut short, its recorder was killed; `isa recover` completes it.'
    assert ending(Bag(own)) == remark
    assert main(['report', str(own)]) == 0
    assert f'\n\n{remark}\nNothing tripped.\n' in capsys.readouterr().out
    page = (own / 'report.html').read_text()
    assert f'<ul class="verdict"><li class="bad">{remark}</li>' in page
