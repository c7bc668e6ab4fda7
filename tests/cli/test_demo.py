"""What `isa demo` prints: the paths in two lines, and a table of what happened."""

from argparse import Namespace

import isa_ros
from isa_ros.cli import commands


def test_the_paths_are_two_lines_and_a_table_follows(tmp_path, monkeypatch, capsys):
    """The run itself is that of a bring-up; here it is a short one in memory."""
    out = tmp_path / 'demo'

    def record(request):
        isa_ros.load('rig_rotary', 'step', duration=0.01).simulate().save(request.out)
        print(request.out)
        return Namespace(out=request.out)
    monkeypatch.setattr(commands, '_record', record)
    assert commands.demo(Namespace(out=out, is_alone=False))
    bag, page, _, header, rotor, *_ = capsys.readouterr().out.splitlines()
    assert bag == str(out / 'bag')
    n_figures = len(list(out.glob('*.png')))
    assert page == f'{out / "report.html"}, and {n_figures} figures beside it'
    assert header.split()[:3] == ['from', 'to', 'peak'] and rotor.startswith('rotor ')
