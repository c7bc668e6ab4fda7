"""The devices of every shipped run: identity, names, and what depends on the tick."""

from pathlib import Path
import struct

import isa_ros
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.cia402_objects import interpolation_period
from isa_ros.fieldbus.device.devices import devices_of, PROFILES
import pytest

NAMES = sorted(path.stem for path in (Path(__file__).parents[3] / 'config').glob('*.yaml'))
LEG = isa_ros.load('leg').configuration


@pytest.mark.parametrize('profile', PROFILES)
def test_every_actuator_of_every_shipped_run_is_a_device(profile):
    kinds = {}
    for name in NAMES:
        run = isa_ros.load(name).configuration
        for own, device in zip(run.actuators, devices_of(run, profile), strict=True):
            assert device.read(0x1008, 0).decode() == own.name
            entries = [(one.index, one.subindex, one.data_type) for one in device.table.entries]
            assert kinds.setdefault(device.identity.product, (own.model, entries)) == (
                own.model, entries)
            for assignment in (0x1C12, 0x1C13):
                for pdo in device.assigned(assignment):
                    assert len(device.transmit(pdo)) == device.size(pdo)
    assert len(kinds) > 3


def test_actuators_of_a_kind_share_a_product_and_others_do_not():
    haa, hfe, kfe = devices_of(LEG)
    assert hfe.identity.product == kfe.identity.product != haa.identity.product
    assert [one.identity.serial for one in (haa, hfe, kfe)] == [1, 2, 3]
    assert {one.identity.vendor for one in (haa, hfe, kfe)} == {0xBAD}
    for one in (haa, hfe, kfe):
        assert one.read_all(0x1018) == b'\4\0' + struct.pack('<4I', *one.identity)


def test_the_profiles_have_different_products():
    products = [{one.identity.product for one in devices_of(LEG, profile)}
                for profile in PROFILES]
    assert [{product >> 16 for product in own} for own in products] == [{402}, {408}]


def test_an_unknown_profile_is_refused():
    with pytest.raises(ConfigError, match="'cia403' is unknown; did you mean"):
        devices_of(LEG, 'cia403')


@pytest.mark.parametrize(('step_ns', 'period'), [
    (1_000_000, (1, -3)), (500_000, (5, -4)), (100_000_000, (1, -1)), (2_500_000, (25, -4)),
    (99_900_000, None)])
def test_the_interpolation_period_is_the_tick_where_8_bits_hold_it(step_ns, period):
    assert interpolation_period(step_ns) == period


def test_a_tick_that_8_bits_do_not_hold_has_no_interpolation_period():
    device = devices_of(isa_ros.load('rig_linear').replace({'step_ms': 99.9}).configuration)[0]
    assert 0x60C2 not in device.table
    assert device.read(0x1C32, 2) == struct.pack('<I', 99_900_000)
