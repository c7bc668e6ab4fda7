"""An inertial measurement unit on a link of any body: data sheet, errors, and what it reads."""

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ParameterError

AXES = 6  # numbers of a reading: specific force, then angular velocity


@frozen(kw_only=True)
class InertialUnitSheet(Parameters):
    """An inertial measurement unit, whatever link it is on."""

    rate_hz: float = parameter('rate of the readings', 'Hz', absent=100.0, gt=0.0, le=10e3)
    x_mm: float = parameter("place in the link's frame", 'mm', absent=0.0, ge=-2e3, le=2e3)
    y_mm: float = parameter("place in the link's frame", 'mm', absent=0.0, ge=-2e3, le=2e3)
    z_mm: float = parameter("place in the link's frame", 'mm', absent=0.0, ge=-2e3, le=2e3)
    accelerometer_sigma: float = parameter(
        'white noise of a reading, standard deviation', 'm/s2', absent=0.0, ge=0.0, le=100.0)
    accelerometer_bias: float = parameter(
        'constant error of each axis', 'm/s2', absent=0.0, ge=-100.0, le=100.0)
    gyro_sigma: float = parameter(
        'white noise of a reading, standard deviation', 'rad/s', absent=0.0, ge=0.0, le=10.0)
    gyro_bias: float = parameter(
        'constant error of each axis', 'rad/s', absent=0.0, ge=-10.0, le=10.0)

    def period_ns(self, step_ns: int, where: str) -> int:
        """
        Return the period of the readings in ns.

        Raises
        ------
        ParameterError
            It is not a whole number of ticks of ``step_ns``; ``where`` names the unit.

        """
        period = NS_PER_SECOND / self.rate_hz
        ticks = round(period / step_ns)
        if ticks < 1 or abs(ticks * step_ns - period) > 1.0:    # 1 ns, far above a rounding
            raise ParameterError(
                f'{where}.rate_hz = {self.rate_hz:g} Hz, its period must be a multiple of '
                f'step_ms = {step_ns / 1e6:g} ms')
        return ticks * step_ns


@frozen(kw_only=True)
class UnitErrors(Parameters):
    """Errors of an inertial unit; noise and bias are first those of its data sheet."""

    accelerometer_sigma: float = parameter(
        'white noise of a reading, standard deviation', 'm/s2', changeable=True, ge=0.0, le=100.0)
    accelerometer_bias: float = parameter(
        'constant error of each axis', 'm/s2', changeable=True, ge=-100.0, le=100.0)
    gyro_sigma: float = parameter(
        'white noise of a reading, standard deviation', 'rad/s', changeable=True, ge=0.0, le=10.0)
    gyro_bias: float = parameter(
        'constant error of each axis', 'rad/s', changeable=True, ge=-10.0, le=10.0)
    scale: float = parameter(
        'what is read over what is there, before noise and bias', '1', changeable=True, ge=-2.0,
        le=2.0)
    stuck: float = fault('1: the reading stays as it is', '1', ge=0.0, le=1.0)
    lost: float = fault('1: the wire is broken, all numbers are 0', '1', ge=0.0, le=1.0)

    def __post_init__(self) -> None:
        """Refuse a unit that is stuck or lost by a part."""
        super().__post_init__()
        for name in ('stuck', 'lost'):
            value = getattr(self, name)
            if value not in (0.0, 1.0):
                raise ParameterError(f'{name} = {value:g}, must be 0 or 1')


def fields_of_unit(name: str) -> tuple[str, str]:
    """Return the fields of a sample with the reading of an inertial unit, of 3 numbers each."""
    return f'{name}_specific_force', f'{name}_angular_velocity'
