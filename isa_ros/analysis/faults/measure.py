"""
Faults injected one by one into a running rig, against the same run without a fault.

The rig is an ISA v5 that moves a mass, on a pump; for faults of parts one that has the part.

A fault is *visible* in a signal that the REU measures, or in the supply's pressure, once it
differs from that of the sound run by more than `VISIBLE` steps of its converter. What the device
itself makes of it are its warnings, trips and state, where a `SAMPLE` has them.
"""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.analysis.faults.recorded import (
    BIT_SETS, DEVICE, EXACT, largest_error, recorded, Signals, STATE, STEP_S, SUPPLY)
from isa_ros.analysis.faults.rigs import common_rigs, DURATION_S, FaultRig, rig_of
from isa_ros.config.models.fault_catalogue import fault_catalogue, named_fault, NamedFault
from isa_ros.config.text.sections import Place
from isa_ros.core.conditions import BITS
from isa_ros.core.device import STATES
from isa_ros.core.fields import units_of
from isa_ros.core.frozen import frozen
from isa_ros.core.signals import CHANNELS, SAMPLE_FIELDS
from isa_ros.errors import SimulationDiverged
from isa_ros.plant.sensors import sensors_record
from isa_ros.text.progress import Progress
from msg_adapters import device
from msg_adapters.diagnostics import OK
import numpy as np

BEGIN_S, END_S = 0.5, 1.0
"""Time of every fault."""
CLEAR_S = 1.1
"""When what the device has kept of a fault is cleared: the causes of all have ended by then."""

VISIBLE = 4.0
"""Steps of a signal's converter."""
SOUND = 40.0
"""Steps within which all signals are after a recovery, about 1 % of the range: where the seals
stick and slip, two runs differ by more than `VISIBLE` for seconds."""
_LINK = 'link'


class Visible(NamedTuple):
    """A signal in which a fault is visible."""

    signal: str
    unit: str
    after_s: float
    """From the begin of the fault to the first sample in which it is."""
    largest: float
    """Largest difference from the sound run while the fault lasts, signed."""


class DeviceReport(NamedTuple):
    """Reports of the device on a fault, without those of the sound run."""

    kind: str
    """``warning``, ``trip`` or ``state``."""
    name: str
    """Of the condition; or the state."""
    after_s: float
    """From the begin of the fault to the first sample with it."""


@frozen
class FaultEffect:
    """The effect of one fault."""

    fault: NamedFault
    visible: tuple[Visible, ...]
    """The earliest first."""
    noticed: tuple[DeviceReport, ...]
    position_error: float
    """Largest distance of the piston from its place in the sound run while it lasts, m."""
    force_error: float
    """Likewise of the force in the sensor, N."""
    recovered_s: float | None
    """From the end of the fault, and a clear-fault, until all is within `SOUND`; None: never."""
    message: str
    """The first of the gravest level in the words of `/diagnostics`; '': all is well."""
    diverged: str = ''
    """The message of a simulation that could not go on."""


def chosen_faults(names: Sequence[str] | None) -> list[NamedFault]:
    """
    Return the faults of the catalogue, or those named.

    Raises
    ------
    ConfigError
        A name is unknown.

    """
    if not names:
        return list(fault_catalogue().values())
    return [named_fault(name, Place('--only')) for name in names]


def is_of_link(fault: NamedFault) -> bool:
    """Return whether a fault is one of a link, which the rig must have then."""
    return any(key.startswith('link.') for key in fault.values)


def outcomes(
        names: Sequence[str] | None = None, report: Progress | None = None) -> list[FaultEffect]:
    """
    Return the outcome of each fault of the catalogue, or of those named, in their order.

    Raises
    ------
    ConfigError
        A name is unknown.

    """
    chosen = chosen_faults(names)
    rigs = dict(zip(('', _LINK), common_rigs()))
    sound: dict[str, Signals] = {}
    found = []
    for k, fault in enumerate(chosen):
        if report is not None:
            report(k, len(chosen))
        name = _LINK if is_of_link(fault) else fault.rig
        rig = rigs[name] = rigs[name] if name in rigs else rig_of(name)
        if name not in sound:
            sound[name] = recorded(rig, (), DURATION_S)
        found.append(_outcome(rig, fault, sound[name]))
    if report is not None:
        report(len(chosen), len(chosen))
    return found


