"""
Kernels as an object or a library of their own, for programs without Python.

An object is position-independent and has no undefined symbol: what machine code of kernels may
call of C is in it (`isa_ros.core.object_runtime`), and references to Python stand on paths that no
kernel takes and are removed. Its machine code gives the same bytes as that compiled for Python:
the same instructions of LLVM, which nothing may reorder or contract.
"""

from collections.abc import Mapping, Sequence
import json
from pathlib import Path
import re
import shutil
import subprocess
import tempfile
from typing import Any, NamedTuple

from isa_ros.core.compiler import compiled_entry, result_of
from isa_ros.core.elf import undefined_symbols
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_library import result_symbol
from isa_ros.core.kinds import result_form
from isa_ros.core.object_runtime import RUNTIME
from isa_ros.errors import ConfigError, one_line, RunError
import llvmlite.binding as llvm


class Target(NamedTuple):
    """A kind of processor, as it is named, and as LLVM names it."""

    name: str
    triple: str
    cpu: str


TARGETS: Mapping[str, Target] = {target.name: target for target in (
    Target('x86-64-v3', 'x86_64-unknown-linux-gnu', 'x86-64-v3'),
    Target('x86-64', 'x86_64-unknown-linux-gnu', 'x86-64'),
    Target('aarch64', 'aarch64-unknown-linux-gnu', 'generic'))}
"""By name; of one architecture the fastest first."""
_LENGTH = re.compile('[1-9][0-9]*')
_COUNTED = 'llvm.x86.atomic.sub.cc.i64'
_V3 = ('avx2', 'bmi', 'bmi2', 'f16c', 'fma', 'lzcnt', 'movbe')
"""What x86-64-v3 has beyond x86-64, as LLVM names it."""


def own_target() -> Target:
    """
    Return the fastest target whose code runs on this machine.

    Raises
    ------
    ConfigError
        None does.

    """
    architecture = llvm.get_process_triple().partition('-')[0]
    features = llvm.get_host_cpu_features()
    for target in TARGETS.values():
        is_missing = target.cpu == 'x86-64-v3' and not all(map(features.get, _V3))
        if target.triple.startswith(f'{architecture}-') and not is_missing:
            return target
    raise ConfigError(f'processor {architecture}: no target, valid: {", ".join(TARGETS)}')


def bitcode_of(entry: KernelEntry) -> bytes:
    """
    Return the bitcode of an entry, optimised for this processor: `object_of` makes objects of it.

    An entry that is neither compiled nor kept is compiled, and so kept.
    """
    target = own_target()
    machine = _machine(target)
    module = _retargeted(_module_of(entry), target, machine)
    _remove_unused(module, machine)
    function = entry.kernel.py_func
    module.get_function(_OWN).name = f'{function.__module__}.{function.__qualname__}'
    _number(module)
    code: bytes = module.as_bitcode()
    return code


def _number(module: Any) -> None:
    """
    Name functions that are not seen outside by their kernels, and all by the place in the module.

    The names of numba have numbers of what the process has compiled before.
    """
    for k, own in enumerate((*module.functions, *module.global_variables)):
        if own.linkage is llvm.Linkage.internal:
            own.name = f'{_kernel_name(own.name) if own.is_function else "constant"}.{k}'


def _kernel_name(name: str) -> str:
    """Return the name of a kernel with its module; numba's has the length of each word before."""
    words, rest = [], name.removeprefix('_ZN')
    while length := _LENGTH.match(rest):
        end = length.end() + int(length[0])
        words.append(rest[length.end():end])
        rest = rest[end:]
    return '.'.join(words) or name


def object_of(codes: Mapping[str, bytes], target: Target) -> bytes:
    """
    Return the object file (ELF) of entries by exported names, of the bitcode of each.

    Each has the C signature ``int64_t name(const int64_t *table)``; all else is internal, but for
    the text that says what a called entry returns. One that raises an error of Python ends the
    process.

    Raises
    ------
    ConfigError
        The object would have undefined symbols; they are named.
    RunError
        A bitcode is not whole.

    """
    machine = _machine(target)
    whole = _retargeted(llvm.parse_assembly(RUNTIME), target, machine)
    for name, code in codes.items():
        whole.link_in(_retargeted(_named(code, name), target, machine))
    undefined = _foreign_instructions(whole, target)
    made: bytes = b'' if undefined else machine.emit_object(whole)
    undefined = undefined or undefined_symbols(made)
    if undefined:
        names = ', '.join(codes)
        raise ConfigError(f'object of {names}: undefined {", ".join(undefined)}, must have none')
    return made


def _named(code: bytes, name: str) -> Any:
    """Return the module of an entry, which gets its exported name."""
    try:
        module = llvm.parse_bitcode(code)
    except RuntimeError as error:
        raise RunError(f'machine code: {one_line(str(error))}') from error
    for own in (*module.functions, *module.global_variables):
        if own.name in (ENTRY, result_symbol(ENTRY)):
            own.name = name + own.name.removeprefix(ENTRY)
    return module


