"""What `isa doctor` found: one line each, and what can be done about it."""

from collections.abc import Sequence
from enum import Enum
from typing import Any, NamedTuple

from isa_ros.text.table import aligned


class Verdict(Enum):
    """How good a finding is; only a problem keeps runs from working."""

    GOOD = 'ok'
    NOTE = 'note'
    PROBLEM = 'problem'


class Finding(NamedTuple):
    """One property of this host, and what to do where it is not good."""

    group: str
    name: str
    found: str
    verdict: Verdict = Verdict.GOOD
    advice: str = ''


def as_text(findings: Sequence[Finding]) -> str:
    """Return a table, the advice below it, and the number of problems and notes."""
    rows = [(own.group, own.name, own.found,
             '' if own.verdict is Verdict.GOOD else own.verdict.value) for own in findings]
    shown = [(group if k == 0 or rows[k - 1][0] != group else '', *rest)
             for k, (group, *rest) in enumerate(rows)]
    advice = [f'{own.verdict.value}: {own.name}: {own.advice}'
              for own in findings if own.verdict is not Verdict.GOOD]
    last = ', '.join(
        f'{(count := sum(own.verdict is verdict for own in findings))} {verdict.value}'
        + 's' * (count != 1) for verdict in (Verdict.PROBLEM, Verdict.NOTE))
    return '\n'.join([*aligned(shown), '', *advice, *([''] if advice else []), last])


def as_tree(findings: Sequence[Finding]) -> Any:
    """Return the findings for a JSON file."""
    return [own._asdict() | {'verdict': own.verdict.value} for own in findings]


def is_healthy(findings: Sequence[Finding]) -> bool:
    """Return whether nothing found keeps runs from working."""
    return all(own.verdict is not Verdict.PROBLEM for own in findings)
