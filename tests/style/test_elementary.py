"""No simulated value comes from a function of the C library, whose last bit is its own."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / 'isa_ros'
SIMULATES = ('core', 'plant', 'reu', 'loads', 'surroundings', 'actuator', 'scenario', 'config')
EXACT = {
    'pi', 'inf', 'nan', 'sqrt', 'floor', 'ceil', 'frexp', 'isfinite', 'isnan', 'isinf', 'isclose',
    'copysign', 'gcd', 'prod', 'radians', 'degrees', 'hypot'}
"""
Names of `math` whose results are rounded as IEEE 754 prescribes; `hypot` is for messages only.
"""


@pytest.mark.parametrize('module', sorted(
    path for folder in SIMULATES for path in (PACKAGE / folder).rglob('*.py')),
    ids=lambda path: str(path.relative_to(PACKAGE)))
def test_elementary_functions_are_our_own(module):
    used = {node.attr for node in ast.walk(ast.parse(module.read_text()))
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
            and node.value.id == 'math'}
    assert used <= EXACT


@pytest.mark.parametrize('module', sorted(
    path for folder in SIMULATES for path in (PACKAGE / folder).rglob('*.py')),
    ids=lambda path: str(path.relative_to(PACKAGE)))
def test_numpy_computes_no_elementary_function(module):
    used = {node.attr for node in ast.walk(ast.parse(module.read_text()))
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
            and node.value.id == 'np'}
    assert not used & {
        'sin', 'cos', 'tan', 'exp', 'expm1', 'log', 'log1p', 'log10', 'tanh', 'power', 'arctan2',
        'arccos', 'arcsin', 'arctan', 'hypot', 'dot', 'matmul'}
