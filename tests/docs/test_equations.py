"""Equation numbers of docstrings and of docs/equations.md are the same."""

from pathlib import Path
import re

ROOT = Path(__file__).parents[2]
LETTERS = 'VCTFMSRLGE'
NUMBER = re.compile(rf'\b([{LETTERS}][1-9]\d?)\b')


def numbers_in_code() -> set[str]:
    """Return the equation numbers in parentheses in the sources."""
    found = set()
    for pattern in ('plant/*.py', 'reu/*.py', 'loads/*.py', 'surroundings/**/*.py', 'core/*.py',
                    'scenario/trot*.py', 'actuator/energy.py'):
        for path in (ROOT / 'isa_ros').glob(pattern):
            for group in re.findall(rf'\(([^()]*[{LETTERS}][1-9][^()]*)\)', path.read_text()):
                found |= set(NUMBER.findall(group))
    return found


def numbers_in_document() -> set[str]:
    """Return the numbers the tables of the document define."""
    text = (ROOT / 'docs' / 'equations.md').read_text()
    return {row.split('|')[1].strip() for row in text.splitlines()
            if re.match(rf'\| [{LETTERS}]\d+ \|', row)}


def test_every_number_in_the_code_is_documented():
    """Each cited equation is in the document."""
    assert numbers_in_code() - numbers_in_document() == set()


def test_every_documented_equation_is_cited_by_the_code():
    """Each equation of the document is computed by the code."""
    assert numbers_in_document() - numbers_in_code() == set()
