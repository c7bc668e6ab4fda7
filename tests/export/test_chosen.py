"""Which actuator is exported, and its parameters."""

from isa_ros.config.text.changes import values_of
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported, word_of
from isa_ros.loads.sheets import Mass
import pytest


def test_a_model_has_its_load_at_the_port():
    chosen = choose('isa_v5')
    assert chosen.config.name == chosen.config.model == 'isa_v5' and chosen.config.load is None
    assert chosen.config.initial_position == 0.05
    own = choose('isa_v5', load='own')
    assert isinstance(own.config.load, Mass)
    assert not exported(chosen).has_own_load and exported(own).has_own_load


def test_an_actuator_of_a_run_file_keeps_its_load():
    assert isinstance(choose('rig_linear').config.load, Mass)
    assert isinstance(choose('rig_linear.yaml:ram').config.load, Mass)
    assert choose('rig_linear', load='port').config.load is None
    assert choose('leg:kfe').config.load is None


def test_only_the_chosen_one_loses_its_load(tmp_path):
    file = tmp_path / 'two.yaml'
    file.write_text('name: two\nsupply: {kind: constant, pressure_mpa: 18.0, '
                    'return_pressure_mpa: 0.1}\nactuators:\n'
                    '  a: {model: isa_v5, load: {kind: mass}}\n'
                    '  b: {model: isa_v2, load: {kind: mass}, initial_position_mm: 30.0}\n')
    chosen = choose(f'{file}:b', load='port')
    assert [own.load is None for own in chosen.run.actuators] == [False, True]
    start = exported(chosen).start[0].item()
    assert start == (0.03, 0.0, 18e6, 0.1e6)


def test_the_start_is_that_of_the_body():
    start = exported(choose('leg:kfe')).start[0]
    assert start['force'] < -10.0 and start['supply_pressure'] == 20.7e6


def test_values_of_the_actuator_and_of_the_run():
    values = values_of(['plant.drive.stroke_mm=80', 'step_ms=2'], '--set')
    chosen = choose('isa_v5', values)
    assert chosen.config.sheet.plant.drive.stroke_mm == 80.0
    assert exported(chosen).step_ns == 2_000_000
    leg = choose('leg:kfe', {'reu.force.kp': 9e-8})
    assert leg.run.actuator('kfe').sheet.reu.force.kp == 9e-8
    assert leg.run.actuator('hfe').sheet.reu.force.kp != 9e-8


def test_presets_and_variants_of_a_model():
    assert choose('isa_v5', preset='table_4').config.preset == 'table_4'
    reu = choose('isa_v5', variants=['position_control']).config.sheet.reu
    assert type(reu.position) is not type(choose('isa_v5').config.sheet.reu.position)


def test_parameters_have_names_values_and_sources():
    chosen = choose('rig_linear', {'load.inertia': 31.5, 'plant.oil.dead_volume_ml': 3.0})
    found = {row.parameter: (row, value) for row, value in chosen.parameters()}
    row, value = found['load.inertia']
    assert (row.value, row.source, value) == ('31.5', '--set', 31.5)
    assert found['plant.oil.dead_volume_ml'][0].source == '--set'
    row, value = found['load.force']
    assert (row.source, value) == ('assumed', 0.0)
    assert found['plant.kind'][1] == 'linear' and found['link.kind'][1] == 'none'
    assert found['plant.drive.rod_mm'][1] == 12.0
    row, _ = found['plant.oil.dead_volume_ml']
    assert row.unit == 'ml'


@pytest.mark.parametrize('text, message', [
    ('leg', r'^leg has 3 actuators, must be leg:ACTUATOR with one of haa, hfe, kfe$'),
    ('leg:kfee', r"^'kfee' is not an actuator of leg; did you mean kfe\?$"),
    ('leg:', r"^'' is not an actuator of leg; valid: haa, hfe, kfe$"),
    ('isa_v5:kfe', r'^isa_v5:kfe: isa_v5 is a model, must be a run file before a colon$'),
    ('isa_v6', r'^isa_v6: no such file; did you mean isa_v5 or isa_v2[?]$'),
])
def test_what_is_refused(text, message):
    with pytest.raises(ConfigError, match=message):
        choose(text)


