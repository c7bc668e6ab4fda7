"""Four control blocks: valid sets, and their rates."""

from dataclasses import replace

from isa_ros.errors import ConfigError
from isa_ros.reu.compensation import DeadBand, Linear
from isa_ros.reu.wiring import active, delay_steps, loop_steps, NEVER, Off, refuse_nonsense
import pytest
from tests.sheets import actuator_sheet, MODELS, override


def test_periods_in_plant_steps():
    """1, 5, 5 and 10 kHz are 50, 10, 10 and 5 steps of 20 us (paper Fig 7)."""
    assert loop_steps(actuator_sheet('isa_v5').reu) == {
        'speed': 50, 'position': 50, 'force': 10, 'pressure': NEVER, 'spool': 10, 'current': 5}


@pytest.mark.parametrize(('model', 'blocks'), [
    ('smart_manifold', ['position', 'force', 'current']),
    ('isa_v2', ['position', 'force', 'current']),
    ('isa_v5', ['position', 'force', 'spool', 'current']),
])
def test_shipped_actuators_have_the_blocks_of_figure_7(model, blocks):
    """Figure 7 A and B."""
    assert list(active(actuator_sheet(model).reu)) == blocks


def test_a_plain_valve_amplifier_has_one_block():
    """Section 3: it may be the valve current loop alone."""
    for model in MODELS:
        reu = actuator_sheet(model, 'default', 'valve_amplifier').reu
        refuse_nonsense(reu)
        assert list(active(reu)) == ['current']


def test_a_fifth_block_is_refused():
    """The standard firmware provides four (paper section 3)."""
    reu = actuator_sheet('isa_v5').reu
    with pytest.raises(ConfigError, match='5 control blocks are on .* must be <= 4'):
        refuse_nonsense(replace(reu, pressure=reu.force))


def test_an_impedance_needs_a_force_block():
    """Its output is a force reference."""
    with pytest.raises(ConfigError, match='impedance .* reu.force.kind is off'):
        refuse_nonsense(replace(actuator_sheet('isa_v5').reu, force=Off()))


def test_a_linearising_block_needs_the_valve_inside():
    """Its output is an opening, not a pressure."""
    plain = actuator_sheet('smart_manifold').reu
    reu = actuator_sheet('smart_manifold', 'default', 'feedback_linearisation').reu
    refuse_nonsense(reu)
    with pytest.raises(ConfigError, match='feedback_linearisation .* set reu.pressure.kind: off'):
        refuse_nonsense(replace(reu, position=Off(), pressure=plain.force))


def test_only_the_block_that_commands_the_valve_inverts_its_flow_curve():
    """Neither a force reference nor the pilot's current has a knee at 1.2 mA."""
    reu = actuator_sheet('smart_manifold').reu
    linear = replace(reu.force, compensation=Linear())
    refuse_nonsense(replace(reu, force=linear, pressure=reu.force))
    with pytest.raises(ConfigError, match='reu.force.compensation.* which reu.pressure commands'):
        refuse_nonsense(replace(reu, pressure=linear))
    reu = actuator_sheet('isa_v5', 'default', 'explicit').reu
    with pytest.raises(ConfigError, match='reu.spool.compensation.* which reu.force commands'):
        refuse_nonsense(replace(reu, spool=replace(
            reu.spool, compensation=reu.force.compensation)))
    with pytest.raises(ConfigError, match='reu.spool.compensation.* which no block commands'):
        refuse_nonsense(replace(reu, position=Off(), force=Off(), spool=replace(
            reu.spool, compensation=reu.force.compensation)))

    band = DeadBand(overlap=1e-5, transition=1e-6, slope=0.9)
    with pytest.raises(ConfigError, match='compensation.kind = dead_band .* reu.force commands'):
        refuse_nonsense(replace(reu, spool=replace(reu.spool, compensation=band)))


@pytest.mark.parametrize('delay_us', [100.0, 30.0])
def test_a_delay_the_loops_cannot_have_is_refused(delay_us):
    """A whole number of plant steps below the period of the current loop."""
    reu = override(actuator_sheet('isa_v5').reu, 'computation_delay_us', delay_us)
    with pytest.raises(ConfigError, match='multiple of 20 us below 100 us'):
        delay_steps(reu, 5)


@pytest.mark.parametrize(('rates', 'message'), [
    ({'position': 3000.0}, r'position.rate_hz = 3000 Hz, .* whole nanoseconds'),
    ({'current': 8000.0}, r'current.rate_hz = 8000 Hz = 0.125 ms, .* plant step 0.02 ms'),
    ({'force': 1250.0, 'spool': 1250.0},
     r'position.rate_hz = 1000 Hz does not divide force.rate_hz = 1250 Hz'),
])
def test_rates_that_do_not_divide_are_refused(rates, message):
    """The message has both rates, or the rate and the step."""
    reu = actuator_sheet('isa_v5').reu
    for loop, rate in rates.items():
        reu = override(reu, f'{loop}.rate_hz', rate)
    with pytest.raises(ConfigError, match=message):
        loop_steps(reu)
