"""Results of functions of parameter sets, kept for sets that are asked for again."""

from collections.abc import Callable
from functools import lru_cache, update_wrapper
from typing import ParamSpec, TypeVar

from isa_ros.core.parameter import text_of

MOST = 64
"""Results that a function keeps."""

_Sets = ParamSpec('_Sets')
_R = TypeVar('_R')


class _Question:
    """A call that equals those with the same values as text: -0.0 is not 0.0, and 1 not 1.0."""

    __slots__ = 'call', 'text'

    def __init__(self, call: Callable[[], object], text: str) -> None:
        self.call, self.text = call, text

    def __hash__(self) -> int:
        return hash(self.text)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Question) and self.text == other.text


def remembered(function: Callable[_Sets, _R]) -> Callable[_Sets, _R]:
    """
    Let a function of parameter sets return its last results again, for the same values.

    A run asks for the same several times, a sweep for those that it does not change at each of its
    runs. What is returned must not be changed.
    """
    @lru_cache(MOST)
    def answer(question: _Question) -> object:
        return question.call()

    def remembering(*sets: _Sets.args, **named: _Sets.kwargs) -> _R:
        text = '\0'.join([*map(text_of, sets),
                          *(f'{name}={text_of(value)}' for name, value in named.items())])
        found = answer(_Question(lambda: function(*sets, **named), text))
        return found    # type: ignore[return-value]
    return update_wrapper(remembering, function)
