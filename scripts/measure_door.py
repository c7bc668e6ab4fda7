"""
How exact the forces of actuators on an external body are, and what a tick of it costs.

The leg of leg.yaml drops as a `Mechanism`, against its own compiled port with ticks of 0.2 ms. A
crane of three cylinders in MuJoCo moves and puts its load on a hard floor, against ticks of
0.1 ms with the full port and MuJoCo in steps of 0.02 ms. Mean forces in the load cells over
0.2 ms are compared. Ports: `look-ahead` is what `MechanismBody` makes, `full` with stiffness and
damping, `x, v, a` and `and 1/m` are given by the loop of the caller, without a look-ahead.

    python -m scripts.measure_door            about two minutes, prints the tables
    python -m scripts.measure_door --write    and writes them into docs/door.md
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
import math
from pathlib import Path
import sys
from typing import Any, NamedTuple

import isa_ros
from isa_ros.bench.crane import crane, CRANE_NAMES, crane_run
from isa_ros.bench.door import crane_rows
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND
from isa_ros.errors import SimulationDiverged
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
import numpy as np
from scripts.leg_mechanism import LegMechanism

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'door.md'
MEAN_S = 2e-4           # of the compared forces
LEG_S, CRANE_S = 0.45, 0.7
LOOK_AHEAD, FULL, GIVEN, WITH_MASS = 'look-ahead', 'full', 'x, v, a', 'and 1/m'
LIGHT_LEG = {f'actuators.{name}.parameters.plant.mechanics.sensor_damping': 200.0
             for name in ('hfe', 'kfe')}
LIGHT_CRANE: Tree = {'sensor_damping': 300.0}
MOVES = {'boom': (0.05, 0.35, -0.045), 'jib': (0.1, 0.3, 0.03), 'bucket': (0.05, 0.2, -0.02)}
"""Start and duration, s, and distance, m, of the move of each cylinder."""
STIFFNESS, DAMPING = 1e6, 2e4       # N/m, N s/m of the commands

Forces = np.ndarray
"""Mean forces in the load cells over `MEAN_S`, (n, k), N | Nm."""
Made = Callable[[isa_ros.Mounting], Any]
Command = Callable[[int, Any], None]
"""Commands, before a tick, whoever has ``command``: a simulation, or `isa_ros.Actuators`."""


class Errors(NamedTuple):
    """Departures from a reference."""

    rms: np.ndarray
    """Over its rms, (k,)."""
    largest: np.ndarray
    """Over its largest force, (k,)."""
    peak: np.ndarray
    """Of the largest force, (k,)."""


def errors(forces: Forces, reference: Forces) -> Errors:
    """Return the departures of forces from those of a reference."""
    apart, peak = forces - reference, np.abs(reference).max(axis=0)
    return Errors(
        np.sqrt((apart ** 2).mean(axis=0) / (reference ** 2).mean(axis=0)),
        np.abs(apart).max(axis=0) / peak, np.abs(forces).max(axis=0) / peak - 1.0)


def means(ticks: Sequence[np.ndarray], step: float) -> Forces:
    """Return means over `MEAN_S` of the windows of ticks, each (5, k)."""
    windows = round(MEAN_S * FORCE_WINDOWS / step)
    whole = np.concatenate(ticks)
    return whole.reshape(-1, windows, whole.shape[1]).mean(axis=1)


def still(tick: int, commanded: Any) -> None:
    """Command nothing: the scenario does."""


def simulated(run: isa_ros.Run, seconds: float, made: Made | None, names: Sequence[str],
              command: Command = still) -> Forces:
    """Return the forces of a run, whose body ``made`` makes (None: that of its file)."""
    own = run.simulation(body=made)
    rows, step = [own.names.index(name) for name in names], run.configuration.step_ns * 1e-9
    found = []
    for tick in range(round(seconds / step)):
        command(tick, own)
        own.step()
        found.append(own.loop.rows.replies['mean_forces'][rows].T.copy())
    return means(found, step)


def owned(run: isa_ros.Run, seconds: float, made: Made, has_mass: bool,
          command: Command = still) -> Forces:
    """Return the forces in a loop of the caller, who gives x, v, a and perhaps 1/m."""
    actuators, step = isa_ros.Actuators(run), run.configuration.step_ns * 1e-9
    own = {actuator.name: actuator for actuator in run.configuration.actuators}
    k = len(actuators.names)
    mounting = isa_ros.Mounting(
        actuators.names, np.arange(k),
        np.array([own[name].initial_position for name in actuators.names]),
        [own[name].sheet.is_rotary for name in actuators.names], step, 0)
    mechanism = made(mounting)
    rest = isa_ros.MechanismBody(mechanism, mounting).sample
    state = mechanism.state
    actuators.start([rest[f'{name}_position'][0] for name in actuators.names],
                    [rest[f'{name}_force'][0] for name in actuators.names])
    found, mass = [], None
    for tick in range(round(seconds / step)):
        now = mechanism.motion(state, actuators.forces)
        if has_mass:
            mass = [mechanism.motion(state, actuators.forces + one).acceleration[j]
                    - now.acceleration[j] for j, one in enumerate(np.eye(k))]
        command(tick, actuators)
        forces = actuators.advance(*now[:3], inverse_mass=mass)
        state = mechanism.stepped(state, forces, step)
        found.append(forces)
    return means(found, step)


def through(port: str, run: isa_ros.Run, seconds: float, made: Made, names: Sequence[str],
            command: Command = still) -> Forces:
    """Return the forces of a run through the door, with one of its ports."""
    if port in (GIVEN, WITH_MASS):
        return owned(run, seconds, made, port == WITH_MASS, command)

    def body(mounting: isa_ros.Mounting) -> isa_ros.MechanismBody:
        return isa_ros.MechanismBody(made(mounting), mounting, has_response=port == FULL)
    return simulated(run, seconds, body, names, command)


def leg_runs(changes: Mapping[str, Any], step_ms: float) -> tuple[isa_ros.Run, isa_ros.Run, Made]:
    """Return the drop of the leg, and that with its leg behind the door, which is made."""
    changed = {'step_ms': step_ms, **changes}
    own = isa_ros.load('leg', 'drop').replace(changed)
    tree, plan = read(find('leg', CONFIG)), read(find('drop', SCENARIOS))
    leg = own.configuration.leg
    assert leg is not None
    del tree['leg'], plan['leg'], plan['figure']
    tree['body'] = {'kind': 'external', 'actuators': [actuator for _, actuator in leg.joints]}
    for actuator in own.configuration.actuators:    # where the scenario holds it
        key, scale = ('deg', math.degrees(1.0)) if actuator.sheet.is_rotary else ('mm', 1e3)
        tree['actuators'][actuator.name][f'initial_position_{key}'] = (
            scale * actuator.initial_position)
    return own, isa_ros.load(tree, plan).replace(changed), partial(LegMechanism, leg)


PORTS = FULL, LOOK_AHEAD, WITH_MASS, GIVEN


def leg_errors(
        changes: Mapping[str, Any], ports: Sequence[str] = PORTS
        ) -> Iterator[tuple[str, Errors, Errors]]:
    """Yield the errors of ports with ticks of 1 ms, and those against the own port with them."""
    names = 'haa', 'hfe', 'kfe'
    fine, _, _ = leg_runs(changes, 0.2)
    reference = simulated(fine, LEG_S, None, names)
    own, behind, made = leg_runs(changes, 1.0)
    alike = simulated(own, LEG_S, None, names)
    yield 'own, compiled', errors(alike, reference), errors(alike, alike)
    for port in ports:
        forces = through(port, behind, LEG_S, made, names)
        yield port, errors(forces, reference), errors(forces, alike)


def quintic(t: float, start: float, seconds: float, distance: float) -> tuple[float, float]:
    """Return place (m) and speed (m/s) of a move whose acceleration begins and ends at 0."""
    u = min(max((t - start) / seconds, 0.0), 1.0)
    return (distance * u ** 3 * (10.0 - 15.0 * u + 6.0 * u * u),
            distance * 30.0 * (u * (1.0 - u)) ** 2 / seconds)


def moves(run: isa_ros.Run, rest: Mapping[str, float]) -> Command:
    """Return what commands the moves of the crane every millisecond, and its forces at rest."""
    step_ns = run.configuration.step_ns

    def command(tick: int, own: Any) -> None:
        t_ns = tick * step_ns
        if t_ns % 1_000_000 == 0:
            for name in CRANE_NAMES:
                place, speed = quintic(t_ns / NS_PER_SECOND, *MOVES[name])
                own.command(name, position=0.1 + place, velocity=speed, effort=rest[name],
                            stiffness=STIFFNESS, damping=DAMPING)
    return command


def crane_forces(
        step_ms: float, port: str, timestep: float, integrator: str, cell: Tree | None) -> Forces:
    """Return the forces in the cylinders of the crane."""
    run, made = crane_run(step_ms, cell), crane(timestep, integrator)
    first = run.simulation(body=made).body_sample
    assert first is not None
    rest = {name: float(first[f'{name}_force']) for name in CRANE_NAMES}
    return through(port, run, CRANE_S, made, CRANE_NAMES, moves(run, rest))


BOUND = 1.0, LOOK_AHEAD, 2e-4, 'RK4'
CASES = (
    BOUND, (1.0, FULL, 2e-4, 'RK4'), (1.0, WITH_MASS, 2e-4, 'RK4'), (1.0, GIVEN, 2e-4, 'RK4'),
    (0.2, GIVEN, 2e-4, 'RK4'), (1.0, LOOK_AHEAD, 2e-5, 'Euler'), (1.0, LOOK_AHEAD, 2e-4, 'Euler'),
    (1.0, LOOK_AHEAD, 1e-3, 'RK4'))
"""Tick in ms, port, MuJoCo's timestep in s, its integrator."""
Case = tuple[float, str, float, str]


