"""The parameters of the device: see `isa_ros.reu.device`."""

from dataclasses import dataclass

from isa_ros.core.parameter import choice, parameter, Parameters


@dataclass(frozen=True, kw_only=True)
class Device(Parameters):
    """Times and movements of the device's states."""

    initialisation_ms: float = parameter(
        'from t = 0 until the outputs may be on', 'ms', ge=0.0, le=60e3)
    quick_stop: str = choice(
        'reference of a quick stop: ramp: from the speed to rest; hold: at rest at once',
        'ramp', 'hold')
    quick_stop_deceleration: float = parameter(
        'of the ramp', 'm/s2 | rad/s2', gt=0.0, le=1e4)
    quick_stop_hold_ms: float = parameter(
        'at rest, before the outputs are off', 'ms', ge=0.0, le=60e3)
    fade_ms: float = parameter(
        'time constant of the rest of a jump between modes or gains', 'ms', gt=0.0, le=1e3)


BEFORE = Device(
    initialisation_ms=0.0, quick_stop='ramp', quick_stop_deceleration=10.0,
    quick_stop_hold_ms=200.0, fade_ms=5.0)
"""Of a resolved configuration older than the device, which had none of its states."""
