"""The data sheet of one actuator, and the SI records the kernels read."""

from isa_ros.actuator.kernel import ACTUATOR
from isa_ros.actuator.link import link_record, LinkSheet, NO_LINK
from isa_ros.actuator.ratings import (
    evidence_of, forcing_areas, null_speed, ratings_of, supervision_of, valve_lag)
from isa_ros.core.changeable import sound
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, nested, Parameters
from isa_ros.core.record import record
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ConfigError
from isa_ros.plant.block_valve import NoneBlock, time_to_open, WHEN_OFF
from isa_ros.plant.chambers import oil_stiffness
from isa_ros.plant.channels import refuse_delays
from isa_ros.plant.coil import ClosedLoopCoil, ExplicitCoil
from isa_ros.plant.cushion_sheets import refuse_cushions
from isa_ros.plant.hose import soft_volume
from isa_ros.plant.load_holding import NoneHolding
from isa_ros.plant.plant import (
    LinearPlant, MotorPlant, Plant, plant_record, RotaryPlant)
from isa_ros.plant.return_spring import CoilSpring, refuse_spring, spring_of
from isa_ros.plant.spool import DataSheetSpool, DirectSpool, PilotedSpool, ResponseSpool
from isa_ros.plant.stated_curves import SidesFlow
from isa_ros.plant.valve_sheets import DataSheetValve
from isa_ros.reu import dither
from isa_ros.reu.block import Pid
from isa_ros.reu.block_drive import BlockWiring
from isa_ros.reu.cascade import KnownPlant, reu_record
from isa_ros.reu.feedback_linearisation import FeedbackLinearisation, LINEARISED
from isa_ros.reu.flow_stop import end_on_holding_valves
from isa_ros.reu.lead_lag import LeadLag
from isa_ros.reu.protection import protection_record
from isa_ros.reu.protection_sheet import reactions_of
from isa_ros.reu.schedule import POINTS
from isa_ros.reu.wiring import Held, loop_steps, Off, refuse_nonsense, Reu, valve_block
import numpy as np

ROUNDED = 1e-3  # of a limit: a data sheet prints three digits


@frozen(kw_only=True)
class ActuatorSheet(Parameters):
    """The data sheet of one actuator: its plant, its REU and the wiring between them."""

    spool_feedback: str = choice(
        "the valve's spool sensor; a mechanical feedback has none", 'electric', 'mechanic')
    plant: Plant
    reu: Reu
    link: LinkSheet = nested(NO_LINK)

    @property
    def is_rotary(self) -> bool:
        """Return whether the generalised units are rad and Nm."""
        return isinstance(self.plant, (RotaryPlant, MotorPlant))

    @property
    def is_endless(self) -> bool:
        """Return whether it turns without an end: its stroke is one turn, in which it starts."""
        return isinstance(self.plant, MotorPlant)


def refuse_wiring(sheet: ActuatorSheet) -> None:
    """
    Refuse control blocks that do not fit their actuator.

    Raises
    ------
    ConfigError
        A spool block without a spool sensor, a loop that would be closed twice or not at
        all, a limit beyond the spool's stop, or an error of `refuse_nonsense`.
    ParameterError
        A sensor's delay that the converters cannot have, or a cushion or a return spring that
        does not fit.

    """
    reu, plant = sheet.reu, sheet.plant
    refuse_nonsense(reu)
    refuse_delays(plant.sensors.channels, loop_steps(reu)['current'])
    if sheet.spool_feedback == 'mechanic' and not isinstance(reu.spool, Off):
        raise ConfigError(
            f'reu.spool.kind = {_kind(reu.spool)}: a valve with mechanical feedback has no spool '
            'sensor; set reu.spool.kind: off')
    if isinstance(plant.spool, PilotedSpool) and not isinstance(reu.spool, Pid):
        raise ConfigError(
            f'reu.spool.kind = {_kind(reu.spool)} and plant.spool.kind = piloted: the spool '
            'loop is open; set reu.spool.kind: pid, or plant.spool.kind: closed_loop')
    if isinstance(reu.spool, Pid) and not isinstance(
            plant.spool, (PilotedSpool, DirectSpool, DataSheetSpool, ResponseSpool)):
        raise ConfigError(
            'reu.spool.kind = pid and plant.spool.kind = closed_loop: equation 8 already is the '
            'closed loop of the spool; set plant.spool.kind: piloted, or reu.spool.kind: held')
    if isinstance(reu.current, LeadLag) != isinstance(plant.coil, ExplicitCoil):
        raise ConfigError(
            f'reu.current.kind = {_kind(reu.current)} and plant.coil.kind = '
            f'{_kind(plant.coil)}: lead_lag needs an explicit coil, held the closed_loop one')
    _refuse_hysteresis_of_pilot(plant)
    _refuse_beside_stated_valve(sheet)
    _refuse_limit_beyond_stop(sheet)
    _refuse_holding_beside_spring(plant)
    if isinstance(plant, LinearPlant):
        refuse_spring(plant.return_spring, plant.drive.areas[0],
                      plant.drive.rated_pressure_mpa * MPA, plant.drive.stroke)
        refuse_cushions(
            plant.drive, plant.cushion_a, plant.cushion_b, plant.oil.dead_volume_ml)
    if sheet.is_endless and isinstance(reu.force, FeedbackLinearisation):
        raise ConfigError(
            'reu.force.kind = feedback_linearisation and plant.kind = motor: its model has '
            'chambers that grow; set reu.force.kind: pid')
    if isinstance(spring_of(plant), CoilSpring) and isinstance(reu.force, FeedbackLinearisation):
        raise ConfigError(
            'reu.force.kind = feedback_linearisation and plant.return_spring.kind = coil: it '
            'needs both chambers; set reu.force.kind: pid')
    if isinstance(plant.block_valve, NoneBlock):
        for key, reaction in reactions_of(reu.protection).items():
            if reaction == 'block':
                raise ConfigError(
                    f'reu.protection.{key} = block: there are no block valves; set '
                    'plant.block_valve.kind: poppet, or the reaction disable')


