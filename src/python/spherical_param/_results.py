"""What reconstruct() returns."""

from __future__ import annotations

import html
import json
import os
import tempfile
from dataclasses import dataclass
from enum import IntFlag
from functools import cached_property
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _arguments as arguments
from . import _core
from ._arguments import ByteArray, FloatArray, IndexArray
from ._clouds import Cloud
from ._errors import InvalidInput
from ._files import MeshExport, vertex_normals
from ._progress import Progress, listening


@dataclass(frozen=True)
class Topology:
    """Combinatorial properties of the mesh, counted on its triangles."""

    vertices: int  #: used by triangles
    edges: int  #: undirected
    triangles: int
    closed: bool  #: no edge has just one triangle
    manifold: bool  #: two triangles to each edge, one fan of them to each vertex
    oriented: bool  #: the triangles of each edge traverse it in opposite directions
    components: int
    euler_characteristic: int  #: V - E + F
    genus: Optional[int]  #: None unless closed, manifold and oriented


@dataclass(frozen=True, eq=False)
class Measures:
    """Size, place and mass properties of the mesh and the solid that it encloses.

    Volume, centroid and inertia are None where the mesh is open or folded, or more than 1 % of its
    triangles intersect.
    """

    volume: Optional[float]  #: [cubed unit of the input]
    area: float  #: [squared unit of the input]
    mean_edge_length: float  #: [unit of the input]
    box_min: FloatArray  #: (3,) corner of the box along the axes [unit of the input]
    box_max: FloatArray  #: (3,) the opposite corner
    centroid: Optional[FloatArray]  #: (3,) centre of mass of the solid
    inertia: Optional[FloatArray]  #: (3, 3) of the solid at unit density about the centroid


@dataclass(frozen=True, eq=False)
class Opening:
    """An opening of the sampled surface: a wide face of the neighbour graph."""

    loop: IndexArray  #: (l,) vertices around it, in order; one that it passes twice, twice
    boundary_length: float  #: of the loop [unit of the input]
    area: float  #: [squared unit of the input]
    spacing: float  #: distance of the points at the loop [unit of the input]
    width: float  #: of the disc that area and loop make [unit of the input]
    center: FloatArray  #: (3,) mean of the loop
    certainty: float  #: that it is one, from 0 at 3 spacings of width to 1 at 9
    is_flat: bool  #: the loop lies in a plane: perhaps a flat face without points
    is_filled: bool  #: the mesh has triangles there


@dataclass(frozen=True, eq=False)
class FilledHole:
    """Triangles over a place that is wide, and without points: probably an opening."""

    cause: str  #: "open", "handles" or "several_parts": what it is a trace of
    triangles: int
    area: float  #: [squared unit of the input]
    boundary_length: float  #: of all its rims [unit of the input]
    diameter: float  #: of the disc that area and boundary make [unit of the input]
    spacing: float  #: distance of the points at its rim [unit of the input]
    center: FloatArray  #: (3,)
    vertices: IndexArray  #: (r,) of its rim, ascending, at most 64
    loops: tuple[IndexArray, ...]
    """(l,) each: its boundary as closed loops of vertices that the mesh's edges join, with the filled
    hole on the left seen from outside; all of it, the longest first, each from its lowest vertex"""


@dataclass(frozen=True, eq=False)
class Handle:
    """Neighbours along the surface that the mesh tears apart: probably a handle."""

    edges: int  #: of the neighbour graph that are torn
    size: float  #: diagonal of the box around them [unit of the input]
    center: FloatArray  #: (3,)
    vertices: IndexArray  #: (r,) their ends, ascending, at most 64


@dataclass(frozen=True, eq=False)
class PartBridge:
    """Two parts of the cloud with a gap between them."""

    points: int  #: of the smaller part
    other_points: int  #: of the larger part
    gap: float  #: [unit of the input]
    spacing: float  #: distance of the points at its ends [unit of the input]
    center: FloatArray  #: (3,)
    vertices: IndexArray  #: (r,) the ends of its bridges, ascending, at most 64


