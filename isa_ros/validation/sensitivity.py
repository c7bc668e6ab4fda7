"""
`isa validate --sensitivity`: which simulated entry notices which wrong parameter.

Each perturbation is one parameter that a reviewer would try. Groups that simulate run with it:
`behaviour`, `limits` and `cavities` for a parameter of the plant, the force loops for one of the
REU, `current_loop` for the amplifier. Their bars stay those of the shipped parameters. An entry
that is reached as shipped and missed with the perturbation has noticed it. A perturbation without
any, unless it is refused, is a hole in the validation: the command then exits with 1.
"""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.errors import ParameterError, SimulationDiverged
from isa_ros.text.progress import Progress
from isa_ros.validation.actuators import Change, CheckedActuators, SUPPLY_PRESSURE
from isa_ros.validation.entry import CheckGroup
from isa_ros.validation.groups import GROUPS
from isa_ros.validation.workers import in_workers

PLANT, LOOPS, RELIEF = ('behaviour', 'limits', 'cavities'), ('rotary_rig', 'isa_v5'), ('isa_v5',)
AMPLIFIER = ('current_loop',)


@frozen
class Perturbation:
    """A wrong parameter."""

    name: str
    change: Change
    groups: tuple[str, ...] = PLANT
    """Names of the groups that run with it."""


def _perturbation(name: str, factor: float, *keys: str) -> Perturbation:
    groups = next((groups for start, groups in _RUN_WITH if keys[0].startswith(start)), PLANT)
    return Perturbation(name, Change(keys, factor), groups)


_RUN_WITH = (('reu.', LOOPS), ('plant.relief.refill', PLANT), ('plant.relief.', RELIEF),
             ('plant.coil.supply', AMPLIFIER))
MORE, LESS = 1.3, 1.0 / 1.3
PERTURBATIONS = (
    _perturbation('friction x3', 3.0, 'plant.friction.stiction', 'plant.friction.coulomb'),
    _perturbation('stiction x1.3', MORE, 'plant.friction.stiction'),
    _perturbation('viscous friction x3', 3.0, 'plant.friction.viscous'),
    _perturbation('Stribeck speed x3', 3.0, 'plant.friction.stribeck_speed'),
    _perturbation('bristle stiffness /2', 0.5, 'plant.friction.bristle_stiffness'),
    _perturbation('bristle damping x3', 3.0, 'plant.friction.bristle_damping'),
    _perturbation('dead volume x3', 3.0, 'plant.oil.dead_volume_ml'),
    _perturbation('bulk modulus x1.3', MORE, 'plant.oil.effective_bulk_modulus'),
    _perturbation('bulk modulus /1.3', LESS, 'plant.oil.effective_bulk_modulus'),
    _perturbation('aeration x10', 10.0, 'plant.oil.aeration_pressure_kpa'),
    _perturbation('vapour pressure 0', 0.0, 'plant.oil.vapour_pressure_kpa'),
    _perturbation('cross-port leakage x1.3', MORE, 'plant.oil.cross_port_leakage'),
    _perturbation('sensor stiffness /2', 0.5, 'plant.mechanics.sensor_stiffness'),
    _perturbation('sensor damping x3', 3.0, 'plant.mechanics.sensor_damping'),
    _perturbation('rotor inertia x3', 3.0, 'plant.mechanics.inertia'),
    _perturbation('load inertia x1.3', MORE, 'load.inertia'),
    _perturbation('load inertia /1.3', LESS, 'load.inertia'),
    _perturbation('bore x1.3', MORE, 'plant.drive.bore_mm'),
    _perturbation('bore /1.3', LESS, 'plant.drive.bore_mm'),
    _perturbation('displacement x1.3', MORE, 'plant.drive.displacement_cc_per_rad'),
    _perturbation('displacement /1.3', LESS, 'plant.drive.displacement_cc_per_rad'),
    _perturbation('supply pressure /1.3', LESS, SUPPLY_PRESSURE),
    _perturbation('valve bandwidth /2', 0.5, 'plant.spool.loop_gain_per_s'),
    _perturbation('current bandwidth /2', 0.5, 'plant.coil.bandwidth_rad_per_s'),
    _perturbation('low flow gain x1.3', MORE, 'plant.valve.low_gain_lpm_per_ma'),
    _perturbation('low flow gain /1.3', LESS, 'plant.valve.low_gain_lpm_per_ma'),
    _perturbation('high flow gain x1.3', MORE, 'plant.valve.high_gain_lpm_per_ma'),
    _perturbation('high flow gain /1.3', LESS, 'plant.valve.high_gain_lpm_per_ma'),
    _perturbation('null leakage x1.3', MORE, 'plant.valve.null_leakage_lpm'),
    _perturbation('null leakage /1.3', LESS, 'plant.valve.null_leakage_lpm'),
    _perturbation('tare leakage x1.3', MORE, 'plant.valve.tare_leakage_lpm'),
    _perturbation('spool stop -20 %', 0.8, 'plant.valve.spool_stop_mm'),
    _perturbation('orifice smoothing x10', 10.0, 'plant.valve.orifice_smoothing_kpa'),
    _perturbation('end-stop stiffness /2', 0.5, 'plant.mechanics.stop_stiffness'),
    _perturbation('converters of one bit less', 11.0 / 12.0, 'plant.sensors.adc_bits'),
    _perturbation('encoder x10', 10.0, 'plant.sensors.encoder_resolution'),
    _perturbation('amplifier of 12 V', 0.5, 'plant.coil.supply_voltage'),
    _perturbation('relief opening x1.3', MORE, 'plant.relief.opening_pressure_mpa'),
    _perturbation('relief slope /1.3', LESS, 'plant.relief.slope_lpm_per_mpa'),
    _perturbation('refill /10', 0.1, 'plant.relief.refill_lpm'),
    _perturbation('K_v of the wrong sign', -1.0, 'reu.force.kv'),
    _perturbation('K_p x1.3', MORE, 'reu.force.kp'),
    _perturbation('K_i x1.3', MORE, 'reu.force.ki'),
    _perturbation('K_f /1.3', LESS, 'reu.force.kf'),
    _perturbation('rate of the force loop /5', 0.2, 'reu.force.rate_hz', 'reu.spool.rate_hz'),
    _perturbation('filter of the speed /2', 0.5, 'reu.speed.filter_hz'),
)


