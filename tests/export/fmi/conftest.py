"""Units of some runs."""

from collections.abc import Callable

from isa_ros.export.fmi.description import Version
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


@pytest.fixture(scope='module', params=Version)
def version(request):
    return request.param


@pytest.fixture(scope='module')
def case(cases):
    return cases('moving')


@pytest.fixture
def make(case, version, tmp_path):
    """Return what makes instances of one unit; all are ended."""
    from tests.export.fmi.importing import Unit     # needs fmpy
    units = []

    def one(*arguments, **options):
        units.append(Unit(case.paths[version], tmp_path / 'unit', *arguments, **options))
        return units[-1]
    yield one
    for unit in units:
        unit.slave.freeInstance()
