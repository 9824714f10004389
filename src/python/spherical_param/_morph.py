"""One shape changed into another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, Optional, SupportsFloat, SupportsIndex, Union, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments as arguments
from . import _core
from ._arguments import ByteArray, FloatArray, IndexArray
from ._errors import InvalidInput
from ._files import MeshExport, vertex_normals
from ._maps import FitName, SphereMap, sphere_map
from ._progress import Progress, listening
from ._results import Result

__all__ = ["ImpossiblePair", "Morph", "MorphFrame", "morph"]

AlignName = Literal["rotation", "none"]
ConnectivityName = Literal["all", "resampled"]


@dataclass(frozen=True)
class ImpossiblePair:
    """A pair of vertices that could not be made one place."""

    pair: int  #: row of ``pairs``
    reason: str  #: one sentence


@dataclass(frozen=True, eq=False, repr=False)
class MorphFrame(MeshExport):
    """The mesh between two shapes at one time."""

    vertices: FloatArray  #: (w, 3)
    triangles: IndexArray  #: (m, 3), those of the morph
    colors: Optional[ByteArray]  #: (w, 3); None unless both shapes have colours

    @cached_property
    def normals(self) -> FloatArray:
        """(w, 3) of the mesh, weighted by angles."""
        return vertex_normals(self.vertices, self.triangles)


@dataclass(frozen=True, eq=False, repr=False)
class Morph:
    """Two shapes on one mesh."""

    triangles: IndexArray  #: (m, 3): manifold, of genus 0, outward; closed if both shapes are
    first: FloatArray  #: (w, 3) the first shape at the vertices
    second: FloatArray  #: (w, 3) the second one, moved and scaled with ``match``
    directions: FloatArray  #: (w, 3) unit vectors: places on the sphere of the first shape
    first_triangle: IndexArray  #: (w,) triangle of the first mesh in which each vertex lies
    first_weights: FloatArray  #: (w, 3) barycentric coordinates in it
    second_triangle: IndexArray  #: (w,) the same in the second mesh
    second_weights: FloatArray  #: (w, 3)
    rotation: FloatArray  #: (3, 3): what u is on the first sphere, rotation @ u is on the second
    alignment_error: float  #: mean squared distance, each centred and scaled to area 1, as rotated
    impossible: tuple[ImpossiblePair, ...]  #: left out; empty if all pairs are honoured
    worst_pair: float  #: largest distance of a pair where its motion ended [rad]
    first_colors: Optional[FloatArray]  #: (w, 3) from 0 to 255; None unless both have colours
    second_colors: Optional[FloatArray]

    def at(self, t: SupportsFloat) -> MorphFrame:
        """The mesh at a time: 0 is the first shape, 1 the second, [0, 1] lies between."""
        time = arguments.real("t", t)
        colors = None
        if self.first_colors is not None and self.second_colors is not None:
            mixed = (1 - time) * self.first_colors + time * self.second_colors
            colors = np.rint(mixed.clip(0, 255)).astype(np.uint8)
        return MorphFrame((1 - time) * self.first + time * self.second, self.triangles, colors)

    def __repr__(self) -> str:
        return (
            f"<spherical_param.Morph: {len(self.first)} vertices, {len(self.triangles)} "
            f"triangles, alignment error {self.alignment_error:.4g}>"
        )


def morph(
    first: Union[Result, SphereMap], second: Union[Result, SphereMap], *, pairs: Optional[ArrayLike] = None,
    align: AlignName = "rotation", connectivity: ConnectivityName = "all", samples: SupportsIndex = 40962,
    fit: Optional[FitName] = None, match: bool = False, area_weight: SupportsFloat = 0.85,
    sweeps: SupportsIndex = 15, threads: SupportsIndex = 0, progress: Progress = None,
) -> Morph:
    """Change one shape into another, by way of their maps to the sphere.

    ``morph(first, second).at(0.5).write("half.ply")`` is the mesh halfway.

    Parameters
    ----------
    first, second : Result or SphereMap
        The shapes; of a ``Result``, ``sphere_map`` is called first.
    pairs : array-like of integers, (p, 2)
        Vertices of both meshes that are the same place, such as
        ``first.vertex_of_input[point]``; at most 4096.
    align : {"rotation", "none"}
        Look for the best rotation of one sphere against the other, or take the maps as they are.
    connectivity : {"all", "resampled"}
        All vertices of both meshes and those where their edges cross, or a geodesic sphere.
    samples : int, 12 to 2**24
        Vertices of "resampled", about.
    fit : {"linear", "smooth"}
        The shapes between their vertices. Default: "linear"; with "resampled" "smooth".
    match : bool
        Move and scale the second shape to the centroid and the area of the first.
    area_weight : float, 0 to 1; sweeps : int, 0 to 1000
        Of the maps, as for ``sphere_map``. Without effect on a ``SphereMap``.
    threads, progress
        As for ``reconstruct``; the stages are "map" and "morph".

    Raises
    ------
    InvalidInput
        A shape has handles, or a shape or an option is not as described.
    ComputeError, Cancelled, MemoryError, KeyboardInterrupt
    """
    arguments.choice("align", align, get_args(AlignName))
    arguments.choice("connectivity", connectivity, get_args(ConnectivityName))
    if fit is None:
        fit = "smooth" if connectivity == "resampled" else "linear"
    arguments.choice("fit", fit, get_args(FitName))
    count = arguments.integer("samples", samples, 12, 2**24)
    is_matched = arguments.truth("match", match)
    maps = []
    for shape in (first, second):
        if not isinstance(shape, (Result, SphereMap)):
            raise InvalidInput(f"a {type(shape).__name__} cannot be morphed; give the Results of reconstruct()")
    for shape in (first, second):
        if isinstance(shape, Result):
            shape = sphere_map(shape, area_weight=area_weight, sweeps=sweeps, threads=threads, progress=progress)
        maps.append(shape)
    with listening(progress) as listener:
        fields = _core.morph(
            *(each._arrays for each in maps), pairs=_pairs(pairs), align=align == "rotation",
            connectivity=connectivity, samples=count, fit=fit, threads=arguments.thread_count(threads),
            progress=listener,
        )
    if is_matched:
        (center, area), (own_center, own_area) = (_center_and_area(each) for each in maps)
        scale = np.sqrt(area / own_area) if own_area > 0 else 1.0
        fields["second"] = scale * (fields["second"] - own_center) + center
    fields["impossible"] = tuple(ImpossiblePair(**pair) for pair in fields["impossible"])
    colors: list[Optional[FloatArray]] = [None, None]
    if all(each.colors is not None for each in maps):
        for side, name in enumerate(("first", "second")):
            values: Any = maps[side].colors
            colors[side] = maps[side].interpolate(values, fields[f"{name}_triangle"], fields[f"{name}_weights"])
    return Morph(**fields, first_colors=colors[0], second_colors=colors[1])


def _pairs(pairs: Optional[ArrayLike]) -> IndexArray:
    array: NDArray[np.generic] = np.empty((0, 2), np.int32) if pairs is None else np.asarray(pairs)
    if array.ndim != 2 or array.shape[1] != 2 or array.dtype.kind not in "iu":
        raise InvalidInput(f"pairs have the type {array.dtype} and the shape {array.shape}; give integers, (p, 2)")
    return np.ascontiguousarray(array, dtype=np.int32)


def _center_and_area(mesh: SphereMap) -> tuple[FloatArray, float]:
    """Of the surface."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1) / 2
    total = float(areas.sum())
    center: FloatArray = areas @ corners.mean(axis=1) / (total or 1.0)
    return center, total
