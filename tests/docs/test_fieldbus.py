"""docs/fieldbus.md and the faults of the device as a master sees them."""

from pathlib import Path
from types import ModuleType

from isa_ros.config.models.fault_catalogue import common_faults
from isa_ros.examples import canopen_master, ethercat_master
import pytest
from scripts import write_bus_faults
from scripts.write_bus_faults import row_of, seen

ROOT = Path(__file__).parents[2]


def text() -> str:
    return (ROOT / 'docs' / 'fieldbus.md').read_text(encoding='utf-8')


@pytest.mark.slow
def test_a_row_of_the_faults_is_that_of_today():
    """The sensor that the example loses too: the trip is reset three times while it lasts."""
    row = row_of(seen(common_faults()['pressure_a_lost']), seen(None))
    assert f'| `pressure_a_lost` | {" | ".join(row)} |' in text()
    assert 'fault 51' in row[0] and row[1] == '0x7300'


@pytest.mark.long
def test_the_table_of_faults_is_that_of_today():
    assert write_bus_faults.page(text()) == text()


def test_every_fault_of_the_catalogue_is_in_the_page():
    page = text()
    on_a_bus = [fault.name for fault in common_faults().values()
                if not any(key.startswith('link.') for key in fault.values)]
    assert [name for name in on_a_bus if f'`{name}`' not in page] == []


@pytest.mark.parametrize('example', [ethercat_master, canopen_master])
def test_an_example_is_of_at_most_60_lines(example: ModuleType):
    """Without empty ones."""
    lines = Path(str(example.__file__)).read_text(encoding='utf-8').splitlines()
    assert sum(bool(line.strip()) for line in lines) <= 60


def test_the_ethercat_example_waits_for_slaves_that_start(monkeypatch: pytest.MonkeyPatch):
    """Pasted as the page has it, the master is there before the slaves."""
    found, waited = [0, -1, 3], list[float]()
    begun = type('Begun', (Exception,), {})

    class Late:
        def open(self, interface: str) -> None:     # noqa: A003
            assert interface == 'ecm'

        def config_init(self) -> int:
            return found.pop(0)

        def config_map(self) -> None:
            raise begun

    monkeypatch.setattr(ethercat_master.pysoem, 'Master', Late)
    monkeypatch.setattr('threading.Event.wait', lambda event, s: waited.append(s))
    with pytest.raises(begun):
        ethercat_master.main(['ecm'])
    assert (found, waited) == ([], [1, 1])
