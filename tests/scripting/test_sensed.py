"""
Errors of the sensors measured from runs: statistics, quantisation, bias, drift, delay, seeds.

The rig drives the valve with a constant current and no loop, so that errors of the sensors do
not move it: what they add is the difference to a run with ideal sensors of 24 bits.
"""

from itertools import combinations
import math
from pathlib import Path

import isa_ros
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.core.signals import CHANNELS
from isa_ros.errors import ConfigError
from isa_ros.testing import assert_replays
from isa_ros.tick.trips import TripWarning
import numpy as np
import pytest
from scipy import stats
from tests.sheets import actuator_sheet

SENSORS = 'actuators.ram.parameters.plant.sensors'
N = 4000        # ticks
MODELS = ('cylinder', 'isa_v2', 'isa_v5', 'smart_manifold')
ALARM = 1e-6
"""Probability with which a check would refuse errors that are as configured."""
LAGS = 20
CODES = {
    'position': 1e-6, 'force': 2e4 / 4096, 'pressure_a': 25e6 / 4096, 'pressure_b': 25e6 / 4096,
    'spool': 0.5e-3 / 4096, 'current': 25e-3 / 4096}
"""Of the ISA v5: 12 bits of the ranges, and the encoder."""


def rig(duration: float = N * 1e-3) -> isa_ros.Run:
    """Return the cylinder whose valve is driven by 0.05 mA."""
    return isa_ros.load('rig_linear', {
        'name': 'creep', 'duration_s': duration,
        'tracks': {'ram': [{'t_s': 0.0, 'position': 'hold', 'effort': 5e-5}]}}).replace(
            {'actuators.ram.variants': ['valve_amplifier']})


def of_channels(key: str, values: dict[str, float]) -> dict[str, float]:
    """Return the changes that set one parameter of channels."""
    return {f'{SENSORS}.{name}.{key}': value for name, value in values.items()}


def bound(n_checks: int) -> float:
    """Return the deviation, in standard deviations, that ``n_checks`` normal numbers exceed."""
    return float(stats.norm.isf(ALARM / (2 * n_checks)))


@pytest.fixture(scope='module')
def exact() -> isa_ros.Result:
    """Return the run with ideal sensors, finer than all that is measured."""
    return rig().replace({f'{SENSORS}.adc_bits': 24, f'{SENSORS}.encoder_resolution': 1e-10}
                         ).simulate()


@pytest.fixture(scope='module')
def noisy() -> isa_ros.Result:
    """Return the run with noise of two codes, and their biases of ten."""
    return rig().replace(
        of_channels('sigma', {name: 2.0 * code for name, code in CODES.items()})
        | of_channels('bias', {name: 10.0 * code for name, code in CODES.items()})
        | {'seed': 11}).simulate()


@pytest.fixture(scope='module', params=['memory', 'bag'])
def errors(request, exact, noisy, tmp_path_factory) -> dict[str, np.ndarray]:
    """Return the errors of every channel in codes, of the result and of its bag."""
    seen = noisy if request.param == 'memory' else read_signals(
        noisy.save(tmp_path_factory.mktemp('noisy') / 'bag'))
    return {name: (seen[f'ram.{name}'] - exact[f'ram.{name}'])[1:] / code
            for name, code in CODES.items()}


def test_noise_and_quantisation_have_the_configured_variance(errors):
    """
    Var = sigma^2 + 1/12 in codes: rounding adds an independent, uniform error (Widrow).

    The estimate of a variance has the relative standard error sqrt(2/N), less with a uniform
    part.
    """
    expected = 2.0 ** 2 + 1.0 / 12.0
    for error in errors.values():
        assert abs(error.var(ddof=1) / expected - 1.0) < bound(6) * math.sqrt(2.0 / N)


def test_the_bias_is_the_mean(errors):
    """Within the standard error of a mean."""
    for error in errors.values():
        assert abs(error.mean() - 10.0) < bound(6) * math.sqrt((4.0 + 1.0 / 12.0) / N)


def test_errors_are_white_and_independent_over_channels(errors):
    """Correlations of independent numbers have the standard error 1/sqrt(N)."""
    centred = {name: (error - error.mean()) / error.std() for name, error in errors.items()}
    n_checks = 6 * LAGS + 15
    limit = bound(n_checks) / math.sqrt(N - LAGS)
    for error in centred.values():
        assert all(abs(np.mean(error[:-lag] * error[lag:])) < limit
                   for lag in range(1, LAGS + 1))
    for one, other in combinations(centred.values(), 2):
        assert abs(np.mean(one * other)) < limit


def test_every_reading_is_a_code(noisy):
    """After the noise: S1, S2."""
    for name, code in CODES.items():
        counts = noisy[f'ram.{name}'] / code
        assert counts == pytest.approx(np.round(counts), abs=1e-6)
        assert len(np.unique(np.round(counts))) > 8