def crane_errors(
        cell: Tree | None, cases: Sequence[Case] = CASES
        ) -> Iterator[tuple[Case, Errors | SimulationDiverged]]:
    """Yield the errors of the crane, or the end of a run that diverges."""
    reference = crane_forces(0.1, FULL, 2e-5, 'Euler', cell)
    for case in cases:
        try:
            forces = crane_forces(*case, cell)
        except SimulationDiverged as error:
            yield case, error
        else:
            yield case, errors(forces, reference)


def _percent(values: np.ndarray, n: int = 2) -> str:
    return ', '.join(f'{100.0 * value:.{n}f}' for value in np.atleast_1d(values))


def _cells(own: Errors | SimulationDiverged) -> tuple[str, str, str]:
    if isinstance(own, SimulationDiverged):
        return f'diverges at t = {own.t_ns / NS_PER_SECOND:.3f} s', '', ''
    return _percent(own.rms), _percent(own.largest, 1), _percent(own.peak, 1)


def tables() -> dict[str, list[str]]:
    """Return the tables of the page by the names of their parts."""
    leg = [['load cells', 'port', 'rms, %: HAA, HFE, KFE', 'largest error, % of the peak',
            'peak, %', 'from the own port, rms, %', 'largest, %']]
    for name, changes in (('shipped', {}), ('200 N s/m', LIGHT_LEG)):
        leg += [[name, port, *_cells(own), _percent(apart.rms), _percent(apart.largest, 1)]
                for port, own, apart in leg_errors(changes)]
    lifted = [['load cell', 'tick, ms', 'port', 'MuJoCo', 'rms, %: boom, jib, bucket',
               'largest error, % of the peak', 'peak, %']]
    for name, cell in (('shipped', None), ('300 N s/m', LIGHT_CRANE)):
        lifted += [[name, f'{step:g}', port, f'{integrator}, {1e3 * timestep:g} ms',
                    *_cells(own)] for (step, port, timestep, integrator), own in crane_errors(
                        cell, CASES if cell is None else CASES[:4])]
    cost = [['', 'us'], *([row.name.partition(': ')[2], f'{row.number:.1f}']
                          for row in crane_rows())]
    return {'leg': markdown(leg, 'llr'), 'crane': markdown(lifted, 'lrllr'),
            'cost': markdown(cost, 'lr')}


def main(arguments: Sequence[str]) -> None:
    """Print the tables; with ``--write`` put them into the page."""
    parts = tables()
    for lines in parts.values():
        sys.stdout.write('\n'.join(lines) + '\n\n')
    if '--write' in arguments:
        PAGE.write_text(with_parts(PAGE.read_text(encoding='utf-8'), parts), encoding='utf-8')


if __name__ == '__main__':
    main(sys.argv[1:])
