"""Points to leave out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Optional, SupportsFloat, SupportsIndex, Union

import numpy as np
from . import _arguments as arguments
from . import _clouds, _core
from ._arguments import FloatArray, IndexArray
from ._clouds import CloudLike
from ._errors import InvalidInput
from ._progress import Progress, listening


@dataclass(frozen=True, eq=False, repr=False)
class Outliers:
    """Points that do not belong to the surface of the others."""

    indices: IndexArray  #: (o,) rows of the outliers, ascending, copies of them included
    scores: FloatArray  #: (n,) how far each point is off its neighbours' surface; nan: not finite
    threshold: float  #: scores above are outliers; 0 with "auto"
    rounds: int  #: passes over the points

    @property
    def inliers(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """(n,) True for all other points: ``points[outliers.inliers]``."""
        mask = np.ones(len(self.scores), dtype=np.bool_)
        mask[self.indices] = False
        return mask

    def __repr__(self) -> str:
        return (
            f"<spherical_param.Outliers: {len(self.indices)} of {len(self.scores)} points, "
            f"threshold {self.threshold:.4g}>"
        )


def deviations(name: str, sigma: Union[SupportsFloat, str]) -> Optional[float]:
    """None: stray points."""
    if not isinstance(sigma, str):
        number = arguments.real(name, sigma)
        if not 0 <= number <= 1000:
            raise InvalidInput(f'{name} = {number} is out of range; use 0 to 1000, or "auto"')
        return number
    if sigma == "auto":
        return None
    raise InvalidInput(f'{name} = "{sigma}" is no number; use 0 to 1000, or "auto"')


def find_outliers(
    points: CloudLike,
    *,
    sigma: Union[SupportsFloat, Literal["auto"]] = 4.0,
    k: SupportsIndex = 16,
    threads: SupportsIndex = 0,
    progress: Progress = None,
) -> Outliers:
    """Find points that are off the surface of their neighbours (section 4.2 of the paper).

    ``reconstruct`` makes a vertex of every point, outliers too: leave them out before, as in
    ``reconstruct(points[find_outliers(points).inliers])``.

    Parameters
    ----------
    points : array-like (n, 3), path, or cloud of Open3D or trimesh
        As for ``reconstruct``.
    sigma : float, 0 to 1000, or "auto"
        Outliers are farther off than the mean by this number of standard deviations. "auto": stray
        points, small clusters of them, points between sheets and single points a little off a
        surface, in spacings there; points of a surface are hardly ever among them.
    k : int, 3 and up
        Neighbours of each point that make its surface.
    threads : int, 0 (all) to 1024
        The result does not depend on it.
    progress : True, or callable(stage, fraction)
        As for ``reconstruct``; the stages are "neighbors" and "outliers", with "auto"
        "neighbors", "graph" and "outliers".

    Raises
    ------
    InvalidInput, Cancelled, MemoryError, KeyboardInterrupt

    Notes
    -----
    No guarantees: a group of outliers as dense as the surface is a surface of its own, and beyond
    the tip of a thin limb an outlier may be in the plane of its neighbours.
    """
    with listening(progress) as listener:
        return Outliers(
            **_core.find_outliers(
                _clouds.read("points", points, listener).points,
                sigma=deviations("sigma", sigma),
                k=arguments.integer("k", k, 3),
                threads=arguments.thread_count(threads),
                progress=listener,
            )
        )