def test_a_drift_has_the_configured_slope(exact):
    """Of the regression over time, within its standard error; and none in another channel."""
    code, slope = CODES['force'], 30.0
    drifting = rig().replace(of_channels('drift_per_s', {'force': slope})).simulate()
    error, t = drifting['ram.force'] - exact['ram.force'], exact.time
    spread = code / math.sqrt(12.0) / math.sqrt(((t - t.mean()) ** 2).sum())
    assert abs(np.polyfit(t, error, 1)[0] - slope) < bound(1) * spread
    ideal = rig().simulate()
    for name in set(CHANNELS) - {'force'}:
        assert (drifting[f'ram.{name}'] == ideal[f'ram.{name}']).all()


@pytest.mark.parametrize('name', CHANNELS)
def test_a_delay_of_three_ticks_shows_what_was_three_ticks_before(name):
    """In the readings' own bits; the others are as they were."""
    ideal = rig(0.2).simulate()
    late = rig(0.2).replace(of_channels('delay_ms', {name: 3.0})).simulate()
    assert (late[f'ram.{name}'][4:] == ideal[f'ram.{name}'][1:-3]).all()
    assert np.ptp(ideal[f'ram.{name}']) > 0.0
    for other in set(CHANNELS) - {name}:
        assert (late[f'ram.{other}'] == ideal[f'ram.{other}']).all()


def test_a_stuck_sensor_keeps_its_first_reading():
    stuck = rig(0.2).replace(of_channels('stuck', {'position': 1.0})
                             | of_channels('sigma', {'force': 10.0})).simulate()
    assert (stuck['ram.position'] == stuck['ram.position'][0]).all()
    assert np.ptp(stuck['ram.force']) > 0.0


def test_readings_clip_at_the_range():
    beyond = rig(0.05).replace(of_channels('bias', {'force': 3e4})).simulate()
    assert (beyond['ram.force'] == 1e4 - CODES['force']).all()


def test_a_seed_gives_its_own_noise_and_the_same_again(noisy):
    """As a key, and as an argument."""
    run = rig(0.05).replace(of_channels('sigma', {'force': 10.0}))
    forces = {seed: run.simulate(seed=seed)['ram.force'] for seed in (0, 1, 2)}
    assert (run.simulate()['ram.force'] == forces[0]).all()
    assert (run.replace({'seed': 2}).simulate()['ram.force'] == forces[2]).all()
    for one, other in combinations(forces.values(), 2):
        assert (one != other).mean() > 0.5
    assert isa_ros.load('rig_linear', seed=5).configuration.seed == 5


def test_a_sweep_over_seeds_gives_the_spread_of_the_noise():
    run = rig(0.02).replace(of_channels('sigma', {'force': 50.0}))
    table = isa_ros.sweep(run, {'seed': np.arange(4)}, workers=1, measure={
        'mean': lambda result: float(result['ram.force'].mean())})
    assert len(set(table['mean'])) == 4


@pytest.mark.parametrize('seed', [-1, 1.5, True, 'one', 2**63])
def test_a_bad_seed_is_refused(seed):
    with pytest.raises(ConfigError, match=(
            r'rig_linear\.yaml: seed = .*, must be a whole number >= 0 and <= '
            '9223372036854775807')):
        rig(0.05).replace({'seed': seed})


def test_a_delay_between_two_conversions_is_refused():
    with pytest.raises(ConfigError, match=(
            r'rig_linear\.yaml: actuators\.ram: plant\.sensors\.force\.delay_ms = 0\.25 ms, must '
            r'be <= 12\.7 ms and a multiple of 0\.1 ms')):
        rig(0.05).replace(of_channels('delay_ms', {'force': 0.25}))


def disturbed_leg(seed: int = 3) -> isa_ros.Run:
    """Return the falling leg with every error on, and two inertial units."""
    own = 'actuators.kfe.parameters.plant.sensors'
    return isa_ros.load('leg', 'drop', duration=0.12, seed=seed).replace({
        **{f'actuators.{name}.variants': ['data_sheet_sensors'] for name in ('haa', 'hfe', 'kfe')},
        f'{own}.force.delay_ms': 0.3, f'{own}.force.drift_per_s': 50.0,
        f'{own}.pressure_b.stuck': 1.0,
        'leg.imus': {'trunk': {'link': 'slider_link', 'accelerometer_sigma': 0.03},
                     'kfe': {'link': 'thigh', 'x_mm': 300.0, 'rate_hz': 1000.0,
                             'gyro_sigma': 6e-4}}})


def test_a_saved_state_continues_the_noise(tmp_path):
    """Delay lines, drift, noise and the readings that stay, from the middle of a run."""
    first, second = disturbed_leg().simulation(), disturbed_leg().simulation()
    for _ in range(57):
        first.step()
    second.restore(first.snapshot())
    for _ in range(60):
        first.step()
        second.step()
    assert second.snapshot() == first.snapshot()


