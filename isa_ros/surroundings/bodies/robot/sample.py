"""The sample of a robot at the end of a tick: its record, from its sheet."""

from collections.abc import Sequence

from isa_ros.core.fields import Field
from isa_ros.surroundings.bodies.robot.sheet import JointLinkage, RobotDrive, RobotSheet
from isa_ros.surroundings.inertial_unit import fields_of_unit
from isa_ros.surroundings.linkage import DIRECT

ROOT_FIELDS = (
    Field('position', 'm', "of the root's origin in the world", (3,)),
    Field('orientation', '1', 'w, x, y, z of the root in the world', (4,)),
    Field('velocity', 'm/s', "of the root's origin, world axes", (3,)),
    Field('angular_velocity', 'rad/s', 'of the root, world axes', (3,)),
    Field('twist', 'm/s, rad/s', "velocity and angular velocity, the root's axes", (6,)),
)
"""Only of a free root."""
ENERGY_FIELDS = (
    Field('kinetic_energy', 'J', 'of all links'),
    Field('potential_energy', 'J', 'of all links, 0 at the ground'),
    Field('elastic_energy', 'J', 'stored in ground and soles'),
    Field('ground_loss', 'J', 'lost in ground and soles since t = 0'),
    Field('drive_work', 'J', 'of the forces of the actuators on the links since t = 0'),
    Field('push_work', 'J', 'of forces from outside on the links since t = 0'),
)
"""The account of a robot: the first four less the last two are constant while it moves."""


def sample_fields(sheet: RobotSheet, units: Sequence[str] = ()) -> tuple[Field, ...]:
    """
    Return the fields of the sample of a robot with inertial units of these names.

    Per joint ``NAME_position``, ``NAME_velocity``, ``NAME_torque``; per actuator ``NAME_lever``,
    an array where it acts on several joints (`RobotSheet.driven`); per contact ``NAME_force``,
    ``NAME_position``, ``NAME_touches``, of a foot ``NAME_wrench``.
    """
    fields: list[Field] = [*ROOT_FIELDS] if sheet.is_free else []
    for joint in sheet.joints:
        q, effort = ('rad', 'Nm') if joint.kind == 'revolute' else ('m', 'N')
        fields += [Field(f'{joint.name}_position', q, 'of the joint'),
                   Field(f'{joint.name}_velocity', f'{q}/s', 'of the joint'),
                   Field(f'{joint.name}_torque', effort, 'of all its actuators')]
    for drive in sheet.drives:
        n = len(sheet.driven(drive))
        fields.append(Field(f'{drive.actuator}_lever', _unit_of_lever(drive),
                            "change of the actuator's coordinate with the joint's",
                            () if n == 1 else (n,)))
    for contact in sheet.contacts:
        fields += [Field(f'{contact.name}_force', 'N', 'from the ground, world axes', (3,)),
                   Field(f'{contact.name}_position', 'm', 'in the world', (3,)),
                   Field(f'{contact.name}_touches', '1', '1: pushes the ground')]
        if contact.is_foot:
            fields.append(Field(f'{contact.name}_wrench', 'N, Nm',
                                'force, and moment about its frame, in the axes of the frame',
                                (6,)))
    fields += ENERGY_FIELDS
    for unit in units:
        force, turning = fields_of_unit(unit)
        fields += [Field(force, 'm/s2', "specific force, the unit's axes", (3,)),
                   Field(turning, 'rad/s', "the unit's axes", (3,))]
    return tuple(fields)


def _unit_of_lever(drive: RobotDrive) -> str:
    own = drive.linkage
    is_direct = isinstance(own, JointLinkage) and own.linkage['kind'] == DIRECT
    return '1' if is_direct else 'm/rad'