class PerturbationEffect(NamedTuple):
    """A perturbation, and the entries whose verdict it changes."""

    perturbation: Perturbation
    flips: tuple[str, ...]
    """Reached as shipped, missed with it."""
    becomes_reached: tuple[str, ...]
    """Missed as shipped, reached with it."""
    refused: str = ''
    """The error, where the actuators refuse the parameter."""


def sensitivity(
        perturbations: Sequence[Perturbation] = PERTURBATIONS,
        groups: Sequence[CheckGroup] = GROUPS,
        progress: Progress | None = None) -> tuple[PerturbationEffect, ...]:
    """
    Run groups as shipped and each perturbation in its own, in two worker processes.

    Raises
    ------
    ParameterError, SimulationDiverged
        A group does not run as shipped.
    RunError
        A worker process was lost.

    """
    def those(names: Iterable[str]) -> tuple[CheckGroup, ...]:
        return tuple(group for group in groups if group.name in names)
    used = {name for each in perturbations for name in each.groups}
    calls = [partial(outcome, those(used), None), *(
        partial(outcome, those(each.groups), each.change) for each in perturbations)]
    shipped, *changed = in_workers(calls, progress)
    return tuple(_noticed(perturbation, shipped, found)
                 for perturbation, found in zip(perturbations, changed, strict=True))


class Verdicts(NamedTuple):
    """Verdicts by the names of the entries, and the error where the parameter is refused."""

    verdicts: dict[str, bool]
    refused: str = ''


def outcome(groups: Sequence[CheckGroup], change: Change | None) -> Verdicts:
    """Return whether each entry is reached; those of a group that diverges are missing."""
    found: dict[str, bool] = {}
    for group in groups:
        try:
            entries = group.check(CheckedActuators(change)).entries
        except (ParameterError, SimulationDiverged) as error:
            if change is None:
                raise
            if isinstance(error, ParameterError):
                return Verdicts({}, str(error))
            continue
        found |= {f'{group.name}.{entry.key}': entry.is_reached for entry in entries}
    return Verdicts(found)


def _noticed(
        perturbation: Perturbation, shipped: Verdicts, changed: Verdicts) -> PerturbationEffect:
    if changed.refused:
        return PerturbationEffect(perturbation, (), (), changed.refused)
    ran = {name: is_reached for name, is_reached in shipped.verdicts.items()
           if name.partition('.')[0] in perturbation.groups}
    return PerturbationEffect(
        perturbation,
        tuple(name for name, is_reached in ran.items()
              if is_reached and not changed.verdicts.get(name, False)),
        tuple(name for name, is_reached in ran.items()
              if not is_reached and changed.verdicts.get(name, False)))


def is_noticed(found: Sequence[PerturbationEffect]) -> bool:
    """Return whether every perturbation flips at least one entry, or is refused."""
    return all(each.flips or each.refused for each in found)