def test_a_bag_with_noise_replays_byte_for_byte(tmp_path):
    bag = disturbed_leg().simulate().save(tmp_path / 'bag')
    assert_replays(bag)
    seen, result = read_signals(bag), disturbed_leg().simulate()
    assert seen.unit('body.trunk_specific_force') == 'm/s2'
    for name, period in (('trunk', 10), ('kfe', 1)):
        for field in ('specific_force', 'angular_velocity'):
            trace = seen.over_time(f'body.{name}_{field}')
            assert (trace.values == result[f'body.{name}_{field}'][::period]).all()
            assert (trace.t == seen.time[::period]).all()


def test_another_seed_is_another_run(tmp_path):
    """The provenance has the seed."""
    from isa_ros.bag.reader import Bag
    bags = [disturbed_leg(seed).simulate().save(tmp_path / f'bag_{seed}') for seed in (3, 4)]
    assert [Bag(bag).provenance.seed for bag in bags] == [3, 4]
    forces = [read_signals(bag)['kfe.force'] for bag in bags]
    assert (forces[0] != forces[1]).mean() > 0.5


@pytest.mark.parametrize('model', MODELS)
def test_levels_of_data_sheets_are_derived_from_the_ranges(model):
    """1.1 codes of noise; zero errors of 0.05 % (force), 0.15 % (pressure) and 1.5 codes."""
    sensors = actuator_sheet(model, 'default', 'data_sheet_sensors').plant.sensors
    pressure = sensors.pressure_range_mpa * 1e6
    levels = {
        'force': (2.0 * sensors.force_range, 0.05e-2 * sensors.force_range),
        'pressure_a': (pressure, 0.15e-2 * pressure), 'pressure_b': (pressure, 0.15e-2 * pressure),
        'spool': (2e-3 * sensors.spool_range_mm, 1.5 * 2e-3 * sensors.spool_range_mm / 4096),
        'current': (2e-3 * sensors.current_range_ma, 1.5 * 2e-3 * sensors.current_range_ma / 4096)}
    for name, (span, bias) in levels.items():
        channel = getattr(sensors, name)
        # Two digits are written: 4 % of 1.3e-7, half of the last one.
        assert channel.sigma == pytest.approx(1.1 * span / 4096, rel=0.04, abs=0.0)
        assert channel.bias == pytest.approx(bias, rel=0.04, abs=0.0)
    assert (sensors.position.delay_ms, sensors.position.sigma) == (0.1, 0.0)


SUPPLY = [('bias', {'bias': -2e6}), ('noise', {'sigma': 1e5}), ('drift', {'drift_per_s': 1e6}),
          ('stuck', {'stuck': 1.0}), ('delay', {'delay_ms': 3.0}), ('scale', {'scale': 0.5})]


@pytest.mark.parametrize(('kind', 'values'), SUPPLY)
def test_the_sensor_of_the_supply_errs_alone(kind: str, values: dict[str, float]) -> None:
    """What the REU reads changes, and in a run without a stop nothing else."""
    pump = {'supply.pressure_mpa': 18.0, 'supply.return_pressure_mpa': 0.0}
    changes = [{'t_s': 0.1, 'supply': 'supply', 'set': {'pressure_mpa': 16.0}}]
    ideal = rig(0.2).replace(pump).simulate(faults=changes)
    assert set(ideal['ram.supply_pressure']) == {18e6, 16e6}
    own = rig(0.2).replace(pump | {
        f'{SENSORS}.supply.{key}': value for key, value in values.items()}).simulate(
            faults=changes)
    read, exact = own['ram.supply_pressure'][1:], ideal['ram.supply_pressure'][1:]
    if kind == 'bias':
        assert read == pytest.approx(exact - 2e6)
    elif kind == 'scale':
        assert read == pytest.approx(0.5 * exact)
    elif kind == 'noise':
        assert 0.7e5 < (read - exact).std() < 1.3e5
    elif kind == 'drift':   # 1 MPa/s, from the first conversion on
        assert read - exact == pytest.approx(1e6 * own.time[1:], abs=200.0)
    elif kind == 'stuck':
        assert set(read) == {18e6}
    else:
        assert (read[3:] == exact[:-3]).all()
    for name in (*CHANNELS, 'supply_flow', 'chamber_pressure_a'):
        assert (own[f'ram.{name}'] == ideal[f'ram.{name}']).all()


@pytest.mark.parametrize(('values', 'condition', 'after_s'), [
    ({'plant.sensors.supply.lost': 1}, 'sensor_range', 0.002),
    ({'plant.sensors.supply.bias': -17e6}, 'supply_low', 0.01),
    ({'fault': 'supply_sensor_lost'}, 'sensor_range', 0.002)])
def test_the_conditions_judge_what_the_sensor_of_the_supply_reads(
        values: dict[str, float], condition: str, after_s: float, tmp_path: Path) -> None:
    """And a replay does as well."""
    given = values if 'fault' in values else {'set': values}
    with pytest.warns(TripWarning):
        result = isa_ros.load('rig_linear').simulate(
            0.1, faults=[{'t_s': 0.05, 'actuator': 'ram'} | given])
    assert result.trips[0].condition == condition
    assert result.trips[0].t_s == pytest.approx(0.05 + after_s, abs=2e-4)
    assert_replays(result.save(tmp_path / 'bag'))