def _foreign_instructions(module: Any, target: Target) -> list[str]:
    """Return the names of instructions that only other processors have: LLVM aborts at them."""
    own = 'x86' if target.triple.startswith('x86') else 'aarch64'
    return [function.name for function in module.functions
            if function.name.startswith(('llvm.x86.', 'llvm.aarch64.'))
            and not function.name.startswith(f'llvm.{own}.')]


def assembled(text: str, target: Target) -> bytes:
    """Return the object file of a text of LLVM as it is."""
    machine = _machine(target)
    code: bytes = machine.emit_object(_retargeted(llvm.parse_assembly(text), target, machine))
    return code


def _machine(target: Target) -> Any:
    """Return LLVM's machine for a target."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.cpu, opt=3, reloc='pic', codemodel='default')


ENTRY = 'entry'
"""The name of an entry in its bitcode."""
_OWN = 'own_entry'
_ENTRY = f"""
declare i32 @{_OWN}(ptr, ptr, ptr)
declare void @llvm.trap()
define i64 @{ENTRY}(ptr %table) {{
  %result = alloca i64
  %error = alloca ptr
  store i64 0, ptr %result
  %status = call i32 @{_OWN}(ptr %result, ptr %error, ptr %table)
  %is_done = icmp eq i32 %status, 0
  br i1 %is_done, label %done, label %raised
raised:
  call void @llvm.trap()
  unreachable
done:
  %number = load i64, ptr %result
  ret i64 %number
}}
"""
_TEXT = """
@{name} = constant [{size} x i8] c"{text}\\00"
"""


def _module_of(entry: KernelEntry) -> Any:
    """Return a module with an entry, of which nothing else is seen outside."""
    made = compiled_entry(entry)
    module = made.library._get_module_for_linking().clone()
    for function in module.functions:
        if function.name == made.fndesc.llvm_func_name:
            function.name = _OWN
        if not function.is_declaration:
            function.linkage = 'internal' if function.name != _OWN else 'external'
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = 'internal'
    text = _ENTRY
    if entry.is_called:
        form = json.dumps(result_form(result_of(entry)))
        text += _TEXT.format(
            name=result_symbol(ENTRY), size=len(form) + 1, text=form.replace('"', '\\22'))
    module.link_in(llvm.parse_assembly(text))
    module.get_function(_OWN).linkage = 'internal'
    return _portable(module)


def _portable(module: Any) -> Any:
    """
    Return a module without x86's instruction by which references to an array are counted down.

    Machine code of the compiling processor leaves it behind. It is for arrays that a kernel has
    allocated, and none of an object has.
    """
    if all(function.name != _COUNTED for function in module.functions):
        return module
    lines = (line for line in str(module).splitlines()
             if not (line.startswith('declare ') and f'@{_COUNTED}(' in line))
    text = '\n'.join((*lines, 'declare i8 @isa_counted(ptr, i64, i32)'))
    return llvm.parse_assembly(text.replace(f'@{_COUNTED}(', '@isa_counted('))


def _retargeted(module: Any, target: Target, machine: Any) -> Any:
    """Return a module as one for another machine."""
    module.triple, module.data_layout = target.triple, str(machine.target_data)
    return module


def _remove_unused(module: Any, machine: Any) -> None:
    """Remove what nothing refers to; the code was optimised when it was compiled."""
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))


_LINKED = ('--no-undefined', '-z', 'noexecstack')


def library_of(objects: Sequence[bytes], out: Path, compiler: str = 'cc') -> None:
    """
    Write a shared library of objects to ``out``; it depends on no other library.

    ``compiler`` links it; one whose name ends with ``ld`` is a linker itself.

    Raises
    ------
    ConfigError
        There is no such C compiler, or it fails, with its first line.

    """
    found = shutil.which(compiler)
    if found is None:
        raise ConfigError(f'{out}: no C compiler {compiler} to link it with')
    with tempfile.TemporaryDirectory() as directory:
        paths = [Path(directory, f'{k}.o') for k in range(len(objects))]
        for path, code in zip(paths, objects):
            path.write_bytes(code)
        options: tuple[str, ...] = (*_LINKED, f'-soname={out.name}')
        if not found.endswith('ld'):
            options = ('-nostdlib', f'-Wl,{",".join(options)}')
        done = subprocess.run([found, '-shared', *options, '-o', str(out), *map(str, paths)],
                              capture_output=True, text=True)
    if done.returncode:
        first = next(iter(done.stderr.splitlines()), f'exit code {done.returncode}')
        raise ConfigError(f'{out}: {compiler} cannot link it: {first}')
