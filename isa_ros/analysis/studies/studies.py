"""
The studies that the paper announces: a parameter of each and its values.

Sections 4, 5.1 and 6 name quantisation, sampling, hunting from overlap, backlash, friction and
stiffness. A study varies one of them on both actuators, everything else as shipped.
`isa_ros.analysis.studies.measure` describes the measures.
"""

from collections.abc import Sequence
from dataclasses import field, replace
import math

from isa_ros.analysis.response.loops import UserUnit
from isa_ros.analysis.studies import texts as study_texts
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError

PRESETS = {'smart_manifold': 'table_4', 'isa_v5': 'default'}
"""The gains of a study: Table 4, and for the ISA v5 those retuned for the leg."""
COULOMB_SHARE = 0.95    # of the stiction: the paper's 1.9 Nm of 2 Nm


@frozen
class Case:
    """
    One study on one actuator.

    ``paths`` are the dotted paths of the parameters that are varied (as `with_parameters` has
    them), each with its share of the value; one that begins with ``load.`` belongs to the
    blocked output.
    """

    model: str
    values: tuple[float, ...]
    unit: UserUnit
    paths: tuple[tuple[str, float], ...]
    variants: tuple[str, ...] = ()

    @property
    def preset(self) -> str:
        """Return the name of its gains."""
        return PRESETS[self.model]

    def parameters(self, value: float) -> dict[str, float]:
        """Return the parameters at a value, in the units of their declarations."""
        return {path: value * self.unit.scale * share for path, share in self.paths}


@frozen
class Study:
    """One parameter, its cases, and a text about the outcomes."""

    name: str
    title: str
    source: str
    """The statement of the paper."""
    cases: tuple[Case, ...]
    seen: str = field(repr=False)
    """Text of the page; ``{isa_v5[12].overshoot:.0f}`` is a number of the run itself."""


def _both(
        unit: UserUnit, manifold: Sequence[float], isa: Sequence[float], *paths: str,
        isa_unit: UserUnit | None = None, variants: Sequence[str] = ()) -> tuple[Case, Case]:
    """Return the cases of both actuators whose parameters all get the value itself."""
    whole = tuple((path, 1.0) for path in paths)
    return (Case('smart_manifold', tuple(manifold), unit, whole, tuple(variants)),
            Case('isa_v5', tuple(isa), isa_unit or unit, whole, tuple(variants)))


def _friction(model: str, unit: str, values: Sequence[float]) -> Case:
    return Case(model, tuple(values), UserUnit(unit), (
        ('plant.friction.stiction', 1.0), ('plant.friction.coulomb', COULOMB_SHARE)))


_BITS, _HZ, _DEG = UserUnit('bit'), UserUnit('Hz'), math.radians(1.0)
_BITS_OF = (6.0, 8.0, 10.0, 12.0, 16.0)
_FORCE_HZ = (1e3, 2e3, 5e3, 1e4)
_POSITION_HZ = (100.0, 200.0, 1e3, 5e3)
_CURRENT_HZ = (5e3, 1e4, 5e4)
_DELAY_US = (0.0, 40.0, 80.0)
_LAP_UM = (-20.0, -10.0, -5.0, 0.0, 5.0, 10.0, 20.0, 40.0)
_KNM, _MNM = UserUnit('kNm/rad', 1e3), UserUnit('N/um', 1e6)

