"""
What pages take for granted before their blocks run; which of their blocks do not run, and why.

A block is named by its first line.
"""

from typing import NamedTuple

ROS2 = "the program ros2 is not among the wheels; tests/ros/test_terminal.py has isa's own"
ENDLESS = 'runs until Ctrl-C, or in two terminals; tests of the command start and end it'
ROOT = 'changes the host, needs root or a namespace of its own; tests/fieldbus has both'
HOSTS = 'needs a second host; tests/ros/hosts.py makes two of network namespaces'
MINUTES = 'takes minutes and writes the page; tests compare the page with a part of it'
INSTALLS = 'installs or fetches packages'
FOREIGN = 'needs data or models that are not in the repository'
OWN_TEST = 'tests/docs/test_export.py and test_export_units.py run it'


class Before(NamedTuple):
    """What a reader of a page has already."""

    shell: str = ''
    """Commands that made it."""
    python: str = ''
    """What the names of its Python blocks are."""
    service: str = ''
    """A command that runs meanwhile, until it is ended."""
    ready: str = ''
    """A command that succeeds once the service is ready."""


_DROPS = './isa bringup leg --scenario drop --duration 0.3 --in-process --out runs/'
_ALONE = 'from isa_ros.programs.actuator import'
BEFORE = {
    'actuator': Before(
        service=f'python -c "{_ALONE} smart_manifold; smart_manifold()"',
        ready='isa echo smart_manifold/joint_states --count 1'),
    'bag': Before(f'{_DROPS}drop; {_DROPS}other'),
    'bodies': Before(),
    'device': Before(python=(
        'import isa_ros\nram = {"model": "isa_v5", "load": {"kind": "mass"}}\n'
        'simulation = isa_ros.load({"name": "one", "supply": {"kind": "constant", '
        '"pressure_mpa": 20.7, "return_pressure_mpa": 0.0}, "actuators": {"knee": ram}, '
        '"emergency_stops": {"legs": {"actuators": ["knee"]}}}).simulation()')),
    'faults': Before(),
    'fieldbus': Before(),
    'first_minutes': Before(
        'printf "name: one\\nsupply: {kind: constant, pressure_mpa: 20.7, '
        'return_pressure_mpa: 0.0}\\nactuators:\\n  ram: {model: isa_v5, load: {kind: mass}}\\n" '
        '> one.yaml',
        service=f'python -c "{_ALONE} main; main()" '
                '--ros-args -p config_file:=one.yaml -r __node:=ram',
        ready='isa echo ram/joint_states --count 1'),
    'link': Before(),
    'network': Before(),
    'loops': Before('sed s/rig_cylinder/my_press/ $ROOT/config/rig_cylinder.yaml > my_press.yaml'),
    'own_cylinder': Before(),
    'paper': Before(),
    'parts': Before(),
    'protection': Before(),
    'python': Before(),
    'quadruped': Before(),
    'report': Before(f'{_DROPS}drop; {_DROPS}other'),
    'robots': Before(),
    'runs': Before(),
    'sensors': Before()}
"""Older pages, with parts of files among their blocks."""

