"""The parameters of all models, presets and variants, as declared."""

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.listing import ListedValue, rows
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.config.text.parameter_sets import build
from scripts.reference.markup import code, escaped, page, table

_HEAD = """\
Every parameter of an actuator, with unit, range and meaning, as it is declared. `isa params
MODEL` lists those of one model with values and their sources, `isa params FILE` those of a run;
in a run file they stand below `actuators.NAME.parameters`, and `--set KEY=VALUE` replaces one.
The last column names the variants of a model that alone have a key, where its default form has
not."""


def parameters_page() -> str:
    """Return the page, a section for each part of plant and REU."""
    found: dict[str, tuple[ListedValue, list[str]]] = {}
    for name in model_names():
        model = actuator_model(name, 'model')
        for variant in ('', *model.variants):
            section = model.with_variants(
                model.with_preset('default', 'preset'), [variant] if variant else [], 'variant')
            sheet = build(ActuatorSheet, section, model.place)
            for row in rows(sheet, section):
                own = found.setdefault(row.parameter, (row, []))[1]
                if name not in own:
                    own.append(f'{name}: {variant}' if variant else name)
    parts: dict[str, list[list[str]]] = {}
    for key, (row, places) in found.items():
        words = key.split('.')
        part = '.'.join(words[:2]) if len(words) > 2 else words[0]
        parts.setdefault(part, []).append([
            code(key), escaped(row.unit), escaped(row.bounds),
            'the form; the keys beside it depend on it' if words[-1] == 'kind'
            else escaped(row.meaning),
            'all' if set(places) >= set(model_names()) else ', '.join(places)])
    return page('Parameters of actuators', _HEAD, *(
        f'## {part}\n\n' + table(['key', 'unit', 'range', 'meaning', 'models'], lines)
        for part, lines in parts.items()))
