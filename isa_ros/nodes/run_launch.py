"""
One run under launch: the nodes of every actuator of a configuration, and the coordinator.

Bodies with a URDF are also shown, with their sensors: by robot_state_publisher where that
is installed, one each, and with ``rviz:=true`` the only one by rviz. ``ros2_control:=FILE`` starts
the controllers of a parameter file for the only one.
"""

from collections.abc import Container, Iterable
from functools import partial
import os
from pathlib import Path
from typing import Any

from ament_index_python import packages as ament_packages
from isa_ros.config.paths import CONFIG, CONTROLLERS, find, find_drawing, SCENARIOS
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.body_control import control_tag, controllers_of, MANAGER, Ros2Controllers
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import changes_of
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.domain import Claim, CLAIMED_BY
from isa_ros.processes.launching import refuse_failure
from isa_ros.processes.processes import Process, run_processes
from isa_ros.run.option import flag, namespace
from isa_ros.run.options import launched_elsewhere, launched_parameters, OPTIONS
from launch import (  # type: ignore[attr-defined]  # mypy takes the folder of the launch files
    Action, LaunchContext, LaunchDescription)
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.events.process import ProcessExited
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

PUBLISHER = 'robot_state_publisher'


def launched_run(**defaults: str) -> LaunchDescription:
    """Return the arguments and the nodes; ``defaults`` of arguments, by name."""
    return LaunchDescription([
        *(DeclareLaunchArgument(
            option.name, default_value=defaults.get(option.name, option.launch_text),
            description=option.description) for option in OPTIONS),
        DeclareLaunchArgument(
            'rviz', default_value='false', description='true: show the only body in rviz'),
        DeclareLaunchArgument(
            'ros2_control', default_value='',
            description='parameter file of the controllers to start, or a shipped one by name'),
        OpaqueFunction(function=_nodes)])


def _nodes(context: LaunchContext) -> list[Node]:
    values = {option.name: LaunchConfiguration(option.name).perform(context)
              for option in OPTIONS}
    config = find(values['config'], CONFIG)
    scenario = find(values['scenario'], SCENARIOS) if values['scenario'] else None
    own, parameters = namespace(values['namespace']), launched_parameters(values)
    texts: Any = parameters.get('set', [])
    run = load_run(config, changes_of(texts).run)
    has_rviz = flag('rviz', LaunchConfiguration('rviz').perform(context))
    named = LaunchConfiguration('ros2_control').perform(context)
    controllers = find(named, CONTROLLERS) if named else None
    processes = run_processes(
        run, config, scenario, parameters, launched_elsewhere(values))
    viewers = _viewers(run, config.parent, own, has_rviz, controllers)
    claim = Claim(own)  # before anything starts; refused while another run is there
    return [*viewers, *(_node(process, own, claim) for process in processes)]


def _viewers(
        run: RunConfig, folder: Path, own: str, has_rviz: bool, controllers: Path | None
        ) -> list[Node]:
    """Return the nodes that show and control bodies; their topics are of the run's namespace."""
    above = f'/{own}' if own else ''
    of_run = [(f'/{topic}', f'{above}/{topic}') for topic in ('tf', 'tf_static', 'clock')]
    installed = ament_packages.get_packages_with_prefixes()
    nodes: list[Node] = []
    tags: dict[str, list[str]] = {}
    if controllers is not None:
        given = f'ros2_control:={controllers.name}'
        body = _only(run, given)
        claimed = controllers_of(controllers, body)
        _refuse_missing(installed, given, [PUBLISHER, *claimed.packages])
        tags[body.name] = [*control_tag(body, claimed.commands, own)]
        nodes += _control(
            controllers, claimed, f'{own}/{body.prefix}'.strip('/'), of_run)
    for body in _described(run) if PUBLISHER in installed else ():
        nodes.append(Node(
            package=PUBLISHER, executable=PUBLISHER,
            namespace=f'{own}/{body.prefix}'.strip('/'), parameters=[{
                'robot_description': ParameterValue(
                    run.description(body, folder, tags.get(body.name, [])), value_type=str),
                'use_sim_time': True}], remappings=of_run))
    if has_rviz:
        body = _only(run, 'rviz:=true')
        _refuse_missing(installed, 'rviz:=true', [PUBLISHER, 'rviz2'])
        fixed = ['-f', body.root_frame] if body.root_frame else []
        nodes.append(Node(
            package='rviz2', executable='rviz2', namespace=f'{own}/{body.prefix}'.strip('/'),
            arguments=['-d', str(find_drawing(f'rviz/{body.kind}.rviz')), *fixed],
            parameters=[{'use_sim_time': True}], remappings=of_run))
    return nodes


def _described(run: RunConfig) -> list[BodyConfig]:
    """Return the bodies with a description."""
    return [body for body in run.bodies if body.has_urdf]


def _only(run: RunConfig, given: str) -> BodyConfig:
    bodies = _described(run)
    if len(bodies) != 1:
        raise ConfigError(f'{given}: {run.source} has no body with a URDF, or several')
    return bodies[0]


def _refuse_missing(installed: Container[str], given: str, packages: Iterable[str]) -> None:
    for package in packages:
        if package not in installed:
            raise ConfigError(f'{given} needs the package {package}, not installed')


def _control(
        path: Path, controllers: Ros2Controllers, own: str, of_run: list[tuple[str, str]]
        ) -> list[Node]:
    """Return the controller manager, and what loads and activates its controllers, then ends."""
    return [
        Node(package=MANAGER, executable='ros2_control_node', namespace=own, output='screen',
             parameters=[str(path.resolve()), {'use_sim_time': True}], remappings=of_run,
             on_exit=refuse_failure),
        Node(package=MANAGER, executable='spawner', namespace=own, output='screen',
             arguments=[*controllers.types, '--controller-manager', MANAGER],
             on_exit=refuse_failure)]


def _node(process: Process, own: str, claim: Claim) -> Node:
    is_coordinator = process.executable == 'coordinator'
    namespace, name = process.placed(own)
    return Node(
        package='isa_ros', executable=process.executable, name=name,
        namespace=namespace, output='screen', additional_env={CLAIMED_BY: str(os.getpid())},
        parameters=[{
            key: ParameterValue(list(value), value_type=list[str])
            if isinstance(value, (list, tuple)) else ParameterValue(value, value_type=type(value))
            for key, value in process.parameters}],
        on_exit=partial(_end_of_run, claim) if is_coordinator else refuse_failure)


def _end_of_run(claim: Claim, event: ProcessExited, context: LaunchContext) -> list[Action]:
    """End the launch, and with it the actuators; fail if the run has failed."""
    claim.close()
    refuse_failure(event, context)
    return [Shutdown(reason='the run has ended')]
