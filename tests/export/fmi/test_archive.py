"""The archive of a unit: equal bytes for equal parts, a clean library, a true description."""

from concurrent.futures import ThreadPoolExecutor
import subprocess
import zipfile

from isa_ros.core.objects import own_target, TARGETS
from isa_ros.core.units import in_si
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import choose
from isa_ros.export.fmi.description import description, Version
from isa_ros.export.fmi.unit import archive, made, parts_of
from isa_ros.export.fmi.variables import Home, Type, UnitRole
import pytest

OF_C = {'calloc', 'free', 'malloc', 'memcmp', 'memcpy', 'memset', 'snprintf', 'strcmp', 'strlen'}


@pytest.fixture(scope='module')
def own():
    return made(parts_of(choose('isa_v5')), own_target())


@pytest.mark.slow
@pytest.mark.parametrize('version', Version)
def test_equal_parts_are_equal_bytes(own, version):
    again = made(parts_of(choose('isa_v5')), own_target())
    assert again.token == own.token
    assert archive(again, version) == archive(own, version)


@pytest.mark.slow
def test_other_values_have_another_token(own):
    other = made(parts_of(choose('isa_v5', {'plant.drive.bore_mm': 33.0})), own_target())
    assert other.token != own.token


@pytest.mark.slow
@pytest.mark.parametrize('version', Version)
def test_the_library_needs_nothing_but_c_and_shows_nothing_but_fmi(own, version, tmp_path):
    (tmp_path / 'unit.fmu').write_bytes(archive(own, version))
    with zipfile.ZipFile(tmp_path / 'unit.fmu') as unit:
        path, = (name for name in unit.namelist() if name.startswith('binaries/'))
        assert unit.testzip() is None and set(unit.namelist()) == {'modelDescription.xml', path}
        (tmp_path / 'lib.so').write_bytes(unit.read(path))

    def symbols(*flags):
        done = subprocess.run(['nm', '-D', *flags, str(tmp_path / 'lib.so')], check=True,
                              capture_output=True, text=True)
        return [line.split()[-2:] for line in done.stdout.splitlines()]
    undefined = {name.partition('@')[0] for kind, name in symbols('--undefined-only')
                 if kind == 'U'}
    shown = {name for _, name in symbols('--defined-only')}
    assert undefined - {'__stack_chk_fail'} <= OF_C
    assert all(name.startswith(f'fmi{version.value[0]}') for name in shown) and len(shown) > 30


@pytest.mark.slow
def test_the_text_compiles_without_a_warning(own, tmp_path):
    for name, text in own.sources.items():
        (tmp_path / name).write_text(text)
    done = subprocess.run(
        ['cc', '-std=c11', '-O2', '-Wall', '-Wextra', '-Wpedantic', '-Werror', '-c',
         *(name for name in own.sources if name.endswith('.c'))], cwd=tmp_path,
        capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_a_compiler_of_another_processor_is_refused(own):
    with pytest.raises(ConfigError, match='--compiler cc is for .*, must be a C compiler for aar'):
        archive(own._replace(processor='aarch64'), Version.FMI3)
    assert 'aarch64' in TARGETS


@pytest.fixture(scope='module')
def table():
    return parts_of(choose('isa_v5')).table


def test_inputs_and_constants_have_places_without_gaps(table):
    for home in (Home.INPUT, Home.NUMBER, Home.TEXT):
        places = [own.place for own in table if own.home is home]
        assert places == list(range(len(places))) and len(places) > 10


def test_names_are_unique_and_say_what_they_are(table):
    assert len({own.name for own in table}) == len(table)
    for own in table:
        assert own.meaning and 'likewise' not in own.meaning or (
            own.role is UnitRole.OUTPUT), own.name


def test_what_may_be_set_starts_in_its_range(table):
    given = [own for own in table if own.home is Home.INPUT]
    assert {own.role for own in given} == {UnitRole.INPUT, UnitRole.START, UnitRole.TUNED}
    for own in given:
        assert own.start is not None
        assert own.low is None or own.low <= own.start, own.name
        assert own.high is None or own.start <= own.high, own.name


@pytest.mark.parametrize('version', Version)
def test_base_units_are_those_of_the_units(table, version):
    """Their factor is that of the listing; a pascal has kg, m and s."""
    from xml.etree import ElementTree as xml
    from isa_ros.export.fmi.description import About
    root = xml.fromstring(description(
        About('one', 'isa_one', '0' * 32, 'a unit', 0.001), table, version))
    base = {unit.get('name'): unit.find('BaseUnit') for unit in root.iter('Unit')}
    assert base['Pa'].attrib == {'kg': '1', 'm': '-1', 's': '-2'}
    assert base['MPa'].attrib == {'kg': '1', 'm': '-1', 's': '-2', 'factor': '1000000.0'}
    assert base['l/min'].get('factor') == repr(in_si('l/min').scale)
    assert base['celsius'].attrib == {'K': '1', 'offset': '273.15'}
    names = {own.unit for own in table if own.kind is Type.REAL} - {'', '1'}
    assert set(base) == names


@pytest.mark.slow
def test_instances_in_threads_give_the_same(cases, tmp_path):
    pytest.importorskip('fmpy')
    from tests.export.fmi.importing import Unit
    from tests.export.fmi.runs import inputs_of
    case = cases('moving')
    units = [Unit(case.paths[Version.FMI3], tmp_path / 'unit') for _ in range(4)]

    def run(unit):
        for tick in case.ticks:
            unit.set(dict(inputs_of(tick, False)))
            unit.step()
        return unit.state()
    with ThreadPoolExecutor(len(units)) as pool:
        assert len(set(pool.map(run, units))) == 1


@pytest.mark.parametrize('version', Version)
def test_the_description_has_the_tick_and_the_ranges_of_what_may_be_set(table, version):
    from xml.etree import ElementTree as xml
    from isa_ros.export.fmi.description import About
    root = xml.fromstring(description(
        About('one', 'isa_one', '0' * 32, 'a unit', 0.0005), table, version))
    assert root.find('DefaultExperiment').get('stepSize') == '0.0005'
    assert root.find('CoSimulation').get('fixedInternalStepSize') == (
        '0.0005' if version is Version.FMI3 else None)
    given = {one.get('name'): one if version is Version.FMI3 else one[0]
             for one in root.find('ModelVariables')}
    for own in table:
        if own.home is Home.INPUT and own.kind is Type.REAL:
            found = given[own.name]
            assert found.get('start') == repr(own.start), own.name
            assert (found.get('min'), found.get('max')) == tuple(
                None if bound is None else repr(bound) for bound in (own.low, own.high)), own.name
    assert given['setpoint.position'].get('max') == '0.1'
    assert (given['mode'].get('min'), given['mode'].get('max')) == ('1', '6')
