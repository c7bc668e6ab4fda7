"""The sensitivity as text, as JSON, and as the page docs/sensitivity.md."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from isa_ros.text.page import Page
from isa_ros.text.table import aligned
from isa_ros.validation.sensitivity import PerturbationEffect

PAGE = 'sensitivity.md'
_SHOWN = 4      # entries in a cell of the page; the JSON has all
_HEAD = """# Sensitivity of the validation

Which simulated entries of [validation.md](validation.md) notice a wrong parameter. Each row is one
parameter times a factor, in all actuators, with everything else as shipped; the bars stay. An
entry that is reached as shipped and missed with the wrong parameter has noticed it. Entries that
read a parameter back do not count: `behaviour`, `limits` and `cavities` run for a parameter of the
plant, `rotary_rig` and `isa_v5` for one of the control blocks, `isa_v5` for the relief valves,
`current_loop` for the amplifier. A perturbation that no entry notices is a hole in the validation;
a value that the actuators refuse cannot go unnoticed.
This page is written by

    ./isa validate --sensitivity --out docs

and exits with 1 if a perturbation is not noticed. `--json FILE` writes every entry of every row.
"""


def as_text(found: Sequence[PerturbationEffect]) -> str:
    """Return the table a terminal shows."""
    rows = [(each.perturbation.name, str(len(each.flips)), _first(each, 2)) for each in found]
    return '\n'.join([*aligned([('perturbation', 'missed', 'among them'), *rows]), '',
                      summary(found)])


def summary(found: Sequence[PerturbationEffect]) -> str:
    """Return how many perturbations are noticed, and the names of those that are not."""
    holes = [each.perturbation.name for each in found if not each.flips and not each.refused]
    refused = sum(bool(each.refused) for each in found)
    return (f'{len(found)} perturbations: {len(found) - len(holes) - refused} noticed, '
            f'{refused} refused, {len(holes)} not noticed'
            + (f': {", ".join(holes)}' if holes else ''))


def _first(each: PerturbationEffect, shown: int = _SHOWN) -> str:
    """Return the first entries of each group in turn, as many as are shown."""
    if each.refused:
        return f'refused: {each.refused}'
    if not each.flips:
        return '**not noticed**'
    by_group: dict[str, list[str]] = {}
    for name in each.flips:
        by_group.setdefault(name.partition('.')[0], []).append(name)
    longest = max(map(len, by_group.values()))
    in_turn = [names[k] for k in range(longest) for names in by_group.values() if k < len(names)]
    left = len(in_turn) - shown
    return ', '.join(in_turn[:shown]) + (f', and {left} more' if left > 0 else '')


def as_tree(found: Sequence[PerturbationEffect]) -> dict[str, Any]:
    """Return the object of the JSON file."""
    return {'perturbations': [{
        'name': each.perturbation.name,
        'key': ', '.join(each.perturbation.change.keys),
        'factor': each.perturbation.change.factor,
        'flips': list(each.flips),
        'becomes_reached': list(each.becomes_reached),
        'refused': each.refused,
    } for each in found]}


def write_page(found: Sequence[PerturbationEffect], directory: Path) -> list[Path]:
    """Write sensitivity.md into a directory; return its path."""
    page = Page(PAGE, _HEAD)
    page.paragraph(f'{summary(found)}.')
    head = 'perturbation', 'keys', 'factor', 'missed', 'becomes reached', 'among the missed'
    page.table([head, *(
        (each.perturbation.name,
         ', '.join(f'`{key}`' for key in each.perturbation.change.keys),
         f'{each.perturbation.change.factor:.3g}', str(len(each.flips)),
         ', '.join(each.becomes_reached), _first(each)) for each in found)], 'llrrll')
    return page.write(directory)
