"""The end of a process under `ros2 launch`; without imports from launch."""

from typing import Protocol


class ProcessEnd(Protocol):
    """Interface of launch's event that a process has ended."""

    process_name: str
    returncode: int


class LaunchState(Protocol):
    """Interface of launch's context."""

    @property
    def is_shutdown(self) -> bool:
        """Return whether the launch ends already, for example after Ctrl-C."""
        ...


def refuse_failure(event: ProcessEnd, context: LaunchState) -> None:
    """
    Make the launch fail if a process has failed.

    Raises
    ------
    RuntimeError
        The process has failed. An exception in an event handler is the only way to an exit code
        of `ros2 launch` other than 0; launch prints it and ends the other processes.

    """
    if event.returncode and not context.is_shutdown:
        raise RuntimeError(f'{event.process_name}: ended with exit code {event.returncode}')