def test_options_that_do_not_go_together():
    with pytest.raises(ConfigError, match='^--load own: kfe of leg moves a body, must have a '
                                          'load of its own$'):
        choose('leg:kfe', load='own')
    with pytest.raises(ConfigError, match='^--preset is not used: leg is not a model'):
        choose('leg:kfe', preset='default')
    with pytest.raises(ConfigError, match='^--variant is not used: leg is not a model'):
        choose('leg:kfe', variants=['x'])


def test_words():
    assert word_of('isa_v5') == 'isa_v5' and word_of('kfe') == 'isa_kfe'
    assert word_of('r1/KFE-2') == 'isa_r1_kfe_2' and word_of('kfe', 'knee') == 'knee'
    for given in ('Knee', '2knee', '', 'knee.c', 'k nee', 'knee\n'):
        with pytest.raises(ConfigError, match='^--name .*, must be lower-case letters'):
            word_of('kfe', given)
    for given in ('int', 'class', 'xor', 'bool', 'size', 'uint16', 'int_fast8', 'linux'):
        with pytest.raises(ConfigError, match=f'^--name {given} is a word or a type of C or C'):
            word_of('kfe', given)
    assert word_of('int') == 'isa_int' and word_of('kfe', 'int_') == 'int_'
    for actuator, given in (('sample', None), ('kfe', 'isa_port')):
        with pytest.raises(ConfigError, match=r'^isa_\w+ is a type of the header; choose'):
            word_of(actuator, given)
    assert word_of('kfe', 'port') == 'port'


STATED = ['plant.drive.bore_mm', 'plant.drive.rod_mm', 'plant.drive.stroke_mm',
          'plant.drive.rated_pressure_mpa', 'plant.valve.flow.rated_flow_lpm',
          'plant.valve.flow.rated_current_ma']


def test_what_data_sheets_would_have_is_assumed_where_it_is_not_given():
    chosen = choose('cylinder')
    assert chosen.assumed == tuple(STATED)
    assert chosen.assumptions[0] == 'plant.drive.bore_mm = 40' and len(chosen.assumptions) == 6
    sources = {row.parameter: row.source for row, _ in chosen.parameters()}
    assert {sources[key] for key in STATED} == {'assumed, not given'}
    drive = {'bore_mm': 50.0, 'rod_mm': 36.0, 'stroke_mm': 300.0, 'rated_pressure_mpa': 16.0}
    own = choose('cylinder', {
        'plant.drive': drive, 'actuators.cylinder.parameters.plant.valve.flow.rated_flow_lpm': 40})
    assert own.assumptions == ['plant.valve.flow.rated_current_ma = 10']
    sources = {row.parameter: row.source for row, _ in own.parameters()}
    assert sources['plant.drive.bore_mm'] == sources['plant.valve.flow.rated_flow_lpm'] == '--set'


def test_nothing_is_assumed_of_a_model_with_a_data_sheet_or_of_a_run_file():
    for chosen in (choose('isa_v5'), choose('rig_cylinder')):
        assert not chosen.assumed and chosen.assumptions == []


def test_one_value_with_two_keys_is_refused_unless_they_say_the_same():
    full = 'actuators.cylinder.parameters.plant.drive.bore_mm'
    with pytest.raises(ConfigError, match=(
            rf'^plant.drive.bore_mm = 40 and {full} = 50 are one value, must be given once$')):
        choose('cylinder', {'plant.drive.bore_mm': 40, full: 50})
    assert choose('cylinder', {'plant.drive.bore_mm': 50, full: 50}
                  ).config.sheet.plant.drive.bore_mm == 50.0


def test_a_name_for_the_bore_that_is_not_its_key_is_refused():
    for name in ('inner_diameter_mm', 'bore'):
        with pytest.raises(ConfigError, match=f'plant.drive.*{name}'):
            choose('cylinder', {'plant.drive.bore_mm': 40, f'plant.drive.{name}': 40})
