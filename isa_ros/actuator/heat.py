"""Heat that the losses of one tick give to the oil and the body of an actuator."""

from isa_ros.core.kernel import kernel
from isa_ros.plant.thermal import heat


@kernel
def take_heat(seconds, reply, energies, thermal, state):
    """
    Advance a `THERMAL_STATE` over a tick of ``seconds`` with its `ENERGIES` and volumes  (T4, T5).

    Oil flows in from the supply, and from the return where that refills a chamber.
    """
    oil = energies.leakage + energies.throttling + energies.cross_port + energies.relief
    body = energies.friction + energies.damping + state.coil
    state.coil = 0.0
    inflow = max(0.0, reply.supply_volume) + max(0.0, -reply.return_volume)
    heat(seconds, oil, body, inflow, thermal, state)
