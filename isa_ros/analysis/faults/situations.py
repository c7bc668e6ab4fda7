"""
Which fault is noticed in which situation: every fault of any actuator, in each of four.

At rest under impedance, in a slow and a fast sine, and against a blocked load with a force that
swings. The rig and the faults are those of `isa_ros.analysis.faults.measure`.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from isa_ros.analysis.faults.measure import is_of_link
from isa_ros.analysis.faults.recorded import (
    BIT_SETS, EXACT, in_mm, in_newtons, largest_error, recorded, Signals, STEP_S)
from isa_ros.analysis.faults.rigs import CONFIG, FaultRig, LINK
from isa_ros.config.models.fault_catalogue import common_faults, named_fault, NamedFault
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.conditions import BITS
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.scripting.run import load
from isa_ros.text.page import Page
from isa_ros.text.progress import Progress
from isa_ros.text.table import aligned
import numpy as np

BEGIN_S, DURATION_S = 0.5, 1.2
PAGE = 'fault_situations.md'
_GAINS: Tree = {'t_s': 0.0, 'position': 'hold', 'stiffness': 1.0e5, 'damping': 4000.0}


def _sine(amplitude: float, hertz: float, moves: str) -> Tree:
    return {'sine': {'amplitude': amplitude, 'frequency_hz': hertz, 'moves': moves}}


SITUATIONS: Mapping[str, tuple[str, Tree]] = {
    'at rest': ('mass', _GAINS),
    'slow': ('mass', _GAINS | _sine(0.02, 0.5, 'position')),
    'fast': ('mass', _GAINS | _sine(0.02, 4.0, 'position')),
    'blocked force': ('blocked', _GAINS | _sine(3000.0, 2.0, 'effort'))}
"""Kind of the load, and the entry of its track, by name."""

_HEAD = f"""# Which fault is noticed when

Each fault of any actuator or pump in four situations, of the rig of
[device_faults.md](device_faults.md): at rest, moving by 20 mm at 0.5 Hz and at 4 Hz, and pushing
with 3 kN at 2 Hz against a blocked load. It begins at {BEGIN_S:g} s and lasts. A cell has the
condition that is noticed first, whether it warns or trips, and after how many ms; then the largest
errors of position and force while the fault lasts, against the same run without it: those of the
piston and of the force in the sensor themselves, whatever the sensors read. Without a condition
there is *nothing*: then these errors are what the fault costs unnoticed. Once a trip has disabled
the device, they are those of a load that nothing holds. Written by

    ./isa faults --situations --out docs
"""


@frozen
class NoticedFault:
    """What is noticed of one fault in one situation."""

    fault: str
    situation: str
    condition: str
    """The one noticed first; '': none."""
    kind: str
    """``warning`` or ``trip``."""
    after_s: float
    position_error: float
    """Largest distance to the run without the fault, m."""
    force_error: float
    """Likewise, N."""
    diverged: str = ''


def situations(
        names: Sequence[str] | None = None, report: Progress | None = None) -> list[NoticedFault]:
    """
    Return what is noticed of each fault of any actuator, or of those named, by situation.

    Raises
    ------
    ConfigError
        A name is unknown, or that of a fault of a part.

    """
    chosen = _chosen(names)
    found = []
    for k, (name, (kind, track)) in enumerate(SITUATIONS.items()):
        config: Tree = {**CONFIG, 'actuators': {'ram': {
            'model': 'isa_v5', 'preset': 'default', 'load': {'kind': kind},
            'initial_position_mm': 50.0}}}
        scenario: Tree = {
            'name': 'situation', 'duration_s': DURATION_S, 'tracks': {'ram': [track]}}
        plain = FaultRig(load(config, scenario), 'ram')
        linked = FaultRig(load({**config, 'link': LINK}, scenario), 'ram')
        sound = [recorded(rig, (), DURATION_S) for rig in (plain, linked)]
        for j, fault in enumerate(chosen):
            if report is not None:
                report(k * len(chosen) + j, len(SITUATIONS) * len(chosen), fault.name)
            has_link = is_of_link(fault)
            found.append(_seen(fault, name, linked if has_link else plain, sound[has_link]))
    if report is not None:
        report(len(found), len(found))
    return found


def _chosen(names: Sequence[str] | None) -> list[NamedFault]:
    """Return the faults of any actuator or pump, or those named."""
    found = [named_fault(name, Place('--only')) for name in names or common_faults()]
    for own in found:
        if own.rig:
            raise ConfigError(f'--only = {own.name!r} is a fault of a part, which no situation '
                              'has; isa faults shows it without --situations')
    return found


def _seen(fault: NamedFault, situation: str, rig: FaultRig, sound: Signals) -> NoticedFault:
    try:
        faulty = recorded(rig, (rig.tree(fault, BEGIN_S),), DURATION_S)
    except SimulationDiverged as error:
        return NoticedFault(fault.name, situation, '', '', 0.0, 0.0, 0.0, str(error))
    condition, kind, after_s = first_alarm(faulty, sound)
    position_error, force_error = (largest_error(faulty, sound, own) for own in EXACT)
    return NoticedFault(
        fault.name, situation, condition, kind, after_s, position_error, force_error)


def first_alarm(faulty: Signals, sound: Signals) -> tuple[str, str, float]:
    """
    Return the condition noticed first, ``warning`` or ``trip``, and after how many seconds.

    Of the same tick the trip; two empty texts and 0 if none is, or only in the sound run too.
    """
    found = []
    for field, kind in BIT_SETS.items():
        new = faulty[field].astype(np.int64) & ~sound[field].astype(np.int64)
        for name, bit in BITS.items():
            ticks = np.flatnonzero(new >> bit & 1)
            if len(ticks):
                found.append((float(ticks[0]) * STEP_S - BEGIN_S, kind != 'trip', name, kind))
    if not found:
        return '', '', 0.0
    after_s, _, name, kind = min(found)
    return name, kind, after_s


def _cell(own: NoticedFault) -> str:
    if own.diverged:
        return own.diverged
    noticed = (f'{own.kind} {own.condition}, {own.after_s / MILLI:.0f} ms' if own.condition
               else 'nothing')
    return f'{noticed}; {in_mm(own.position_error)} mm, {in_newtons(own.force_error)} N'


def _rows(found: Sequence[NoticedFault]) -> list[tuple[str, ...]]:
    faults = dict.fromkeys(own.fault for own in found)
    cells = {(own.fault, own.situation): _cell(own) for own in found}
    return [('fault', *SITUATIONS), *(
        (fault, *(cells[fault, name] for name in SITUATIONS)) for fault in faults)]


def as_text(found: Sequence[NoticedFault]) -> str:
    """Return the matrix for a terminal."""
    return '\n'.join(aligned(_rows(found)))


def as_tree(found: Sequence[NoticedFault]) -> dict[str, Any]:
    """Return the matrix for JSON."""
    return {'situations': [vars(own) for own in found]}


def write_page(found: Sequence[NoticedFault], directory: Path) -> list[Path]:
    """Write the page; return its path."""
    page = Page(PAGE, _HEAD)
    page.section('Matrix')
    page.table(_rows(found))
    return page.write(directory)
