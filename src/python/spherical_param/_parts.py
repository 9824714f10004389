"""Surfaces of a cloud."""

from __future__ import annotations

from typing import Optional, SupportsIndex

from numpy.typing import ArrayLike

from . import _arguments as arguments
from . import _core
from ._arguments import IndexArray, ProgressFunction


def find_parts(
    points: ArrayLike,
    *,
    min_points: SupportsIndex = 50,
    threads: SupportsIndex = 0,
    progress: Optional[ProgressFunction] = None,
) -> tuple[IndexArray, ...]:
    """Take a cloud apart into its surfaces, each for a call of ``reconstruct``.

    ``[reconstruct(points[part]) for part in find_parts(points)]`` meshes each by itself, and
    ``find_parts(points)[0]`` is the largest.

    Parameters
    ----------
    points : array-like, (n, 3)
        As for ``reconstruct``.
    min_points : int, 4 and up
        Distinct points of a part, at least.
    threads : int, 0 (all) to 1024
        The result does not depend on it.
    progress : callable(stage, fraction)
        As for ``reconstruct``; the stages are "neighbors" and "graph".

    Returns
    -------
    tuple of arrays of integers
        Rows of each part, ascending; the part of most points first. Points of no part, such as
        stray ones, are in none.

    Raises
    ------
    InvalidInput, Cancelled, MemoryError, KeyboardInterrupt

    Notes
    -----
    No guarantees: surfaces that touch are one part.
    """
    return tuple(
        _core.find_parts(
            arguments.positions("points", points),
            min_points=arguments.integer("min_points", min_points, 4),
            threads=arguments.thread_count(threads),
            progress=arguments.progress_function(progress),
        )
    )
