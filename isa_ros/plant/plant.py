"""
One actuator's plant: valve, oil, moving part and sensors composed.

State, rates and parameters are nested records of floats, one row per actuator
(`PLANT_STATE`, `PLANT`); signs as in the components' headers.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import nested, Parameters
from isa_ros.core.record import attributed, record
from isa_ros.core.remembered import remembered
from isa_ros.errors import ParameterError
from isa_ros.plant import (
    block_valve, chambers, coil, cushion, drives, friction, hose, hysteresis, load_holding,
    mechanics, relief, return_spring, sensors, spool, thermal, valve_record)
from isa_ros.plant.block_valve import NoneBlock, PoppetBlock
from isa_ros.plant.counterbalance import CounterbalanceHolding
from isa_ros.plant.cushion_sheets import Cushion, NoneCushion
from isa_ros.plant.hose_sheets import LumpedHoses, NoneHoses, per_wall
from isa_ros.plant.load_holding import NoneHolding
from isa_ros.plant.motor import add_losses, Motor
from isa_ros.plant.pilot_check import PilotCheckHolding
from isa_ros.plant.return_spring import CoilSpring, NoneSpring, Spring
from isa_ros.plant.service_lines import holding_record
from isa_ros.plant.spool import block_spool, stop_spool
from isa_ros.plant.thermal import LumpedThermal, NoneThermal
from isa_ros.plant.valve_sheets import DataSheetValve, DualGainValve, HighResponseValve
import numpy as np
from numpy.typing import NDArray

PLANT = np.dtype([
    ('coil', coil.COIL),
    ('spool', spool.SPOOL),
    ('valve', valve_record.VALVE),
    ('chambers', chambers.CHAMBERS),
    ('relief', relief.RELIEF),
    ('friction', friction.FRICTION),
    ('mechanics', mechanics.MECHANICS),
    ('sensors', sensors.SENSORS),
    ('thermal', thermal.THERMAL),
    ('block', block_valve.BLOCK),
    ('hysteresis', hysteresis.HYSTERESIS),
    ('cushion_a', cushion.CUSHION),
    ('cushion_b', cushion.CUSHION),
    ('hoses', hose.HOSES),
    ('holding_a', load_holding.HOLDING), ('holding_b', load_holding.HOLDING),
    ('spring', return_spring.SPRING),
])
PLANT_STATE = np.dtype([
    ('coil', coil.COIL_STATE),
    ('spool', spool.SPOOL_STATE),
    ('chambers', chambers.CHAMBERS_STATE),
    ('friction', friction.FRICTION_STATE),
    ('mechanics', mechanics.MECHANICS_STATE),
    ('block', block_valve.BLOCK_STATE),
    ('cushion', cushion.CUSHION_STATE),
    ('lines', hose.LINES_STATE),
])


EVERY_STEP = 1e9    # m3: every chamber is smaller, so that every step is one of volumes


@frozen(kw_only=True)
class PlantSheet(Parameters):
    """The data sheet of one actuator's hydraulics, mechanics and sensors."""

    coil: coil.ClosedLoopCoil | coil.ExplicitCoil
    spool: (spool.ClosedLoopSpool | spool.DirectSpool | spool.PilotedSpool
            | spool.DataSheetSpool | spool.ResponseSpool)
    valve: DualGainValve | HighResponseValve | DataSheetValve
    oil: chambers.ChamberOil
    relief: relief.Relief
    friction: friction.Friction
    mechanics: mechanics.Mechanics
    sensors: sensors.Sensors
    thermal: NoneThermal | LumpedThermal = nested(NoneThermal())
    block_valve: NoneBlock | PoppetBlock = nested(NoneBlock())
    hoses: NoneHoses | LumpedHoses = nested(NoneHoses())
    holding_a: NoneHolding | PilotCheckHolding | CounterbalanceHolding = nested(NoneHolding())
    holding_b: NoneHolding | PilotCheckHolding | CounterbalanceHolding = nested(NoneHolding())

    def __post_init__(self) -> None:
        """Refuse load-holding valves without hoses, and a wall that makes oil stiffer."""
        super().__post_init__()
        if isinstance(self.hoses, LumpedHoses):
            per_wall(self.hoses, self.oil.effective_bulk_modulus)
            return
        for name in ('holding_a', 'holding_b'):
            if not isinstance(getattr(self, name), NoneHolding):
                raise ParameterError(
                    f'{name}: a load-holding valve compares the pressures of the lines, which '
                    'only hoses have; set hoses.kind: lumped')


@frozen(kw_only=True)
class LinearPlant(PlantSheet):
    """A cylinder; generalised units N, m."""

    drive: drives.Cylinder
    cushion_a: Cushion = nested(NoneCushion())
    cushion_b: Cushion = nested(NoneCushion())
    return_spring: Spring = nested(NoneSpring())


