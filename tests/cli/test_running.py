"""What is printed of a run: its bags, and what lies beside them from before."""

from pathlib import Path
from types import SimpleNamespace

from isa_ros.cli.running import PAGE, recorded
import pytest


@pytest.mark.parametrize('has_page', [False, True])
def test_a_report_of_the_bag_before_is_named(
        tmp_path: Path, has_page: bool, capsys: pytest.CaptureFixture[str]) -> None:
    """Of the bag that has it beside it, and of no other."""
    first, second = tmp_path / 'first', tmp_path / 'second'
    for bag in (first, second):
        bag.mkdir()
    if has_page:
        (second / PAGE).touch()
    session = SimpleNamespace(
        warnings=['warned'], bags=[first, second], lines=['ended'],
        pace=SimpleNamespace(shortfall=''))
    recorded(session, lambda report: None)  # type: ignore[arg-type]
    out, errors = capsys.readouterr()
    assert out.splitlines() == [str(first), str(second)]
    told = [f'isa: {second}/report.html: is of the bag that was replaced; isa report {second} '
            'writes it anew'] if has_page else []
    assert errors.splitlines() == ['isa: warned', *told, 'isa: ended']
