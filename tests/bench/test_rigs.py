"""The run files of the growth."""

from isa_ros.bench.rigs import request_of
from isa_ros.bench.spec import LEG, ONE_PROCESS, PROCESSES, QUADRUPED, Spec
from isa_ros.config.runs.run_file import load_run
from isa_ros.scenario.scenario import load_scenario


def test_twelve_actuators_are_four_legs_on_loads_of_their_own(tmp_path):
    request = request_of(Spec('12', PROCESSES, 250), tmp_path)
    run = load_run(request.config)
    assert [actuator.name for actuator in run.actuators] == [
        f'{joint}_{leg}' for leg in (1, 2, 3, 4) for joint in ('haa', 'hfe', 'kfe')]
    assert [a.model for a in run.actuators[:3]] == ['smart_manifold', 'isa_v5', 'isa_v5']
    assert all(actuator.load is not None for actuator in run.actuators)
    assert (request.duration_s, request.in_process) == (0.25, False)


def test_the_leg_is_the_shipped_one_in_its_drop(tmp_path):
    request = request_of(Spec(LEG, ONE_PROCESS, 250), tmp_path)
    assert (request.config.name, request.scenario.name) == ('leg.yaml', 'drop.yaml')
    assert request.in_process


def test_the_quadruped_trots_with_its_controller(tmp_path):
    request = request_of(Spec(QUADRUPED, PROCESSES, 250), tmp_path)
    assert (request.config.name, request.scenario.name) == (
        'quadruped.yaml', 'quadruped_trot.yaml')
    scenario = load_scenario(request.scenario, load_run(request.config))
    assert [own.name for own in scenario.run.called] == ['trot']
    assert str(Spec(QUADRUPED, PROCESSES, 250)) == 'the quadruped, processes'
