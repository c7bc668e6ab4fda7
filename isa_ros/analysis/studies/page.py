"""Studies as text, as JSON, and as the page docs/studies.md with its figures."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
import textwrap
from typing import Any

from isa_ros.analysis.studies.figure import study_figure
from isa_ros.analysis.studies.measure import MeasuresAt, RIPPLE_S, Studied
from isa_ros.analysis.studies.studies import Case, STUDIES, Study
from isa_ros.text.page import Page, png_with_palette
from isa_ros.text.table import aligned, digits, RIGHT

PAGE = 'studies.md'
LINE = 99       # characters
_HEAD = """# Studies

What the paper announces to analyse with its simulation: one parameter at a time, everything else
as shipped, on the smart manifold with the gains of Table 4 and on the ISA v5 with its default
gains. This page and its figures are written by

    ./isa study --all --out docs

A star marks the shipped value. Rise (10 to 90 %) and overshoot are those of a step of 10 % of
the rating against a blocked output at mid stroke, the -3 dB of sines as large (-: outside of 10
to 160 Hz). A ripple is half of peak to peak, of what is left 0.8 s after such a step up or back
down: at mid stroke, near the stop at 2 % of the stroke, where the oil is stiffest, and while
standing on the wheel after a trot. *At* is the frequency of the largest, told where it exceeds
2 % of the step. The errors are rms in a trot at 1 m/s: the wheel of the manifold moves as HFE, a
mass of 50 kg on the ISA v5 as the piston of KFE, without feed-forward.
"""


def head(result: Studied) -> tuple[str, ...]:
    """Return the names of the columns."""
    force = result.force_unit
    return (result.case.unit.symbol, 'rise, ms', 'overshoot, %', '-3 dB, Hz',
            f'ripple mid, {force}', f'near stop, {force}', f'on wheel, {force}', 'at, Hz',
            f'error, {force}', f'error, {result.position_unit}')


def cells(result: Studied, outcome: MeasuresAt) -> tuple[str, ...]:
    """Return a row of the table."""
    at = '-' if outcome.ripple_hz is None else f'{outcome.ripple_hz:.3g}'
    step = (outcome.rise, outcome.overshoot, outcome.bandwidth)
    ripples = (outcome.ripple_mid, outcome.ripple_end, outcome.ripple_wheel)
    errors = (outcome.force_error, outcome.position_error)
    return (f'{outcome.value:g}{"*" if result.is_shipped(outcome) else ""}',
            *(digits(value, 3) for value in (*step, *ripples)),
            f'<= {at}' if outcome.ripple_hz == 1.0 / RIPPLE_S else at,
            *(digits(value, 3) for value in errors))


def as_text(study: Study, results: Sequence[Studied]) -> str:
    """Return what a terminal shows."""
    blocks = [f'{study.title} ({study.source})']
    for result in results:
        blocks.append('\n'.join([_name(result.case), *aligned(_table(result), RIGHT)]))
    return '\n\n'.join(blocks)


def _table(result: Studied) -> list[tuple[str, ...]]:
    return [head(result), *(cells(result, outcome) for outcome in result.outcomes)]


def _name(case: Case) -> str:
    added = ''.join(f' + {variant}' for variant in case.variants)
    return f'{case.model}, gains {case.preset}{added}: {", ".join(path for path, _ in case.paths)}'


def as_tree(study: Study, results: Sequence[Studied]) -> dict[str, Any]:
    """Return a study for JSON; null where there is no number."""
    names = [f.name for f in fields(MeasuresAt) if f.name != 'step']
    return {
        'name': study.name, 'title': study.title, 'source': study.source,
        'cases': [{
            'model': result.case.model, 'preset': result.case.preset,
            'variants': list(result.case.variants), 'unit': result.case.unit.symbol,
            'parameters': {path: share * result.case.unit.scale
                           for path, share in result.case.paths},
            'shipped': result.shipped, 'step': result.amplitude, 'force_unit': result.force_unit,
            'position_unit': result.position_unit,
            'outcomes': [{name: getattr(outcome, name) for name in names}
                         for outcome in result.outcomes],
        } for result in results]}


class _ByValue(Mapping[str, MeasuresAt]):
    """The outcomes of a result by their value as it is shown, for `Study.seen`."""

    def __init__(self, result: Studied) -> None:
        self._of = {f'{outcome.value:g}': outcome for outcome in result.outcomes}

    def __getitem__(self, value: object) -> MeasuresAt:
        return self._of[str(value)]

    def __iter__(self) -> Any:
        return iter(self._of)

    def __len__(self) -> int:
        return len(self._of)


def seen(study: Study, results: Sequence[Studied]) -> str:
    """Return what one sees in a study, its numbers filled in; '' for a part of it."""
    if study not in STUDIES:
        return ''
    text = study.seen.format_map({result.case.model: _ByValue(result) for result in results})
    return textwrap.fill(' '.join(text.split()), LINE)


def write_page(done: Sequence[tuple[Study, Sequence[Studied]]], directory: Path) -> list[Path]:
    """Write studies.md and figures/study_*.png into a directory; return their paths."""
    page = Page(PAGE, _HEAD)
    for study, results in done:
        page.section(study.title)
        page.paragraph(f'`isa study {study.name}`; {study.source}.')
        page.paragraph(seen(study, results))
        page.figure(f'study_{study.name}', study.title,
                    png_with_palette(study_figure(study.title, results)))
        for result in results:
            page.paragraph(_name(result.case))
            page.table(_table(result), RIGHT)
    return page.write(directory)
