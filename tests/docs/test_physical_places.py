"""Rows of "Places for extensions" about what actuators meet: a body, a supply."""

import re
import textwrap

import pytest
from tests.docs.patched_copy import files_of, names_of, PatchedCopy

RAIL = textwrap.dedent('''\
    """A mass on a rail between two cylinders, with a spring."""

    from typing import Any, ClassVar

    from isa_ros.config.runs.body_config import BodyConfig, BodyInputs
    from isa_ros.config.text.key_tables import KeyTable
    from isa_ros.config.text.keys import Key, NAME, ParameterSet
    from isa_ros.config.text.sections import Place, Section
    from isa_ros.core.fields import Field, record_type, units_of
    from isa_ros.core.frozen import frozen
    from isa_ros.core.parameter import parameter, Parameters
    from isa_ros.core.units import MILLI
    from isa_ros.surroundings.messages import JointStates
    import numpy as np

    FIELDS = (Field('place', 'm', 'of the mass'), Field('speed', 'm/s', 'of the mass'))


    @frozen(kw_only=True)
    class RailSheet(Parameters):
        """The mass, its spring and its start."""

        mass_kg: float = parameter('moving mass', 'kg', gt=0.0, le=1e3)
        stiffness: float = parameter('of the spring', 'N/m', ge=0.0, le=1e6)
        start_mm: float = parameter('place at t = 0, spring at rest', 'mm', ge=0.0, le=70.0)


    class Rail:
        """The body."""

        units = units_of(FIELDS)

        def __init__(self, sheet: RailSheet, rows: Any, step: float) -> None:
            self.rows, self._sheet, self._step = np.array(rows), sheet, step
            self.sample = np.zeros(1, record_type(FIELDS))
            self.sample['place'] = sheet.start_mm * MILLI

        def starts(self, starts: Any) -> None:
            starts['position'][self.rows] = self.sample['place']

        def ports(self, ports: Any) -> None:
            for row in self.rows:
                ports[row]['x0'], ports[row]['v0'] = self.sample[0]
                ports[row]['inverse_mass'] = 1.0 / self._sheet.mass_kg

        def advance(self, replies: Any) -> None:
            x, v = self.sample[0]
            force = replies['mean_forces'][self.rows].mean(axis=1).sum()
            force -= self._sheet.stiffness * (x - self._sheet.start_mm * MILLI)
            v += self._step * force / self._sheet.mass_kg
            self.sample[0] = x + self._step * v, v

        def snapshot(self) -> bytes:
            return self.sample.tobytes()

        def restore(self, snapshot: bytes) -> None:
            self.sample[:] = np.frombuffer(snapshot, self.sample.dtype)


    @frozen(kw_only=True)
    class RailConfig(BodyConfig):
        """A rail as a body of a run."""

        kind: ClassVar[str] = 'rail'
        KEYS: ClassVar[KeyTable] = KeyTable((
            Key('left', NAME, 'the actuator on the left', of=lambda own: own.joints[0][1]),
            Key('right', NAME, 'the actuator on the right', of=lambda own: own.joints[1][1]),
            Key('sheet', ParameterSet(RailSheet), 'mass and spring')))
        sheet: RailSheet
        fields = FIELDS

        @classmethod
        def of(cls, name: str, values: dict[str, Any], place: Place, step_ns: int,
               is_checked: bool) -> tuple[BodyConfig, Section]:
            return cls(name=name, sheet=values['sheet'], joints=(
                ('left', values['left']), ('right', values['right']))), {}

        def position_of(self, joint: str) -> float:
            return self.sheet.start_mm * MILLI

        def messages(self, step_ns: int) -> tuple[JointStates, ...]:
            return JointStates(
                f'/{self.prefix}rail', ['rail'], ['place'], ['speed'], []),

        def body(self, made: BodyInputs) -> Rail:
            return Rail(self.sheet, made.rows, made.step_ns * 1e-9)
    ''')
RUN_RAIL = """
from pathlib import Path
import isa_ros
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.config.differences import configuration_differences
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import dump, parse
from isa_ros.replay.replay import replay
tree = {
    'name': 'slide', 'supply': {
        'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
    'body': {'kind': 'rail', 'left': 'pull', 'right': 'push', 'sheet': {
        'mass_kg': 40.0, 'stiffness': 2e5, 'start_mm': 40.0}},
    'actuators': {'push': {'model': 'isa_v5'}, 'pull': {'model': 'isa_v5'}}}
run = isa_ros.load(tree, {'name': 'push', 'duration_s': 0.03, 'tracks': {
    'push': [{'t_s': 0.0, 'position': 0.04, 'effort': 500.0}]}})
Path('slide.yaml').write_text(dump(tree))
text = run.configuration.to_yaml()
assert run_of_text(text) == run.configuration
result = run.simulate()
bag = result.save('rail')
assert result['body.place'][-1] > 0.0401 and result.units['body.speed'] == 'm/s'
assert (read_signals(bag)['body.place'] == result['body.place']).all()
print(sorted(name for name in Bag(bag).types if 'rail' in name), replay(Bag(bag)).is_equal)
heavy = run.replace({'body.sheet.mass_kg': 50.0})
heavy.simulate().save('heavy')
print(*configuration_differences(parse(text, ''), parse(heavy.configuration.to_yaml(), '')))
"""


