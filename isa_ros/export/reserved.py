"""Names that an actuator cannot have in C: its header would not compile, or not in C++."""

_C = (
    'auto break case char const constexpr continue default do double else enum extern false float '
    'for goto if inline int long nullptr register restrict return short signed sizeof static '
    'static_assert struct switch thread_local true typedef typeof typeof_unqual union unsigned '
    'void volatile while alignas alignof bool asm')
_CPP = (
    'and and_eq bitand bitor catch char8_t char16_t char32_t class co_await co_return co_yield '
    'compl concept const_cast consteval constinit decltype delete dynamic_cast explicit export '
    'friend mutable namespace new noexcept not not_eq operator or or_eq private protected public '
    'reinterpret_cast requires static_cast template this throw try typeid typename using virtual '
    'wchar_t xor xor_eq')
_MACROS = 'linux unix'     # that compilers define
_TYPES = (
    'clock div fpos intmax intptr ldiv lldiv max_align nullptr ptrdiff size ssize time uintmax '
    'uintptr va_list wchar wint')

RESERVED = frozenset((f'{_C} {_CPP} {_MACROS} {_TYPES}').split()) | {
    f'{sign}int{kind}{bits}' for sign in ('', 'u') for kind in ('', '_least', '_fast')
    for bits in (8, 16, 32, 64)}
"""Words of both languages, and names that are types of their libraries with _t behind."""
