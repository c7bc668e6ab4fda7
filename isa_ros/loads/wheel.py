"""The paper's load wheel between the rig's two end stops. Units kg m2, rad, Nm or kg, m, N."""

from dataclasses import dataclass

from isa_ros.core.parameter import parameter, Parameters
from isa_ros.errors import ParameterError


@dataclass(frozen=True, kw_only=True)
class Wheel(Parameters):
    """The paper's load wheel with the rig's two end stops."""

    inertia: float = parameter('wheel', 'kg | kg m2', gt=0.0, le=1e4)
    stop_low: float = parameter('lower end stop of the rig', 'm | rad')
    stop_high: float = parameter('upper end stop of the rig', 'm | rad')
    stop_stiffness: float = parameter('end stops', 'N/m | Nm/rad', gt=0.0, le=1e9)
    stop_damping: float = parameter('end stops', 'Ns/m | Nms/rad', ge=0.0, le=1e6)

    def __post_init__(self) -> None:
        """Refuse a lower stop that is not below the upper one."""
        super().__post_init__()
        if self.stop_low >= self.stop_high:
            raise ParameterError(
                f'stop_low = {self.stop_low:g} m | rad, must be < stop_high = '
                f'{self.stop_high:g} m | rad')
