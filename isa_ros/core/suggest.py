"""Suggestions for an unknown name, for error messages."""

from collections.abc import Iterable, Sequence
import difflib
import re

_UNIT = (r'(?:l_min|m3|mm|um|cm|m|mrad|rad|deg|mpa|kpa|hpa|pa|bar|psi|lpm|ml|cc|l|khz|hz|ms|us|ns'
         r'|s|min|kg|g|kn|n|nm|ma|a|kv|v|w|j|ohm|h|celsius|percent)')
_UNIT_SUFFIX = re.compile(rf'_(?:per_)?{_UNIT}(?:_per_{_UNIT})*$')
_MAX_NAMED = 12  # names in a message
_LONGEST = 60    # characters of a name in a message


def alternatives(name: str, names: Iterable[str]) -> str:
    """Return the valid names closest to an unknown one, as the end of a message."""
    names = list(names)
    stem = _UNIT_SUFFIX.sub('', name)
    for known in names:
        if _UNIT_SUFFIX.sub('', known) == stem:
            if known == stem:
                return f'the key is {known}, in SI'
            return f'the key is {known} (the unit belongs to the key)'
    near = near_names(name, names)
    if near:
        return f'did you mean {near}?'
    if not names:
        return 'no names are defined here'
    return f'valid: {listed(names)}'


def near_names(name: str, names: Iterable[str]) -> str:
    """Return the valid names closest to an unknown one, joined by "or"; '' if none is close."""
    return ' or '.join(difflib.get_close_matches(name, list(names), n=3, cutoff=0.6))


def listed(names: Sequence[str]) -> str:
    """Return names as a list of at most a dozen, each shortened, and the number of all."""
    if not names:
        return 'none'
    first = ', '.join(shortened(name) for name in names[:_MAX_NAMED])
    return first + (f', ... ({len(names)} in all)' if len(names) > _MAX_NAMED else '')


def shortened(text: str) -> str:
    """Return a text of at most `_LONGEST` characters."""
    return text if len(text) <= _LONGEST else f'{text[:_LONGEST]}...'
