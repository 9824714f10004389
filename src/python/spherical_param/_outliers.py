"""Points to leave out, and surfaces of a cloud."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, SupportsFloat, SupportsIndex, Union

import numpy as np

from . import _clouds, _core
from ._arguments import IndexArray
from ._clouds import CloudLike
from ._errors import InvalidInput
from ._progress import Progress, listening

__all__ = ["Outliers", "find_outliers", "find_parts"]


@dataclass(frozen=True, eq=False, repr=False)
class Outliers:
    """Points that do not belong to the surface of the others."""

    indices: IndexArray  #: (o,) rows of the outliers, ascending, copies of them included
    inliers: np.ndarray[Any, np.dtype[np.bool_]]
    """(n,) True for all other points: ``points[outliers.inliers]``"""

    def __repr__(self) -> str:
        return f"<spherical_param.Outliers: {len(self.indices)} of {len(self.inliers)} points>"


def find_outliers(
    points: CloudLike, *, sigma: Union[SupportsFloat, Literal["auto"]] = 4.0, threads: SupportsIndex = 0,
    progress: Progress = None,
) -> Outliers:
    """Find the points that ``reconstruct(points, outliers=sigma)`` leaves out.

    Parameters
    ----------
    points : array-like (n, 3), path, or cloud of Open3D or trimesh
        As for ``reconstruct``.
    sigma : float, 0 to 1000, or "auto"
        Outliers deviate by more than the mean and this number of standard deviations (section 4.2
        of the paper). "auto": stray points, small clusters, points between sheets and isolated
        points a little off a surface; hardly ever points of a surface.
    threads, progress
        As for ``reconstruct``; the stages are "neighbors", "graph" and "outliers".

    Raises
    ------
    InvalidInput, Cancelled, MemoryError, KeyboardInterrupt

    Notes
    -----
    No guarantees: a group of outliers as dense as the surface is a surface of its own, and beyond
    the tip of a thin limb an outlier may be in the plane of its neighbours.
    """
    with listening(progress) as listener:
        cloud = _clouds.read("points", points, listener)
        try:
            indices = _core.find_outliers(cloud.points, {"outliers": sigma, "threads": threads}, progress=listener)
        except InvalidInput as error:  # which names the option of reconstruct()
            raise InvalidInput(str(error).replace("outliers", "sigma", 1)) from None
    inliers = np.ones(len(cloud.points), dtype=np.bool_)
    inliers[indices] = False
    return Outliers(indices, inliers)


def find_parts(
    points: CloudLike, *, min_points: SupportsIndex = 50, threads: SupportsIndex = 0, progress: Progress = None
) -> tuple[IndexArray, ...]:
    """Find the surfaces of a cloud that ``reconstruct(points, parts="each")`` meshes.

    Parameters
    ----------
    points : array-like (n, 3), path, or cloud of Open3D or trimesh
        As for ``reconstruct``.
    min_points : int, 4 and up
        Minimum number of distinct points of a part.
    threads, progress
        As for ``reconstruct``; the stages are "neighbors", "graph", "outliers"
        and "parts".

    Returns
    -------
    tuple of arrays of integers
        Rows of each part, ascending; the largest part first. Stray points are in no part.

    Raises
    ------
    InvalidInput, Cancelled, MemoryError, KeyboardInterrupt

    Notes
    -----
    No guarantees: surfaces that touch are one part.
    """
    with listening(progress) as listener:
        cloud = _clouds.read("points", points, listener)
        values = {"min_points": min_points, "threads": threads}
        parts: tuple[IndexArray, ...] = _core.find_parts(cloud.points, values, progress=listener)
    return parts
