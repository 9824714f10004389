"""Surfaces of a cloud."""

from __future__ import annotations

from typing import SupportsIndex

from . import _arguments as arguments
from . import _clouds, _core
from ._arguments import IndexArray
from ._clouds import CloudLike
from ._progress import Progress, listening


def find_parts(
    points: CloudLike,
    *,
    min_points: SupportsIndex = 50,
    threads: SupportsIndex = 0,
    progress: Progress = None,
) -> tuple[IndexArray, ...]:
    """Take a cloud apart into its surfaces, each for a call of ``reconstruct``.

    ``reconstruct(points, parts="each")`` meshes them; ``find_parts(points)[0]`` is the largest.

    Parameters
    ----------
    points : array-like (n, 3), path, or cloud of Open3D or trimesh
        As for ``reconstruct``.
    min_points : int, 4 and up
        Distinct points of a part, at least.
    threads : int, 0 (all) to 1024
        The result does not depend on it.
    progress : True, or callable(stage, fraction)
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
    with listening(progress) as listener:
        return tuple(
            _core.find_parts(
                _clouds.read("points", points, listener).points,
                min_points=arguments.integer("min_points", min_points, 4),
                threads=arguments.thread_count(threads),
                progress=listener,
            )
        )
