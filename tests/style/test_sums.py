"""No simulated value passes through `sum`: from Python 3.12 on it rounds differently."""

import ast
from pathlib import Path

import isa_ros

PACKAGE = Path(isa_ros.__file__).parent
SIMULATED = (
    'actuator', 'config', 'core', 'loads', 'plant', 'reu', 'run', 'scenario', 'surroundings')
EXACT = {
    ('actuator/saved_rows.py', '(rows.nbytes for rows in self._rows)'),
    ('config/runs/supplies.py', '(len(supply.sampled) for supply in supplies)'),
    ('core/lowering.py',
     '(1 + (sizes.get(own.callee.name, 0) if isinstance(own, CallInstr) else 0) '
     'for block in function.blocks for own in block.instructions)'),
    ('reu/device_record.py', '(1 << mode for mode in possible_modes(reu))'),
    ('run/row_messages.py', '(floats(sample).size for sample in rows.bodies.values())'),
    ('run/wire/steps.py', '(record.itemsize for record in roster.bodies.values())'),
    ('scenario/device_steps.py', '(kind for name, kind in _REQUESTS.items() if tree.get(name))'),
    ('surroundings/surroundings.py', 'sizes')}
"""Sums of integers, or of two numbers."""


def sums() -> set[tuple[str, str]]:
    """Return (file, argument) of every call of `sum` or `math.fsum` in what is simulated."""
    files = [path for name in SIMULATED for path in (PACKAGE / name).rglob('*.py')]
    files += [PACKAGE / name for name in ('simulation.py', 'controller.py', 'requests.py')]
    return {
        (str(path.relative_to(PACKAGE)), ast.unparse(call.args[0]))
        for path in files for call in ast.walk(ast.parse(path.read_text()))
        if isinstance(call, ast.Call) and ast.unparse(call.func) in ('sum', 'math.fsum')}


def test_no_simulated_value_passes_through_sum() -> None:
    assert sums() == EXACT
