"""What a new user does: 27 tasks, each with its page, its commands and what must be seen."""

from typing import NamedTuple

COMMAND = '$ '
"""What a step begins with that is a line of a page; others are the first line of a block."""


class Task(NamedTuple):
    """One task, as a page has it."""

    title: str
    page: str
    """Of docs/, without its ending."""
    steps: tuple[str, ...] = ()
    """None: all blocks of the page."""
    shows: str = ''
    """What must be printed."""
    makes: str = ''
    """A file that must be there then."""
    service: str = ''
    """A command that runs meanwhile, as in a second terminal."""


_HELLO = 'import isa_ros'
_ERROR = 'def error(result):'
_GAINS = "gains = isa_ros.load('tuned.yaml').configuration.actuator('isa_v5').sheet.reu.force"
TASKS = (
    Task('install it, and see a leg land', 'tutorial', ('./isa demo --out runs/demo',),
         'ground: at most 564 N', 'runs/demo/report.html'),
    Task('replay that run', 'tutorial', ('./isa replay runs/demo/bag',), 'equal: 1001 ticks'),
    Task('look at it in Python', 'tutorial', (_HELLO,), 'at most 2383 N'),
    Task('measure a loop', 'tutorial', ('./isa step isa_v5 --loop force',), 'overshoot: 10.5 %'),
    Task('tune it', 'tutorial',
         ('./isa tune isa_v5 --phase-margin 45 --bandwidth 100 --out tuned.yaml',),
         'kp 1.335e-07', 'tuned.yaml'),
    Task('give the leg the new gains', 'tutorial', (_HELLO, _ERROR, _GAINS), '102.2 N'),
    Task('sweep a gain on all cores', 'tutorial',
         (_HELLO, _ERROR, _GAINS, 'table = isa_ros.sweep('), '99.4885'),
    Task('ask what this host has', 'first_minutes', ('isa doctor',), 'numpy'),
    Task('command an actuator from a second terminal', 'actuator',
         ('isa command smart_manifold 1.0',), 'position', service='smart_manifold'),
    Task('an own cylinder from its data sheet', 'own_cylinder',
         ('name: rig_cylinder', './isa params rig_cylinder.yaml'), 'overshoot: '),
    Task('an own servo valve on a bench', 'own_valve', ('name: my_valve', _HELLO),
         '40 mA: 38.3 l/min'),
    Task('an own load, and a push', 'own_load',
         (_HELLO, "push = {'t_s': 0.1, 'actuator': 'ram', 'set': {'load.force': -500.0}, "
                  "'until_s': 0.3}"), '-4.96 mm at 0.29 s'),
    Task('an own leg', 'own_leg', ('name: my_leg', _HELLO), 'my_leg.yaml: foot 566 N'),
    Task('a crane from its URDF', 'robots', ('./isa draw crane --out crane.png',), 'equal: ',
         'crane.png'),
    Task('what a low-leakage valve saves', 'bag',
         ('./isa bringup rig_knee.yaml --duration 2 --out runs/v5',), '94.4 %'),
    Task('a controller in Python', 'controller', ('# hold.py', 'from hold import Hold'),
         'the knee moved by 13 mm'),
    Task('a policy at 50 Hz with action hold', 'controller',
         ('# policy.py', 'from policy import Policy'), '25 actions in 500 ticks'),
    Task('a predictive controller at 100 Hz, 2 ms late', 'controller',
         ('# predictive.py', 'from predictive import Predictive'), '[4, 14, 24] ms'),
    Task('a controller in C over a serial line', 'c_controller', (), 'moved by 4.0 mm'),
    Task('a controller in C on a CAN bus', 'c_bus', (), 'moved by 3.9 mm'),
    Task('files for a bus master', 'fieldbus',
         ('$ isa bus describe leg --ros2-control igh',), makes='igh'),
    Task('an actuator as a library of C', 'export', ('isa export isa_v5 --c --out my_actuator',),
         'isa_v5, model isa_v5'),
    Task('faults of the device', 'faults', ('./isa faults --list',), 'valve_stuck'),
    Task('push the load over time, and report it', 'faults',
         ('name: my_push', './isa bringup rig_linear --scenario my_push.yaml --in-process '
                           '--out runs/push'), makes='runs/push/report.html'),
    Task('a run as a regression test', 'reproduce', (), 'passed'),
    Task('size a pump', 'pump_sizing', (), 'mean 7.0 l/min, peak 36.7 l/min'),
    Task('actuators and coordinator apart', 'network',
         ('./isa actuators leg.yaml --scenario drop.yaml &',), 'equal: 301 ticks'))