@dataclass(frozen=True)
class Finding:
    """What to know of a mesh, and the keyword that deals with it."""

    text: str  #: "2 separate parts (395 and 5,633 points)"
    option: str  #: a keyword of reconstruct(); empty if none deals with it
    value: str  #: of that keyword
    is_fault: bool  #: a self-intersection, fold, filled opening, cut handle or joined part

    def __str__(self) -> str:
        if not self.option:
            return self.text
        try:
            float(self.value)
        except ValueError:
            return f"{self.text}: try {self.option}={json.dumps(self.value)}"
        return f"{self.text}: try {self.option}={self.value}"


class TriangleMark(IntFlag):
    """What is wrong at a triangle: ``Diagnosis.triangle_marks`` has the sum for each of them."""

    SELF_INTERSECTION = 1  #: it intersects another
    FILLED_HOLE = 2  #: it is part of a filled hole
    HANDLE = 4  #: at the ends of torn edges of a handle
    PART_BRIDGE = 8  #: at the ends of bridges between parts
    OUTSIDE_GRAPH = 16  #: at an edge between points that are no near neighbours


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """Does the cloud look like a closed surface without handles? The mesh always is one.

    ``triangle_marks``, with ``details``, has for each triangle the sum of

    ========================================  ==================================================
    ``TriangleMark.SELF_INTERSECTION`` (1)    it intersects another triangle
    ``TriangleMark.FILLED_HOLE`` (2)          it is part of a filled hole
    ``TriangleMark.HANDLE`` (4)               it is at the torn edges of a handle
    ``TriangleMark.PART_BRIDGE`` (8)          it is at a bridge between parts
    ``TriangleMark.OUTSIDE_GRAPH`` (16)       an edge joins points that are no near neighbours
    ========================================  ==================================================

    ``mesh.triangles[mesh.diagnosis.triangle_marks & TriangleMark.FILLED_HOLE > 0]`` are those over
    openings.
    """

    kind: str  #: "closed_genus0", "open", "handles", "several_parts" or "unclear"
    looks_closed_genus0: bool
    openings: int  #: filled holes that are a trace of nothing else
    is_one_sided: bool  #: like a band of Moebius; found with openings alone
    boundaries: int  #: loops around openings that the mesh leaves open
    filled_holes: tuple[FilledHole, ...]  #: by falling area
    handles: tuple[Handle, ...]  #: by falling number of edges
    bridges: tuple[PartBridge, ...]  #: by falling number of points
    edges_outside_graph: float  #: fraction of edges between points that are no near neighbours
    genus: Optional[int]
    """Handles of the surface, counted by the cycles of the neighbour graph; None where that was not
    needed or unknown"""
    triangle_marks: Optional[NDArray[np.uint8]]
    """(m,) with ``details``, for each triangle the sum of its ``TriangleMark``; else None"""


@dataclass(frozen=True)
class Bridge:
    """An edge that was added to join two parts of the neighbour graph."""

    start: int  #: vertex in one part
    end: int  #: vertex in the other
    length: float  #: [unit of the input]


@dataclass(frozen=True, eq=False)
class Graph:
    """Size of the neighbour graph, and what it took to connect it."""

    edges: int
    components: int  #: connected components before they were joined
    bridges: tuple[Bridge, ...]
    without_tangent_plane: IndexArray  #: (t,) vertices without a trustworthy tangent plane
    searched_again: int  #: points for which more neighbours were asked
    uncertified: int  #: points whose cell is not certified even so
    weak: int  #: points that too few neighbours agreed with, repaired


@dataclass(frozen=True)
class EmbeddingLevel:
    """Work on one level of the multilevel embedding."""

    nodes: int
    edges: int
    sweeps: int
    newton_iterations: int
    linear_iterations: int
    residual: float  #: mean length of the tangential Laplacian at the end [radius]


