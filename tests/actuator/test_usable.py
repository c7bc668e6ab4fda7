"""Gains that no loop can use: one count of the sensor demands the whole output."""

from dataclasses import replace

from isa_ros.actuator.link import NO_LINK
from isa_ros.actuator.sheet import ActuatorSheet, ROUNDED
from isa_ros.actuator.tunable import changing, refuse_unusable, tunables, with_changed
from isa_ros.actuator.usable import RELAY, usable
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.core.record import row_record, rows_of
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.plant.sensors import sensors_record
from isa_ros.reu.block import block_record, BLOCK_STATE, block_step
from isa_ros.reu.compensation import Linear
from isa_ros.reu.filters import speed_record, SPEED_STATE, speed_step
from isa_ros.reu.schedule import POINTS
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override

EVERY = [(name, variant) for name in model_names()
         for variant in ('', *actuator_model(name, 'test').variants)]


@pytest.mark.parametrize('model', MODELS)
def test_at_the_bound_one_count_saturates_the_block_and_at_half_of_it_does_not(model):
    """u_max / q, with the block itself: K_p alone, linear, at rest."""
    sheet = actuator_sheet(model)
    force, count = sheet.reu.force, float(sensors_record(sheet.plant.sensors)['force_step'])
    largest = usable(sheet)['reu.force.kp'].bounds['le']
    outputs = []
    for kp in (largest, 0.5 * largest):
        alone = replace(force, kp=kp, ki=0.0, compensation=Linear(), retracting_factor=1.0)
        row = row_record(np.array([block_record(alone, np.ones(POINTS))]))
        state = rows_of(1, BLOCK_STATE)[0]
        block_step(count, 0.0, 0.0, 0.0, 1.0, row, state)
        outputs.append(abs(state.output))
    # A quotient and a product: two roundings of half an ulp, at most 2.2e-16 each.
    assert outputs == [
        force.limit, pytest.approx(0.5 * force.limit, rel=4.5e-16, abs=0.0)]


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('gain', ['kp', 'ki'])
def test_a_gain_beyond_it_is_refused_by_configuration_and_parameter(model, gain):
    sheet = actuator_sheet(model)
    beyond = 1.01 * usable(sheet)[f'reu.force.{gain}'].bounds['le']
    refuse_unusable(sheet)
    with pytest.raises(ParameterError, match=f'^reu.force.{gain} = .*one count of its sensor'):
        refuse_unusable(override(sheet, f'reu.force.{gain}', beyond))
    tunable = tunables(sheet)[f'force.{gain}']
    with pytest.raises(ParameterError, match=f'^force.{gain} = .*one count of its sensor'):
        with_changed(sheet, {tunable.name: 1.01 * tunable.bounds['le']})


@pytest.mark.parametrize('model', MODELS)
def test_shipped_gains_are_far_below(model):
    """A hundred counts, the noise of a real sensor, do not fill the output either."""
    gains = [own for name, own in tunables(actuator_sheet(model)).items()
             if own.doc.endswith(RELAY)]
    assert len(gains) >= 4
    assert all(100.0 * own.value < own.bounds['le'] for own in gains)


@pytest.mark.parametrize(('model', 'variant'), EVERY)
def test_what_is_described_is_what_is_accepted(model, variant):
    """
    Each value that may change, at each end of its range: in force there, refused beyond.

    A level of the protection has its range with the other one off: a warning is before its trip.
    """
    sheet = actuator_sheet(model, 'default', *([variant] if variant else []))
    known = changing(sheet)
    for name, own in known.items():
        if name.endswith('reaction'):
            continue    # one of some names, of which each condition has its own
        part, _, level = name.rpartition('.')
        other = {'warning': 'trip', 'trip': 'warning'}.get(level)
        off = {} if other is None else {f'{part}.{other}': 0.0}
        for end, bound in own.bounds.items():
            inwards = -1.0 if end.startswith('l') else 1.0
            step = 1e-6 * max(abs(bound), abs(own.value))
            if end in ('ge', 'le'):
                with_changed(sheet, off | {name: bound}, known)
            else:
                with_changed(sheet, off | {name: bound + inwards * step}, known)
            with pytest.raises(ConfigError, match=name.rpartition('.')[2]):
                with_changed(sheet, off | {name: bound - inwards * (step or 1e-6)}, known)


def test_the_output_of_a_block_is_what_the_next_one_inwards_can_have():
    """The stop of the spool, or the range of the inner block's sensor."""
    def largest(sheet: ActuatorSheet) -> dict[str, float]:
        return {name: own.bounds['le'] for name, own in tunables(sheet).items()
                if name.endswith(('limit', 'offset'))}
    plain = actuator_sheet('isa_v5')
    stop, pressures = 1.78e-4 * (1.0 + ROUNDED), 25e6   # data sheets print three digits
    assert largest(plain) == {'force.limit': stop, 'force.offset': stop}
    inner = actuator_sheet('isa_v5', 'default', 'pressure_control').reu.pressure
    both = replace(plain, reu=replace(plain.reu, pressure=inner))
    assert largest(both) == {
        'force.limit': pressures, 'force.offset': pressures,
        'pressure.limit': stop, 'pressure.offset': stop}
    explicit = largest(actuator_sheet('isa_v5', 'default', 'explicit'))
    assert explicit['spool.limit'] == 12.5e-3   # of the current sensor


def test_a_gain_on_a_speed_has_the_bound_of_one_count_through_its_filter():
    """F / (alpha q f): the speed that one count of the encoder shows at first."""
    sheet = actuator_sheet('isa_v5')
    state = rows_of(1, SPEED_STATE)[0]
    row = row_record(np.array([speed_record(sheet.reu.speed)]))
    count = float(sensors_record(sheet.plant.sensors)['encoder'])
    speed_step(count, row, state)
    assert state.velocity * tunables(sheet)['position.damping'].bounds['le'] == pytest.approx(
        max(sheet.reu.position.force_out, sheet.reu.position.force_in), rel=1e-12)


def test_without_a_link_its_values_do_not_change():
    known = changing(actuator_sheet('isa_v5'))
    values = ('delay_cycles', 'jitter_us', 'loss', 'burst_loss', 'burst_frames', 'duplicates',
              'reordered')
    assert {name: own.bounds for name, own in known.items() if name.startswith('link.')} == {
        f'link.{value}': {'ge': 0.0, 'le': 0.0} for value in values}
    linked = replace(actuator_sheet('isa_v5'), link=replace(NO_LINK, kind='ethercat'))
    assert changing(linked)['link.loss'].bounds == {'ge': 0.0, 'le': 1.0}
