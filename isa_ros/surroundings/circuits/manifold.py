"""
A manifold: a block or a wide pipe in which the oil has one pressure; and the tank.

Actuators are fed by manifolds, and return their oil to the one that `returns_to` names. All other
parts stand between manifolds and the tank. Equation C45.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, name, nested, parameter, Parameters
from isa_ros.surroundings.circuits.heat import NoneHeat, TankHeat


@frozen(kw_only=True)
class ManifoldPart(Parameters):
    """Oil at one pressure, from which actuators may be fed."""

    oil_volume_l: float = parameter('oil in it', 'l', gt=0.0, le=1000.0)
    returns_to: str = name('the manifold or tank that its actuators return their oil to',
                           absent='', source='the tank')
    leakage_lpm_per_mpa: float = fault(
        'flow to the outside per pressure', 'l/min/MPa', ge=0.0, le=100.0)


@frozen(kw_only=True)
class TankPart(Parameters):
    """The tank, at a constant pressure; a circuit has one."""

    pressure_mpa: float = parameter(
        'gauge, of a closed tank', 'MPa', absent=0.0, source='assumed, open', changeable=True,
        ge=0.0, le=2.0)
    heat: TankHeat = nested(NoneHeat())
