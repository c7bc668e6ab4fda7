"""An actuator that its losses heat: the balance, its sample, saved states, and its limits."""

from dataclasses import replace

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.signals import LOAD_PORT
from isa_ros.errors import ParameterError
from isa_ros.loads.sheets import Mass
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import refuse_too_fast
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override, own_load, setpoint, smart_actuator, TICK

LOSSES = ('leakage', 'throttling', 'cross_port', 'relief', 'friction', 'damping')


def heated(model: str, **changed: float) -> ActuatorSheet:
    """Return the sheet of a model with its variant `thermal`."""
    sheet = actuator_sheet(model, 'default', 'thermal')
    for name, value in changed.items():
        sheet = override(sheet, f'plant.thermal.{name}', value)
    return sheet


def moved(model: str, ticks: int, **changed: float) -> SmartActuator:
    """Return an actuator after some ticks back and forth on its wheel."""
    actuator = smart_actuator(model, 'wheel', timing=TICK, sheet=heated(model, **changed))
    move(actuator, ticks)
    return actuator


def move(actuator: SmartActuator, ticks: int) -> None:
    middle = 0.5 * actuator._config.sheet.plant.drive.stroke
    for _ in range(ticks):
        phase = actuator.t_ns * 1e-9 * 20.0
        actuator.accept(setpoint(position=middle * (1.0 + 0.5 * np.sin(phase))))
        actuator.tick()


@pytest.mark.parametrize('model', MODELS)
def test_heat_of_the_losses_is_stored_or_carried_away(model: str) -> None:
    """Of 2000 ticks, within 1e-9 of the heat; and it is that of the energies in the sample."""
    actuator = moved(model, 2000, start_celsius=30.0)
    own, state = actuator.memory.constants['plant']['thermal'][0], actuator.memory.thermals[0]
    stored = (own['oil_capacity'] * (state['oil'] - 30.0)
              + own['body_capacity'] * (state['body'] - 30.0))
    remainder = state['heat'] - stored - state['to_oil'] - state['to_air']
    assert abs(remainder) <= 1e-9 * state['heat']
    assert state['heat'] > 10.0
    losses = sum(float(actuator.sample[f'{name}_energy']) for name in LOSSES)
    coil = state['heat'] - losses   # at most 24 V at 10 mA over 2 s
    assert 0.0 < coil < 0.48


def test_an_explicit_coil_heats_with_its_current() -> None:
    """R i^2 t of the current that holds the mean of a constant one."""
    sheet = actuator_sheet('isa_v5', 'default', 'explicit', 'valve_amplifier', 'thermal')
    actuator = smart_actuator('isa_v5', 'blocked', timing=TICK, sheet=sheet)
    actuator.accept(setpoint(effort=2e-3))
    for _ in range(50):
        actuator.tick()
    coil = actuator.memory.constants['plant']['coil'][0]
    before = actuator.memory.thermals['heat'][0] - _losses(actuator)
    for _ in range(100):
        actuator.tick()
    heat = actuator.memory.thermals['heat'][0] - _losses(actuator) - before
    current = float(actuator.memory.continuous['plant']['coil']['current'][0])
    assert current > 2e-3
    assert heat == pytest.approx(coil['resistance'] * current * current * 0.1, rel=1e-2)


def test_oil_that_is_refilled_from_the_return_cools() -> None:
    """T4: torn open, the chamber takes oil of the supply's temperature from the return."""
    sheet = heated('isa_v5', start_celsius=70.0, supply_celsius=20.0, ambient_celsius=70.0)
    for share in ('plant.valve.null_leakage_lpm', 'plant.valve.tare_leakage_lpm'):
        sheet = override(sheet, share, 1e-6)
    actuator = smart_actuator(
        'isa_v5', Mass(inertia=50.0, force=8000.0), timing=TICK, sheet=sheet, position=0.02)
    cooled = 0.0
    state = actuator.memory.thermals[0]
    for _ in range(60):
        before = float(state['to_oil']), float(state['oil'])
        actuator.tick()
        reply = actuator.reply
        if reply.return_volume < 0.0:
            # the mean of the temperature is that of both ends, to the square of a tick
            mean = 0.5 * (before[1] + float(state['oil']))
            own = actuator.memory.constants['plant']['thermal'][0]
            inflow = max(0.0, float(reply.supply_volume)) - float(reply.return_volume)
            assert float(state['to_oil']) - before[0] == pytest.approx(
                own['per_volume'] * inflow * (mean - 20.0), rel=1e-3, abs=0.0)
            cooled += -float(reply.return_volume)
    assert cooled > 1e-7