@dataclass(frozen=True, eq=False)
class Embedding:
    """How the embedding on the sphere ended."""

    stop_reason: str  #: "converged", "iteration_limit", "stagnated", "collapsed", "unfinished"
    iterations: int  #: steps made; of Newton's method for the multilevel embedding
    residual: float  #: mean tangential Laplacian [radius]
    residuals: FloatArray  #: (i,) before each step and at the end [radius]
    centroid_norm: float  #: length of the mean direction, in [0, 1]; 1: collapsed
    fallback_start: bool  #: the iteration collapsed, and a start that did not was taken instead
    levels: tuple[EmbeddingLevel, ...]  #: of the multilevel embedding, the finest first
    starts: int  #: of the coarsest level that were tried
    collapsed_starts: int  #: of these, rejected
    added_barrier: bool  #: a barrier holds it, which would collapse without
    energy: float  #: that of the weights, without the barrier

    @property
    def converged(self) -> bool:
        """Whether the residual came down to ``tolerance``."""
        return self.stop_reason == "converged"


@dataclass(frozen=True)
class Triangulation:
    """How the triangulation of the sphere came about."""

    hull_vertices: int  #: points that it held as vertices by itself
    reinserted: int  #: points that it left out, put back
    coincident: int  #: of these, at exactly the position of another point
    hull_rejected: bool  #: the hull could not be used, and all points were inserted one by one


@dataclass(frozen=True)
class OptimizationPhase:
    """What one phase of the optimisation did."""

    name: str
    tried: int  #: vertices or parts that were taken out
    moves: int  #: flips, or those taken out that stayed at another place
    energy_before: float  #: in the phase's own terms [unit of the input]
    energy: float
    self_intersections: Optional[int]  #: at its end; None if not looked for
    seconds: float


@dataclass(frozen=True)
class Optimization:
    """How the mesh was optimised on the points."""

    phases: tuple[OptimizationPhase, ...]
    energy: float  #: total absolute curvature and a penalty on needles [unit of the input]
    rough: float  #: fraction of rough vertices after the first flips, in [0, 1]
    noise_steps: int  #: of smoothing that it took because the cloud is noisy; 0: it is not
    smoothed_self_intersections: int  #: with ``noise_steps``: on the smoothed points
    is_out_of_time: bool  #: the time limit ended it early
    alignment: float  #: how far the sampling follows the curvature, in [-1, 1]
    unevenness: float  #: relative deviation of the distances of a point's neighbours


@dataclass(frozen=True)
class Consolidation:
    """What ``consolidation`` found and did; all zero without."""

    noise: float  #: median distance of the points from the surface [unit of the input]
    merged: int  #: points that became one with others, without exact duplicates
    max_displacement: float  #: of a point [unit of the input]
    mean_displacement: float
    rms_displacement: float


@dataclass(frozen=True)
class Smoothing:
    """The smoothed surface; all zero without ``smoothing``."""

    max_displacement: float  #: of a point [unit of the input]
    mean_displacement: float
    rms_displacement: float
    volume_before: float  #: [cubed unit of the input]
    volume_after: float
    self_intersections: int  #: pairs of triangles, on the smoothed points


@dataclass(frozen=True, eq=False)
class HistoryFrame:
    """One state of the embedding on its way."""

    level: int  #: that was worked on: 0 is the graph itself, 1 the next coarser
    nodes: int  #: of that level
    step: str  #: "start", "sweeps", "newton", "iteration" or "end"
    iteration: int  #: steps of this kind that were made on this level
    residual: Optional[float]  #: mean tangential Laplacian, where it is known [radius]
    sphere: FloatArray  #: (h, 3) unit vectors, of the history's vertices


@dataclass(frozen=True, eq=False)
class History:
    """How the embedding unfolded, for some of the vertices."""

    vertices: IndexArray  #: (h,) indices of vertices
    frames: tuple[HistoryFrame, ...]  #: in the order of the work; the last is the embedding


