"""What refuses a bus before kernels are compiled for it."""

from dataclasses import replace
from pathlib import Path

import isa_ros
from isa_ros.config.paths import CONFIG, find
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.ethercat.line import cabled
from isa_ros.fieldbus.lines import refuse_unusable
from isa_ros.fieldbus.request import BusRequest, CANOPEN, ETHERCAT, MIT, SERIAL
from isa_ros.run.options import Request
import pytest

RUN = Request(config=find('leg', CONFIG), in_process=True, is_alone=True)
REQUEST = BusRequest(
    run=RUN, bus=CANOPEN, arguments={'interface': 'virtual', 'channel': 'lines'})
LINE = BusRequest(run=RUN, bus=SERIAL, arguments={'path': Path(), 'baud': 0})
STEP_NS = 1_000_000
LEG = isa_ros.load('leg').configuration


def with_arguments(request: BusRequest, **changes) -> BusRequest:
    return replace(request, arguments={**request.arguments, **changes})


def refused(request: BusRequest, names: int = 1, profile: str = 'cia402') -> str:
    with pytest.raises(ConfigError) as error:
        refuse_unusable(request, devices_of(LEG, profile)[:names], STEP_NS)
    return str(error.value)


def test_what_fits_and_can_be_opened_is_not_refused(tmp_path: Path):
    devices = devices_of(LEG)[:2]
    refuse_unusable(REQUEST, devices, STEP_NS)
    refuse_unusable(replace(REQUEST, bus=MIT), devices, STEP_NS)
    line = tmp_path / 'line'
    refuse_unusable(with_arguments(LINE, path=line, baud=2_000_000), devices, STEP_NS)
    assert not line.is_symlink()


@pytest.mark.parametrize(('request_', 'words'), [
    (REQUEST, 'CAN at 1 Mbit/s carries 1000 bit'),
    (with_arguments(replace(REQUEST, bus=MIT), bitrate=500_000),
     'CAN at 0.5 Mbit/s carries 500 bit'),
    (LINE, '1000000 baud carries 1000 bit in 1 ms')])
def test_frames_that_do_not_fit_are_refused_with_the_arithmetic(request_, words):
    assert words in refused(request_, names=3)


@pytest.mark.parametrize(('request_', 'words'), [
    (with_arguments(REQUEST, interface='none'),
     'interface = none, channel = lines: no interface of python-can'),
    (with_arguments(LINE, path=Path('/dev/none/line')),
     'serial line /dev/none/line: cannot be'),
    (with_arguments(REQUEST, first_node=0), 'must be 1 to 127')])
def test_what_cannot_be_opened_is_refused(request_, words):
    assert words in refused(request_)


def test_a_master_finds_the_devices_by_the_arguments_that_are_no_numbers():
    assert with_arguments(REQUEST, bitrate=5, first_node=2).place == 'virtual lines'
    assert with_arguments(LINE, path=Path('a/line')).place == 'a/line'


def test_cables_connect_the_slaves_in_another_order():
    devices = devices_of(LEG)
    assert cabled(devices, '') == devices
    assert [one.name for one in cabled(devices, 'kfe,haa,hfe')] == ['kfe', 'haa', 'hfe']


@pytest.mark.parametrize('order', ['kfe', 'haa,hfe,kfe,kfe', 'haa,hfe,knee', 'haa, hfe, kfe'])
def test_an_order_without_each_slave_once_is_refused(order):
    """Before the interface is looked at."""
    ring = BusRequest(run=RUN, bus=ETHERCAT, arguments={'interface': 'none', 'order': order})
    assert refused(ring, names=3) == f'--order {order}: must have each of haa, hfe, kfe once'
    assert ring.place == 'none'


def test_a_profile_without_impedance_is_refused_for_mit_frames():
    assert 'haa: has no impedance mode' in refused(
        replace(REQUEST, bus=MIT), profile='cia408')
