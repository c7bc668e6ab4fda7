"""One `isa bus` on an interface: a second one ends with one line, and changes nothing."""

from pathlib import Path

from isa_ros.cli.main import main
from isa_ros.config.paths import CONFIG, find
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.request import BusRequest, CANOPEN, ETHERCAT, MIT, SERIAL
from isa_ros.fieldbus.sole_bus import sole_bus
from isa_ros.run.options import Request
import pytest

RUN = Request(config=find('rig_linear', CONFIG), in_process=True, is_alone=True)


def on(bus: str, **arguments) -> BusRequest:
    return BusRequest(run=RUN, bus=bus, arguments=arguments)


HELD = on(CANOPEN, interface='virtual', channel='sole')


def test_a_second_command_is_refused_in_one_line_and_makes_no_bag(tmp_path, capsys):
    """Both buses of a CAN channel count as one; options that are no place make no difference."""
    for bus in ('canopen', 'mit'):
        bag = tmp_path / bus
        with sole_bus(HELD):
            assert main(['bus', bus, 'rig_linear', '--interface', 'virtual', '--channel', 'sole',
                         '--first-node', '7', '--out', str(bag)]) == 2
        printed = capsys.readouterr().err
        assert f'{bus} on virtual sole: another isa bus (process ' in printed
        assert printed.count('\n') == 1 and not bag.exists()


@pytest.mark.parametrize('other', [
    on(CANOPEN, interface='virtual', channel='sole2'),
    on(CANOPEN, interface='slcan', channel='sole'),
    on(ETHERCAT, interface='virtual sole'),
    on(SERIAL, path=Path('virtual sole'), baud=0)])
def test_other_places_are_free(other):
    with sole_bus(HELD), sole_bus(other):
        pass


def test_a_place_is_free_again_after_the_end():
    for _ in range(2):
        with sole_bus(HELD), pytest.raises(ConfigError), sole_bus(HELD):
            pass
    with sole_bus(on(MIT, interface='virtual', channel='sole', bitrate=5)):
        pass


def test_a_serial_line_is_left_to_its_own_lock():
    line = on(SERIAL, path=Path('line'), baud=0)
    with sole_bus(line), sole_bus(line):
        pass


def test_the_longest_channel_has_a_name():
    with sole_bus(on(CANOPEN, interface='virtual', channel='x' * 300)):
        pass


def test_an_ethernet_interface_has_one_ring(capsys):
    with sole_bus(on(ETHERCAT, interface='ecs')):
        assert main(['bus', 'ethercat', 'rig_linear', '--interface', 'ecs']) == 2
    assert 'ethercat on ecs: another isa bus (process ' in capsys.readouterr().err
