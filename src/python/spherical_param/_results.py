"""The results of reconstruct()."""

from __future__ import annotations

import html
import inspect
import os
import tempfile
from dataclasses import dataclass
from enum import IntFlag
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union
from zlib import crc32

import numpy as np

from . import _core
from ._arguments import ByteArray, FloatArray, IndexArray
from ._clouds import Cloud
from ._errors import InvalidInput
from ._figures import Finding, LeftOut, Surface, View
from ._files import MeshExport, vertex_normals
from ._progress import Progress, listening

__all__ = ["Result", "Results", "TriangleMark"]


class TriangleMark(IntFlag):
    """Faults at a triangle: ``Diagnosis.triangle_marks`` has the sum for each triangle.

    ========================================  ==================================================
    ``TriangleMark.SELF_INTERSECTION`` (1)    it intersects another triangle
    ``TriangleMark.FILLED_HOLE`` (2)          it is over an opening that is filled
    ``TriangleMark.PART_BRIDGE`` (4)          it is at a bridge between parts
    ``TriangleMark.OUTSIDE_GRAPH`` (8)        an edge joins points that are not neighbours
    ========================================  ==================================================

    ``mesh.triangles[mesh.diagnosis.triangle_marks & TriangleMark.FILLED_HOLE > 0]`` are those over
    openings.
    """

    SELF_INTERSECTION = 1
    FILLED_HOLE = 2
    PART_BRIDGE = 4
    OUTSIDE_GRAPH = 8


@dataclass(frozen=True, eq=False)
class Source:
    """The input of a result, for its report."""

    cloud: Cloud
    options: dict[str, Any]
    part: int  #: among the surfaces of the cloud
    checksum: int  #: of the points

    @property
    def command(self) -> str:
        """The call that made the result."""
        name = "points" if self.cloud.name is None else repr(self.cloud.name)
        keywords = (f", {key}={value!r}" for key, value in self.options.items())
        return f"spherical_param.reconstruct({name}{''.join(keywords)})"


class OfCloud(MeshExport):
    """A mesh whose vertices have what the points of a cloud have."""

    if TYPE_CHECKING:

        @property
        def _source(self) -> Source: ...
        @property
        def input_of_vertex(self) -> IndexArray: ...
    @cached_property
    def normals(self) -> FloatArray:
        """(v, 3) of the points, or else of the mesh, weighted by angles."""
        given = self._source.cloud.normals
        if given is not None:
            return given[self.input_of_vertex]
        return vertex_normals(self.vertices, self.triangles)

    @property
    def colors(self) -> Optional[ByteArray]:
        """(v, 3) of the points; None if they have none."""
        colors = self._source.cloud.colors
        return None if colors is None else colors[self.input_of_vertex]

    def _export_scalars(self) -> dict[str, FloatArray]:
        scalars = self._source.cloud.scalars
        return {name: values[self.input_of_vertex] for name, values in scalars.items()}


@dataclass(frozen=True, eq=False, repr=False)
class Result(Surface, OfCloud):
    """A mesh through all points, closed or open, its quality, and its map to the sphere.

    Vertices are the distinct finite points, in the order of the input, where consolidation and
    smoothing moved them, then ``added_vertices`` others; ``vertex_of_input`` and
    ``input_of_vertex`` carry anything that points have to the vertices and back:
    ``values[mesh.input_of_vertex]``. In a notebook a result is shown by its report.
    """

    vertex_of_input: IndexArray  #: (n,) vertex of each point of the cloud; -1: left out
    view: Optional[View]  #: the place from which the cloud is seen as one layer
    left_out: LeftOut  #: rows of the cloud in no surface, by reason
    stages: dict[str, float]  #: wall time of each stage, in the order of the work [s]
    _source: Source

    def report(self, path: Union[str, os.PathLike[str]], *, progress: Progress = None) -> None:
        """Write a page to look at: mesh, sphere and findings, in one file.

        It opens in a browser without a network. The points are meshed once more for the data of the
        page, which take no memory before.

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
            raise InvalidInput(f"{os.fspath(path)!r} does not end in .html; give a name that does")
        if not _core.has_report:
            raise InvalidInput(
                "this package was built without the page; install three.js (libjs-three) and build it again"
            )
        source = self._source
        if crc32(source.cloud.points.data) != source.checksum:
            raise InvalidInput("the points were changed since; give reconstruct() a copy of them")
        with listening(progress) as listener:
            _core.write_report(
                os.fsencode(path), source.cloud.points, source.cloud.colors, source.options,
                info=source.cloud.info, part=source.part, input=source.cloud.name or "points",
                command=source.command, progress=listener,
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

    def _export_added(self) -> ByteArray:
        marks = np.zeros(len(self.vertices), np.uint8)
        marks[len(marks) - self.added_vertices :] = 1
        return marks

    def __repr__(self) -> str:
        volume = self.measures.volume
        enclosed = "" if volume is None else f", volume {volume:.6g}"
        return (
            f"<spherical_param.Result: {self.verdict} {len(self.vertices)} vertices, "
            f"{len(self.triangles)} triangles, area {self.measures.area:.6g}{enclosed}>"
        )


if Result.__doc__ and Surface.__doc__:  # not with python -OO
    attributes = inspect.cleandoc(Surface.__doc__).partition("\n\n")[2]
    Result.__doc__ = f"{inspect.cleandoc(Result.__doc__)}\n\n{attributes}"


class Results(tuple[Result, ...], OfCloud):
    """The results of the surfaces of a cloud, the largest first, with a common verdict.

    All of them together are a mesh, too: the vertices of one after those of the other.
    """

    verdict: str  #: a headline: "3 surfaces, all sound."
    findings: tuple[Finding, ...]  #: of all results; with several, each names its parts
    failures: tuple[str, ...]  #: why parts could not be meshed
    view: Optional[View]  #: the place from which the cloud is seen as one layer
    left_out: LeftOut  #: rows of the cloud in no surface, by reason
    stages: dict[str, float]  #: wall time of each stage, over all parts [s]
    vertices: FloatArray  #: (v, 3) of all surfaces [unit of the input]
    triangles: IndexArray  #: (t, 3) of all surfaces, into ``vertices``
    input_of_vertex: IndexArray  #: (v,) row of the cloud of each vertex
    _is_added: ByteArray
    _source: Source

    def report(self, path: Union[str, os.PathLike[str]], *, progress: Progress = None) -> None:
        """Write a page to look at, of the largest surface. As ``Result.report``."""
        self[0].report(path, progress=progress)

    def _export_added(self) -> ByteArray:
        return self._is_added

    def _repr_html_(self) -> Optional[str]:
        return self[0]._repr_html_()

    def __repr__(self) -> str:
        return f"<spherical_param.Results: {self.verdict}>"


def make_results(fields: dict[str, Any], cloud: Cloud, options: dict[str, Any]) -> Results:
    """The results that the surfaces of the core become.

    ``vertex_of_input`` of a surface is about its own points, that of a result about the whole
    cloud.
    """
    checksum = crc32(cloud.points.data)
    results = []
    for part, surface in enumerate(fields.pop("surfaces")):
        vertex_of_input = np.full(len(cloud.points), -1, np.int32)
        vertex_of_input[surface["inputs"]] = surface["vertex_of_input"]
        surface["vertex_of_input"] = vertex_of_input
        common = {name: fields[name] for name in ("view", "left_out", "stages")}
        results.append(Result(**surface, **common, _source=Source(cloud, options, part, checksum)))
    whole = Results(results)
    vars(whole).update(fields, _source=results[0]._source)
    return whole
