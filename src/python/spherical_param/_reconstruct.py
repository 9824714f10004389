"""From points to a mesh."""

from __future__ import annotations

import inspect
from typing import Any, Literal, Optional, SupportsFloat, SupportsIndex

from numpy.typing import ArrayLike

from . import _arguments as arguments
from . import _core, _options
from ._arguments import ProgressFunction
from ._results import Result, make_result

_TABLE = _core.option_table()
_NAMES = [row["name"] for row in _TABLE]


def reconstruct(
    points: ArrayLike,
    *,
    details: bool = False,
    progress: Optional[ProgressFunction] = None,
    **options: Any,
) -> Result:
    """Mesh the points of an object without holes through it.

    The mesh is closed, manifold, oriented outward, of genus 0 and in one piece, and every distinct
    finite point is a vertex. No normals and no radius are needed, and the defaults need no tuning.

    Parameters
    ----------
    points : array-like, (n, 3)
        In any unit, any real type, worked on in double precision. At least 4 distinct finite points
        that are not all in one plane. Points with a coordinate that is not finite (or masked) are
        ignored, and counted.
OPTIONS

    Returns
    -------
    Result
        Mesh and map to the sphere; ``verdict``, ``findings`` and ``diagnosis`` say how
        far to trust them.

    Raises
    ------
    InvalidInput
        Points or an option are not as described. A subclass of ValueError.
    TypeError
        There is no such option.
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
                f"reconstruct() has no option {name!r}; use one of {', '.join(_NAMES)}, details "
                "or progress"
            )
    array = arguments.positions("points", points)
    options["threads"] = arguments.thread_count(options.get("threads", 0))
    fields = _core.reconstruct(
        array,
        options,
        details=arguments.truth("details", details),
        progress=arguments.progress_function(progress),
    )
    return make_result(fields, array)


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
    parameters = [signature.parameters["points"].replace(annotation=ArrayLike)] + keywords
    reconstruct.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=parameters, return_annotation=Result
    )
    reconstruct.__annotations__ = {each.name: each.annotation for each in parameters}
    reconstruct.__annotations__["return"] = Result
    text = reconstruct.__doc__
    if text:  # not with python -OO
        reconstruct.__doc__ = text.replace("OPTIONS", _options.documentation(_TABLE))


_describe()
