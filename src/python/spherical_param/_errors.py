"""Exceptions of the package. Their messages are "cause; remedy"."""

from __future__ import annotations

__all__ = ["Cancelled", "ComputeError", "InvalidInput"]


class InvalidInput(ValueError):
    """The caller's mistake, found before the work begins: an array or option is not as it must be.

    The message names what was given, and what to give instead.
    """


class ComputeError(RuntimeError):
    """A computation that could not be carried out although the input was valid.

    Not converging is a result, never a ComputeError.
    """


class Cancelled(RuntimeError):
    """The progress function returned False."""


for _error in (InvalidInput, ComputeError, Cancelled):
    _error.__module__ = "spherical_param"
