"""The page of licences names what the requirements name, as their metadata say."""

from importlib.metadata import metadata
from importlib.util import find_spec
from pathlib import Path
import re

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / 'docs' / 'licences.md').read_text(encoding='utf-8')
LICENCES = {name: row.group(2) for row in re.finditer(r'^\| (`.*) \| (.*) \|$', PAGE, re.MULTILINE)
            for name in re.findall('`([^`]*)`', row.group(1))}
BY_HAND = re.compile(r'^([A-Za-z0-9_.-]+)==', re.MULTILINE)


def named(file: str) -> set[str]:
    """Return the packages above the line from which on a script writes."""
    return set(BY_HAND.findall((ROOT / file).read_text(encoding='utf-8').split('# All that')[0]))


BOOK = named('requirements-docs.txt')
"""Installed where the book is made."""


def test_the_packages_are_those_of_the_requirements():
    assert set(LICENCES) == named('requirements.txt') | named('requirements-test.txt') | BOOK
    assert {'numpy', 'python-can', 'pymcap-cli'} <= set(LICENCES)


@pytest.mark.parametrize('name', sorted(LICENCES))
def test_a_licence_is_the_one_of_its_metadata(name):
    """The family: texts say MIT License or BSD, the page has the identifier."""
    if name in BOOK and find_spec(name.replace('-', '_')) is None:
        pytest.skip(f'{name} is not installed: requirements-docs.txt')
    own = metadata(name)
    stated = ' '.join([own.get('License-Expression') or '', *(
        text for text in own.get_all('Classifier') or [] if text.startswith('License'))])
    if not stated.strip():
        stated = (own.get('License') or '').partition('\n')[0]
    if not stated.strip() or name == 'matplotlib':     # a wheel of ROS, a licence of its own
        return
    family = re.search('LGPL|GPL|MPL|MIT|BSD|Apache|CeCILL', LICENCES[name].partition(';')[0])
    found = stated.replace('GNU General Public License', 'GPL')
    assert family and family.group() in found, stated
    assert ('GPL' in LICENCES[name]) == ('GPL' in found)
