"""
The states of one actuator at one instant: exact ones of the plant, references of its REU.

A `SAMPLE` holds what the sensors read; a `STATES` row holds the values behind the sensors, and
references that are not reported.
"""

from isa_ros.core.kernel import kernel
from isa_ros.plant.coil import coil_current
from isa_ros.reu.bumpless import pressure_reference
from isa_ros.reu.reactions import setpoint_in_force
import numpy as np

STATES = np.dtype([
    ('position', 'f8'),             # of the piston or rotor, m | rad
    ('velocity', 'f8'),             # m/s | rad/s
    ('force', 'f8'),                # in the force or torque sensor, N | Nm
    ('pressure', 'f8'),             # of chamber A less that of B, Pa
    ('pressure_a', 'f8'),           # Pa gauge
    ('pressure_b', 'f8'),           # Pa gauge
    ('spool', 'f8'),                # m
    ('current', 'f8'),              # amplifier A
    ('position_reference', 'f8'),   # m | rad
    ('force_reference', 'f8'),      # N | Nm; 0 without a force block
    ('pressure_reference', 'f8'),   # of the difference, Pa; 0 without a pressure block
    ('spool_reference', 'f8'),      # m
    ('current_reference', 'f8'),    # amplifier A
    ('drive', 'f8'),                # output of the blocks: V with an explicit coil, else A
])


@kernel
def write_states(state, force, actuator, reu_state, row):
    """Fill one `STATES` row from a `CONTINUOUS`, its sensor force (N | Nm) and a `REU_STATE`."""
    plant = state.plant
    row.position = plant.mechanics.position
    row.velocity = plant.mechanics.velocity
    row.force = force
    row.pressure = plant.chambers.p_a - plant.chambers.p_b
    row.pressure_a = plant.chambers.p_a
    row.pressure_b = plant.chambers.p_b
    row.spool = plant.spool.position
    row.current = coil_current(plant.coil, actuator.plant.coil)
    row.position_reference = setpoint_in_force(reu_state).position
    row.force_reference = reu_state.force_reference
    row.pressure_reference = pressure_reference(
        reu_state.status.acting, actuator.reu, reu_state)
    row.spool_reference = reu_state.spool_reference
    row.current_reference = reu_state.current_reference
    row.drive = reu_state.drive
