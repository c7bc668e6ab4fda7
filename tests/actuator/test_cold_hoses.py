"""R14 behind hoses: what the comparison allows is at least the force that their drop takes."""

import isa_ros
from isa_ros.actuator.ratings import evidence_of, ratings_of
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.core.oil_properties import viscosity
from isa_ros.plant.hose import series_flow, warm_hoses
from isa_ros.plant.plant import plant_record
import numpy as np
import pytest
from scipy.optimize import brentq

KEY = 'actuators.boom.parameters.plant.thermal'


def sheet(celsius: float | None) -> ActuatorSheet:
    """Return the cylinder behind hoses, all of it at a temperature; None: not thermal."""
    changes = {} if celsius is None else {'actuators.boom.variants': ['thermal'], **{
        f'{KEY}.{name}_celsius': celsius for name in ('start', 'supply', 'ambient')}}
    return isa_ros.load('rig_hoses', changes=changes).configuration.actuators[0].sheet


def allowed(of: ActuatorSheet) -> float:
    """Return what a speed allows, Ns/m."""
    plant = plant_record(of.plant)[0]
    return float(evidence_of(plant, of.reu, True, 0).viscous)


def drop(flow: float, hoses: np.record) -> float:
    """Return the drop over a hose at a flow (m3/s), Pa  (C41)."""
    return float(brentq(lambda dp: series_flow(dp, 0.0, 0.0, hoses) - flow, 0.0, 1e9))


@pytest.mark.parametrize('celsius', [-10.0, 0.0, 15.0, 60.0])
def test_it_allows_for_the_drop_of_the_coldest_oil(celsius: float) -> None:
    """Of both hoses at every speed up to the rated one, with the friction of the seals."""
    own = sheet(celsius)
    plant, limit = plant_record(own.plant)[0], allowed(own)
    thermal = plant.thermal
    thicker = viscosity(celsius, thermal.oil) / viscosity(thermal.oil.celsius, thermal.oil)
    hoses = plant.hoses.copy()
    warm_hoses(thicker, hoses.beta, hoses)
    for share in (0.05, 0.3, 1.0):
        speed = share * ratings_of(plant).speed
        force = thermal.sigma2 * thicker * speed + sum(
            area * drop(area * speed, hoses)
            for area in (plant.chambers.area_a, plant.chambers.area_b))
        assert force <= limit * speed * (1.0 + 1e-9)


def test_cold_it_is_more_and_warm_that_of_the_sheet() -> None:
    assert allowed(sheet(0.0)) > 2.0 * allowed(sheet(None))
    assert allowed(sheet(60.0)) == allowed(sheet(None))
