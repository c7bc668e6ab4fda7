"""The arguments and the errors of `isa bus`."""

from pathlib import Path

from isa_ros.cli.bus_commands import bus_request_of
from isa_ros.cli.main import main, make_parser
from isa_ros.config.paths import CONFIG, find
from isa_ros.fieldbus.request import BusRequest
from isa_ros.run.options import Request
import pytest

LEG = find('leg', CONFIG)


def asked(*arguments: str) -> BusRequest:
    """Return the request of `isa bus ARGUMENTS`."""
    options = make_parser().parse_args(['bus', *arguments])
    options.is_alone = True
    return bus_request_of(options)


def run_of(**more) -> Request:
    return Request(config=LEG, in_process=True, is_alone=True, **more)


def test_a_bus_has_the_options_of_a_run_and_its_own():
    assert asked('ethercat', 'leg', '--interface', 'ecs') == BusRequest(
        run=run_of(), bus='ethercat', arguments={'interface': 'ecs', 'order': ''})
    assert asked(
        'ethercat', 'leg', '--interface', 'ecs', '--pace', 'real_time', '--profile', 'cia408',
        '--watchdog-ms', '20', '--no-ros', '--duration', '2', '--out', 'bag', '--seed', '3',
    ) == BusRequest(
        run=run_of(duration_s=2.0, out=Path('bag'), seed=3), bus='ethercat',
        arguments={'interface': 'ecs', 'order': ''}, pace='real_time', profile='cia408',
        watchdog_ms=20.0, has_ros=False)


def test_buses_on_can_and_on_a_serial_line_have_theirs():
    for bus in ('canopen', 'mit'):
        assert asked(bus, 'leg', '--interface', 'slcan', '--channel', 'c', '--bitrate', '500000',
                     '--first-node', '5') == BusRequest(
            run=run_of(), bus=bus, arguments={
                'interface': 'slcan', 'channel': 'c', 'bitrate': 500_000, 'first_node': 5,
                'allow_network': False, **({'unconfigured': False} if bus == 'canopen' else {})})
    assert asked(bus, 'leg', '--interface', 'udp_multicast', '--channel', 'c',
                 '--allow-network').arguments['allow_network'] is True
    assert asked('serial', 'leg', '--path', 'line', '--baud', '9600') == BusRequest(
        run=run_of(), bus='serial', arguments={'path': Path('line'), 'baud': 9600})


@pytest.mark.parametrize('arguments, error', [
    ([], 'the following arguments are required: BUS'),
    (['ethercat', 'leg'], 'the following arguments are required: --interface'),
    (['canopen', 'leg', '--interface', 'virtual'], 'are required: --channel'),
    (['profinet', 'leg'], "invalid choice: 'profinet'"),
    (['ethercat', 'leg', '--interface', 'ecs', '--pace', 'slow'], "invalid choice: 'slow'"),
    (['ethercat', 'leg', '--interface', 'ecs', '--watchdog-ms', '0'], 'must be a number > 0'),
    (['ethercat', 'leg', '--interface', 'ecs', '--in-process'], 'unrecognized arguments'),
    (['ethercat', 'leg', '--interface', 'ecs', '--controller', 'a'], 'unrecognized arguments'),
    (['describe', 'leg'], '--eds --ros2-control --ros2-canopen --table is required')])
def test_a_wrong_command_line_is_answered_in_one_line(arguments, error, capsys):
    with pytest.raises(SystemExit) as ended:
        main(['bus', *arguments])
    printed = capsys.readouterr().err
    assert ended.value.code == 2
    assert error in printed and printed.count('\n') == 1


def test_an_interface_that_does_not_exist_is_refused_before_anything_is_made(tmp_path, capsys):
    bag = tmp_path / 'bag'
    assert main(['bus', 'ethercat', 'leg', '--interface', 'none0', '--out', str(bag)]) == 2
    printed = capsys.readouterr().err
    assert "interface 'none0' does not exist, must be one of" in printed
    assert printed.count('\n') == 1 and not bag.exists()


def test_the_devices_are_described(tmp_path, capsys):
    """One ESI for all, an EDS for each; of one actuator the name is as given."""
    assert main(['bus', 'describe', 'leg', '--esi', str(tmp_path / 'leg.xml')]) == 0
    assert main(['bus', 'describe', 'leg', '--eds', str(tmp_path / 'leg.eds')]) == 0
    assert main(['bus', 'describe', 'rig_linear', '--eds', str(tmp_path / 'ram.eds')]) == 0
    names = ['leg.xml', 'leg_haa.eds', 'leg_hfe.eds', 'leg_kfe.eds', 'ram.eds']
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    assert capsys.readouterr().out.split() == [str(tmp_path / name) for name in names]
    assert (tmp_path / 'leg.xml').read_text().startswith('<?xml')
    assert '[FileInfo]' in (tmp_path / 'ram.eds').read_text()


def test_the_table_has_every_kind_of_device_once(capsys):
    """The knee and the hip are ISA v5, the HAA turns."""
    assert main(['bus', 'describe', 'leg', '--table']) == 0
    printed = capsys.readouterr().out
    heads = [line for line in printed.splitlines() if ': product 0x' in line]
    assert [line.split(':')[0] for line in heads] == ['haa', 'hfe, kfe']
    assert printed.count('0x6040') >= len(heads)
