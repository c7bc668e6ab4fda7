"""
Write the pages of docs/reference from the code.

    python -m scripts.write_reference
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from scripts.reference.api import api_page
from scripts.reference.cli import cli_page
from scripts.reference.exit_codes import exit_codes_page
from scripts.reference.parameters import parameters_page
from scripts.reference.topics import topics_page

FOLDER = Path(__file__).resolve().parents[1] / 'docs' / 'reference'
PAGES: Mapping[str, Callable[[], str]] = {
    'api': api_page, 'cli': cli_page, 'exit_codes': exit_codes_page,
    'parameters': parameters_page, 'topics': topics_page}
"""What gives the text of each page."""


def main() -> None:
    """Write all pages."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in PAGES.items():
        (FOLDER / f'{name}.md').write_text(text(), encoding='utf-8')


if __name__ == '__main__':
    main()
