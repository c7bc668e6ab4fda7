"""Units of some runs."""

from collections.abc import Callable

import pytest
from tests.export.fmi.runs import Case, case_of


@pytest.fixture(scope='session')
def cases(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Case]:
    """Return what gives the case of a run by name; each is made once."""
    found: dict[str, Case] = {}

    def case(name: str) -> Case:
        if name not in found:
            found[name] = case_of(name, tmp_path_factory.mktemp(name))
        return found[name]
    return case
