"""Completion, asked of the shells themselves where they are installed."""

from collections.abc import Sequence
from pathlib import Path
import re
import shutil
import subprocess

from isa_ros.cli.completion.grammar import commands_of
from isa_ros.cli.completion.scripts import script_of, SHELLS
from isa_ros.cli.main import main, make_parser
import pytest

COMMANDS = list(commands_of(make_parser()))

# What the shell would do with the line: the words it offers, one in a line, FILES for its files.
BASH = """
COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _isa
((${{#COMPREPLY[@]}})) || COMPREPLY=(FILES)
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
ZSH = """
compdef() {{ }}
source {script}
_describe() {{ local each; for each in ${{(P)2}}; do print -r -- ${{each%%:*}}; done }}
_files() {{ print FILES }}
compadd() {{ shift; print -rl -- $@ }}
words=({line}); CURRENT=${{#words}}; _isa
"""


def offered(shell: str, words: Sequence[str], tmp_path: Path) -> list[str]:
    """Return what a shell offers for the last of ``words``."""
    if shutil.which(shell) is None:
        pytest.skip(f'{shell} is not installed')
    script = tmp_path / f'isa.{shell}'
    script.write_text(script_of(shell, COMMANDS), encoding='utf-8')
    line = ' '.join(f"'{word}'" for word in words)
    if shell == 'fish':
        program = f'source {script}; complete -C "{" ".join(words)}"'
    elif shell == 'zsh':
        program = ZSH.format(script=script, line=line)
    else:
        program = f'source {script}\n' + BASH.format(line=line)
    arguments = {'bash': ['--norc'], 'zsh': ['-f'], 'fish': ['--no-config']}[shell]
    done = subprocess.run(
        [shell, *arguments, '-c', program], check=True, capture_output=True, text=True,
        timeout=60, cwd=tmp_path)
    assert not done.stderr
    found = [row.partition('\t')[0] for row in done.stdout.splitlines()]
    return [row for row in found if row.startswith(words[-1]) or row == 'FILES']


@pytest.mark.parametrize('shell', SHELLS)
@pytest.mark.parametrize('words, expected', [
    (['isa', 're'], ['recover', 'replay', 'report']),
    (['isa', 'bus', 'can'], ['canopen']),
    (['isa', 'bringup', 'leg', '--comp'], ['--compression']),
    (['isa', 'bringup', '--compression', 'l'], ['lz4']),
    (['isa', 'bringup', 'demo', '--scenario', 'tro'], ['trot', 'trot_leg']),
    (['isa', 'bus', 'canopen', 'leg', '--pace', 'real'], ['real_time']),
    (['isa', 'bode', '--loop', 'p'], ['position', 'pressure']),
    (['isa', 'bringup', 'rig_kn'], ['rig_knee']),
])
def test_a_shell_offers_what_may_follow(
        shell: str, words: list[str], expected: list[str], tmp_path: Path) -> None:
    """Of the command that is there, also below `isa bus`; `demo` is no command as a file."""
    found = [word for word in offered(shell, words, tmp_path) if word != 'FILES']
    assert sorted(found) == expected


@pytest.mark.parametrize('shell', ['bash', 'zsh'])
def test_files_are_offered_where_they_may_stand(shell: str, tmp_path: Path) -> None:
    assert offered(shell, ['isa', 'replay', ''], tmp_path) == ['FILES']
    assert offered(shell, ['isa', 'bringup', '--out', ''], tmp_path) == ['FILES']


@pytest.mark.parametrize('shell', SHELLS)
def test_every_command_and_option_is_in_the_script(
        shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    """As `isa completion` prints it; fish has flags without their dashes."""
    assert main(['completion', shell]) == 0
    printed = capsys.readouterr().out
    assert len(COMMANDS) > 20
    for command in COMMANDS:
        for name in command.below:
            assert name in printed
        for option in command.options:
            for flag in option.flags:
                own = flag.strip('-') if shell == 'fish' else flag
                assert re.search(rf"['( ]{own}[': )]", printed), flag


def test_an_option_has_its_own_command_and_values() -> None:
    by_path = {command.path: command for command in COMMANDS}
    options = {flag: option for option in by_path['bus', 'canopen'].options
               for flag in option.flags}
    assert options['--profile'].is_closed and options['--profile'].values == ('cia402', 'cia408')
    assert not options['--scenario'].is_closed and 'drop' in options['--scenario'].values
    assert not options['--no-ros'].takes_value and options['--no-ros'].meaning.startswith('no n')
    assert by_path['bringup',].first_words[0] == 'cooled_station'
    assert '(default' not in options['--pace'].meaning


def test_another_shell_is_refused_with_the_known_ones(
        capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(['completion', 'fsh'])
    assert ended.value.code == 2
    assert 'did you mean fish' in capsys.readouterr().err