def _refuse_holding_beside_spring(plant: Plant) -> None:
    """Refuse a load-holding valve without a pilot, or without a load."""
    if not isinstance(spring_of(plant), CoilSpring):
        return
    for name in ('holding_a', 'holding_b'):
        if not isinstance(getattr(plant, name), NoneHolding):
            raise ConfigError(
                f'plant.{name} and plant.return_spring.kind = coil: the valve does not feed line '
                'B, so that it opens none in A, and in B there is nothing to hold; set '
                f'plant.{name}.kind: none')


def _refuse_hysteresis_of_pilot(plant: Plant) -> None:
    """Refuse the hysteresis of a valve whose loop is in the REU: it is not that of the pilot."""
    widest = plant.valve.hysteresis_percent
    if widest > 0.0 and isinstance(plant.spool, PilotedSpool):
        raise ConfigError(
            f'plant.valve.hysteresis_percent = {widest:g} % and plant.spool.kind = piloted: a '
            'data sheet has that of the closed loop of the spool, and the current is that of the '
            'pilot; set plant.spool.kind: closed_loop, or 0 %')


def _refuse_beside_stated_valve(sheet: ActuatorSheet) -> None:
    """
    Refuse what a data sheet's valve does not have: an inverse of its curve, and two throttles.

    A leakage at a current beyond its stop is refused here, when it is scaled.
    """
    valve = sheet.plant.valve
    if not isinstance(valve, DataSheetValve):
        return
    last, full = valve.leakage.current_ma[-1], valve.flow.currents_ma[-1]
    if last > full * (1.0 + ROUNDED):
        raise ConfigError(
            f'plant.valve.leakage.current_ma[{len(valve.leakage.current_ma) - 1}] = {last:g} mA, '
            f'must be <= {full:g} mA, the current at the stop of plant.valve.flow')
    if valve.compensated_drop_mpa > 0.0 and not isinstance(sheet.plant.block_valve, NoneBlock):
        raise ConfigError(
            f'plant.valve.compensated_drop_mpa = {valve.compensated_drop_mpa:g} MPa and '
            'plant.block_valve.kind = poppet, must be none: the drop over a land is not known')
    if isinstance(sheet.reu.force, FeedbackLinearisation):
        for name, is_there in (
                ('compensated_drop_mpa', valve.compensated_drop_mpa > 0.0),
                ('dead_band_percent', valve.dead_band_percent > 0.0),
                ('flow.kind = sides', isinstance(valve.flow, SidesFlow))):
            if is_there:
                raise ConfigError(
                    f'reu.force.kind = feedback_linearisation and plant.valve.{name}: it inverts '
                    'one curve without dead band and compensator; set reu.force.kind: pid')


_KINDS: dict[type, str] = {
    Off: 'off', Held: 'held', dither.HeldWithDither: 'held', Pid: 'pid', LeadLag: 'lead_lag',
    ClosedLoopCoil: 'closed_loop', ExplicitCoil: 'explicit'}


def _kind(part: Parameters) -> str:
    return _KINDS[type(part)]


def _refuse_limit_beyond_stop(sheet: ActuatorSheet) -> None:
    """Refuse an output limit beyond the valve's stop: the integral would still wind up."""
    name = valve_block(sheet.reu)
    if name is None:
        return
    stop, unit = valve_stop(sheet), 'A' if isinstance(sheet.reu.spool, Off) else 'm'
    limit = getattr(sheet.reu, name).limit
    if limit > stop * (1.0 + ROUNDED):
        raise ConfigError(
            f'reu.{name}.limit = {limit:g} {unit}, must be <= {stop:.4g} {unit}, the stop of the '
            f'spool (reu.spool.kind = {_kind(sheet.reu.spool)}: {name} commands '
            f"{'the series current' if unit == 'A' else 'the spool'})")


