"""Accounts of oil and energy from the rows of a run."""

from isa_ros.core.accounts import accounts_of, ENERGY, MEAN, OIL, PEAK, PUMP, SHARES
from isa_ros.core.signals import SAMPLE
from isa_ros.surroundings.supply import SUPPLY_SAMPLE
import numpy as np


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


def test_at_the_start_there_is_no_mean():
    found = accounts_of(['hip'], np.zeros(1, SAMPLE), [], np.zeros(0, SUPPLY_SAMPLE), 0)
    assert found['hip'][MEAN.key] == 0.0
