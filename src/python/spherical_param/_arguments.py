"""Arrays and options of callers are checked here, and converted to what the core takes."""

from __future__ import annotations

import operator
from contextlib import suppress
from typing import Any, SupportsFloat, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InvalidInput

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]
ByteArray = NDArray[np.uint8]


def thread_count(threads: SupportsIndex) -> int:
    """The most threads to work with; 0: all processors."""
    return integer("threads", threads, 0, 1024)


def _numbers(name: str, value: ArrayLike, kinds: str, remedy: str) -> NDArray[Any]:
    if isinstance(value, np.ma.MaskedArray) and value.dtype.kind in "fiu":
        # Masked points are ignored.
        masked: Any = value
        value = masked.astype(np.float64).filled(np.nan)
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise InvalidInput(
            f"{name} cannot be made an array ({error}); give an array with rows of one length"
        ) from error
    if array.dtype.kind == "O":
        # Such as rows of Fraction or Decimal; others are refused below.
        with suppress(TypeError, ValueError):
            array = array.astype(np.float64)
    for attribute in ("points", "vertices"):
        if array.dtype.kind == "O" and hasattr(value, attribute):
            raise InvalidInput(
                f"{name} has the unknown type {type(value).__name__}; pass np.asarray(pcd.{attribute})"
            )
    if array.dtype.kind not in kinds:
        raise InvalidInput(f"{name} is an array of {array.dtype}; give an array of {remedy}")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = "; give an array of shape (n, 3)"
        if array.ndim == 2 and array.shape[0] == 3:
            hint = "; it looks transposed, give its .T"
        elif array.ndim == 2 and array.shape[1] > 3:
            hint = "; give its first three columns, [:, :3]"
        raise InvalidInput(f"{name} has the shape {array.shape}, not (n, 3){hint}")
    return array


def positions(name: str, value: ArrayLike) -> FloatArray:
    """(n, 3) float64 in C order: the caller's own array, if it is one."""
    array = _numbers(name, value, "fiu", "real numbers, float64 best")
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array, dtype=np.float64)


def triangle_indices(name: str, value: ArrayLike) -> IndexArray:
    """(m, 3) int32 in C order."""
    array = _numbers(name, value, "iu", "integers, int32 best")
    limits = np.iinfo(np.int32)
    if array.size and (array.min() < limits.min or array.max() > limits.max):
        raise InvalidInput(f"{name} has an index beyond 32 bits; give indices of the points")
    return np.ascontiguousarray(array, dtype=np.int32)


def integer(name: str, value: SupportsIndex, least: int = -(2**31), most: int = 2**31 - 1) -> int:
    """An integer of a range, or of the range that the core can check."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InvalidInput(f"{name} = {value!r} is not an integer; give one") from None
    if not least <= number <= most:
        raise InvalidInput(f"{name} = {number} is out of range; use {least} to {most}")
    return number


def real(name: str, value: SupportsFloat) -> float:
    """A number; the core checks its range."""
    if isinstance(value, (str, bytes)):
        raise InvalidInput(f"{name} = {value!r} is not a number; give one")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name} = {value!r} is not a number; give one") from None


def truth(name: str, value: bool) -> bool:
    """A flag; other values that count as true, such as a text, are mostly mistakes."""
    if not isinstance(value, (bool, np.bool_)):
        raise InvalidInput(f"{name} = {value!r} is neither True nor False; give one of them")
    return bool(value)


def choice(name: str, value: str, choices: tuple[str, ...]) -> str:
    """The name of a choice, checked before long work."""
    if not isinstance(value, str) or value not in choices:
        known = ", ".join(repr(known) for known in choices)
        raise InvalidInput(f"{name} = {value!r} is not known; use one of {known}")
    return value
