"""Units in fmpy, an importer that others have written: both versions of FMI with one face."""

from collections.abc import Mapping, Sequence
import ctypes
from pathlib import Path
from typing import Any

from fmpy import calloc, extract, fmi2, fmi3, free, read_model_description
import numpy as np

STEP = 0.001
OK, WARNING, DISCARD, ERROR = range(4)


class Unit:
    """
    An instance of a unit in ``directory``, where it is unpacked.

    It is initialised with parameters by name in ``start`` at t = ``begin``, unless it ``waits``.
    ``messages`` are what it has reported: status and text.
    """

    def __init__(
            self, path: Path, directory: Path, start: Mapping[str, Any] = {}, *,
            begin: float = 0.0, waits: bool = False) -> None:
        own = read_model_description(str(path))
        self.is_3 = own.fmiVersion.startswith('3')
        self.variables = {one.name: one for one in own.modelVariables}
        self.messages: list[tuple[int, str]] = []
        if not directory.exists():
            extract(str(path), unzipdir=str(directory))
        make = fmi3.FMU3Slave if self.is_3 else fmi2.FMU2Slave
        self.slave: Any = make(
            guid=own.guid, unzipDirectory=str(directory), instanceName='one',
            modelIdentifier=own.coSimulation.modelIdentifier)
        self.callbacks: Any = None
        self.instantiate()
        self.begin, self.n_steps = begin, 0
        if not waits:
            self.initialise(start)

    def _log(self, status: int, message: bytes | str) -> None:
        text = message.decode() if isinstance(message, bytes) else message
        self.messages.append((status, text.replace('%%', '%')))

    def instantiate(self) -> None:
        """Make the instance, once more if it was made; what it says is added to ``messages``."""
        if self.is_3:
            self.callbacks = fmi3.fmi3LogMessageCallback(
                lambda _, status, category, message: self._log(status, message))
            self.slave.instantiate(logMessage=self.callbacks)
            return
        own = self.callbacks = fmi2.fmi2CallbackFunctions()
        own.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda _, instance, status, category, message: self._log(status, message))
        own.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        own.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.slave.instantiate(callbacks=own)

    def initialise(self, start: Mapping[str, Any] = {}) -> None:
        """Go from the creation to the first step."""
        self.set(start)
        if self.is_3:
            self.slave.enterInitializationMode(startTime=self.begin)
        else:
            self.slave.setupExperiment(startTime=self.begin)
            self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def _call(self, verb: str, name: str) -> Any:
        """Return getter or setter of the type of a variable."""
        kind = self.variables[name].type
        if kind == 'Enumeration':
            kind = 'Int64' if self.is_3 else 'Integer'
        return getattr(self.slave, f'{verb}{kind}')

    def set(self, values: Mapping[str, Any]) -> None:  # noqa: A003
        """Set variables by name, one after the other."""
        for name, value in values.items():
            self._call('set', name)([self.variables[name].valueReference], [value])

    def get(self, name: str) -> Any:
        """Return the value of a variable."""
        found, = self._call('get', name)([self.variables[name].valueReference])
        return found

    def numbers(self, names: Sequence[str]) -> np.ndarray:
        """Return the values of some variables as floats."""
        return np.array([float(self.get(name)) for name in names])

    @property
    def reached(self) -> float:
        """Return the time that it has reached by itself, s; FMI 2 has no variable for it."""
        if self.is_3:
            return float(self.get('time'))
        value = fmi2.fmi2Real()
        self.slave.fmi2GetRealStatus(self.slave.component, fmi2.fmi2LastSuccessfulTime,
                                     ctypes.byref(value))
        return value.value

    @property
    def t(self) -> float:
        """Return the time at which the next step begins, s."""
        return self.begin + self.n_steps * STEP

    def step(self, n: int = 1) -> None:
        """Make a step of n ticks."""
        self.slave.doStep(self.t, n * STEP)
        self.n_steps += n

    def outputs(self) -> list[str]:
        """Return the names of the outputs."""
        return [name for name, own in self.variables.items() if own.causality == 'output']

    def state(self) -> bytes:
        """Return the whole state as bytes."""
        get, to_bytes, _, _, free_state = self._of_states()
        held = get()
        try:
            return bytes(to_bytes(held))
        finally:
            free_state(held)

    def restore(self, state: bytes) -> None:
        """Continue from a `state`."""
        _, _, from_bytes, put, free_state = self._of_states()
        held = from_bytes(state)
        try:
            put(held)
        finally:
            free_state(held)

    def _of_states(self) -> Sequence[Any]:
        """Return what gets a state, makes bytes of it and a state of bytes, sets and frees it."""
        own = self.slave
        if self.is_3:
            return (own.getFMUState, own.serializeFMUState, own.deserializeFMUState,
                    own.setFMUState, own.freeFMUState)
        return (own.getFMUstate, own.serializeFMUstate, own.deSerializeFMUstate,
                own.setFMUstate, own.freeFMUstate)

    def close(self) -> None:
        """End the instance."""
        self.slave.terminate()
        self.slave.freeInstance()
