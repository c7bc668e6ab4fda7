"""A caller's code: whatever it raises is one line with its place; its numbers are checked."""

from pathlib import Path

from isa_ros.errors import ConfigError, RunError, SetpointError
from isa_ros.surroundings.callers import at_step, cause_of, failures_of, numbers_of
import numpy as np
import pytest

HERE = Path(__file__).name


@pytest.mark.parametrize(('error', 'shown'), [
    (KeyError('missing'), "KeyError: 'missing'"),
    (ValueError('two\n  lines'), 'ValueError: two lines'),
    (ZeroDivisionError(), 'ZeroDivisionError'),
    (SystemExit(0), 'SystemExit: 0')])
def test_a_failure_has_function_type_text_and_place(error: BaseException, shown: str) -> None:
    with pytest.raises(RunError) as raised:
        with failures_of('Mine.step'):
            _raise(error)
    assert str(raised.value) == f'Mine.step: {shown} ({HERE}:{_RAISED})'
    assert raised.value.__cause__ is error


def _raise(error: BaseException) -> None:
    raise error


_RAISED = _raise.__code__.co_firstlineno + 1


@pytest.mark.parametrize('error', [ConfigError('mine'), KeyboardInterrupt()])
def test_an_error_of_ours_and_an_interrupt_pass_as_they_are(error: BaseException) -> None:
    with pytest.raises(type(error)) as raised:
        with failures_of('Mine.step'):
            raise error
    assert raised.value is error


def test_what_does_not_fail_is_left_alone() -> None:
    with failures_of('Mine.step'):
        pass


def test_a_syntax_error_has_the_place_in_its_text() -> None:
    with pytest.raises(SyntaxError) as raised:
        compile('x = = 1', 'mine.py', 'exec')
    assert cause_of(raised.value) == 'SyntaxError: invalid syntax (mine.py, line 1)'


def test_the_place_is_the_last_one_in_a_file() -> None:
    """Frames of the import machinery, and of generated code, are named `<...>`."""
    with pytest.raises(ZeroDivisionError) as raised:
        _divide()
    assert cause_of(raised.value).endswith(f'({HERE}:{_divide.__code__.co_firstlineno + 1})')


def _divide() -> None:
    eval('1 / 0')


def test_numbers_have_one_for_each_actuator() -> None:
    found = numbers_of(['ram', 'arm'], 'position', [1, 2])
    assert found.dtype == np.float64 and found.tolist() == [1.0, 2.0]
    with pytest.raises(ConfigError, match=(
            r'^position has the shape \(1,\), must have \(2,\): one number for each of ram, '
            'arm$')):
        numbers_of(['ram', 'arm'], 'position', [1.0])


@pytest.mark.parametrize('bad', [np.nan, np.inf, -np.inf])
def test_the_first_number_that_is_not_finite_is_named(bad: float) -> None:
    with pytest.raises(ConfigError, match=f'^arm: force = {bad}, must be finite$'):
        numbers_of(['ram', 'arm', 'leg'], 'force', [0.0, bad, np.nan])
    with pytest.raises(ConfigError, match='^ram: force = '):
        numbers_of(['ram'], 'force', [bad])


class Steps:
    """A controller as far as its place goes."""

    def step(self, state: object) -> int:
        """Return no setpoints."""
        return 3


class OfRobot:
    """Stands before a controller, as that of a robot does."""

    __wrapped__ = Steps()

    def step(self, state: object) -> int:
        """Call the controller."""
        return self.__wrapped__.step(state)


def test_what_a_controller_returns_has_the_place_of_its_step() -> None:
    line = Steps.step.__code__.co_firstlineno
    for controller in (Steps(), OfRobot()):
        assert at_step(SetpointError('3 are none'), controller) == (
            f'3 are none (test_callers.py:{line})')
    assert at_step(SetpointError('3 are none'), object()) == '3 are none'
