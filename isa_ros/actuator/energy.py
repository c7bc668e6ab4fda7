"""Energy of one actuator: its account since t = 0, and the heat of its losses."""

from isa_ros.core.kernel import kernel
from isa_ros.plant.energy import elastic_energy
from isa_ros.plant.servo_valve import tare_flow
from isa_ros.plant.thermal import heat


@kernel
def add_tare(seconds, port, valve, totals):
    """Add oil and loss of the pilot stage, whose flow is constant over a tick  (V9, E2)."""
    drop = port.supply_pressure - port.return_pressure
    volume = seconds * tare_flow(port.supply_pressure, port.return_pressure, valve)
    totals.supply_volume += volume
    totals.return_volume += volume
    totals.energies.leakage += volume * drop


@kernel
def stored_elastically(state, mechanics):
    """Return the energy of the moving part and the force sensor of a `CONTINUOUS`  (E6), in J."""
    own = state.plant.mechanics
    return elastic_energy(own.position, own.velocity, state.load.position, mechanics)


@kernel
def add_energies(reply, port, feed, energies, elastic, seconds, sample):
    """
    Add one tick of ``seconds`` to the account of a `SAMPLE`.

    ``reply`` has the volumes of the tick, ``energies`` its `ENERGIES`, and ``elastic`` is by how
    much `stored_elastically` grew in it, J. Both pressures of ``port`` are constant over a tick,
    but that of the supply where ``feed``, its `SUPPLY_PORT`, has an elastance.
    """
    drawn = (energies.drawn if feed.elastance > 0.0
             else port.supply_pressure * reply.supply_volume)
    hydraulic = drawn - port.return_pressure * reply.return_volume      # (E1)
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


@kernel
def take_heat(seconds, reply, feed, energies, thermal, state):
    """
    Advance a `THERMAL_STATE` over a tick of ``seconds`` with its `ENERGIES` and volumes  (T4, T5).

    Oil flows in from the supply, and from the return where that refills a chamber, with the
    temperature of ``feed``, its `SUPPLY_PORT`, if that has one  (T10). Return the heat that oil
    took along, J.
    """
    oil = energies.leakage + energies.throttling + energies.cross_port + energies.relief
    body = energies.friction + energies.damping + state.coil
    state.coil = 0.0
    inflow = max(0.0, reply.supply_volume) + max(0.0, -reply.return_volume)
    supply = feed.celsius if feed.is_warm > 0.0 else thermal.supply
    return heat(seconds, oil, body, inflow, supply, thermal, state)
