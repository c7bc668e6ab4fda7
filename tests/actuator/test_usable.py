"""Gains that no loop can use: one count of the sensor demands the whole output."""

from dataclasses import replace

from isa_ros.actuator.tunable import refuse_unusable, tunables, with_changed
from isa_ros.actuator.usable import largest_gains
from isa_ros.errors import ParameterError
from isa_ros.plant.sensors import sensors_record
from isa_ros.reu.block import block_record, BLOCK_STATE, block_step
from isa_ros.reu.compensation import Linear
from isa_ros.reu.schedule import POINTS
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override


@pytest.mark.parametrize('model', MODELS)
def test_at_the_bound_one_count_saturates_the_block_and_at_half_of_it_does_not(model):
    """u_max / q, with the block itself: K_p alone, linear, at rest."""
    sheet = actuator_sheet(model)
    force, count = sheet.reu.force, float(sensors_record(sheet.plant.sensors)['force_step'])
    largest = largest_gains(sheet)['force.kp']
    outputs = []
    for kp in (largest, 0.5 * largest):
        alone = replace(force, kp=kp, ki=0.0, compensation=Linear(), retracting_factor=1.0)
        row = np.array([block_record(alone, np.ones(POINTS))]).view(np.recarray)[0]
        state = np.zeros(1, BLOCK_STATE).view(np.recarray)[0]
        block_step(count, 0.0, 0.0, 0.0, 1.0, row, state)
        outputs.append(abs(state.output))
    # A quotient and a product: two roundings of half an ulp, at most 2.2e-16 each.
    assert outputs == [
        force.limit, pytest.approx(0.5 * force.limit, rel=4.5e-16, abs=0.0)]


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('gain', ['kp', 'ki'])
def test_a_gain_beyond_it_is_refused_by_configuration_and_parameter(model, gain):
    sheet = actuator_sheet(model)
    beyond = 1.01 * largest_gains(sheet)[f'force.{gain}']
    refuse_unusable(sheet)
    with pytest.raises(ParameterError, match=f'^reu.force.{gain} = .*one count of its sensor'):
        refuse_unusable(override(sheet, f'reu.force.{gain}', beyond))
    tunable = tunables(sheet)[f'force.{gain}']
    with pytest.raises(ParameterError, match=f'^force.{gain} = .*one count of its sensor'):
        with_changed(sheet, {tunable.name: 1.01 * tunable.bounds['le']})


@pytest.mark.parametrize('model', MODELS)
def test_shipped_gains_are_far_below(model):
    """A hundred counts, the noise of a real sensor, do not fill the output either."""
    sheet = actuator_sheet(model)
    values = tunables(sheet)
    assert all(100.0 * values[name].value < largest
               for name, largest in largest_gains(sheet).items())
