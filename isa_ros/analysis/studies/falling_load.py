"""
A crane whose hose bursts under its load: with and without valves that hold it.

The crane of `config/crane.yaml` holds its load with 4 m of hose to the lift cylinder; the hose of
the side that bears it bursts. The study is shown as text, as JSON, and as the page
docs/falling_load.md.
"""

from collections.abc import Mapping, Sequence
from typing import Any
import warnings

from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI, MPA
from isa_ros.scripting.run import load
from isa_ros.text.page import Page, png_with_palette
from isa_ros.text.progress import Progress, told
from isa_ros.text.table import digits, RIGHT
from isa_ros.tick.trips import TripWarning
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

NAME, TITLE = 'falling_load', 'A crane whose hose bursts, with and without load-holding valves'
BURST_S, SECONDS = 1.0, 4.0

HOSES: Mapping[str, Any] = {
    'kind': 'lumped', 'inner_diameter_mm': 12.7, 'length_m': 4.0,
    'wall': {'kind': 'expanding', 'expansion_ml_per_m': 3.0, 'pressure_mpa': 8.0},
    'rated_lpm': 40.0, 'rated_drop_mpa': 0.6}
"""DN 12, assumed."""
PILOT_CHECK: Mapping[str, Any] = {
    'kind': 'pilot_check', 'pilot_ratio': 4.0, 'cracking_mpa': 0.3, 'rated_lpm': 60.0,
    'rated_drop_mpa': 0.6, 'lag_ms': 10.0}
COUNTERBALANCE: Mapping[str, Any] = {
    'kind': 'counterbalance', 'pilot_ratio': 3.0, 'setting_mpa': 7.8, 'opening_mpa': 4.0,
    'rated_lpm': 60.0, 'rated_drop_mpa': 3.0, 'check_rated_lpm': 60.0,
    'check_rated_drop_mpa': 0.6, 'lag_ms': 10.0}
"""Set 1.3 times above the 6 MPa of the load, assumed."""
CASES: Mapping[str, Mapping[str, Any] | None] = {
    'hoses alone': None, 'pilot check': PILOT_CHECK, 'counterbalance': COUNTERBALANCE}

_LIFT = 'actuators.lift.parameters.plant'
_STIFF = {'stiffness': 2e6, 'damping': 6e4}
_SCENARIO: Tree = {
    'name': NAME, 'duration_s': SECONDS,
    'tracks': {'lift': [{'t_s': 0.0, 'position': 'hold', 'effort': 38500.0, **_STIFF}],
               'tilt': [{'t_s': 0.0, 'position': 'hold', 'effort': -12000.0, **_STIFF}]},
    'faults': [{'t_s': BURST_S, 'actuator': 'lift', 'set': {'plant.hoses.burst_a': 1.0}}]}
_HEAD = """# A crane whose hose bursts

The forestry crane of `config/crane.yaml` holds its load, 38 kN at the lift cylinder, 5.8 MPa in
its chamber A. After a second the hose of that chamber bursts. A block valve in the valve block
is on the wrong side of it; a valve on the cylinder holds the load ([parts.md](parts.md)).
This page is written by

    ./isa study falling_load --out docs
"""
_TEXT = """With the hose alone the boom comes down as fast as the burst lets oil out, until the
load touches the ground. The REU sees the burst hose, because the pressure sensors are in the valve
block: its device trips, and its valve at null leaks into the other line. That pilots the valves. A
pilot check valve opens wholly, chamber A empties, the pilot's pressure breaks down, and it shuts:
the load comes down in jerks. A counterbalance valve throttles the same oil. Setting, ratio, flows
and hoses are assumed."""


@frozen
class FallingLoad:
    """What one case does."""

    case: str
    time: NDArray[np.float64]
    position: NDArray[np.float64]
    pressure: NDArray[np.float64]
    """Of chamber A, Pa."""

    @property
    def fallen(self) -> float:
        """Return how far the piston has come in since the burst, m."""
        return float(self.position[self.time <= BURST_S][-1] - self.position[-1])

    @property
    def first(self) -> float:
        """Return how far it has in the first half second, m."""
        return float(self.position[self.time <= BURST_S][-1]
                     - self.position[self.time <= BURST_S + 0.5][-1])

    @property
    def fastest(self) -> float:
        """Return its largest speed inwards after the burst, m/s."""
        after = self.time >= BURST_S
        return float(-np.diff(self.position[after]).min() / (self.time[1] - self.time[0]))

    @property
    def peak(self) -> float:
        """Return the largest pressure of chamber A after the burst, Pa."""
        return float(self.pressure[self.time >= BURST_S].max())


def results(progress: Progress | None = None) -> list[FallingLoad]:
    """Simulate the crane in each case."""
    found = []
    for case, holding in told([*CASES.items()], progress):
        changes: dict[str, Any] = {
            'body.start.joints_deg.swing_pitch': 0.0, f'{_LIFT}.hoses': HOSES}
        if holding is not None:
            changes[f'{_LIFT}.holding_a'] = holding
        with warnings.catch_warnings():     # the device of a burst hose trips, as it should
            warnings.simplefilter('ignore', TripWarning)
            result = load('crane', _SCENARIO, changes=changes).simulate()
        position = np.asarray(result['lift.position'], float)
        found.append(FallingLoad(
            case, np.linspace(0.0, SECONDS, len(position)), position,
            np.asarray(result['lift.chamber_pressure_a'], float)))
    return found


def _table(found: Sequence[FallingLoad]) -> list[tuple[str, ...]]:
    return [('lift cylinder', 'in after 0.5 s, mm', 'after 3 s, mm', 'fastest, m/s',
             'peak in A, MPa'),
            *((own.case, digits(own.first / MILLI, 3), digits(own.fallen / MILLI, 3),
               digits(own.fastest, 3), digits(own.peak / MPA, 3)) for own in found)]


def _numbers(found: Sequence[FallingLoad]) -> dict[str, Any]:
    return {'outcomes': [
        {'case': own.case, 'first': own.first, 'fallen': own.fallen, 'fastest': own.fastest,
         'peak': own.peak} for own in found]}


def _fill(page: Page, found: Sequence[FallingLoad]) -> None:
    page.figure(NAME, TITLE, png_with_palette(_figure(found)))
    page.table(_table(found), RIGHT)
    page.paragraph(_TEXT)


def _figure(found: Sequence[FallingLoad]) -> Figure:
    figure = Figure(figsize=(7.0, 5.0), dpi=85, layout='constrained')
    above, below = figure.subplots(2, 1, sharex=True)
    for own in found:
        above.plot(own.time, own.position / MILLI, label=own.case)
        below.plot(own.time, own.pressure / MPA, label=own.case)
    for ax, label in ((above, 'lift cylinder, mm'), (below, 'chamber A, MPa')):
        ax.set_ylabel(label, fontsize='small')
        ax.axvline(BURST_S, color='gray', linestyle=':')
        ax.grid(visible=True, linewidth=0.4)
        ax.tick_params(labelsize='small')
    above.legend(fontsize='small')
    below.set_xlabel('time, s; dotted: the hose bursts', fontsize='small')
    return figure


STUDY = OwnStudy(NAME, TITLE, results, _table, _numbers, _HEAD, _fill)
