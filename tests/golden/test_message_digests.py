"""The bytes of every topic of every shipped configuration and scenario are unchanged."""

import json

import pytest
from tests.golden.message_digests import digests, FILE, IDLE, pairs

RECORDED = json.loads(FILE.read_text(encoding='utf-8'))


@pytest.fixture(scope='module')
def scenarios():
    """Return every pair; each worker would load them where the module did it."""
    return pairs()


def test_every_pair_is_recorded(scenarios):
    """Every shipped configuration is recorded, and every shipped scenario fits one of them."""
    assert sorted(scenarios) == sorted(RECORDED)
    assert {name.split()[1] for name in scenarios} >= {IDLE, 'drop.yaml', 'step.yaml'}


@pytest.mark.golden
@pytest.mark.parametrize('name', RECORDED)
def test_messages_are_those_of_the_recorded_digests(name, scenarios):
    """Compared topic by topic, so that a failure lists the changed ones."""
    assert digests(scenarios[name]) == RECORDED[name]
