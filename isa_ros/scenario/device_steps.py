"""What an event of a track asks of the device: enable, mode, its reference, clear, quick stop."""

from collections.abc import Mapping
from typing import Any

from isa_ros.actuator.requests import start_mode
from isa_ros.actuator.setpoint_range import reference_bounds
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.device import MODES, REFERENCES
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_MODE, HAS_QUICK_STOP, HAS_REFERENCE)
from isa_ros.errors import ConfigError
from isa_ros.reu.wiring import mode_of
import numpy as np

_REQUESTS: Mapping[str, int] = {'clear_fault': HAS_CLEAR_FAULT, 'quick_stop': HAS_QUICK_STOP}


@frozen
class DeviceStep:
    """Takes effect once, at the tick of its event; None leaves a value unchanged."""

    is_enabled: bool | None = None
    mode: int | None = None
    """Number of `isa_ros.core.device.MODES`."""
    reference: tuple[int, float] | None = None
    """Mode and value: A, m or Pa."""
    requests: int = 0
    """Sum of `HAS_CLEAR_FAULT` and `HAS_QUICK_STOP`."""

    def write(self, row: np.void) -> None:
        """Fill a `COMMAND` row; what the step does not have is left unchanged."""
        kinds = self.requests
        if self.is_enabled is not None:
            kinds |= HAS_ENABLE
            row['is_enabled'] = int(self.is_enabled)
        if self.mode is not None:
            kinds |= HAS_MODE
            row['mode'] = self.mode
        if self.reference is not None:
            kinds |= HAS_REFERENCE
            row['mode'], row['reference'] = self.reference
        row['kinds'] |= kinds

    def tree(self) -> Tree:
        """Return its keys as a scenario file has them."""
        tree: Tree = {}
        if self.is_enabled is not None:
            tree['enabled'] = self.is_enabled
        if self.mode is not None:
            tree['mode'] = MODES[self.mode]
        if self.reference is not None:
            tree[MODES[self.reference[0]]] = self.reference[1]
        return tree | {name: True for name, kind in _REQUESTS.items() if self.requests & kind}


def read_device_step(tree: Tree, place: Place, actuator: ActuatorConfig, mode: int) -> DeviceStep:
    """
    Return what an event asks of the device; ``mode`` is the one in force before it.

    Raises
    ------
    ConfigError
        A value is invalid, or the wiring of the actuator or the mode do not have it.

    """
    for name in ('enabled', *_REQUESTS):
        if name in tree and not isinstance(tree[name], bool):
            raise ConfigError(f'{place}.{name} = {tree[name]!r}, must be true or false')
    new: Any = tree.get('mode')
    number = None if new is None else mode_of(str(new), actuator.sheet.reu, f'{place}.mode')
    enabled: Any = tree.get('enabled')
    return DeviceStep(
        enabled, number, _reference(tree, place, actuator, number or mode),
        sum(kind for name, kind in _REQUESTS.items() if tree.get(name)))


def _reference(
        tree: Tree, place: Place, actuator: ActuatorConfig, mode: int) -> tuple[int, float] | None:
    given = [name for name in REFERENCES if name in tree]
    for name in given:
        if REFERENCES[name] != mode:
            raise ConfigError(
                f'{place}.{name} is not used: the mode is {MODES[mode]}; set mode: {name}')
        low, high, unit, what = reference_bounds(actuator.sheet)[mode]
        check(f'{place}.{name}', tree[name], {
            'doc': what, 'unit': unit, 'bounds': {'ge': low, 'le': high}})
    return (mode, float(tree[given[0]])) if given else None  # type: ignore[arg-type]


def mode_before(actuator: ActuatorConfig) -> int:
    """Return the mode in which an actuator starts."""
    return start_mode(actuator.name, actuator.mode, actuator.sheet.reu)
