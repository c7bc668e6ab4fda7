"""Tables of an exported actuator: numbers and texts as a compiler reads them."""

import math
import subprocess

from isa_ros.export.tables import number, quoted
import numpy as np

TEXTS = ('plain, with spaces', 'quote " and \\ and \\n', '??/ ??=', 'line\nnext\ttab', 'µ °C 💧',
         '\x1b[31m\x7f', '%d %s', '1\x002')
NUMBERS = (0.1, -0.0, 1e308, 5e-324, 1 / 3, 1.0, -2.5e-7, math.inf, -math.inf)


def test_texts_and_numbers_arrive(tmp_path):
    rows = ', '.join(f'{{{quoted(text)}, sizeof {quoted(text)}}}' for text in TEXTS)
    numbers = ', '.join(map(number, NUMBERS))
    (tmp_path / 'text.c').write_text(
        '#include <math.h>\n#include <stdio.h>\n'
        'static const struct { const char *text; size_t size; } ROWS[] = {' + rows + '};\n'
        f'static const double NUMBERS[] = {{{numbers}}};\n'
        'int main(void) {\n'
        'for (int k = 0; k < (int)(sizeof ROWS / sizeof *ROWS); k++)\n'
        '  fwrite(ROWS[k].text, 1, ROWS[k].size, stdout);\n'
        'fwrite(NUMBERS, sizeof NUMBERS, 1, stdout);\nreturn 0; }\n')
    subprocess.run(['cc', '-std=c11', '-Wall', '-Wextra', '-Wpedantic', '-Werror', 'text.c', '-o',
                    'text'], cwd=tmp_path, check=True)
    found = subprocess.run([tmp_path / 'text'], capture_output=True, check=True).stdout
    expected = b''.join(text.encode() + b'\0' for text in TEXTS)
    assert found[:len(expected)] == expected
    assert found[len(expected):] == np.array(NUMBERS).tobytes()


def test_a_number_that_is_none():
    assert number(math.nan) == 'NAN' and quoted('') == '""'
