"""
Properties of a mineral oil over its temperature: viscosity and compressibility.

Temperatures are in celsius and kinematic viscosities in mm2/s (cSt), the units of data sheets.
Neglected: their change with pressure, and that of density and specific heat with temperature,
2 % and 5 % over 30 K.
"""

from isa_ros.core.elementary import exp, log
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.errors import ParameterError
import numpy as np

_KELVIN = 273.15            # K at 0 celsius
_WALTHER = 0.7              # mm2/s, the constant of ASTM D341 for viscosities above 2 mm2/s
_COOL, _WARM = 40.0, 100.0  # celsius, of the two viscosities of a data sheet


@frozen(kw_only=True)
class MineralOil(Parameters):
    """A hydraulic oil as its data sheet describes it."""

    density: float = parameter('rho', 'kg/m3', ge=600.0, le=1500.0)
    specific_heat: float = parameter('c', 'J/(kg K)', ge=1000.0, le=5000.0)
    viscosity_at_40_cst: float = parameter(
        'kinematic viscosity at 40 celsius', 'mm2/s', ge=2.0, le=1000.0)
    viscosity_at_100_cst: float = parameter(
        'kinematic viscosity at 100 celsius', 'mm2/s', ge=2.0, le=1000.0)
    compressibility_per_k: float = parameter(
        'growth of the compressibility, of that at the temperature of the sheet', '1/K',
        ge=0.0, le=0.008)

    def __post_init__(self) -> None:
        """Refuse an oil that does not get thinner as it gets warmer."""
        super().__post_init__()
        if self.viscosity_at_100_cst >= self.viscosity_at_40_cst:
            raise ParameterError(
                f'viscosity_at_100_cst = {self.viscosity_at_100_cst:g} mm2/s, must be < '
                f'viscosity_at_40_cst = {self.viscosity_at_40_cst:g} mm2/s')


PROPERTIES = np.dtype([
    ('a', 'f8'), ('b', 'f8'),   # of T1
    ('celsius', 'f8'),          # the sheet's temperature, at which every factor is 1
    ('viscosity', 'f8'),        # mm2/s, at that temperature
    ('per_k', 'f8'),            # 1/K, of T2
])


def properties_record(sheet: MineralOil, celsius: float) -> np.record:
    """Return the `PROPERTIES` record of an oil whose factors are 1 at a temperature."""
    cool, warm = (log(log(viscosity + _WALTHER)) for viscosity in (
        sheet.viscosity_at_40_cst, sheet.viscosity_at_100_cst))
    log_cool, log_warm = log(_COOL + _KELVIN), log(_WARM + _KELVIN)
    b = (cool - warm) / (log_warm - log_cool)
    own = record(PROPERTIES, a=cool + b * log_cool, b=b, celsius=celsius, viscosity=1.0,
                 per_k=sheet.compressibility_per_k)
    own.viscosity = viscosity(celsius, own)
    return own


@kernel
def viscosity(celsius, oil):
    """
    Return nu of ln ln (nu + 0.7) = a - b ln(Theta)  (T1), in mm2/s.

    Walther's equation as ASTM D341 has it above 2 mm2/s; Theta is the absolute temperature. Two
    viscosities of the data sheet give a and b.
    """
    return exp(exp(oil.a - oil.b * log(celsius + _KELVIN))) - _WALTHER


@kernel
def thickness(celsius, oil):
    """Return nu/nu_0, the viscosity over that at the sheet's temperature  (T1)."""
    return viscosity(celsius, oil) / oil.viscosity


@kernel
def softness(celsius, oil):
    """
    Return 1 + k (theta - theta_0), the compressibility over that of the sheet  (T2).

    Positive within the ranges: k <= 0.008/K, theta >= -30 and theta_0 <= 80 celsius.
    """
    return 1.0 + oil.per_k * (celsius - oil.celsius)