STUDIES = (
    Study(
        'adc_bits', 'Resolution of the converters',
        'section 5.1: quantisation errors can be analysed',
        _both(_BITS, _BITS_OF, _BITS_OF, 'plant.sensors.adc_bits'), study_texts.ADC_BITS),
    Study(
        'encoder', 'Resolution of the encoder',
        'section 5.1: quantisation errors can be analysed',
        _both(UserUnit('mdeg', 1e-3 * _DEG), (0.069, 0.69, 6.9, 20.7, 69.0),
              (0.1, 1.0, 10.0, 30.0, 100.0), 'plant.sensors.encoder_resolution',
              isa_unit=UserUnit('um', 1e-6)), study_texts.ENCODER),
    Study(
        'force_rate', 'Rate of the force or torque block',
        'section 5.1: sampling frequencies can be analysed',
        (Case('smart_manifold', _FORCE_HZ, _HZ, (('reu.force.rate_hz', 1.0),)),
         Case('isa_v5', _FORCE_HZ, _HZ, (
             ('reu.force.rate_hz', 1.0), ('reu.spool.rate_hz', 1.0)))), study_texts.FORCE_RATE),
    Study(
        'position_rate', 'Rate of the position block and of the speed estimate',
        'section 5.1: sampling frequencies can be analysed',
        _both(_HZ, _POSITION_HZ, _POSITION_HZ, 'reu.position.rate_hz', 'reu.speed.rate_hz'),
        study_texts.POSITION_RATE),
    Study(
        'current_rate', 'Rate of the current block, with its coil in the loop',
        'section 5.1: sampling frequencies can be analysed',
        _both(_HZ, _CURRENT_HZ, _CURRENT_HZ, 'reu.current.rate_hz', variants=('explicit',)),
        study_texts.CURRENT_RATE),
    Study(
        'delay', 'Computational delay, with the coil in the loop',
        'section 5.1: sampling frequencies can be analysed',
        _both(UserUnit('us'), _DELAY_US, _DELAY_US, 'reu.computation_delay_us',
              variants=('explicit',)), study_texts.DELAY),
    Study(
        'lap', 'Overlap of the valve, underlap below zero',
        'section 5.1: hunting from the overlap around null',
        _both(UserUnit('um'), _LAP_UM, _LAP_UM,
              *(f'plant.valve.lap.{land}_um' for land in ('pa', 'at', 'bt', 'pb'))),
        study_texts.LAP),
    Study(
        'backlash', 'Backlash between sensor and load',
        'sections 4 and 6: the impact of backlash on the controller',
        _both(UserUnit('mrad', 1e-3), (0.0, 0.2, 0.5, 1.0, 2.0, 5.0),
              (0.0, 10.0, 20.0, 50.0, 100.0, 200.0), 'plant.mechanics.backlash',
              isa_unit=UserUnit('um', 1e-6)), study_texts.BACKLASH),
    Study(
        'friction', 'Friction: stiction, and Coulomb friction 5 % below it',
        'sections 4 and 6: the impact of friction on the controller',
        (_friction('smart_manifold', 'Nm', (0.2, 1.0, 2.0, 6.0, 20.0)),
         _friction('isa_v5', 'N', (10.0, 50.0, 100.0, 300.0, 1000.0))), study_texts.FRICTION),
    Study(
        'sensor_stiffness', 'Stiffness of the force or torque sensor',
        'section 6: properties that lead to structure stiffness',
        _both(_KNM, (2.0, 5.0, 20.0, 50.0, 100.0), (5.0, 20.0, 50.0, 100.0, 200.0),
              'plant.mechanics.sensor_stiffness', isa_unit=_MNM), study_texts.SENSOR_STIFFNESS),
    Study(
        'support', 'Stiffness of what the output is blocked by',
        'section 6: a test bench assumed infinitely rigid',
        _both(_KNM, (2.0, 10.0, 20.0, 50.0, 200.0), (1.0, 3.0, 10.0, 30.0, 100.0),
              'load.stiffness', isa_unit=_MNM), study_texts.SUPPORT),
)


def study_of(name: str) -> Study:
    """
    Return a study by its name.

    Raises
    ------
    ConfigError
        The study does not exist.

    """
    names = [study.name for study in STUDIES]
    if name not in names:
        raise ConfigError(f'study {name!r} is unknown; {alternatives(name, names)}')
    return STUDIES[names.index(name)]


def only_model(study: Study, model: str | None) -> Study:
    """
    Return a study of one actuator; None: of all its actuators.

    Raises
    ------
    ConfigError
        The study does not have the actuator.

    """
    if model is None:
        return study
    models = [case.model for case in study.cases]
    if model not in models:
        raise ConfigError(
            f'--model {model}: not a model of a study; {alternatives(model, models)}')
    return replace(study, cases=(study.cases[models.index(model)],))
