"""A run whose processes cannot discover each other is refused at once, before it compiles."""

from isa_ros.errors import ConfigError
from isa_ros.nodes.bringup import bringup
from isa_ros.nodes.coordinator import runs
from isa_ros.nodes.participant import Participant
from isa_ros.run.options import Request
import pytest
from tests.ros.started import actuator, RIG

pytestmark = pytest.mark.ros


@pytest.fixture
def no_discovery(domain, monkeypatch):
    """Switch discovery off; a run that nevertheless begins to compile fails the test."""
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'OFF')
    monkeypatch.setattr(runs, 'warmed_up', lambda _: pytest.fail('the run was prepared'))


def test_a_run_in_processes_is_refused_and_the_way_out_named(no_discovery, tmp_path):
    with pytest.raises(ConfigError, match='OFF: .* so that rotor cannot take part; set it to '
                                          'LOCALHOST; or use --in-process'):
        bringup(Request(config=RIG, out=tmp_path / 'bag'))


def test_a_controller_is_refused_in_one_process_too(no_discovery, tmp_path):
    with pytest.raises(ConfigError, match='so that sway cannot take part'):
        bringup(Request(
            config=RIG, out=tmp_path / 'bag', in_process=True, controllers=('sway',)))


def test_a_controller_s_node_is_refused(no_discovery, observer, monkeypatch):
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'OFF')
    with pytest.raises(ConfigError, match='so that observer cannot take part'):
        Participant(observer, lambda state: [])


def test_a_participant_is_refused(no_discovery, tmp_path):
    with actuator(tmp_path / 'log', 'rotor', config_file=RIG, lockstep=True) as process:
        assert process.exit_code() == 2
    assert 'so that rotor cannot take part' in process.errors
    assert process.errors.count('\n') == 1
