"""Numpy records whose fields have names, in kernels and in plain Python alike."""

from collections.abc import Collection
from functools import cache, lru_cache
import math
from typing import Any

from isa_ros.core.suggest import alternatives
import numpy as np
from numpy.typing import ArrayLike, NDArray


class Record(np.record):    # type: ignore[misc]  # with what a row has before numpy's own class
    """
    A row with its fields as attributes, in a third of the time that `numpy.record` takes.

    A field that is a row is one too, without another type made of it, in a tenth; `attributed` is
    of such. A row of several fields, ``row[['x', 'n']]``, is numpy's, without attributes.
    """

    __getattribute__ = np.void.__getattribute__
    __getitem__ = np.void.__getitem__   # type: ignore[assignment]  # of fewer arguments

    def __getattr__(self, name: str) -> Any:
        """Return a field; what numpy has of that name comes first."""
        try:
            return self[name]
        except ValueError:
            raise AttributeError(_unknown(name, self.dtype.names)) from None

    def __setattr__(self, name: str, value: Any) -> None:
        """Fill a field."""
        try:
            self[name] = value
        except ValueError:
            if name in (self.dtype.names or ()):
                raise
            raise AttributeError(_unknown(name, self.dtype.names)) from None


@lru_cache(256)     # a controller may ask for a field at each tick
def _unknown(name: str, names: tuple[str, ...] | None) -> str:
    known = '' if name.startswith('_') else f'; {alternatives(name, names or ())}'
    return f'no field {name}{known}'


def attributed(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """Return an equal type, less titles and alignment, whose rows at any depth are `Record`."""
    return dtype if dtype.type is Record else _attributed(dtype)


@cache
def _attributed(dtype: np.dtype[Any]) -> np.dtype[Any]:
    if dtype.subdtype is not None:
        return np.dtype((attributed(dtype.base), dtype.shape))
    if dtype.names is None or dtype.fields is None:
        return dtype
    return np.dtype((Record, {
        'names': dtype.names, 'formats': [attributed(dtype[name]) for name in dtype.names],
        'offsets': [dtype.fields[name][1] for name in dtype.names], 'itemsize': dtype.itemsize}))


def rows_of(n: int, dtype: np.dtype[np.void]) -> np.ndarray:
    """
    Return zeros of ``dtype``, (n,), whose rows have attributes in plain Python too.

    The array itself is a plain one: a numpy subclass as argument slows every call of a kernel.
    """
    return np.zeros(n, attributed(dtype))


def row_record(rows: np.ndarray) -> np.record:
    """Return the first row with its fields as attributes, on the same memory."""
    row: np.record = rows.view(attributed(rows.dtype))[0]
    return row


def record(dtype: np.dtype[np.void], /, **fields: ArrayLike) -> np.record:
    """
    Return one record of ``dtype``, each of its fields given by name.

    It has attributes, so that a kernel also runs on it as plain Python. A field that is itself
    a record is given as one: numpy would fill it from a tuple or another record by place.

    Raises
    ------
    TypeError
        A field is missing or unknown, or a nested one is not a record of its own type.

    """
    names = dtype.names or ()
    missing = [name for name in names if name not in fields]
    unknown = [name for name in fields if name not in names]
    if missing or unknown:
        raise TypeError(
            f'record of {", ".join(names)}: '
            f'missing {", ".join(missing) or "none"}, unknown {", ".join(unknown) or "none"}')
    row: np.record = rows_of(1, dtype)[0]
    for name, value in fields.items():
        nested = dtype[name]
        if nested.names is not None and getattr(value, 'dtype', None) != nested:
            raise TypeError(
                f'{name} = {value!r}, must be a record of {", ".join(nested.names)}')
        row[name] = value
    return row


def floats(rows: NDArray[np.void]) -> NDArray[np.float64]:
    """
    Return the memory of records of floats as numbers: (n, floats of a row) for rows (n, ...).

    Copying records takes a tenth of the time in this form.
    """
    n_floats = math.prod(rows.shape[1:]) * rows.itemsize // np.dtype(np.float64).itemsize
    return rows.view(np.float64).reshape(len(rows), n_floats)


def float_columns(record: np.dtype[np.void], first: int = 0) -> dict[str, int]:
    """Return the column of every float of a record by field, ``field[k]`` for an array."""
    columns: dict[str, int] = {}
    for name in record.names or ():
        n = record[name].itemsize // 8
        for k in range(n):
            columns[name if record[name].shape == () else f'{name}[{k}]'] = first
            first += 1
    return columns


def first_not_finite(
        rows: np.ndarray, may_be_nan: Collection[str] = ()) -> tuple[str, float] | None:
    """
    Return the path and value of the first float of some rows that is not finite, None if all are.

    Fields named in ``may_be_nan``, which are not nested, may be NaN, but not infinite.
    """
    if _is_all_floats(rows.dtype) and np.isfinite(rows.view(np.float64)).all():
        return None
    for name in rows.dtype.names or ():
        values = np.asarray(rows[name])
        if values.dtype.names is not None:
            broken = first_not_finite(values.copy())
            if broken is not None:
                return f'{name}.{broken[0]}', broken[1]
        elif values.dtype.kind == 'f':
            is_broken = np.isinf(values) if name in may_be_nan else ~np.isfinite(values)
            if is_broken.any():
                return name, float(values[is_broken][0])
    return None


@cache
def _is_all_floats(dtype: np.dtype[np.void]) -> bool:
    """Return whether a record is the memory of floats and of nothing else."""
    if dtype.names is None:
        return dtype.base == np.float64
    return all(_is_all_floats(dtype[name]) for name in dtype.names)