def _losses(actuator: SmartActuator) -> float:
    return sum(float(actuator.sample[f'{name}_energy']) for name in LOSSES)


def test_the_sample_has_the_temperature_of_the_oil() -> None:
    actuator = moved('isa_v5', 50)
    assert actuator.sample['temperature'] == actuator.memory.thermals['oil'][0] > 40.0


def test_without_the_model_the_oil_keeps_the_temperature_of_the_sheet() -> None:
    sheet = override(actuator_sheet('isa_v5'), 'plant.oil.temperature_celsius', 55.0)
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet)
    constants = actuator.memory.constants.tobytes()
    assert actuator.sample['temperature'] == 55.0
    move(actuator, 20)
    assert actuator.sample['temperature'] == 55.0
    assert actuator.memory.constants.tobytes() == constants


def test_a_restored_actuator_continues_byte_for_byte() -> None:
    """Also one whose constants are those of another temperature."""
    actuator, twin = moved('isa_v5', 300), moved('isa_v5', 7, start_celsius=40.0)
    twin.restore(actuator.snapshot())
    for one in (actuator, twin):
        move(one, 100)
    assert twin.snapshot() == actuator.snapshot()
    assert twin.memory.constants.tobytes() == actuator.memory.constants.tobytes()


def test_a_started_actuator_begins_at_its_temperature_again() -> None:
    actuator, fresh = moved('isa_v5', 100), moved('isa_v5', 0)
    start = (0.05, 0.0, 20.7e6, 0.0)
    for one in (actuator, fresh):
        one.start(*start)
        move(one, 50)
    assert actuator.snapshot() == fresh.snapshot()


def test_actuators_together_get_as_warm_as_alone() -> None:
    """Rows of one memory, of which one is not heated."""
    sheets = [heated(model) for model in MODELS]
    sheets[1] = actuator_sheet(MODELS[1])
    configs = [ActuatorConfig(model, model, 'default', sheet, own_load(model, 'mass'),
                              0.5 * sheet.plant.drive.stroke)
               for model, sheet in zip(MODELS, sheets)]
    group = ActuatorGroup(configs, TICK)
    alone = [SmartActuator(config, TICK) for config in configs]
    ports = np.zeros(len(configs), LOAD_PORT)
    ports['supply_pressure'] = 20.7e6
    for _ in range(50):
        group.advance(ports)
        for own in alone:
            own.tick()
    for row, own in enumerate(alone):
        assert group.samples[row].tobytes() == own.memory.samples[0].tobytes()
    assert list(group.samples['temperature'] > 40.0) == [True, False, True]


def test_a_temperature_at_which_the_plant_is_too_fast_is_refused() -> None:
    """At -30 celsius VG 46 is 130 times thicker than at 40."""
    sheet = override(heated('isa_v5'), 'plant.friction.viscous', 1e3)
    refuse_too_fast(plant_record(sheet.plant)[0], sheet.plant, LoadSide())
    cold = replace(sheet, plant=replace(sheet.plant, thermal=replace(
        sheet.plant.thermal, ambient_celsius=-30.0)))
    with pytest.raises(ParameterError) as refused:
        refuse_too_fast(plant_record(cold.plant)[0], cold.plant, LoadSide())
    message = str(refused.value)
    assert 'plant.friction.viscous = 1000 Ns/m, must be <= ' in message
    assert message.endswith(', for the plant step of 20 us with oil at -30 celsius')
