"""R14 behind hoses: what the comparison allows is at least the force that their drop takes."""

import isa_ros
from isa_ros.actuator.ratings import evidence_of, ratings_of
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.core.oil_properties import viscosity
from isa_ros.plant.hose import largest_resistance, series_flow, warm_hoses
from isa_ros.plant.plant import plant_record
import numpy as np
import pytest
from scipy.optimize import brentq

KEY = 'actuators.boom.parameters.plant.thermal'


def sheet(celsius: float | None, **others: float) -> ActuatorSheet:
    """Return the cylinder behind hoses, but for ``others`` at a temperature; None: not thermal."""
    changes = {} if celsius is None else {'actuators.boom.variants': ['thermal'], **{
        f'{KEY}.{name}_celsius': others.get(name, celsius)
        for name in ('start', 'supply', 'ambient')}}
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


@pytest.mark.parametrize('name', ['start', 'supply', 'ambient'])
def test_the_coldest_of_start_supply_and_air_counts(name: str) -> None:
    """The losses only add to it."""
    assert allowed(sheet(41.0, **{name: 3.0})) == allowed(sheet(3.0)) > 1.5 * allowed(sheet(41.0))


@pytest.mark.parametrize('thicker', [1.0, 2.5])
@pytest.mark.parametrize('share', [0.3, 0.99, 1.01, 5.0])
def test_the_largest_resistance_is_that_of_the_hose(share: float, thicker: float) -> None:
    """Drop over flow by C41, below and above the flow at which thick oil is turbulent."""
    hoses = plant_record(sheet(None).plant)[0].hoses
    flow, warmed = share * thicker * hoses.critical, hoses.copy()
    warm_hoses(thicker, hoses.beta, warmed)
    assert largest_resistance(hoses, flow, thicker) == pytest.approx(
        drop(flow, warmed) / flow, rel=1e-9)


def test_what_it_allows_is_that_of_both_hoses() -> None:
    """A^2 R of each, R at the larger flow of the rated speed; seals as thick as the oil."""
    plant = plant_record(sheet(0.0).plant)[0]
    thicker = viscosity(0.0, plant.thermal.oil) / viscosity(
        plant.thermal.oil.celsius, plant.thermal.oil)
    areas = plant.chambers.area_a, plant.chambers.area_b
    resistance = largest_resistance(
        plant.hoses, ratings_of(plant).speed * max(areas), thicker)
    assert thicker > 5.0 and areas[0] != areas[1]
    assert allowed(sheet(0.0)) == pytest.approx(
        thicker * plant.friction.sigma2 + sum(area * area for area in areas) * resistance,
        rel=1e-12)
