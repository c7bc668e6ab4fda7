"""One coordinator per domain; on one host a second one is refused at once."""

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.domain import domain_id, sole_coordinator
import pytest
from tests.ros.domains import held_domain


def test_a_second_coordinator_is_refused(monkeypatch):
    with held_domain(monkeypatch) as domain:
        with sole_coordinator():
            with pytest.raises(
                    ConfigError, match=f'another coordinator runs in ROS_DOMAIN_ID {domain}'):
                with sole_coordinator():
                    pass
        with sole_coordinator():
            pass


def test_another_domain_is_free(monkeypatch):
    with held_domain(monkeypatch), sole_coordinator():
        with held_domain(monkeypatch), sole_coordinator():
            pass


@pytest.mark.parametrize(('text', 'number'), [(None, 0), ('', 0), ('0', 0), ('232', 232)])
def test_domain_of_the_environment(monkeypatch, text, number):
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    if text is not None:
        monkeypatch.setenv('ROS_DOMAIN_ID', text)
    assert domain_id() == number


@pytest.mark.parametrize('text', ['-1', '233', 'leg', '1.5'])
def test_no_domain_is_refused(monkeypatch, text):
    monkeypatch.setenv('ROS_DOMAIN_ID', text)
    with pytest.raises(ConfigError, match='must be an integer from 0 to 232'):
        domain_id()