@dataclass(frozen=True, eq=False)
class Source:
    """What a result was made of, for its report."""

    cloud: Cloud
    keywords: dict[str, Any]
    rows: Optional[IndexArray]  #: that were meshed; None: all
    outliers: Optional[IndexArray]  #: rows that were left out; None: not looked for

    @property
    def left_out(self) -> Optional[IndexArray]:
        """Rows of other parts; None: not looked for."""
        if self.rows is None or "parts" not in self.keywords:
            return None
        is_left_out = np.isfinite(self.cloud.points).all(axis=1)
        is_left_out[self.rows] = False
        if self.outliers is not None:
            is_left_out[self.outliers] = False
        return np.flatnonzero(is_left_out).astype(np.int32)

    @property
    def command(self) -> str:
        """The call that made the result."""
        name = "points" if self.cloud.name is None else repr(self.cloud.name)
        keywords = (f", {key}={value!r}" for key, value in self.keywords.items())
        return f"spherical_param.reconstruct({name}{''.join(keywords)})"


@dataclass(frozen=True, eq=False, repr=False)
class Result(MeshExport):
    """A genus-0 mesh through all points, closed or open, its map to the sphere, and their quality.

    Vertices are the distinct finite points, in the order of the input; ``vertex_of_input`` and
    ``input_of_vertex`` carry anything that points have to the vertices and back:
    ``values[mesh.input_of_vertex]``. What is written or given to other libraries has the smoothed
    or consolidated points, if there are any, with normals and colours. In a notebook a result is shown by its
    report.
    """

    vertices: FloatArray  #: (v, 3) the points[input_of_vertex] [unit of the input]
    triangles: IndexArray  #: (m, 3) counter-clockwise seen from outside; m = 2v - 4 if closed
    sphere: FloatArray  #: (v, 3) unit vectors: the embedding of each vertex
    boundary: tuple[IndexArray, ...]
    """(l,) each: closed loops of vertices, with the surface on the left; empty of a closed mesh"""
    openings: tuple[Opening, ...]  #: of the surface, filled or not
    vertex_of_input: IndexArray  #: (n,) vertex of each input point; -1: left out
    input_of_vertex: IndexArray  #: (v,) first input point at that position
    outliers: IndexArray  #: points that belong to no surface but are vertices; see find_outliers
    duplicates: int  #: points that repeat an earlier one
    ignored: int  #: points that are not finite
    self_intersections: IndexArray  #: (s, 2) pairs of triangles that intersect, exactly found
    smoothed: Optional[FloatArray]  #: (v, 3) after ``smoothing``; None without
    consolidated: Optional[FloatArray]
    """(v, 3) after ``consolidation``, before smoothing: what the mesh was made of; None without"""
    topology: Topology  #: counted on ``triangles``
    measures: Measures  #: of the mesh on the input's points, or the consolidated ones
    diagnosis: Diagnosis  #: does the cloud look like a closed genus-0 surface?
    consolidation: Consolidation
    graph: Graph
    embedding: Embedding
    triangulation: Triangulation
    optimization: Optimization
    smoothing: Smoothing
    stages: dict[str, float]  #: wall time of each stage, in the order of the work [s]
    history: Optional[History]  #: how the embedding unfolded; None without ``history_vertices``
    vertex_residuals: Optional[FloatArray]
    """(v,) with ``details`` the length of the tangential Laplacian of ``sphere`` [radius]; else
    None"""
    intersecting_triangles: int  #: that intersect another, on the smoothed points if there are any
    usable: bool  #: at most 1 % of the triangles intersect
    verdict: str  #: a headline: "A sound mesh with 2 openings."
    findings: tuple[Finding, ...]  #: what to know, and what to do; empty if all is well
    colors: Optional[ByteArray]  #: (v, 3) of the points; None if they have none
    _source: Source

    @cached_property
    def normals(self) -> FloatArray:
        """(v, 3) of the points; if they have none, those of the mesh, weighted by angles."""
        given = self._source.cloud.normals
        if given is not None:
            return given[self.input_of_vertex]
        return vertex_normals(self._export_points(), self.triangles)

    def _export_normals(self) -> FloatArray:
        return self.normals

    def _export_colors(self) -> Optional[ByteArray]:
        return self.colors

    def report(self, path: Union[str, os.PathLike[str]], *, progress: Progress = None) -> None:
        """Write a page to look at: mesh, sphere, unfolding and findings, in one file.

        It opens in a browser without a network. The points are meshed once more, with what the page
        shows: until then nothing of that takes memory.

        Parameters
        ----------
        path
            A name that ends in .html.
        progress : True, or callable(stage, fraction)
            As for ``reconstruct``.

        Raises
        ------
        InvalidInput
            The name does not end in .html, the array of points was changed since, or the package
            was built without the page.
        OSError
            The file cannot be written.
        Cancelled, MemoryError, KeyboardInterrupt
        """
        if not os.fspath(path).lower().endswith(".html"):
            raise InvalidInput(f"{os.fspath(path)!r} is no name of a page; give one with .html")
        if not _core.has_report:
            raise InvalidInput(
                "this package was built without the page; install three.js (libjs-three) and build "
                "it again"
            )
        source = self._source
        if not np.array_equal(source.cloud.points[self.input_of_vertex], self.vertices):
            raise InvalidInput("the points were changed since; give reconstruct() a copy of them")
        threads = arguments.thread_count(source.keywords.get("threads", 0))
        with listening(progress) as listener:
            _core.write_report(
                os.fsencode(path),
                source.cloud.points,
                source.cloud.colors,
                source.rows,
                source.outliers,
                source.left_out,
                {**source.keywords, "threads": threads},
                input=source.cloud.name or "points",
                command=source.command,
                progress=listener,
            )

    def _repr_html_(self) -> Optional[str]:
        """The report, as notebooks show it."""
        if not _core.has_report:
            return None
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder, "page.html")
            self.report(page)
            text = html.escape(page.read_text(encoding="utf-8"))
        return f'<iframe srcdoc="{text}" width="100%" height="700" style="border: 0"></iframe>'

    def _export_points(self) -> FloatArray:
        moved = self.consolidated if self.smoothed is None else self.smoothed
        return self.vertices if moved is None else moved

    def __repr__(self) -> str:
        volume = self.measures.volume
        enclosed = "" if volume is None else f", volume {volume:.6g}"
        return (
            f"<spherical_param.Result: {self.verdict} {len(self.vertices)} vertices, "
            f"{len(self.triangles)} triangles, area {self.measures.area:.6g}{enclosed}>"
        )


