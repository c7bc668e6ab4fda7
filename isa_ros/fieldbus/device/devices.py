"""The devices of a run: identity and table of each actuator, and its drive of a profile."""

from collections.abc import Callable, Mapping
from typing import NamedTuple
import zlib

from isa_ros.bag.provenance import installed_versions
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.conditions import BITS
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device import cia402_objects, cia408_objects
from isa_ros.fieldbus.device.actuator_device import ActuatorDevice
from isa_ros.fieldbus.device.axis import Axis
from isa_ros.fieldbus.device.bus_device import BusDevice, Identity, VENDOR
from isa_ros.fieldbus.device.canopen_objects import communication_objects
from isa_ros.fieldbus.device.cia402 import Drive402
from isa_ros.fieldbus.device.cia402_motion_objects import motion_objects
from isa_ros.fieldbus.device.cia408 import Drive408
from isa_ros.fieldbus.device.communication_area import (
    error_objects, ethercat_objects, identity_objects, parameter_objects, pdo_objects)
from isa_ros.fieldbus.device.diagnosis import diagnosis_object
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.drive import Drive
from isa_ros.fieldbus.device.faults import Faults
from isa_ros.fieldbus.device.integer_twins import twin_objects
from isa_ros.fieldbus.device.manufacturer_area import manufacturer_objects
from isa_ros.fieldbus.device.objects import Object, ObjectTable, Value
from isa_ros.fieldbus.device.process_data import Mapped

REVISION = 1
"""Of the object tables."""
_PACKAGE = 'isa_ros'
_WORD = 0xFFFF


class Profile(NamedTuple):
    """A personality of the device."""

    device_type: int
    objects: Callable[[Axis], list[Object]]
    pdos: Mapping[int, Mapped]
    drive: Callable[[Axis, dict[Key, Value], Faults], Drive]


def _objects_402(axis: Axis) -> list[Object]:
    return [*cia402_objects.cia402_objects(axis), *motion_objects(axis)]


def _drive_402(axis: Axis, values: dict[Key, Value], faults: Faults) -> Drive:
    return Drive402(axis, values, faults, 1 << BITS['supply_low'])


PROFILES: Mapping[str, Profile] = {
    'cia402': Profile(
        cia402_objects.DEVICE_TYPE, _objects_402, cia402_objects.PDOS_402, _drive_402),
    'cia408': Profile(
        cia408_objects.DEVICE_TYPE, cia408_objects.cia408_objects, cia408_objects.PDOS_408,
        Drive408)}
"""The personalities by name; the first is the default."""


def devices_of(run: RunConfig, profile: str = 'cia402') -> list[BusDevice]:
    """
    Return the actuators of a run as devices on a bus, in the order of the run.

    Raises
    ------
    ConfigError
        There is no such profile.

    """
    if profile not in PROFILES:
        raise ConfigError(f'profile {profile!r} is unknown; {alternatives(profile, PROFILES)}')
    return [_device(config, k + 1, run.step_ns, PROFILES[profile])
            for k, config in enumerate(run.actuators)]


def _device(
        config: ActuatorConfig, serial: int, step_ns: int, profile: Profile) -> ActuatorDevice:
    axis = Axis(config, step_ns)
    identity, table = _table(axis, serial, profile)
    return ActuatorDevice(axis, identity, table, profile.drive)


def _table(axis: Axis, serial: int, profile: Profile) -> tuple[Identity, ObjectTable]:
    """Return identity and table; the product is that of all actuators with equal entries."""
    objects = [
        *error_objects(), *parameter_objects(), *communication_objects(axis.step_ns),
        *ethercat_objects(axis.step_ns),
        *manufacturer_objects(axis), *twin_objects(axis), *profile.objects(axis)]
    entries = {(entry.index, entry.subindex): entry for one in objects for entry in one.entries}
    objects += pdo_objects(profile.pdos, entries)
    kind = axis.model + ''.join(
        f'{entry.index:X}:{entry.subindex}{entry.name}{entry.data_type.name}{entry.pdo}'
        for one in objects for entry in one.entries)
    product = (profile.device_type & _WORD) << 16 | zlib.crc32(kind.encode()) & _WORD
    identity = Identity(VENDOR, product, REVISION, serial)
    own = identity_objects(
        profile.device_type, identity, axis.name, axis.model,
        installed_versions()[_PACKAGE])
    own.append(diagnosis_object())  # equal in all devices: no part of their kind
    return identity, ObjectTable([*own, *objects])
