"""Energy account of one actuator: what its oil brought and where it went, since t = 0."""

from isa_ros.core.kernel import kernel
from isa_ros.plant.energy import elastic_energy
from isa_ros.plant.servo_valve import tare_flow


@kernel
def add_tare(seconds, port, valve, totals):
    """Add oil and loss of the pilot stage, whose flow is constant over a tick  (V9, E2)."""
    drop = port.supply_pressure - port.return_pressure
    volume = seconds * tare_flow(port.supply_pressure, port.return_pressure, valve)
    totals.supply_volume += volume
    totals.return_volume += volume
    totals.energies.leakage += volume * drop


@kernel
def stored_elastically(body, mechanics):
    """Return the energy of the moving part and of the force sensor of a `BODY`  (E6), in J."""
    own = body.plant.mechanics
    return elastic_energy(own.position, own.velocity, body.load.position, mechanics)


@kernel
def add_energies(reply, port, energies, elastic, seconds, sample):
    """
    Add one tick of ``seconds`` to the account of a `SAMPLE`.

    ``reply`` has the volumes of the tick, ``energies`` its `ENERGIES`, and ``elastic`` is by how
    much `stored_elastically` grew in it, J. Both pressures of ``port`` are constant over a tick.
    """
    hydraulic = (port.supply_pressure * reply.supply_volume
                 - port.return_pressure * reply.return_volume)      # (E1)
    sample.power = hydraulic / seconds
    sample.peak_power = max(sample.peak_power, sample.power)
    sample.hydraulic_energy += hydraulic
    sample.leakage_energy += energies.leakage
    sample.throttling_energy += energies.throttling
    sample.cross_port_energy += energies.cross_port
    sample.relief_energy += energies.relief
    sample.friction_energy += energies.friction
    sample.damping_energy += energies.damping
    sample.work += energies.work
    sample.stored_energy += energies.compression + elastic
