"""Shortcuts of a process that only lowers do what numba does, but for what nobody reads."""

from types import SimpleNamespace
import warnings

from isa_ros.core import shortcuts
from numba.core import errors, ir, typeinfer
from numba.core.compiler_machinery import FunctionPass
import pytest
from tests.core.shortened import HERE, shortened


def test_an_error_is_told_where_it_arose(monkeypatch):
    context = shortened('numba.core.typeinfer.new_error_context')
    monkeypatch.setattr(errors, 'loc_info', told := {})
    for line, raised in ((4, errors.TypingError('wrong')), (5, KeyError('other'))):
        with pytest.raises(type(raised)) as caught:
            with context('typing of {what} at {loc}', what='y', loc=ir.Loc('here.py', line)):
                raise raised
        assert ('During: typing of y at here.py (4)' in str(caught.value)) == (line == 4)
    assert told['loc'].line == 5
    with context('within numba', loc=ir.Loc(errors.__file__, 9)):
        pass
    assert told['loc'].line == 5


def test_no_timer_is_called():
    with shortened('numba.core.event.install_timer')('numba:compile', pytest.fail):
        pass


OWN = ir.Scope(None, HERE).define('own', HERE)


@pytest.mark.parametrize(('value', 'is_inlined'), [
    (ir.Expr.make_function('f', None, (), (), HERE), True),
    (ir.Expr.build_list([], HERE), True),
    (ir.Expr.build_tuple([], HERE), False),
    (ir.Expr.getattr(OWN, 'stencil', HERE), True),
    (ir.Expr.getattr(OWN, 'append', HERE), False),
    (ir.Global('reduce', object(), HERE), True),
    (ir.FreeVar(0, 'other', SimpleNamespace(__name__='reduce'), HERE), True),
    (ir.Global('len', len, HERE), False),
    (ir.Const(3, HERE), False)])
def test_closures_are_looked_for_where_there_may_be_some(value, is_inlined):
    looked = []
    block = ir.Block(ir.Scope(None, HERE), HERE)
    block.append(ir.Assign(value, block.scope.define('x', HERE), HERE))
    own = SimpleNamespace(func_ir=SimpleNamespace(blocks={0: block}))
    shortened('InlineClosureCallPass.run', looked.append)(own)
    assert looked == [own] * is_inlined


class Constraint:
    """Warns, fails or says that it was there."""

    def __init__(self, line, does):
        self.loc, self._does = ir.Loc('here.py', line), does

    def __call__(self, inferer):
        return self._does()


def fail(error):
    """Raise an error."""
    raise error


def test_constraints_warn_and_fail_at_their_places():
    literal = errors.ForceLiteralArg({0})
    network = SimpleNamespace(constraints=[
        Constraint(3, lambda: None),
        Constraint(4, lambda: warnings.warn(errors.NumbaWarning('slow'))),
        Constraint(5, lambda: fail(errors.TypingError('no such thing'))),
        Constraint(6, lambda: fail(literal)),
        Constraint(7, lambda: warnings.warn(errors.NumbaWarning('slower')))])
    given, found = [], []
    for propagate in (typeinfer.ConstraintNetwork.propagate,
                      shortened('ConstraintNetwork.propagate')):
        inferer = SimpleNamespace(warnings=errors.WarningsFixer(errors.NumbaWarning))
        failures = propagate(network, inferer)
        found.append([(type(own), str(own)) for own in failures])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter('always')
            inferer.warnings.flush()
        given.append([(str(own.message), own.filename, own.lineno) for own in caught])
    assert found[0] == found[1] and len(found[0]) == 2
    assert given[0] == given[1] == [('slow', 'here.py', 4), ('slower', 'here.py', 7)]


class Pass:
    """A pass that notes its steps."""

    def __init__(self, steps):
        self._steps = steps
        self.name = lambda: 'noted'

    def __getattr__(self, name):
        return lambda state: self._steps.append(name)


def test_a_pass_runs_whole_and_is_told_to_who_listens(monkeypatch):
    steps, told = [], []
    run = shortened('PassManager._runPass', lambda *own: told.append(own[1]))
    quiet = {'_print_before': [], '_print_after': [], '_print_wrap': [], '_analysis': 'known'}
    run(SimpleNamespace(**quiet), 3, passed := Pass(steps), 'state')
    assert steps == ['run_initialization', 'run_pass', 'run_finalizer']
    assert passed.analysis == 'known' and told == []
    for k, printed in enumerate(('_print_before', '_print_after', '_print_wrap')):
        run(SimpleNamespace(**{**quiet, printed: ['noted']}), k, passed, 'state')
    monkeypatch.setitem(shortcuts.event._registered, 'numba:run_pass', ['listener'])
    run(SimpleNamespace(**quiet), 3, passed, 'state')
    assert told == [0, 1, 2, 3] and len(steps) == 3


def test_a_pass_that_leaves_deletions_is_refused():
    class Leaving(FunctionPass):
        _name = 'leaving'

        def __init__(self):
            pass

        def run_pass(self, state):
            return True
    block = ir.Block(ir.Scope(None, HERE), HERE)
    block.append(ir.Del('x', HERE))
    manager = SimpleNamespace(_print_before=[], _print_after=[], _print_wrap=[], _analysis=None)
    state = SimpleNamespace(func_ir=SimpleNamespace(blocks={0: block}))
    with pytest.raises(errors.CompilerError, match='Illegal IR, del found'):
        shortened('PassManager._runPass')(manager, 0, Leaving(), state)


def test_generators_are_processed_by_numba():
    told = []
    run = shortened('PostProcessor.run', lambda *own: told.append(own))
    of_generator = SimpleNamespace(func_ir=SimpleNamespace(is_generator=True))
    run(of_generator, True)
    assert told == [(of_generator, True, False)]
    block = ir.Block(ir.Scope(None, HERE), HERE)
    block.append(ir.Return(block.scope.define('x', HERE), HERE))
    patched = []
    own = SimpleNamespace(
        func_ir=SimpleNamespace(is_generator=False, blocks={0: block}, generator_info='old'),
        _insert_var_dels=lambda extend_lifetimes: patched.append(extend_lifetimes))
    run(own)
    assert own.func_ir.variable_lifetime.usedefs.usemap == {0: {'x'}}
    assert own.func_ir.generator_info is None and patched == []
    run(own, True, extend_lifetimes=True)
    assert patched == [True] and len(told) == 1
