"""The shims declare the functions and types of the standard's headers, which fmpy ships."""

from importlib.resources import files
from pathlib import Path
import re
import subprocess

from isa_ros.export.fmi.unit import SHIMS
import pytest

fmpy = pytest.importorskip('fmpy')

HEADERS = Path(fmpy.__file__).parent / 'c-code'
SOURCES = files('isa_ros.export.fmi') / 'sources'


def shims(version):
    """Return the texts of a version by file."""
    return {name: (SOURCES / name).read_text() for own, names in SHIMS.items()
            if own.value[0] == str(version) for name in names if name.endswith('.c')}


@pytest.mark.parametrize('version', [2, 3])
def test_every_function_has_the_type_of_the_standard(version, tmp_path):
    """With the headers of the standard instead of their own types the shims compile, too."""
    for name, text in shims(version).items():
        assert text.count(f'#include "fmi{version}.h"') == 1
        (tmp_path / name).write_text(text.replace(
            f'#include "fmi{version}.h"', f'#include "fmi{version}Functions.h"'))
        done = subprocess.run(
            ['cc', '-std=c11', '-Wall', '-Wextra', '-Werror', '-c', f'-I{SOURCES}',
             f'-I{HEADERS}', name], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize('version', [2, 3])
def test_every_function_of_co_simulation_is_there(version):
    declared = set(re.findall(rf'(?<=TYPE)\s+(fmi{version}\w+);',
                              (HEADERS / f'fmi{version}Functions.h').read_text()))
    text = ''.join(shims(version).values())
    defined = set(re.findall(rf'EXPORT .*?\b(fmi{version}\w+)\(', text))
    for macro, names in (('WHOLE', ('Get', 'Set')), ('NO_VARIABLE', ('Get', 'Set')),
                         ('NO_FUNCTION', ('',))):
        for name in re.findall(rf'^{macro}\((\w+)', text, re.MULTILINE):
            defined |= {f'fmi{version}{verb}{name}' for verb in names}
    of_model_exchange = {
        'fmi2EnterEventMode', 'fmi2NewDiscreteStates', 'fmi2EnterContinuousTimeMode',
        'fmi2CompletedIntegratorStep', 'fmi2SetTime', 'fmi2SetContinuousStates',
        'fmi2GetDerivatives', 'fmi2GetEventIndicators', 'fmi2GetContinuousStates',
        'fmi2GetNominalsOfContinuousStates'}
    assert len(declared) > 40
    assert declared - defined == (of_model_exchange if version == 2 else set())
