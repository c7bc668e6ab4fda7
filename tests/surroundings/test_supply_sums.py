"""One supply feeds all actuators of a run: it loses what they say they draw, all together."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import Records
from isa_ros.run.local_run import LocalRun
from isa_ros.surroundings import supply
from isa_ros.tick.source import ScheduledSource
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import FluidPressure, JointState
from tests.sheets import setpoint

CONFIG = Path(__file__).parents[2] / 'config'
STANDARD_ATMOSPHERE = 101_325.0  # Pa
STEP_NS = 1_000_000
STEP = 1e-3  # s
TICKS = 120
STARTS_AT = 20  # tick at which the second actuator is sent off
SHEET = supply.AccumulatorSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.2, gas_volume_l=0.05, precharge_mpa=12.0,
    polytropic_exponent=1.4, line_volume_l=0.1, bulk_modulus=7e8, pump_flow_lpm=6.0,
    pump_lag_s=0.1, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=24.0)


class Kept:
    """A recorder that keeps the values of three topics, by topic."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names
        self.pressure: list[float] = []
        self.drawn: dict[str, list[tuple[float, float]]] = {'first': [], 'second': []}
        """Volume since t = 0 (m3) and mean flow over the last tick (m3/s)."""

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Take what a supply is about."""
        for topic, data in messages:
            if self._names[topic] == '/coordinator/supply_pressure':
                self.pressure.append(decode(data, FluidPressure).fluid_pressure)
            elif self._names[topic].endswith('/valve'):
                valve = decode(data, JointState)
                name = valve.header.frame_id
                entry = list(valve.name).index(f'{name}/supply')
                self.drawn[name].append((valve.position[entry], valve.velocity[entry]))


@cache
def recorded() -> Kept:
    """Return a run of two cylinders, of which the second extends and the first stands."""
    run = load_run(CONFIG / 'rig_linear.yaml')
    feed = replace(run.supplies[0], sheet=SHEET, feeds=('first', 'second'))
    run = replace(run, supplies=(feed,), actuators=tuple(
        replace(run.actuators[0], name=name) for name in feed.feeds))

    def commands(tick: int, rows: Records) -> None:
        if tick == STARTS_AT:
            rows[1] = setpoint(position=0.08)
    local = LocalRun(run)
    kept = Kept([topic.name for topic in local.topics])
    local.simulate(TICKS, ScheduledSource(commands), kept)
    return kept


def test_the_second_actuator_draws_what_the_test_is_about():
    """The piston's 363 mm2 over some 20 mm, against the leakage of the one at rest."""
    kept = recorded()
    assert kept.drawn['second'][-1][0] > 5e-6 > 5.0 * kept.drawn['first'][-1][0] > 0.0


def test_the_supply_loses_what_all_actuators_draw():
    """
    C8 with Q_drawn the sum over the actuators, in ticks from the flow that each tells.

    The flows are told as volume over step: one rounding each, and 120 ticks of pressures of
    2e7 Pa, rounded to 4e-9 Pa some ten times each: below 1e-5 Pa. What the actuator at rest
    leaks is some 2e5 Pa by then.
    """
    kept = recorded()
    alone = supply.Supply(SHEET, STEP_NS, flow_slope=1e-12)
    expected = [alone.pressure]
    for (_, first), (_, second) in list(zip(*kept.drawn.values()))[1:]:
        alone.advance((first + second) * STEP)
        expected.append(alone.pressure)
    assert np.array(kept.pressure) - STANDARD_ATMOSPHERE == pytest.approx(
        np.array(expected), rel=0.0, abs=1e-5)


@pytest.mark.parametrize('name', ['first', 'second'])
def test_the_volume_is_the_flow_summed_since_the_start(name):
    """`~/valve`: position of the entry supply is oil since t = 0, velocity its mean flow."""
    drawn = np.array(recorded().drawn[name])
    assert tuple(drawn[0]) == (0.0, 0.0)
    # 120 sums of numbers below the last, rounded to 1e-16 of it
    assert drawn[:, 0] == pytest.approx(
        np.cumsum(drawn[:, 1]) * STEP, rel=0.0, abs=2e-14 * drawn[-1, 0])
