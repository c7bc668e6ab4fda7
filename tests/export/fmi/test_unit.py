"""The life of a unit: phases, steps, time, types and constants; as fmpy sees it."""

from ctypes import byref

import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.asserted import refused  # noqa: E402
from tests.export.fmi.importing import ERROR, STEP, Unit  # noqa: E402

pytestmark = pytest.mark.slow


def test_fmpy_finds_no_problem(case, version):
    from fmpy.validation import validate_fmu
    assert validate_fmu(str(case.paths[version])) == []


def test_a_step_that_is_no_multiple_of_the_tick_is_not_made(make):
    unit = make()
    unit.set({'setpoint.position': 0.06})
    unit.step(30)
    before = unit.state()
    for size in (0.0015, 0.0, -0.001, 0.0009999, 1e-9, float('nan'), float('inf'), 1e12):
        refused(unit, ERROR, ', must be a multiple of the tick, 0.001 s', unit.slave.doStep,
                unit.t, size)
    assert unit.state() == before
    unit.slave.doStep(unit.t, 0.002 + 1e-12)    # as sums of times have it
    assert unit.reached == pytest.approx(0.032)


def test_a_step_from_another_time_is_not_made(make):
    unit = make()
    unit.step(3)
    refused(unit, ERROR, 'a step from t = 0.01 s, must be from 0.003 s', unit.slave.doStep,
            0.01, STEP)
    refused(unit, ERROR, 'a step from t = 0.002 s, must be from 0.003 s', unit.slave.doStep,
            0.002, STEP)
    assert unit.reached == 0.003


def test_a_step_of_many_ticks_is_as_many_steps(make):
    unit, other = make(), make()
    for own, sizes in ((unit, [1] * 40), (other, [7, 1, 30, 2])):
        own.set({'setpoint.position': 0.07, 'setpoint.stiffness': 1e5})
        for size in sizes:
            own.step(size)
    assert unit.state() == other.state()
    assert unit.get('position') == other.get('position') != 0.05


def test_time_begins_where_the_importer_says(make):
    unit = make(begin=2.5)
    assert unit.reached == 2.5
    unit.step(10)
    assert unit.reached == 2.51
    found = unit.slave.doStep(2.51, 4 * STEP)
    assert found == ((False, False, False, 2.514) if unit.is_3 else None)


def test_phases_are_in_their_order(make):
    unit = make(waits=True)
    refused(unit, ERROR, 'a step is not possible before its initialization', unit.slave.doStep,
            0.0, STEP)
    refused(unit, ERROR, 'to end the initialization is not possible before its initialization',
            unit.slave.exitInitializationMode)
    unit.initialise()
    refused(unit, ERROR, 'after its initialization', unit.slave.enterInitializationMode)
    unit.step()
    unit.slave.terminate()
    refused(unit, ERROR, 'a step is not possible when it has ended', unit.slave.doStep, unit.t,
            STEP)
    assert unit.reached == 0.001


def test_the_token_of_another_unit_is_refused(case, version, tmp_path):
    unit = Unit(case.paths[version], tmp_path / 'unit', waits=True)
    token = unit.slave.guid
    unit.slave.guid = f'{token[:-1]}_'
    with pytest.raises(Exception, match='[Ii]nstantiate'):
        unit.instantiate()
    assert unit.messages == [
        (ERROR, f'another token (guid) than {token} is not possible with this unit')]
    unit.slave.guid = token
    unit.instantiate()
    assert len(unit.messages) == 1


def test_what_is_no_cosimulation_is_refused_when_it_is_made(make):
    unit = make(waits=True)
    library, token = unit.slave.dll, unit.slave.guid.encode()

    def made(function, *given):
        return function(*given, *(kind() for kind in function.argtypes[len(given):]))
    asked = {'model exchange': lambda: library.fmi2Instantiate(
        b'one', 0, token, b'', byref(unit.callbacks), 0, 0)}
    if unit.is_3:
        named, logged = (b'one', token, b'', False, False), (None, unit.callbacks)
        asked = {
            'model exchange': lambda: made(
                library.fmi3InstantiateModelExchange, *named, *logged),
            'scheduled execution': lambda: made(
                library.fmi3InstantiateScheduledExecution, *named, *logged),
            'event mode': lambda: made(
                library.fmi3InstantiateCoSimulation, *named, True, False, None, 0, *logged),
            'an intermediate update': lambda: made(
                library.fmi3InstantiateCoSimulation, *named, False, False, None, 1, *logged)}
    for what, make_it in asked.items():
        assert not make_it()
        assert unit.messages.pop() == (ERROR, f'{what} is not possible with this unit')
    assert not unit.messages


def test_types_and_references_are_checked(make):
    unit = make()
    real, whole = unit.variables['position'], unit.variables['trips']
    getter = unit.slave.getInt32 if unit.is_3 else unit.slave.getInteger
    read = unit.slave.getFloat64 if unit.is_3 else unit.slave.getReal
    refused(unit, ERROR, 'position is a number, must be a whole number', getter,
            [real.valueReference])
    refused(unit, ERROR, 'trips is a whole number, must be a number', read,
            [whole.valueReference])
    most = max(own.valueReference for own in unit.variables.values()) + 1 + (not unit.is_3)
    for beyond in (most, 9999):
        refused(unit, ERROR, f'value reference {beyond}, must be < {most}', read, [beyond])
    write = unit.slave.setFloat64 if unit.is_3 else unit.slave.setReal
    for name in ('position', 'supply.pressure', 'plant.drive.bore_mm'):
        refused(unit, ERROR, f'{name} is computed or constant, it cannot be set', write,
                [unit.variables[name].valueReference], [0.02])


def test_constants_are_those_of_the_listing(make, case):
    unit = make()
    for row, value in case.chosen.parameters():
        assert unit.get(row.parameter) in (
            value, value.encode() if isinstance(value, str) else value), row.parameter
    assert unit.get('supply.gas_volume_l') == 0.2
    assert unit.get('plant.drive.bore_mm') > 1.0