def _outcome(rig: FaultRig, fault: NamedFault, sound: Signals) -> FaultEffect:
    try:
        faulty = recorded(
            rig, ({**rig.tree(fault, BEGIN_S), 'until_s': END_S},), DURATION_S, CLEAR_S)
    except SimulationDiverged as error:
        return FaultEffect(fault, (), (), 0.0, 0.0, None, '', str(error))
    begin, end = round(BEGIN_S / STEP_S), round(END_S / STEP_S)
    resolution, units = _resolution(rig), _units(rig)
    visible, last = [], end
    for name, step in resolution.items():
        difference = faulty[name] - sound[name]
        is_seen = np.abs(difference) > VISIBLE * step
        if is_seen[:end + 1].any():
            during = difference[begin:end + 1]
            visible.append(Visible(
                name, units[name], float(np.argmax(is_seen) - begin) * STEP_S,
                float(during[np.argmax(np.abs(during))])))
        far = np.flatnonzero(np.abs(difference) > SOUND * step)
        if len(far):
            last = max(last, int(far[-1]) + 1)
    position_error, force_error = (
        largest_error(faulty, sound, name, end + 1) for name in EXACT)
    return FaultEffect(
        fault, tuple(sorted(visible, key=lambda own: own.after_s)),
        tuple(_noticed(faulty, sound, begin)),
        position_error, force_error,
        None if last >= len(faulty[SUPPLY]) else (last - end) * STEP_S,
        _message(faulty, rig.actuator))


def _message(faulty: Signals, name: str) -> str:
    """Return the words of the first sample at the gravest level, or '' if that is OK."""
    reported = np.array([faulty[name] for name in DEVICE]).T
    changes = [0, *np.flatnonzero((reported[1:] != reported[:-1]).any(axis=1)) + 1]
    statuses = [device.joined(name, dict(zip(DEVICE, reported[tick]))) for tick in changes]
    gravest = max(statuses, key=lambda status: status.level)
    return '' if gravest.level == OK else gravest.message


def _noticed(
        faulty: Signals, sound: Signals,
        begin: int) -> list[DeviceReport]:
    found = []
    for field, kind in BIT_SETS.items():
        new = faulty[field].astype(np.int64) & ~sound[field].astype(np.int64)
        for name, bit in BITS.items():
            ticks = np.flatnonzero(new >> bit & 1)
            if len(ticks):
                found.append(DeviceReport(kind, name, (int(ticks[0]) - begin) * STEP_S))
    ticks = np.flatnonzero(faulty[STATE] != sound[STATE])
    if len(ticks):
        found.append(DeviceReport(
            'state', STATES[int(faulty[STATE][ticks[0]])], (int(ticks[0]) - begin) * STEP_S))
    return sorted(found, key=lambda own: own.after_s)


def _resolution(rig: FaultRig) -> dict[str, float]:
    """Return the step of the converter of every signal, SI."""
    own = sensors_record(rig.run.configuration.actuator(rig.actuator).sheet.plant.sensors)
    steps = {'position': own.encoder, 'pressure_a': own.pressure_step,
             'pressure_b': own.pressure_step, SUPPLY: own.pressure_step}
    return {name: float(steps[name] if name in steps else own[f'{name}_step'])
            for name in (*CHANNELS, SUPPLY)}


def _units(rig: FaultRig) -> dict[str, str]:
    is_rotary = rig.run.configuration.actuator(rig.actuator).sheet.is_rotary
    return {SUPPLY: 'Pa'} | units_of(SAMPLE_FIELDS, is_rotary)
