"""What the map to the sphere is for: low distortion, new meshes, texture coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, Optional, SupportsFloat, SupportsIndex, Union, get_args

import numpy as np
from numpy.typing import ArrayLike

from . import _arguments as arguments
from . import _core
from ._arguments import ByteArray, FloatArray, IndexArray
from ._errors import InvalidInput
from ._files import MeshExport
from ._progress import Progress, listening
from ._results import Result

__all__ = [
    "Distortion", "Remeshed", "SphereMap", "SphereMapLevel", "Statistics", "TextureCoordinates",
    "measure_map_distortion", "remesh", "sphere_map", "texture_coordinates",
]

GridName = Literal["icosahedral", "octahedral"]
FitName = Literal["smooth", "linear"]
ChartName = Literal["octahedral", "equirectangular", "cube"]


@dataclass(frozen=True)
class Statistics:
    """A quantity over the triangles of a mesh, each weighted by its area in space."""

    mean: float
    p95: float  #: the least value that 95 % of the area do not exceed
    max: float


@dataclass(frozen=True)
class Distortion:
    """How far a map from a mesh to the unit sphere is from an isometry."""

    flipped_triangles: int  #: 0: the map is one to one (an exact test)
    degenerate_triangles: int  #: without an area in space, no part of the statistics
    angle: Statistics  #: ratio of singular values, 1: conformal
    area: Statistics  #: ratio of the fractions of area, or its inverse, >= 1; 1: equal areas
    mean_angle_difference: float  #: of the corners [degree]
    stretch_efficiency: float  #: of Praun and Hoppe (2003), in (0, 1]; 1: no stretch


@dataclass(frozen=True)
class SphereMapLevel:
    """Work on one level of the hierarchy of meshes."""

    vertices: int
    sweeps: int
    energy: float  #: mean per unit of area


@dataclass(frozen=True, eq=False, repr=False)
class SphereMap:
    """A mesh with a map to the unit sphere that is one to one."""

    vertices: FloatArray  #: (v, 3) of the mesh [unit of the input]
    triangles: IndexArray  #: (m, 3) of the mesh, outward
    directions: FloatArray  #: (v, 3) unit vectors: the map
    caps: FloatArray  #: (c, 3) unit vectors: vertices inside the openings; none of a closed mesh
    distortion: Distortion  #: of the map
    before: Optional[Distortion]  #: of the embedding that was its start; None without one
    levels: tuple[SphereMapLevel, ...]  #: finest first
    colors: Optional[ByteArray] = None  #: (v, 3), if the points of the mesh had some

    @property
    def _arrays(self) -> tuple[FloatArray, IndexArray, FloatArray, FloatArray]:
        return self.vertices, self.triangles, self.directions, self.caps

    def interpolate(self, values: ArrayLike, triangles: IndexArray, weights: FloatArray) -> FloatArray:
        """Values of the vertices, (v,) or (v, c), at places in ``triangles``: (w,) or (w, c)."""
        corners = np.asarray(values, dtype=np.float64)[self.triangles[triangles]]
        places: FloatArray = np.einsum("ij...,ij->i...", corners, weights)
        return places

    def __repr__(self) -> str:
        return (
            f"<spherical_param.SphereMap: {len(self.vertices)} vertices, "
            f"{self.distortion.flipped_triangles} flipped triangles, "
            f"mean distortion of angles {self.distortion.angle.mean:.4g}, "
            f"of areas {self.distortion.area.mean:.4g}>"
        )


def _distortion(fields: dict[str, Any]) -> Distortion:
    fields["angle"] = Statistics(**fields["angle"])
    fields["area"] = Statistics(**fields["area"])
    return Distortion(**fields)


def _start(mesh: Result) -> FloatArray:
    """The embedding of a mesh that has a map to one sphere; (0, 3) without one."""
    handles = mesh.topology.genus or 0
    if mesh.has_certain_triangles_only:
        problem = 'is a tangle; give reconstruct() topology="sphere", which maps it as it is'
    elif mesh.topology.components > 1:
        problem = f'is in {mesh.topology.components} pieces; give reconstruct() topology="sphere", which joins them'
    elif handles:
        problem = f"has {handles} handle{'s' * (handles > 1)}; give reconstruct() handles=\"none\", which cuts them"
    else:
        return np.empty((0, 3)) if mesh.sphere is None else mesh.sphere
    raise InvalidInput(f"the mesh has no map to one sphere: it {problem}")


def _mesh(
    mesh: Union[Result, SphereMap, ArrayLike], triangles: Optional[ArrayLike], sphere: Optional[ArrayLike]
) -> tuple[FloatArray, IndexArray, FloatArray]:
    """Vertices, triangles and directions, or (0, 3), of what a function was given."""
    if isinstance(mesh, (Result, SphereMap)):
        if triangles is not None or sphere is not None:
            raise InvalidInput(
                f"triangles and sphere were given beside a {type(mesh).__name__}, which has its own; leave them out"
            )
        if isinstance(mesh, SphereMap):
            return mesh.vertices, mesh.triangles, mesh.directions
        return mesh.vertices, mesh.triangles, _start(mesh)
    if triangles is None:
        raise InvalidInput("points were given without triangles; give both, or the Result of reconstruct()")
    return (
        arguments.positions("points", mesh),
        arguments.triangle_indices("triangles", triangles),
        np.empty((0, 3)) if sphere is None else arguments.positions("sphere", sphere),
    )


def sphere_map(
    mesh: Union[Result, SphereMap, ArrayLike], triangles: Optional[ArrayLike] = None,
    sphere: Optional[ArrayLike] = None, *, area_weight: SupportsFloat = 0.85, sweeps: SupportsIndex = 15,
    threads: SupportsIndex = 0, progress: Progress = None,
) -> SphereMap:
    """Make a map of low distortion from a mesh to the sphere: one to one, no triangle flipped.

    Parameters
    ----------
    mesh : Result, SphereMap, or array-like (v, 3)
        A mesh of ``reconstruct``; or the points of one, with ``triangles``. One with handles needs
        ``handles="none"`` of ``reconstruct``, which cuts them.
    triangles : array-like of integers, (m, 3)
        Manifold, oriented outward, of genus 0, in one piece, each point used; openings stay open on
        the sphere.
    sphere : array-like, (v, 3)
        Unit vectors, the start: an embedding gives the map its orientation in space, and may have
        flipped triangles. A ``Result`` has one with ``details=True``.
    area_weight : float, 0 to 1
        Of areas (1) against angles (0).
    sweeps : int, 0 to 1000
        Sweeps of each level, at most; 0: the map is only made valid.
    threads, progress
        As for ``reconstruct``; the stage is "map".

    Raises
    ------
    InvalidInput
        The mesh has handles, or the mesh, the start or an option is not as described.
    ComputeError, Cancelled, MemoryError, KeyboardInterrupt
    """
    points, indices, start = _mesh(mesh, triangles, sphere)
    with listening(progress) as listener:
        fields = _core.sphere_map(
            points, indices, start, area_weight=arguments.real("area_weight", area_weight),
            sweeps=arguments.integer("sweeps", sweeps), threads=arguments.thread_count(threads),
            progress=listener,
        )
    return SphereMap(
        vertices=points.copy(), triangles=indices.copy(), directions=fields["sphere"], caps=fields["caps"],
        distortion=_distortion(fields["distortion"]),
        before=_distortion(fields["before"]) if len(start) else None,
        levels=tuple(SphereMapLevel(**level) for level in fields["levels"]),
        colors=mesh.colors if isinstance(mesh, (Result, SphereMap)) else None,
    )


def measure_map_distortion(
    mesh: Union[Result, SphereMap, ArrayLike], triangles: Optional[ArrayLike] = None,
    sphere: Optional[ArrayLike] = None, *, threads: SupportsIndex = 0,
) -> Distortion:
    """Measure how far a map from a mesh to the unit sphere is from an isometry.

    Parameters
    ----------
    mesh, triangles, sphere
        As for ``sphere_map``; any triangles, and unit vectors. A ``Result`` has the embedding with
        ``details=True`` or ``topology="sphere"``.
    threads : int, 0 (all) to 1024
        The result does not depend on it.

    Raises
    ------
    InvalidInput
        There is no embedding, sizes do not match, an index is out of range, or a number is not finite.
    """
    points, indices, directions = _mesh(mesh, triangles, sphere)
    if len(directions) == 0:
        raise InvalidInput("there is no sphere to measure; give unit vectors, or reconstruct() details=True")
    return _distortion(
        _core.measure_map_distortion(points, indices, directions, threads=arguments.thread_count(threads))
    )


@dataclass(frozen=True, eq=False, repr=False)
class Remeshed(MeshExport):
    """A surface that was sampled anew."""

    vertices: FloatArray  #: (w, 3) [unit of the input]
    triangles: IndexArray  #: (2w - 4, 3), outward
    normals: FloatArray  #: (w, 3) unit vectors, outward
    directions: FloatArray  #: (w, 3) unit vectors: the map to the sphere
    frequency: int  #: parts of each edge of the grid's solid
    self_intersections: IndexArray  #: (s, 2) pairs of triangles that intersect
    self_intersections_before: int  #: before vertices were slid along the surface
    moved: int  #: vertices that were slid
    flipped_edges: int  #: edges that were flipped thereafter
    source_triangle: IndexArray  #: (w,) triangle of ``map`` in which each direction lies
    source_weights: FloatArray  #: (w, 3) barycentric coordinates in it
    map: SphereMap  #: the surface that was sampled, with its map

    @cached_property
    def colors(self) -> Optional[ByteArray]:
        """(w, 3), if the points of the mesh had some."""
        if self.map.colors is None:
            return None
        return np.rint(self.transfer(self.map.colors)).astype(np.uint8)

    def transfer(self, values: ArrayLike) -> FloatArray:
        """Carry values from the vertices of ``map`` to these vertices.

        Parameters
        ----------
        values : array-like, (v,) or (v, c)
            For a ``Result`` of points that have values: ``values[result.input_of_vertex]``.

        Returns
        -------
        (w,) or (w, c) float64, interpolated over the triangles of ``map``.

        Raises
        ------
        InvalidInput
            There is not one value, or one row, for each vertex of ``map``.
        """
        array = np.asarray(values)
        if array.dtype.kind not in "biuf" or array.ndim not in (1, 2):
            raise InvalidInput(
                f"values have the type {array.dtype} and the shape {array.shape}; give real numbers, (v,) or (v, c)"
            )
        if len(array) != len(self.map.vertices):
            raise InvalidInput(
                f"there are {len(array)} values for {len(self.map.vertices)} vertices; give one "
                "for each vertex of map, such as values[result.input_of_vertex]"
            )
        return self.map.interpolate(array, self.source_triangle, self.source_weights)

    def __repr__(self) -> str:
        return (
            f"<spherical_param.Remeshed: {len(self.vertices)} vertices, "
            f"{len(self.triangles)} triangles, {len(self.self_intersections)} self-intersections>"
        )


def remesh(
    mesh: Union[Result, SphereMap, ArrayLike], triangles: Optional[ArrayLike] = None,
    sphere: Optional[ArrayLike] = None, *, grid: GridName = "icosahedral",
    points: Optional[SupportsIndex] = None, fit: FitName = "smooth", area_weight: SupportsFloat = 0.5,
    sweeps: SupportsIndex = 40, threads: SupportsIndex = 0, progress: Progress = None,
) -> Remeshed:
    """Sample a surface anew, with regular triangles and any number of points.

    The mesh is manifold, of genus 0, oriented outward, and open where the surface is. Where its
    triangles would intersect, vertices slide along the surface, then edges are flipped;
    ``self_intersections`` holds the rest.

    Parameters
    ----------
    mesh, triangles, sphere
        As for ``sphere_map``, which is called first; a ``SphereMap`` is taken as it is.
    grid : {"icosahedral", "octahedral"}
        The triangles of a geodesic sphere or a subdivided octahedron.
    points : int, 4 to 2**28
        Number of points; the nearest that the grid can have is taken. Default: as many as the mesh.
    fit : {"smooth", "linear"}
        The surface between the vertices: quadrics through them, or the triangles themselves.
    area_weight : float, 0 to 1; sweeps : int, 0 to 1000
        Of the map, as for ``sphere_map``; a grid likes one with less shear. Without effect on a
        ``SphereMap``.
    threads, progress
        As for ``reconstruct``; the stages are "map", "surface", "resample", "untangle" and
        "intersections".

    Raises
    ------
    InvalidInput
        The mesh has handles, or the mesh, the start or an option is not as described.
    ComputeError, Cancelled, MemoryError, KeyboardInterrupt
    """
    arguments.choice("grid", grid, get_args(GridName))
    arguments.choice("fit", fit, get_args(FitName))
    count = None if points is None else arguments.integer("points", points, 4, 2**28)
    if isinstance(mesh, SphereMap) and triangles is None and sphere is None:
        mapped = mesh
    else:
        options: Any = {"area_weight": area_weight, "sweeps": sweeps, "threads": threads, "progress": progress}
        mapped = sphere_map(mesh, triangles, sphere, **options)
    with listening(progress) as listener:
        fields = _core.remesh(
            mapped._arrays, grid=grid, count=len(mapped.vertices) if count is None else count, fit=fit,
            threads=arguments.thread_count(threads), progress=listener,
        )
    return Remeshed(map=mapped, **fields)


@dataclass(frozen=True, eq=False, repr=False)
class TextureCoordinates:
    """A mesh laid out in the unit square, cut where the layout is: no triangle wraps round."""

    vertices: FloatArray  #: (w, 3) of the cut mesh; the first v are those of the mesh, in order
    triangles: IndexArray  #: (m, 3) of the cut mesh, outward: the surface is what it was
    coordinates: FloatArray  #: (t, 2) (u, v) in [0, 1], u to the right and v up
    coordinate_triangles: IndexArray  #: (m, 3) rows of ``coordinates`` for each triangle
    source_triangle: IndexArray  #: (m,) triangle of the mesh that each is a part of
    source_vertices: IndexArray  #: (w, 3) vertices of the mesh between which each vertex lies
    source_weights: FloatArray  #: (w, 3) their weights, >= 0, with sum 1

    def __repr__(self) -> str:
        sizes = f"{len(self.triangles)} triangles, {len(self.coordinates)} coordinates"
        return f"<spherical_param.TextureCoordinates: {sizes}>"


def texture_coordinates(
    mesh: Union[Result, SphereMap, Remeshed], *, chart: ChartName = "octahedral", margin: SupportsFloat = 1.0 / 64
) -> TextureCoordinates:
    """Lay a mesh out in a chart of the sphere, for texture mapping.

    Parameters
    ----------
    mesh : SphereMap, Remeshed or Result
        A map that is one to one, or a mesh, for which ``sphere_map`` is called first.
    chart : {"octahedral", "equirectangular", "cube"}
        Layout, for images of 1:1, 2:1 and 3:2.
    margin : float, [0, 0.25)
        Free space around each face of a cube map, as a fraction of its side.

    Raises
    ------
    InvalidInput
        The mesh has handles, a triangle is flipped on the sphere, or an option is not as described.
    ComputeError, MemoryError, KeyboardInterrupt
    """
    if isinstance(mesh, Result):
        mesh = sphere_map(mesh)
    if not isinstance(mesh, (SphereMap, Remeshed)):
        raise InvalidInput(
            f"a {type(mesh).__name__} is no Result, SphereMap or Remeshed; give the mesh of "
            "reconstruct() or the map of sphere_map()"
        )
    fields = _core.texture_coordinates(
        mesh.triangles, mesh.directions, chart=arguments.choice("chart", chart, get_args(ChartName)),
        margin=arguments.real("margin", margin),
    )
    vertices = np.einsum("ijk,ij->ik", mesh.vertices[fields["source_vertices"]], fields["source_weights"])
    vertices[: len(mesh.vertices)] = mesh.vertices  # without rounding
    return TextureCoordinates(vertices=vertices, **fields)