def make_result(fields: dict[str, Any], source: Source) -> Result:
    fields["boundary"] = tuple(fields["boundary"])
    fields["openings"] = tuple(Opening(**opening) for opening in fields["openings"])
    diagnosis = fields["diagnosis"]
    diagnosis["filled_holes"] = tuple(FilledHole(**hole) for hole in diagnosis["filled_holes"])
    diagnosis["handles"] = tuple(Handle(**handle) for handle in diagnosis["handles"])
    diagnosis["bridges"] = tuple(PartBridge(**bridge) for bridge in diagnosis["bridges"])
    graph = fields["graph"]
    graph["bridges"] = tuple(Bridge(**bridge) for bridge in graph["bridges"])
    embedding = fields["embedding"]
    embedding["levels"] = tuple(EmbeddingLevel(**level) for level in embedding["levels"])
    optimization = fields["optimization"]
    optimization["phases"] = tuple(OptimizationPhase(**phase) for phase in optimization["phases"])
    history = fields["history"]
    if history is not None:
        history["frames"] = tuple(HistoryFrame(**frame) for frame in history["frames"])
        fields["history"] = History(**history)
    fields.update(
        topology=Topology(**fields["topology"]),
        measures=Measures(**fields["measures"]),
        diagnosis=Diagnosis(**diagnosis),
        graph=Graph(**graph),
        embedding=Embedding(**embedding),
        triangulation=Triangulation(**fields["triangulation"]),
        optimization=Optimization(**optimization),
        consolidation=Consolidation(**fields["consolidation"]),
        smoothing=Smoothing(**fields["smoothing"]),
        findings=tuple(Finding(**finding) for finding in fields["findings"]),
    )
    vertices = fields["input_of_vertex"]
    colors = source.cloud.colors
    return Result(
        vertices=source.cloud.points[vertices],
        colors=None if colors is None else colors[vertices],
        _source=source,
        **fields,
    )
