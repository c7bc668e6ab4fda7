"""
The scripts that a shell reads.

All three find the command by going through the words of the line, so that `isa bus canopen` has
its own options; what takes a value offers the known ones, else files.
"""

from collections.abc import Callable, Mapping, Sequence
import shlex

from isa_ros.cli.completion.grammar import Argument, CommandGrammar

_BASH = """\
# Completion of isa for bash: source <(isa completion bash)
_isa() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} at= i
    COMPREPLY=()
    for ((i = 1; i < COMP_CWORD; i++)); do
        case "$at ${{COMP_WORDS[i]}}" in
            {paths}) at="$at ${{COMP_WORDS[i]}}" ;;
        esac
    done
    case "$at ${{COMP_WORDS[COMP_CWORD-1]}}" in
{values}
    esac
    local flags= words=
    case "$at" in
{commands}
    esac
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$flags" -- "$word"))
    else
        COMPREPLY=($(compgen -W "$words" -- "$word"))
    fi
}}
complete -o default -F _isa isa
"""

_ZSH = """\
#compdef isa
# Completion of isa for zsh: source <(isa completion zsh), after compinit
_isa() {{
    local at= i
    for ((i = 2; i < CURRENT; i++)); do
        case "$at ${{words[i]}}" in
            ({paths}) at="$at ${{words[i]}}" ;;
        esac
    done
    case "$at ${{words[CURRENT-1]}}" in
{values}
    esac
    local -a flags names
    case "$at" in
{commands}
    esac
    if [[ ${{words[CURRENT]}} == -* ]]; then
        _describe option flags
    else
        (($#names)) && _describe word names
        _files
    fi
}}
compdef _isa isa
"""

_FISH = """\
# Completion of isa for fish: isa completion fish | source
function __isa_at
    set -l at
    for word in (commandline -opc)[2..]
        if contains -- "$at $word" {paths}
            set at "$at $word"
        end
    end
    test "$at" = "$argv"
end
{commands}
"""


def script_of(shell: str, commands: Sequence[CommandGrammar]) -> str:
    """Return the script that completes ``commands`` in a shell of `SHELLS`."""
    return SHELLS[shell](commands)


def _bash(commands: Sequence[CommandGrammar]) -> str:
    values = _cases(commands, lambda own: (
        f'COMPREPLY=($(compgen -W {_quoted(own.values)} -- "$word")); return'
        if own.values else 'return'))
    return _BASH.format(
        paths=_paths(commands), values='\n'.join(values), commands='\n'.join(
            f'        {_at(own.path)}) flags={_quoted(list(_meanings(own)))} '
            f'words={_quoted(own.first_words)} ;;' for own in commands))


def _zsh(commands: Sequence[CommandGrammar]) -> str:
    values = _cases(commands, lambda own: _zsh_values(own) + 'return', opening='(')
    return _ZSH.format(
        paths=_paths(commands), values='\n'.join(values), commands='\n'.join(
            f'        ({_at(own.path)}) flags=({_described(_meanings(own))}) '
            f'names=({_described(_words(own))}) ;;' for own in commands))


def _zsh_values(own: Argument) -> str:
    known = f'compadd -- {" ".join(map(shlex.quote, own.values))}; ' if own.values else ''
    return known if own.is_closed else f'{known}_files; '


def _fish(commands: Sequence[CommandGrammar]) -> str:
    lines = []
    for own in commands:
        here = f"complete -c isa -n '__isa_at \"{_path(own.path)}\"'"
        lines += [f'{here} -f'] if own.below else []
        lines += [f'{here} -a {shlex.quote(name)} -d {_fish_text(summary)}'
                  for name, summary in _words(own).items()]
        for option in own.options:
            names = ' '.join(f'-l {flag[2:]}' if flag.startswith('--') else f'-s {flag[1:]}'
                             for flag in option.flags)
            value = ' -r' * option.takes_value + ' -f' * option.is_closed
            words = f" -a '{' '.join(option.values)}'" if option.values else ''
            lines.append(f'{here} {names}{value}{words} -d {_fish_text(option.meaning)}')
    return _FISH.format(
        paths=' '.join(_at(own.path) for own in commands if own.path), commands='\n'.join(lines))


SHELLS: Mapping[str, Callable[[Sequence[CommandGrammar]], str]] = {
    'bash': _bash, 'zsh': _zsh, 'fish': _fish}
"""What makes the script of each shell."""


def _path(path: Sequence[str]) -> str:
    """Return a path as the scripts hold it: a space before each word."""
    return ''.join(f' {word}' for word in path)


def _at(path: Sequence[str]) -> str:
    return shlex.quote(_path(path))


def _paths(commands: Sequence[CommandGrammar]) -> str:
    return '|'.join(_at(own.path) for own in commands if own.path)


def _cases(
        commands: Sequence[CommandGrammar], action: Callable[[Argument], str],
        opening: str = '') -> list[str]:
    """Return a line of a case for every option that takes a value."""
    return [
        f'        {opening}{"|".join(_at((*own.path, flag)) for flag in option.flags)}) '
        f'{action(option)} ;;'
        for own in commands for option in own.options if option.takes_value]


def _meanings(own: CommandGrammar) -> dict[str, str]:
    return {flag: option.meaning for option in own.options for flag in option.flags}


def _words(own: CommandGrammar) -> dict[str, str]:
    return {word: own.below.get(word, '') for word in own.first_words}


def _quoted(words: Sequence[str]) -> str:
    return shlex.quote(' '.join(words))


def _described(meanings: Mapping[str, str]) -> str:
    """Return words with their meanings, as _describe of zsh takes them."""
    return ' '.join(
        shlex.quote(word.replace(':', '\\:') + (f':{text}' if text else ''))
        for word, text in meanings.items())


def _fish_text(text: str) -> str:
    """Return a text in single quotes of fish, which knows other escapes than a shell of POSIX."""
    escaped = text.replace('\\', '\\\\').replace("'", "\\'")
    return f"'{escaped}'"
