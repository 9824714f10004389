"""From points to a mesh."""

from __future__ import annotations

import inspect
import time
import warnings
from typing import (
    Any,
    Callable,
    Literal,
    Optional,
    SupportsFloat,
    SupportsIndex,
    Union,
    get_args,
)

import numpy as np

from . import _arguments as arguments
from . import _core, _options
from ._arguments import IndexArray
from ._clouds import CloudLike, read
from ._errors import ComputeError, InvalidInput
from ._outliers import deviations
from ._progress import Progress, listening
from ._results import Result, Source, make_result

PartsName = Literal["all", "largest", "each"]

_TABLE = _core.option_table()
_NAMES = [row["name"] for row in _TABLE]


def reconstruct(
    points: CloudLike,
    *,
    details: bool = False,
    parts: PartsName = "all",
    min_points: SupportsIndex = 50,
    outliers: Union[SupportsFloat, Literal["auto"], None] = None,
    progress: Progress = None,
    **options: Any,
) -> Union[Result, tuple[Result, ...]]:
    """Mesh the points of an object without holes through it.

    The mesh is closed, manifold, oriented outward, of genus 0 and in one piece, and every distinct
    finite point is a vertex. No normals and no radius are needed, and the defaults need no tuning.

    Parameters
    ----------
    points : array-like (n, 3), path, or cloud of another library
        An array in any unit, of any real type; the work is done in double precision. A structured
        array has x, y, z, and may have normals (nx, ny, nz or normal_x ...) and colours (red,
        green, blue or r, g, b, or rgb as PCL packs them). A file is .pcd, .ply, .obj, .xyz or
        .txt. Of Open3D a point cloud or mesh, of trimesh a PointCloud or Trimesh, the normals
        of which are not used. Colours and normals come along. At least 4 distinct finite points that are not all in one plane.
        Points with a coordinate that is not finite (or masked) are ignored, and counted.
OPTIONS

    Returns
    -------
    Result
        Mesh and map to the sphere; ``verdict``, ``findings`` and ``diagnosis`` say how far to trust
        them. With ``parts="each"`` a tuple of results, the part of most points first; parts that
        cannot be meshed are left out with a warning.

    Raises
    ------
    InvalidInput
        Points or an option are not as described. A subclass of ValueError.
    TypeError
        There is no such option.
    OSError
        A file cannot be read.
    ComputeError, Cancelled, MemoryError, KeyboardInterrupt

    Notes
    -----
    No guarantees: the mesh may intersect itself, and openings of the cloud are closed and its
    handles cut; ``diagnosis`` reports them. Below 2 KB of memory a point, 3 KB with a tolerance.
    The result does not depend on ``threads``; a forked process works with one. Ctrl-C and False of
    ``progress`` are noticed every second or two; the paper's own stages ("iterative", "qhull") may
    take longer.

    Examples
    --------
    >>> mesh = reconstruct(points)  # doctest: +SKIP
    >>> mesh.vertices, mesh.triangles  # doctest: +SKIP
    """
    for name in options:
        if name not in _NAMES:
            raise TypeError(
                f"reconstruct() has no option {name!r}; use one of {', '.join(_NAMES)}, details, "
                "parts, min_points, outliers or progress"
            )
    arguments.choice("parts", parts, get_args(PartsName))
    least = arguments.integer("min_points", min_points, 4)
    has_details = arguments.truth("details", details)
    threads = arguments.thread_count(options.get("threads", 0))
    keywords = dict(options)
    if outliers is not None:
        keywords["outliers"] = outliers
    if parts != "all":
        keywords.update(parts=parts, min_points=least)
    with listening(progress) as listener:
        cloud = read("points", points, listener)

        def mesh(rows: Optional[IndexArray], time_limit: Any) -> Result:
            values = {**options, "threads": threads, "time_limit": time_limit}
            fields = _core.reconstruct(
                cloud.points, rows, values, details=has_details, progress=listener
            )
            return make_result(fields, Source(cloud, keywords, rows, stray))

        is_kept = np.isfinite(cloud.points).all(axis=1)
        stray = None
        if outliers is not None:
            sigma = deviations("outliers", outliers)
            stray = _core.find_outliers(
                cloud.points, sigma=sigma, k=16, threads=threads, progress=listener
            )["indices"]
            is_kept[stray] = False
        elif parts == "all":
            return mesh(None, options.get("time_limit"))
        rows = np.flatnonzero(is_kept).astype(np.int32)
        if parts == "all":
            return mesh(rows, options.get("time_limit"))
        groups = _core.find_parts(
            cloud.points[rows], min_points=least, threads=threads, progress=listener
        )
        if not groups:
            raise InvalidInput(
                f"no part has {least} points; give a lower min_points, or leave parts out"
            )
        if parts == "largest":
            return mesh(rows[groups[0]], options.get("time_limit"))
        return _each([rows[group] for group in groups], options.get("time_limit"), mesh)


def _each(
    parts: list[IndexArray], time_limit: Any, mesh: Callable[[IndexArray, Any], Result]
) -> tuple[Result, ...]:
    """A result of each part; one that cannot be meshed is a warning."""
    end = None
    if time_limit is not None:
        end = time.monotonic() + arguments.real("time_limit", time_limit)
    results = []
    failures: list[Exception] = []
    points_left = sum(map(len, parts))
    for number, rows in enumerate(parts, 1):
        # Each part has its share of the time.
        share = None
        if end is not None:
            share = max(0.0, end - time.monotonic()) * len(rows) / points_left
        points_left -= len(rows)
        try:
            results.append(mesh(rows, share))
        except (InvalidInput, ComputeError) as error:
            failures.append(error)
            warnings.warn(
                f"part {number} of {len(parts)} ({len(rows)} points) cannot be meshed: {error}",
                stacklevel=3,
            )
    if not results:
        raise failures[0]
    return tuple(results)


def _describe() -> None:
    """Give reconstruct() the signature and documentation of all options."""
    kinds = globals()
    keywords = [
        inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=eval(kind, kinds)
        )
        for name, kind, default, *_ in _options.keywords(_TABLE)
    ]
    signature = inspect.signature(reconstruct)
    parameters = [signature.parameters["points"].replace(annotation=CloudLike)] + keywords
    reconstruct.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=parameters, return_annotation=Union[Result, tuple[Result, ...]]
    )
    reconstruct.__annotations__ = {each.name: each.annotation for each in parameters}
    reconstruct.__annotations__["return"] = Union[Result, tuple[Result, ...]]
    text = reconstruct.__doc__
    if text:  # not with python -OO
        reconstruct.__doc__ = text.replace("OPTIONS", _options.documentation(_TABLE))


_describe()
