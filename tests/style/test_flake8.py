"""The code style that `colcon test` checks."""

from pathlib import Path

from ament_flake8.main import main_with_errors
import flake8_quotes
import pytest
from tests.garbage import uncollected

ROOT = Path(__file__).parents[2]
CODE = ('isa_ros', 'msg_adapters', 'benchmarks', 'launch', 'scripts', 'tests', 'setup.py')


@pytest.mark.linter
@pytest.mark.flake8
def test_flake8_finds_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """
    As ament_flake8 configures it: 99 columns, single quotes, google import order.

    But for docstrings: ament_pep257 checks them by the same program, with more of its rules.
    flake8-quotes looks for comments with noqa, for which it takes a file apart once more, where
    the word is.
    """
    monkeypatch.setattr('flake8_docstrings.pep257Checker.run', lambda _: iter(()))
    noqa_lines = flake8_quotes.QuoteChecker.get_noqa_lines
    monkeypatch.setattr(
        'flake8_quotes.QuoteChecker.get_noqa_lines',
        lambda own, lines: noqa_lines(own, lines) if any('noqa' in x for x in lines) else [])
    monkeypatch.chdir(ROOT)
    with uncollected():     # a third faster
        return_code, errors = main_with_errors(argv=[p for p in CODE if (ROOT / p).exists()])
    assert return_code == 0, '\n'.join(errors)
