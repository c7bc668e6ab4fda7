"""Accounts of oil and energy from the rows of a run."""

from isa_ros.core.accounts import (
    accounts_of, ENERGY, HELD, MEAN, OIL, PEAK, PUMP, RETURN, RETURNED, SHARES, SUPPLY_SHARES)
from isa_ros.core.signals import SAMPLE
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
import numpy as np
import pytest


def test_an_account_has_the_fields_of_its_row():
    samples, supplies = np.zeros(2, SAMPLE), np.zeros(1, SUPPLY_SAMPLE)
    samples[1]['supply_volume'], samples[1]['hydraulic_energy'] = 2e-4, 300.0
    samples[1]['throttling_energy'], samples[1]['peak_power'] = 120.0, 900.0
    supplies[0]['drawn'], supplies[0]['energy'], supplies[0]['pump_energy'] = 1e-3, 40.0, 50.0
    found = accounts_of(['hip', 'knee'], samples, ['supply'], supplies, 1_500_000_000)
    assert list(found) == ['hip', 'knee', 'supply']
    knee, supply = found['knee'], found['supply']
    assert knee[OIL.key] == 0.2 and knee['oil drawn (l)'] == 0.2
    assert knee[MEAN.key] == 200.0 and knee[PEAK.key] == 900.0
    assert knee['throttling (J)'] == 120.0
    assert supply[PUMP.key] == 50.0 and supply[OIL.key] == 1.0
    assert set(found['hip'].values()) == {0.0}
    assert {entry.key for entry in SHARES} < set(knee) and ENERGY.key in knee
    assert {PUMP.key, HELD.key, *(entry.key for entry in SUPPLY_SHARES)} < set(supply)


def test_an_account_has_what_was_returned_and_what_the_chambers_hold():
    samples, supplies = np.zeros(1, SAMPLE), np.zeros(1, SUPPLY_SAMPLE)
    samples['return_volume'], samples['chamber_pressure_a'] = 3e-4, -0.1e6
    samples['chamber_pressure_b'], samples['cavity_a'] = 7e6, 2e-6
    samples['cavity_b'], samples['largest_cavity'] = 1e-6, 5e-6
    supplies['returned'], supplies['return_energy'], supplies['held_energy'] = 4e-4, 5.0, 6.0
    found = accounts_of(['hip'], samples, ['supply'], supplies, 1_000_000_000)
    hip, supply = found['hip'], found['supply']
    assert hip[RETURNED.key] == pytest.approx(0.3) and hip['oil returned (l)'] == hip[RETURNED.key]
    assert (hip['pressure A (MPa)'], hip['pressure B (MPa)']) == (-0.1, 7.0)
    assert [hip[f'{name} (ml)'] for name in ('cavity A', 'cavity B', 'largest cavity')] == (
        pytest.approx([2.0, 1.0, 5.0]))
    assert supply[RETURNED.key] == pytest.approx(0.4)
    assert (supply[RETURN.key], supply[HELD.key]) == (5.0, 6.0)


def test_at_the_start_there_is_no_mean():
    found = accounts_of(['hip'], np.zeros(1, SAMPLE), [], np.zeros(0, SUPPLY_SAMPLE), 0)
    assert found['hip'][MEAN.key] == 0.0
