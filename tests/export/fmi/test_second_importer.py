"""libcosim, the library of the Open Simulation Platform: a unit in a second importer."""

import math

from isa_ros.export.fmi.description import Version
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import numpy as np
import pytest
from tests.export.fmi.runs import OF_SUPPLY, SAMPLED

Execution = pytest.importorskip('libcosimpy.CosimExecution').CosimExecution
Manipulator = pytest.importorskip('libcosimpy.CosimManipulator').CosimManipulator
Observer = pytest.importorskip('libcosimpy.CosimObserver').CosimObserver
Slave = pytest.importorskip('libcosimpy.CosimSlave').CosimLocalSlave
fmpy = pytest.importorskip('fmpy')

pytestmark = pytest.mark.slow
STEP_NS = 1_000_000


def setpoint(k):
    """Return position (m), velocity (m/s) and effort (N) of a tick."""
    t = 1e-3 * k
    return 0.05 + 0.004 * math.sin(20.0 * t), 0.08 * math.cos(20.0 * t), 200.0 * math.sin(7.0 * t)


def test_every_output_in_libcosim_is_that_of_the_run(cases):
    case = cases('accumulator')
    path = case.paths[Version.FMI2]
    variables = {own.name: own for own in fmpy.read_model_description(str(path)).modelVariables}
    names = [name for name in (*SAMPLED, *OF_SUPPLY) if variables[name].type == 'Real']
    references = [variables[name].valueReference for name in names]
    execution = Execution.from_step_size(step_size=STEP_NS)
    at = execution.add_local_slave(Slave(fmu_path=str(path), instance_name='ram'))
    observer, manipulator = Observer.create_last_value(), Manipulator.create_override()
    assert execution.add_observer(observer) and execution.add_manipulator(manipulator)
    inputs = [variables[f'setpoint.{name}'].valueReference
              for name in ('position', 'velocity', 'effort')]
    simulation = Simulation(idle(case.run.configuration))
    rows = simulation.samples['ram'], simulation.supply_samples['supply']
    for k in range(200):
        position, velocity, effort = setpoint(k)
        simulation.command('ram', position=position, velocity=velocity, effort=effort)
        simulation.step()
        assert manipulator.slave_real_values(at, inputs, setpoint(k))
        assert execution.step()
        expected = [float(rows[name not in SAMPLED][{**SAMPLED, **OF_SUPPLY}[name]])
                    for name in names]
        assert np.array(observer.last_real_values(at, references)).tobytes() == np.array(
            expected).tobytes(), k
    assert rows[0]['position'] != 0.05 and len(names) >= 50