def valve_stop(sheet: ActuatorSheet) -> float:
    """Return the output at the spool's stop: m of spool, or A of series current."""
    valve = sheet.plant.valve
    if isinstance(sheet.reu.spool, Off):
        return valve.spool_stop_mm / valve.spool_gain_mm_per_ma * MILLI
    return valve.spool_stop_mm * MILLI


def output_per_spool(sheet: ActuatorSheet) -> float:
    """Return the output that commands the valve over the spool's travel: 1, or A/m."""
    if isinstance(sheet.reu.spool, Off):
        return 1.0 / sheet.plant.valve.spool_gain_mm_per_ma
    return 1.0


def force_stiffness(plant: np.record) -> np.ndarray:
    """
    Return the stiffness in the force loop at `POINTS` equal distances, shape (POINTS,).

    It is that of the trapped oil in series with the force sensor, in N/m or Nm/rad.
    """
    k_s = plant.mechanics.k_s
    return np.array([
        1.0 / (1.0 / oil_stiffness(s, plant.chambers) + 1.0 / k_s)
        for s in np.linspace(0.0, plant.chambers.stroke, POINTS)])


def known_model(plant: np.record, per_spool: float) -> np.record:
    """
    Return the `LINEARISED` record: a linearising block's model of its actuator.

    Of a single-acting cylinder, which only stops use, a spring retracts as oil on an area would.
    """
    oil, valve = plant.chambers, plant.valve
    area_b = forcing_areas(plant)[1] if plant.spring.is_on else oil.area_b
    f_pb, f_bt = (valve.f_at, valve.f_pa) if plant.spring.is_on else (valve.f_pb, valve.f_bt)
    return record(
        LINEARISED, area_a=oil.area_a, area_b=area_b, stroke=oil.stroke,
        dead_volume=oil.dead_volume, beta=oil.beta, c_li=oil.c_li, k_s=plant.mechanics.k_s,
        k_low=valve.k_low, k_high=valve.k_high, q_rest=valve.q_rest, x_dg=valve.x_dg,
        x_max=valve.x_max, per_root_drop=valve.per_root_drop, f_pa=valve.f_pa,
        f_at=valve.f_at, f_bt=f_bt, f_pb=f_pb, output_per_spool=per_spool,
        has_points=valve.has_points, flow=valve.flow)


def block_wiring(sheet: ActuatorSheet) -> BlockWiring:
    """Return what the REU knows of the block valves of a sheet."""
    own = sheet.plant.block_valve
    return BlockWiring() if isinstance(own, NoneBlock) else BlockWiring(
        time_to_open(own), own.closes == WHEN_OFF)


def actuator_record(sheet: ActuatorSheet, offset_steps: int) -> np.ndarray:
    """
    Return the `ACTUATOR` record of a sheet without a load of its own, shape (1,).

    The REU knows the plant without its faults.
    """
    known = plant_record(sound(sheet.plant))
    if known[0].hoses.is_on:    # the oil of a hose is as soft as more of it in the chamber
        known[0].chambers.dead_volume += soft_volume(known[0].hoses)
    reu = reu_record(sheet.reu, offset_steps, KnownPlant(
        stroke=known[0].chambers.stroke, stiffness=force_stiffness(known[0]),
        model=known_model(known[0], output_per_spool(sheet)), lag=valve_lag(known[0], sheet.reu),
        null_speed=null_speed(known[0]), resolution=known[0].sensors.encoder,
        k_spool=known[0].valve.k_spool, parallel=known[0].coil.parallel,
        block=block_wiring(sheet)))
    reu['rules']['flow']['is_endless'] = float(sheet.is_endless)
    if known[0].holding_a.kind or known[0].holding_b.kind:
        end_on_holding_valves(reu['rules']['flow'])
    reu['protection'] = protection_record(
        sheet.reu.protection, ratings_of(known[0]),
        evidence_of(known[0], sheet.reu, sheet.spool_feedback == 'electric', offset_steps),
        supervision_of(
            known[0], sheet.reu, sheet.spool_feedback == 'electric', sheet.is_endless),
        loop_steps(sheet.reu)['current'], sheet.link.watchdog_ms * MILLI,
        sheet.reu.watchdog_ms * MILLI)
    rows = np.zeros(1, ACTUATOR)
    rows['plant'], rows['reu'] = plant_record(sheet.plant), reu
    rows['link'] = link_record(sheet.link)
    return rows
