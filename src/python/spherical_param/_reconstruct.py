"""From points to a mesh."""

from __future__ import annotations

import inspect
import warnings
from typing import Any, Optional, Union

from . import _arguments as arguments
from . import _core
from ._clouds import CloudLike, read
from ._progress import Progress, listening
from ._results import Result, Results, make_results

_TABLE = _core.option_table()
_NAMES = [row["name"] for row in _TABLE]


def reconstruct(
    points: CloudLike, *, columns: Optional[str] = None, details: bool = False, progress: Progress = None,
    **options: Any,
) -> Union[Result, Results]:
    """Mesh a point cloud.

    The mesh is manifold, oriented, and goes through the points. It has the parts, openings and
    handles that the cloud certainly shows, and leaves certain stray points out. With
    ``topology="sphere"`` it is one closed surface of genus 0 through every distinct finite point.
    No normals and no radius are needed, and the defaults need no tuning.

    Parameters
    ----------
    points : array-like (n, 3), path, or cloud of another library
        An array in any unit, of any real type; the work is done in double precision. A structured
        array has x, y, z, and may have normals (nx, ny, nz or normal_x ...) and colours (red,
        green, blue or r, g, b, or rgb as PCL packs them). A file is .pcd, .ply, .obj, or
        text of any extension. Of Open3D a point cloud or mesh, of trimesh a PointCloud or Trimesh, the normals
        of which are not used. Colours and normals come along. At least 4 distinct finite points
        that are not all in one plane.
        Points with a coordinate that is not finite (or masked) are left out and listed.
    OPTIONS
    columns : names, default None
        What the columns of a text file are, from the first on, e.g. "x,y,z,-,red,green,blue"; "-"
        is left out. None: what the file says, or looks like.
    details : bool, default False
        Fill ``Result.sphere`` also where the mesh is made without it, ``Result.vertex_residuals``
        and ``Diagnosis.triangle_marks``.
    progress : True, or callable(stage, fraction), default None
        True: a bar on the standard error. A function is called from the calling thread during the
        work. ``stage`` is "read", "view", "neighbors", "graph", "outliers", "parts",
        "consolidation", "openings", "embedding", "triangulation", "optimization", "smoothing",
        "cleaning", "fill" or "quality"; ``fraction``, in [0, 1], is that of the stage's current
        loop. If it returns False, the work ends with Cancelled; if it raises, with that exception.

    Returns
    -------
    Result or Results
        The mesh; ``verdict``, ``findings`` and ``diagnosis`` say how far to trust it. Of several
        surfaces, and always with ``parts="each"``, a tuple of results, the largest first, which is
        also the mesh of all; parts that cannot be meshed are left out with a warning.
        ``topology="sphere"`` and the other values of ``parts`` make one result.

    Raises
    ------
    InvalidInput
        Invalid points or option. A subclass of ValueError.
    TypeError
        Unknown option.
    OSError
        A file cannot be read.
    ComputeError, Cancelled, MemoryError, KeyboardInterrupt

    Notes
    -----
    No guarantees: the mesh may intersect itself, openings that are not certain are filled, and
    handles that are not certain are cut; ``diagnosis`` reports them. Below 2 KB of memory a point,
    3 KB with a tolerance. The result does not depend on ``threads``. Ctrl-C
    and False of ``progress`` are noticed every second or two; the paper's own method may take
    longer.

    Examples
    --------
    >>> mesh = reconstruct(points)  # doctest: +SKIP
    >>> mesh.vertices, mesh.triangles  # doctest: +SKIP
    """
    for name in options:
        if name not in _NAMES:
            raise TypeError(
                f"reconstruct() has no option {name!r}; use one of {', '.join(_NAMES)}, columns, details or progress"
            )
    has_details = arguments.truth("details", details)
    with listening(progress) as listener:
        cloud = read("points", points, listener, columns)
        fields = _core.reconstruct(cloud.points, options, info=cloud.info, details=has_details, progress=listener)
    for failure in fields["failures"]:
        warnings.warn(failure, stacklevel=2)
    results = make_results(fields, cloud, options)
    return results if len(results) > 1 or options.get("parts") == "each" else results[0]


def _describe() -> None:
    """Put the options of the table into the signature and the documentation of reconstruct()."""
    signature = inspect.signature(reconstruct)
    points, *others = [each for each in signature.parameters.values() if each.kind is not each.VAR_KEYWORD]
    options = [inspect.Parameter(row["name"], inspect.Parameter.KEYWORD_ONLY, default=row["default"]) for row in _TABLE]
    reconstruct.__signature__ = signature.replace(parameters=[points, *options, *others])
    rows = [f"{row['name']} : {row['range']}, default {row['default']!r}\n        {row['help']}" for row in _TABLE]
    if reconstruct.__doc__:  # not with python -OO
        reconstruct.__doc__ = reconstruct.__doc__.replace("OPTIONS", "\n    ".join(rows))


_describe()