@pytest.mark.slow
def test_a_kind_of_bodies_is_a_class_and_a_row(copied: PatchedCopy) -> None:
    """Run file, simulation, bag, replay, lists, comparison and diagnostics use its class."""
    copied.add('isa_ros/config/runs/rail_config.py', RAIL)
    kinds = 'isa_ros/config/runs/body_kinds.py'
    copied.replace(kinds, '    RobotConfig,\n)}', '    RobotConfig,\n    RailConfig,\n)}')
    copied.replace(kinds, 'import LegConfig\n', 'import LegConfig\n'
                   'from isa_ros.config.runs.rail_config import RailConfig\n')
    assert len(copied.touched) == 2
    assert names_of(copied.touched) - {'config/runs/rail_config.py'} <= files_of('body')
    topics, compared = copied.python(RUN_RAIL).splitlines()
    assert topics == "['/rail'] True"
    assert compared == (
        "DifferingKey(key='body.sheet.mass_kg', expected=40.0, actual=50.0, unit='kg')")
    listed = copied.isa('params', 'slide.yaml')
    assert re.search(r'^mass_kg +40 +kg ', listed, re.M)
    assert 'equal' in copied.isa('replay', 'rail')


_FALLING = '''@frozen(kw_only=True)
class FallingSupply(Parameters):
    """A bottle without a pump: its pressure falls at a constant rate."""

    pressure_mpa: float = parameter('gauge pressure at t = 0', 'MPa', gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter('gauge return pressure', 'MPa', ge=0.0, le=5.0)
    lasts_s: float = parameter('time until it is empty', 's', gt=0.0, le=1e4)
    return_line: ReturnLine = nested(HeldReturn())
    dump: NoneDump = nested(NoneDump())


SupplySheet = ConstantSupply | AccumulatorSupply | CircuitSupply | FallingSupply
'''
_FALLS = """
import isa_ros
from isa_ros.config.runs.run_reading import run_of_text
run = isa_ros.load('rig_linear').replace({'supply': {
    'kind': 'falling', 'pressure_mpa': 20.0, 'return_pressure_mpa': 0.0, 'lasts_s': 2.0}})
assert run_of_text(run.configuration.to_yaml()) == run.configuration
result = run.simulate(0.1)
print(f"{result['supply.pressure'][0] * 1e-6:.3f} {result['supply.pressure'][-1] * 1e-6:.3f}")
"""


@pytest.mark.slow
def test_a_supply_is_two_files(copied: PatchedCopy) -> None:
    """Its kind is in run files, resolved texts and lists, and its pressure at the valves."""
    path, kernel = 'isa_ros/surroundings/supply.py', 'isa_ros/surroundings/supply_tick.py'
    copied.replace(
        path, 'SupplySheet = ConstantSupply | AccumulatorSupply | CircuitSupply\n', _FALLING)
    copied.replace(
        path, '                          dump_fields(sheet.dump, self._step))], tick.IDEAL)\n',
        '                          dump_fields(sheet.dump, self._step), self._step * MPA *\n'
        "                          sheet.pressure_mpa / getattr(sheet, 'lasts_s', math.inf))],\n"
        '                        tick.IDEAL)\n')
    copied.replace(path, 'from functools import cached_property\n',
                   'from functools import cached_property\nimport math\n')
    copied.replace(
        kernel, "    ('dump_valve', DUMP)])", "    ('dump_valve', DUMP), ('fall', 'f8')])")
    copied.replace(kernel, '        lower(ideal[0], state)\n',
                   '        lower(ideal[0], state)\n        state.pressure -= ideal[0].fall\n')
    assert names_of(copied.touched) == files_of('supply') and len(copied.touched) == 2
    assert copied.python(_FALLS) == '20.000 19.000\n'
    assert 'lasts_s' in copied.isa(
        'params', 'rig_linear', '--set', 'supply.kind=falling', '--set',
        'supply.lasts_s=1.0')
