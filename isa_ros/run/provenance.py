"""The provenance of a run's bag: what its result depends on."""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from pkgutil import walk_packages
from types import MappingProxyType
from typing import Any

from isa_ros.bag.provenance import installed_versions, KERNELS, Provenance
from isa_ros.core import kernel
from isa_ros.core.kernel_key import digest_of
from isa_ros.core.saved_state import RunState
from isa_ros.core.value_text import is_kernel
from isa_ros.scenario.scenario import Scenario

_OF_TICK = ('actuator', 'loads', 'plant', 'reu', 'surroundings')
_PACKING = ('run.link_packing', 'run.pack_kernel')


def provenance_of(
        scenario: Scenario, state: RunState | None = None,
        bodies: Mapping[str, str] = MappingProxyType({})) -> Provenance:
    """
    Return what the bag of a run says about its making.

    ``state`` is where it goes on from, ``bodies`` the `Surroundings.provenance`.
    """
    run = scenario.run
    return Provenance(
        configuration=run.to_yaml(), scenario=scenario.to_yaml(), seed=run.seed,
        versions=recorded_versions(),
        state=None if state is None else state.to_json(run.digest, installed_versions()),
        bodies=bodies)


def recorded_versions() -> dict[str, str]:
    """Return the versions that a bag names: of packages, and of the kernels if compiled."""
    return installed_versions() | ({KERNELS: tick_digest()} if kernel.IS_COMPILED else {})


@cache
def tick_digest() -> str:
    """
    Return a digest of the kernels of a tick and all that they name, of the values at first sight.

    It changes with an equation, a constant, or a field of a record; it does not with words, lines
    and paths. Another minor release of Python has other bytecode, thus another digest.
    """
    return digest_of(_kernels()).hex()[:16]


def _kernels() -> Iterator[Any]:
    """Yield the kernels of all modules that a tick may use, in the order of their names."""
    names = [f'isa_ros.{name}' for name in _PACKING]
    for package in _OF_TICK:
        found = import_module(f'isa_ros.{package}')
        names += [module.name for module in walk_packages(found.__path__, f'{found.__name__}.')]
    for name in sorted(names):
        for _, value in sorted(vars(import_module(name)).items()):
            if is_kernel(value) and value.py_func.__module__ == name:
                yield value
