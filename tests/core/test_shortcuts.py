"""Shortcuts through numba: the same machine code, and none where numba is another."""

import copy
import os
from pathlib import Path
import subprocess
import sys
from types import SimpleNamespace

from isa_ros.core.kernel import kernel, part_of_kernel
from isa_ros.core.shortcuts import digest_of_source, Shortcut, take
from numba.core import ir, types
from numba.core.types import Record
import pytest
from tests.core.shortened import HERE, shortened

ROOT = Path(__file__).parents[2]


@part_of_kernel
def shifted(row, by):
    """Return a sum that is taken in several blocks."""
    total = 0.0
    for k in range(len(row)):
        if row[k] > by:
            total += row[k] - by
        else:
            total -= min(row[k], 0.5 * by)
    return total


@kernel
def varied(own):
    """Use what the shortcuts are of: records, an inlined part twice, a closure, overloads."""
    def twice(value):
        return 2.0 * value
    for k in range(len(own.table)):
        mass = own.masses[k]
        mass.x += twice(shifted(own.table[k], mass.v)) + max(mass.v, 1.5)
        own.table[k, 0] = shifted(own.table[k], 0.25) / (1.0 + abs(mass.x))
    return len(own.masses)


def in_process(program: str, *arguments: object, **environment: str) -> str:
    """Run a program in a process of its own; return what it prints."""
    return subprocess.run(
        [sys.executable, '-c', program, *map(str, arguments)], cwd=ROOT, check=True,
        capture_output=True, text=True,
        env={**os.environ, 'PYTHONPATH': str(ROOT), **environment}).stdout.strip()


OBJECT = """
from pathlib import Path
import sys
from isa_ros.core import lowering
if sys.argv[2] == 'none':
    lowering.SHORTCUTS = ()
lowering.declare()
lowering.lower_only()
from isa_ros.core.kernel import entry_of
from isa_ros.core.kinds import kind_of
from isa_ros.core.objects import own_target
from tests.core.test_bound import memory
from tests.core.test_shortcuts import varied
from tests.objects import made_object
Path(sys.argv[1]).write_bytes(
    made_object({'varied': entry_of(varied, kind_of(memory()))}, own_target()))
"""


@pytest.mark.slow
def test_objects_are_the_same_bytes(tmp_path):
    in_process(OBJECT, tmp_path / 'long.o', 'none')
    in_process(OBJECT, tmp_path / 'short.o', 'all')
    code = (tmp_path / 'short.o').read_bytes()
    assert len(code) > 2000 and code == (tmp_path / 'long.o').read_bytes()


def test_the_installed_numba_is_the_one_that_they_are_for():
    """After an upgrade: read what changed in those that are named, and note the new digests."""
    assert in_process(
        'from isa_ros.core.shortcuts import SHORTCUTS, take\n'
        'print(len(SHORTCUTS), take(SHORTCUTS))') == '13 []'


class Owner:
    """Has a function of another source."""

    def own(self):
        """Return a number."""
        return 1


def test_another_source_is_left_alone():
    before = Owner.own
    digest = digest_of_source(before)
    other = Shortcut(Owner, 'own', '0' * 16, lambda own: None)
    missing = Shortcut(Owner, 'gone', digest, lambda own: None)
    present = Shortcut(Owner, 'own', '', lambda own: None)
    assert take([other, missing, present]) == ['Owner.own', 'Owner.gone', 'Owner.own']
    assert Owner.own is before and not hasattr(Owner, 'gone')


def test_a_known_source_is_replaced(monkeypatch):
    monkeypatch.setattr(Owner, 'own', Owner.own)    # undone afterwards
    known = Shortcut(Owner, 'own', digest_of_source(Owner.own),
                     lambda own: lambda self: own(self) + 1)
    assert take([known]) == []
    assert Owner().own() == 2
    assert take([known]) == ['Owner.own']   # never twice
    assert digest_of_source(len) == 'unknown'


def test_variables_of_instructions():
    scope = ir.Scope(None, HERE)
    a, b, c = (scope.define(name, HERE) for name in 'abc')
    listed = shortened('Inst._rec_list_vars')
    for inner, expected in (
            (ir.Expr.binop(len, a, b, HERE), [a, b]),
            (ir.Expr.build_tuple([a, b, a], HERE), [a, b, a]),
            (ir.Expr.call(a, [b, c], (('named', a),), HERE), [a, b, c, a])):
        assert listed(inner, inner._kws) == inner._rec_list_vars(inner._kws) == expected
        whole = ir.Assign(inner, c, HERE)
        assert listed(whole, vars(whole)) == whole.list_vars() == [*expected, c]
    assert listed(ir.Del('a', HERE), [a, {'of': b}]) == [a, b]


def test_a_copied_scope_is_its_own():
    scope = ir.Scope(None, HERE)
    first = scope.define('x', HERE)
    scope.redefine('x', HERE)
    other = shortened('Scope.__deepcopy__')(scope, memo := {})
    assert memo[id(scope)] is other and other == copy.deepcopy(scope)
    assert other.localvars.get('x') is first
    assert other.redefine('x', HERE).name == 'x.2'
    assert (len(other.localvars), len(scope.localvars)) == (3, 2)
    assert (scope.redefined['x'], other.redefined['x']) == (1, 2)
    assert scope.var_redefinitions['x'] == {'x.1'}
    assert other.var_redefinitions['x'] == {'x.1', 'x.2'}
    assert shortened('Loc.__deepcopy__')(HERE, {}) is HERE


def record(*names: str) -> Record:
    """Return a type of records."""
    return Record.make_c_struct([(name, types.float64) for name in names])


def test_the_text_of_a_record_is_written_once():
    written = []
    text = shortened('Record.__repr__', lambda own: written.append(own) or own.name[:12])
    assert [text(own) for own in (record('a', 'b'), record('c'), record('a', 'b'))] == [
        own.name[:12] for own in (record('a', 'b'), record('c'), record('a', 'b'))]
    assert written == [record('a', 'b'), record('c')]


def test_an_overload_is_looked_up_once_for_its_types():
    asked = []
    look_up = shortened('BaseFunction.get_call_type', lambda *own: asked.append(own) or object())
    function, context, whole, real = 'f', 'cpu', types.int64, types.float64
    first = look_up(function, context, [whole], {})
    assert look_up(function, context, (whole,), {}) is first
    others = [look_up(*own) for own in (
        ('g', context, (whole,), {}), (function, 'gpu', (whole,), {}),
        (function, context, (real,), {}), (function, context, (whole,), {'by': real}),
        (function, context, (whole,), {'by': whole}))]
    assert len({id(own) for own in (first, *others)}) == 6 == len(asked)
    assert look_up(function, context, ([],), {}) is not look_up(function, context, ([],), {})


def test_the_size_of_a_type_is_asked_once():
    asked = []
    size = shortened('BaseContext.get_abi_sizeof', lambda own, ty: asked.append(ty) or len(ty))
    first, second = SimpleNamespace(target_data='x86'), SimpleNamespace(target_data='arm')
    assert [size(first, 'i64'), size(first, 'i64'), size(first, 'i8'), size(second, 'i64')] == [
        3, 3, 2, 3]
    assert asked == ['i64', 'i8', 'i64']
