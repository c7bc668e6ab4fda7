"""Strict YAML: errors with their line, and numbers that keep every bit."""

from datetime import date
from pathlib import Path
from typing import Any

from hypothesis import given, strategies as st
from isa_ros.config.text import yaml_text as strict_yaml
from isa_ros.errors import ConfigError
import pytest
from pytest import MonkeyPatch
import yaml


@pytest.fixture(params=['the fastest parser', 'the one without libyaml'])
def parse(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return `strict_yaml.parse` with either parser, whatever PyYAML was built with."""
    if request.param != 'the fastest parser':
        monkeypatch.setattr(strict_yaml, '_Loader', strict_yaml._PythonLoader)
    return strict_yaml.parse


@pytest.mark.parametrize('text, expected', [
    ('a: 1\nb: 2\na: 3\n', 'x.yaml: line 3: duplicate key a'),
    ('a: &one {b: 1}\nc: *one\n', r'x.yaml: line 2: aliases'),
    ('a: [1, 2\n', 'x.yaml: line 2: '),
    ('a: !!python/name:os.system x\n', r'x.yaml: line 1: tags \(!name\) are not read'),
    ('a: !!python/object/apply:os.system [x]\n', 'line 1: tags'),
    ('a: !!timestamp abc\n', 'line 1: tags'),
    ('a: !!bool maybe\n', 'line 1: tags'),
    ('a: !!set {b: 1}\n', 'line 1: tags'),
    ('a: ! 3\n', 'line 1: tags'),
    ('!!map {a: 1}\n', 'line 1: tags'),
    ('a: 1' + '0' * 300 + '\n', 'x.yaml: line 1: a number of 301 digits, must be <= 300'),
    ('a:\n\tb: 1\n', '^x.yaml: line 2: begins with a tab, must be indented by spaces$'),
    ('a:\n  b: 1\n \tc: 2\n', '^x.yaml: line 3: begins with a tab'),
    ('- 1\n', 'x.yaml: must be sections'),
    ('', 'x.yaml: must be sections'),
    ('a: 1\n---\nb: 2\n', 'x.yaml: line 2: '),
    ('1: a\n', 'x.yaml: line 1: key 1 must be a name'),
    ('[a, b]: 1\n', 'x.yaml: line 1: key .* must be a name'),
    ('a: \x07\n', 'x.yaml: is not YAML'),
    ('a: ' + '[' * 5000 + ']' * 5000 + '\n', 'x.yaml: line 1: nested deeper than 16'),
    ('a: [' + '1,' * 20001 + ']\n', 'x.yaml: line 1: more than 20000 values'),
    ('a: ' + 'x' * (1 << 20), 'x.yaml: larger than 1048576 bytes'),
])
def test_refused_text_names_file_and_line(parse: Any, text: str, expected: str) -> None:
    with pytest.raises(ConfigError, match=expected) as caught:
        parse(text, 'x.yaml')
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('text, value', [
    ('1e5', 1e5), ('-2.5E-3', -2.5e-3), ('.5', 0.5), ('3', 3), ('010', 10.0), ('on', 'on'),
    ('yes', 'yes'), ('1:30', '1:30'), ('2024-01-01', '2024-01-01'), ('true', True),
    ('~', None), ('', None), ("'3'", '3'), ('1_000', '1_000'), ('.inf', float('inf')),
])
def test_scalars_follow_yaml_1_2(parse: Any, text: str, value: object) -> None:
    """YAML 1.1 would read 1e5 as a text, 010 as 8, on as true and 1:30 as 90."""
    got = parse(f'a: {text}\n', 'x.yaml')['a']
    assert got == value and type(got) is type(value)


@given(st.floats(allow_nan=False))
def test_a_float_keeps_every_bit(number: float) -> None:
    assert strict_yaml.parse(strict_yaml.dump({'a': number}), 'x')['a'] == number


WORDS = st.text(st.characters(codec='ascii', categories=['L', 'N', 'P', 'S']), min_size=1)


@given(st.dictionaries(WORDS, st.one_of(WORDS, st.booleans(), st.none())))
def test_names_and_texts_survive_a_round_trip(tree: dict[str, str | bool | None]) -> None:
    text = strict_yaml.dump(tree)
    if tree:
        assert strict_yaml.parse(text, 'x') == tree


ASCII = st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=40)
SCALARS = st.one_of(
    ASCII, st.none(), st.booleans(), st.integers(), st.floats(),
    st.sampled_from(('~', 'null', 'on', '1e5', '0x1f', '12:30', '2001-01-01', '-', '? a', 'a: b')))


@pytest.mark.skipif(not yaml.__with_libyaml__, reason='PyYAML was built without libyaml')
@given(st.dictionaries(ASCII.filter(bool), st.recursive(SCALARS, lambda below: st.one_of(
    st.lists(below), st.dictionaries(ASCII.filter(bool), below)))))
def test_the_dumper_of_the_library_writes_the_same_bytes(tree: dict[str, Any]) -> None:
    """Else a bag of a host whose PyYAML has no library would have another configuration."""
    with MonkeyPatch.context() as patch:
        patch.setattr(strict_yaml, '_Dumper', strict_yaml._PythonDumper)
        by_python = strict_yaml.dump(tree)
    assert strict_yaml._is_plain(tree) and strict_yaml.dump(tree) == by_python


@pytest.mark.parametrize('tree', [
    {'a': 'x' * 41}, {'a': ['\xe4']}, {'a': {'b': ['c', ('d\n',)]}}, {'': 1}, {'\xe4': 1},
    {'a': {'b': {'': 1}}}, {'y' * 41: 1}, {'a': {10 ** 125: 1}}, {'a': [date(2020, 1, 1)]},
    {'a': {'b', ''}}])
def test_what_dumpers_may_write_in_other_lines_is_left_to_python(tree: dict[str, Any]) -> None:
    with MonkeyPatch.context() as patch:
        patch.setattr(strict_yaml, '_Dumper', None)     # a use of it would fail
        assert strict_yaml.dump(tree)


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match='no_such.yaml: cannot be read: No such file'):
        strict_yaml.read(tmp_path / 'no_such.yaml')
    with pytest.raises(ConfigError, match='cannot be read: Is a directory'):
        strict_yaml.read(tmp_path)
    binary = tmp_path / 'binary.yaml'
    binary.write_bytes(b'a: \xff\n')
    with pytest.raises(ConfigError, match='binary.yaml: byte 3: is not UTF-8'):
        strict_yaml.read(binary)
