"""What refuses a bus before kernels are compiled for it."""

from dataclasses import replace
from pathlib import Path

import isa_ros
from isa_ros.config.paths import CONFIG, find
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.lines import refuse_unusable
from isa_ros.fieldbus.request import BusRequest, CANOPEN, MIT, SERIAL
from isa_ros.run.options import Request
import pytest

RUN = Request(config=find('leg', CONFIG), in_process=True, is_alone=True)
REQUEST = BusRequest(run=RUN, bus=CANOPEN, interface='virtual', channel='lines')
STEP_NS = 1_000_000
LEG = isa_ros.load('leg').configuration


def refused(request: BusRequest, names: int = 1, profile: str = 'cia402') -> str:
    with pytest.raises(ConfigError) as error:
        refuse_unusable(request, devices_of(LEG, profile)[:names], STEP_NS)
    return str(error.value)


def test_what_fits_and_can_be_opened_is_not_refused(tmp_path: Path):
    devices = devices_of(LEG)[:2]
    refuse_unusable(REQUEST, devices, STEP_NS)
    refuse_unusable(replace(REQUEST, bus=MIT), devices, STEP_NS)
    line = tmp_path / 'line'
    refuse_unusable(replace(REQUEST, bus=SERIAL, path=line, baud=2_000_000), devices, STEP_NS)
    assert not line.is_symlink()


@pytest.mark.parametrize(('changes', 'words'), [
    ({}, 'CAN at 1 Mbit/s carries 1000 bit'),
    ({'bus': MIT, 'bitrate': 500_000}, 'CAN at 0.5 Mbit/s carries 500 bit'),
    ({'bus': SERIAL}, '1000000 baud carries 1000 bit in 1 ms')])
def test_frames_that_do_not_fit_are_refused_with_the_arithmetic(changes, words):
    assert words in refused(replace(REQUEST, **changes), names=3)


@pytest.mark.parametrize(('changes', 'words'), [
    ({'interface': 'none'}, 'interface = none, channel = lines: no interface of python-can'),
    ({'bus': SERIAL, 'path': Path('/dev/none/line')}, 'serial line /dev/none/line: cannot be'),
    ({'first_node': 0}, 'must be 1 to 127')])
def test_what_cannot_be_opened_is_refused(changes, words):
    assert words in refused(replace(REQUEST, **changes))


def test_a_profile_without_impedance_is_refused_for_mit_frames():
    assert 'haa: has no impedance mode' in refused(
        replace(REQUEST, bus=MIT), profile='cia408')