@frozen(kw_only=True)
class RotaryPlant(PlantSheet):
    """A vane actuator; generalised units Nm, rad."""

    drive: drives.Vane


@frozen(kw_only=True)
class MotorPlant(PlantSheet):
    """A motor that turns without an end; generalised units Nm, rad."""

    drive: Motor


Plant = LinearPlant | RotaryPlant | MotorPlant


def is_heated(sheet: PlantSheet) -> bool:
    """Return whether the losses heat the actuator."""
    return isinstance(sheet.thermal, LumpedThermal)


def plant_record(sheet: Plant) -> NDArray[np.void]:
    """Return the `PLANT` record of a sheet, shape (1,), the caller's own."""
    return _plant_record(sheet).copy()


@remembered
def _plant_record(sheet: Plant) -> NDArray[np.void]:
    area_a, area_b = sheet.drive.areas
    celsius = sheet.oil.temperature_celsius
    lands = valve_record.valve_record(sheet.valve, area_a / area_b)
    rated = lands.x_max / lands.k_spool
    shift = valve_record.null_shift(sheet.valve, rated)
    own_spool = spool.spool_record(sheet.spool, celsius, lands.x_max, shift)
    oil = chambers.chambers_record(sheet.drive, sheet.oil, sheet.mechanics.inertia)
    own_spring = return_spring.spring_of(sheet)
    if isinstance(own_spring, CoilSpring):
        lands.f_pb = lands.f_bt = oil.holds_b = 0.0
    hoses = hose.hoses_record(sheet.hoses, oil)
    if hoses.is_on:     # what leaves a hose enters its chamber: only volumes keep the oil (C40)
        oil.least_a = oil.least_b = EVERY_STEP
    seals = friction.friction_record(sheet.friction)
    moving = mechanics.mechanics_record(sheet.mechanics)
    if isinstance(sheet, MotorPlant):
        add_losses(sheet.drive, oil, seals, moving)
    return np.array([record(
        PLANT,
        coil=coil.coil_record(sheet.coil),
        spool=own_spool,
        valve=lands,
        chambers=oil,
        relief=relief.relief_record(sheet.relief),
        friction=seals,
        mechanics=moving,
        sensors=sensors.sensors_record(sheet.sensors),
        thermal=thermal.thermal_record(
            sheet.thermal, celsius, spool.bias_per_k(sheet.spool) + shift[1], oil, lands, seals,
            own_spool),
        block=block_valve.block_record(sheet.block_valve),
        hysteresis=hysteresis.hysteresis_record(sheet.valve, rated),
        hoses=hoses,
        holding_a=holding_record(sheet.holding_a),
        holding_b=holding_record(sheet.holding_b),
        spring=return_spring.spring_record(own_spring),
        **cushion.cushion_records(sheet),
        )], attributed(PLANT))


@kernel
def begin_volumes(y, plant):
    """Begin a step of volumes of a `PLANT_STATE`  (C11)."""
    s = y.mechanics.position
    v_a, v_b = cushion.port_volumes(y.cushion.end, s, plant)
    chambers.begin_volumes(y.chambers, v_a, v_b, plant.chambers)
    cushion.begin_trapped(y.cushion, s, plant)


@kernel
def end_volumes(y, plant):
    """End it: pressures and cavities of what the chambers, and what a spear traps, lack."""
    s = y.mechanics.position
    v_a, v_b = cushion.port_volumes(y.cushion.end, s, plant)
    chambers.end_volumes(y.chambers, v_a, v_b, plant.chambers)
    cushion.end_trapped(y.cushion, s, plant)


@kernel
def settle(y, plant):
    """
    Apply to one `PLANT_STATE` after a step what no rate can.

    The stops of spool and poppets, plays, and a spear that has entered or left.
    """
    if plant.hysteresis.is_on > 0.0:
        hysteresis.remember(
            coil.coil_current(y.coil, plant.coil) / plant.coil.parallel, plant.hysteresis)
    stop_spool(y.spool, plant.valve.x_max)
    if plant.spool.is_stuck > 0.0:
        block_spool(y.spool)
    if plant.block.is_on > 0.0:
        y.block.lift = min(max(y.block.lift, 0.0), 1.0)
    if plant.cushion_a.is_on + plant.cushion_b.is_on > 0.0:
        cushion.divide(y, plant)


@kernel
def exact_force(y, x_load, v_load, plant):
    """Return the force in the force sensor, N or Nm."""
    return mechanics.sensor_force(
        y.mechanics.position, y.mechanics.velocity, x_load, v_load, plant.mechanics)
