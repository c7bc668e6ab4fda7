"""docs/versions.md has every key that an older bag may lack; one of them is simulated so."""

import re

from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
import pytest
from scripts import write_old_keys
from tests.bag.golden import GOLDEN, rewrite

PAGE = write_old_keys.PAGE.read_text(encoding='utf-8')
ROWS = {key: value for key, value, _ in write_old_keys.lacked()}


def test_its_table_is_that_of_the_declarations() -> None:
    """`python scripts/write_old_keys.py` after a new key."""
    assert write_old_keys.page(PAGE) == PAGE


def test_a_changed_value_is_noticed() -> None:
    changed = PAGE.replace('| 860.0 |', '| 861.0 |', 1)
    assert changed != PAGE and write_old_keys.page(changed) == PAGE


@pytest.mark.parametrize('key, value', [
    ('record', 'everything'), ('seed', '0'), ('supplies.NAME.oil.density', '860.0'),
    ('actuators.NAME.plant.oil.entrained_air', '0.0'),
    ('emergency_stops.NAME.dumps', 'at_rest')])
def test_keys_of_all_depths_are_there(key: str, value: str) -> None:
    assert ROWS[key] == value


def test_what_has_no_value_is_not_there() -> None:
    """A bag without it is refused."""
    assert not {'name', 'actuators.NAME.model', 'actuators.NAME.plant.oil.dead_volume_ml'} & {
        *ROWS}


def test_a_bag_that_lacks_a_key_of_the_table_replays(tmp_path, capsys) -> None:
    """Of the plant: what it lacks is as the table says, so that the bytes are the same."""
    def older(text: str) -> str:
        changed, count = re.subn(r' entrained_air: 0\.0,', '', text)
        assert count == 1
        return changed
    bag = rewrite(Bag(GOLDEN / 'rotor_step'), tmp_path / 'old', configuration=older)
    assert main(['replay', str(bag)]) == 0
    printed = capsys.readouterr().out
    assert 'plant.oil.entrained_air is missing in the bag, 0.0 is meant' in printed
    assert 'equal: 151 ticks' in printed
