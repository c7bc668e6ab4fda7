"""The header of an exported actuator: its types are the records of the signals."""

import re
import subprocess

from isa_ros.core.conditions import BITS
from isa_ros.core.device import EVENTS, MODES, STATES
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, LOAD_PORT, LOAD_REPLY, SAMPLE, START, SUPPLY_PORT, SUPPLY_REPLY)
from isa_ros.export.header import header
import pytest

TYPES = {'start': START, 'port': LOAD_PORT, 'feed': SUPPLY_PORT, 'command': COMMAND,
         'reply': LOAD_REPLY, 'fed': SUPPLY_REPLY, 'sample': SAMPLE}
STRICT = ('-Wall', '-Wextra', '-Wpedantic', '-Werror', '-fsyntax-only')
LANGUAGES = {'c99': 'cc', 'c11': 'cc', 'c++11': 'c++', 'c++20': 'c++'}


def compiled(text, tmp_path, standard):
    """Let a compiler check a text."""
    compiler = LANGUAGES[standard]
    path = tmp_path / f'text.{"c" if compiler == "cc" else "cpp"}'
    path.write_text(text)
    return subprocess.run([compiler, f'-std={standard}', *STRICT, path], cwd=tmp_path,
                          capture_output=True, text=True)


def asserted(claim):
    """Return a claim that C checks."""
    return f'_Static_assert({claim}, "{claim}");'


def claims():
    """Yield what the types of C must be."""
    for name, dtype in TYPES.items():
        kind = f'isa_{name}_t'
        yield f'sizeof({kind}) == {dtype.itemsize}'
        for field in dtype.names:
            own, at = dtype.fields[field]
            yield f'offsetof({kind}, {field}) == {at}'
            yield f'sizeof((({kind} *)0)->{field}) == {own.itemsize}'
    for kind, names in (('MODE', MODES), ('STATE', STATES), ('EVENT', EVENTS)):
        for number, name in enumerate(names):
            yield f'ISA_{kind}_{name.upper().replace(" ", "_")} == {number}'
    for name, bit in BITS.items():
        yield f'ISA_CONDITION_{name.upper()} == {1 << bit}'
    yield ('(ISA_SETPOINT | ISA_ENABLE | ISA_GAINS | ISA_MODE | ISA_CLEAR_FAULT | ISA_QUICK_STOP |'
           f' ISA_REFERENCE) == {EVERY_KIND}')


@pytest.mark.parametrize('standard', LANGUAGES)
def test_every_compiler_takes_two_headers(standard, tmp_path):
    for word in ('isa_one', 'isa_two'):
        (tmp_path / f'{word}.h').write_text(header(word, 'an actuator'))
    done = compiled('#include "isa_one.h"\n#include "isa_two.h"\n#include "isa_one.h"\n'
                    'int main(void) { return isa_one_size() == isa_two_size(); }\n',
                    tmp_path, standard)
    assert done.returncode == 0, done.stderr


def test_types_are_the_records(tmp_path):
    (tmp_path / 'isa_one.h').write_text(header('isa_one', 'an actuator'))
    text = '\n'.join(['#include "isa_one.h"', *map(asserted, claims())])
    assert compiled(text, tmp_path, 'c11').returncode == 0
    wrong = asserted('offsetof(isa_command_t, mode) == 40')
    assert 'static assertion failed' in compiled(f'{text}\n{wrong}', tmp_path, 'c11').stderr


def test_headers_with_other_types_are_refused(tmp_path):
    text = header('isa_one', 'an actuator')
    (tmp_path / 'isa_one.h').write_text(text)
    other = header('isa_two', 'another')
    number = re.search(r'#define ISA_ACTUATOR_TYPES (0x[0-9a-f]{8}) ', other)[1]
    assert text.count(number) == other.count(number) == 2
    (tmp_path / 'isa_two.h').write_text(other.replace(number, '0x12345678'))
    done = compiled('#include "isa_one.h"\n#include "isa_two.h"\n', tmp_path, 'c11')
    assert 'isa_two.h and another exported header are of different versions' in done.stderr


def test_the_number_follows_the_types(monkeypatch):
    from isa_ros.export import header as module
    before = header('isa_one', 'an actuator')
    monkeypatch.setattr(module, 'MODES', (*MODES, 'another'))
    after = header('isa_one', 'an actuator')
    numbers = [re.search(r'ISA_ACTUATOR_TYPES (0x[0-9a-f]+)', text)[1]
               for text in (before, after)]
    assert numbers[0] != numbers[1]


def test_a_name_does_not_end_the_comment(tmp_path):
    text = header('isa_one', 'the actuator a of run*/int x;\n#error.yaml')
    assert text.splitlines()[1] == ' * isa_one: the actuator a of run* /int x;\\n#error.yaml.'


def test_nothing_is_left_to_fill():
    assert re.findall('@[A-Z]+@', header('isa_one', 'an actuator')) == []


def test_what_was_assumed_is_in_the_first_comment(tmp_path):
    text = header('isa_own', 'the actuator own', ['plant.a = 1', 'plant.b */ = 2'])
    first = text.partition('*/')[0].splitlines()
    assert first[1] == ' * isa_own: the actuator own.'
    assert first[2:6] == [' *', ' * Assumed, since --set did not give them:', ' * plant.a = 1',
                          ' * plant.b * / = 2']
    assert 'Assumed' not in header('isa_own', 'the actuator own')
    done = compiled(text, tmp_path, 'c99')
    assert done.returncode == 0, done.stderr