NOT_RUN = {
    'actuator': {'source .venv/bin/activate': ENDLESS,
                 'ros2 topic echo /smart_manifold/joint_states': ROS2,
                 'ros2 param describe /smart_manifold reu.force.kp': ROS2},
    'bench': {'./isa bench --against feb533f3 --first-run --out docs': MINUTES},
    'bodies': {'$ python -m isa_ros.examples.mjcf_robot ur5e.xml shoulder_lift_joint elbow_joint':
               FOREIGN, 'class Mechanism(Protocol):': 'signatures, no program'},
    'canopen': {"pip install -e '.[canopen]'": INSTALLS, 'modprobe vcan': ROOT,
                'isa bus serial rig_linear --path /tmp/isa --baud 1000000': ENDLESS,
                "unshare -rn sh -c 'ip link set lo up multicast on; ip route add 224.0.0.0/4 dev "
                "lo; exec bash'": ROOT},
    'controller': {'python -m isa_ros.examples.sway': ENDLESS},
    'device': {'ros2 topic echo /knee/device': ROS2,
               "ros2 service call /emergency_stop std_srvs/srv/SetBool '{data: true}'": ROS2},
    'device_faults': {'./isa faults --out docs': MINUTES},
    'door': {'python -m scripts.measure_door --write': MINUTES},
    'ethercat': {'unshare -rn': ROOT},
    'export': {'isa export isa_v5 --c --out my_actuator': OWN_TEST,
               '#include "isa_v5.h"': OWN_TEST,
               'isa export isa_v5 --fmu --out my_units': OWN_TEST,
               'from fmpy import simulate_fmu': OWN_TEST},
    'falling_load': {'./isa study falling_load --out docs': MINUTES},
    'fault_situations': {'./isa faults --situations --out docs': MINUTES},
    'faults': {'python -m tests.soak killed --runs 10 --seconds 600 --seed 1': MINUTES,
               './isa faults': MINUTES},
    'fieldbus': {'unshare -rn bash': ROOT, 'nsenter --preserve-credentials -U -n -t PID': ROOT,
                 'isa replay runs/leg_sensor_lost': ROOT, "pip install -e '.[canopen]'": INSTALLS,
                 'isa bus serial rig_linear --path /tmp/ram': ENDLESS,
                 'tshark -i ecm -w ecat.pcap': ROOT},
    'first_tasks': {'python -m scripts.first_tasks DIR --write': MINUTES},
    'hysteresis': {'./isa study hysteresis --out docs': MINUTES},
    'impacts': {'python scripts/measure_impacts.py': MINUTES},
    'installing': {"pip install '.[mujoco]'": INSTALLS,
                   './isa demo': INSTALLS,
                   'sudo apt install python3-lz4 python3-zstandard': INSTALLS,
                   'python -m scripts.make_kernels --all': MINUTES},
    'layouts': {"sed 's,/rotor/,/smart_manifold/,g; s,\"rotor,\"smart_manifold,g' "
                'rig_rotary.pj3.xml > smart_manifold.pj3.xml': 'needs an installed package',
                'python -m scripts.write_layouts my_press.yaml --out .':
                'tests/scripts writes layouts of other files'},
    'link': {'python -m isa_ros.examples.over_a_link': MINUTES},
    'loops': {'./isa study backlash': MINUTES},
    'lowering': {'./isa study lowering --out docs': MINUTES},
    'network': {
        'ss -lunp | grep python': HOSTS, 'isa bringup leg.yaml --namespace left': ENDLESS,
        'export ROS_DOMAIN_ID=42 ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET': HOSTS,
        './isa actuators leg.yaml --scenario drop.yaml': HOSTS,
        './isa bringup leg.yaml --scenario drop.yaml --elsewhere all --out runs/drop': HOSTS,
        'export ROS_DOMAIN_ID=42 ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST': HOSTS,
        'export FASTRTPS_DEFAULT_PROFILES_FILE=$PWD/host1.xml': HOSTS},
    'paper': {'./isa validate --out docs': MINUTES},
    'paper-errata': {'python scripts/measure_readings.py': MINUTES},
    'power_unit': {'./isa study power_unit --out docs': MINUTES},
    'protection': {'ros2 param set /ram reu.protection.mask 4.0': ROS2},
    'quadruped': {'ros2 launch isa_ros robot.launch.py scenario:=quadruped_trot '
                  'real_time_factor:=1 rviz:=true': ROS2},
    'real_data': {'isa against press.csv my_press.yaml --mapping press.yaml --out overlay.png':
                  FOREIGN,
                  'isa compare press.csv runs/mine --mapping press.yaml': FOREIGN,
                  'isa identify press.csv --mapping press.yaml --config my_press.yaml': FOREIGN,
                  'python -m scripts.fetch_records records': FOREIGN},
    'ros2_control': {
        'sudo apt install ros-jazzy-ros2-control ros-jazzy-ros2-controllers \\': INSTALLS,
        'ros2 launch isa_ros leg.launch.py real_time_factor:=1 ros2_control:=leg_torque \\': ROS2},
    'runs': {'./isa bringup leg.yaml --real-time-factor 1': ENDLESS,
             'ros2 topic pub --once /joint_command sensor_msgs/msg/JointState \\': ROS2},
    'scenario_file': {'name: lower': 'tests/docs/test_scenario_file.py reads it'},
    'sensitivity': {'./isa validate --sensitivity --out docs': MINUTES},
    'servo_valve': {'./isa study servo_valve --out docs': MINUTES},
    'speed': {'.venv/bin/python -m pip install -r requirements-bench.txt': INSTALLS},
    'studies': {'./isa study --all --out docs': MINUTES},
    'temperature': {'./isa study temperature --out docs': MINUTES},
    'time': {'./isa bringup leg.yaml --paused': ROS2,
             'ros2 service call /set_simulation_state simulation_interfaces/srv/'
             'SetSimulationState \\': ROS2},
    'validation': {'./isa validate --out docs': MINUTES},
    'view': {'./isa view leg --scenario drop': ENDLESS},
    'versions': {'git worktree add ../isa_ros-0.2.0 0.2.0 && ../isa_ros-0.2.0/isa replay BAG':
                 INSTALLS}}
"""By page and first line: why the blocks of a test leave it out."""
