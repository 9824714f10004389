"""Meshes for other libraries, into files, and to look at."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _core
from ._arguments import ByteArray, FloatArray, IndexArray


def vertex_normals(points: FloatArray, triangles: IndexArray) -> FloatArray:
    """Unit normals: those of the triangles, weighted by their angles; 0 where all are degenerate."""
    sums = np.zeros_like(points)
    corners = points[triangles]
    for k in range(3):
        a = corners[:, (k + 1) % 3] - corners[:, k]
        b = corners[:, (k + 2) % 3] - corners[:, k]
        normals = np.cross(a, b)
        lengths = np.linalg.norm(normals, axis=1)
        angles = np.arctan2(lengths, (a * b).sum(axis=1))
        weights = np.divide(angles, lengths, out=np.zeros_like(angles), where=lengths > 0)
        for axis in range(3):
            sums[:, axis] += np.bincount(triangles[:, k], weights=weights * normals[:, axis], minlength=len(points))
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.divide(sums, lengths, out=np.zeros_like(sums), where=lengths > 0)


class MeshExport:
    """What results that hold a mesh can be turned into."""

    if TYPE_CHECKING:

        @property
        def vertices(self) -> FloatArray: ...
        @property
        def triangles(self) -> IndexArray: ...
        @property
        def normals(self) -> FloatArray: ...
        @property
        def colors(self) -> Optional[ByteArray]: ...
    def _export_added(self) -> Optional[ByteArray]:
        """(v,) 1 for each vertex that was added to the points, else 0; None if none can be."""
        return None

    def _export_scalars(self) -> dict[str, FloatArray]:
        """(v,) other numbers of the vertices, by their names."""
        return {}

    def to_trimesh(self) -> Any:
        """The mesh as a ``trimesh.Trimesh``, vertices and triangles as they are.

        Raises ImportError without trimesh.
        """
        import trimesh

        return trimesh.Trimesh(
            self.vertices, self.triangles, vertex_normals=self.normals, vertex_colors=self.colors, process=False
        )

    def to_open3d(self) -> Any:
        """The mesh as an ``open3d.geometry.TriangleMesh``. Raises ImportError without Open3D."""
        import open3d

        mesh = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(self.vertices), open3d.utility.Vector3iVector(self.triangles)
        )
        mesh.vertex_normals = open3d.utility.Vector3dVector(self.normals)
        if self.colors is not None:
            mesh.vertex_colors = open3d.utility.Vector3dVector(self.colors / 255)
        return mesh

    def to_meshio(self) -> Any:
        """The mesh as a ``meshio.Mesh``. Raises ImportError without meshio."""
        import meshio

        data: dict[str, Any] = {"normals": self.normals}
        if self.colors is not None:
            data["colors"] = self.colors
        return meshio.Mesh(self.vertices, [("triangle", self.triangles)], point_data=data)

    def write(
        self, path: Union[str, os.PathLike[str]], *, offset: Optional[tuple[float, float, float]] = None
    ) -> tuple[float, float, float]:
        """Write the mesh into a file: .ply, .obj, .vtk, .glb, .stl or .off, with what it has room for.

        Coordinates are in single precision, or in double where that would move points by more than
        a millionth of their extent; .glb and .stl, which have no double, get them less an offset
        then. A property ``added`` of .ply files marks added vertices; .ply and .vtk have the other
        numbers of the points of a file. Under the given name the file is whole, or not there.

        Parameters
        ----------
        path
            Its extension says the format.
        offset
            Subtracted from the coordinates [unit of the input]; None: what the format needs.

        Returns
        -------
        tuple of 3 float
            What was subtracted, mostly 0.

        Raises
        ------
        InvalidInput
            There is no such format.
        OSError
            The file cannot be written.
        """
        added = self._export_added()
        x, y, z = _core.write_mesh(
            os.fsencode(path), np.ascontiguousarray(self.vertices),
            np.ascontiguousarray(self.triangles), np.ascontiguousarray(self.normals), self.colors,
            added if added is not None and added.any() else None, self._export_scalars(), offset,
        )
        return x, y, z

    def show(self) -> None:
        """Show the mesh in a window of Open3D or PyVista, or else by matplotlib.

        The first of them that is installed; without a display, matplotlib, which also draws in
        notebooks, and takes its time from 100,000 triangles on. Raises ImportError without any.
        """
        if sys.platform in ("win32", "darwin") or {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
            with suppress(ImportError):
                import open3d

                open3d.visualization.draw_geometries([self.to_open3d()])
                return
            with suppress(ImportError):
                import pyvista

                faces = np.insert(self.triangles, 0, 3, axis=1)
                pyvista.PolyData(self.vertices, faces.ravel()).plot(scalars=self.colors, rgb=True)
                return
        self._plot()

    def _plot(self) -> None:
        import matplotlib.pyplot as pyplot

        points, colors = self.vertices, self.colors
        axes: Any = pyplot.figure().add_subplot(projection="3d")
        axes.set_box_aspect(np.ptp(points, axis=0) + 1e-300)
        surface = axes.plot_trisurf(*points.T, triangles=self.triangles, color="lightsteelblue")
        if colors is not None:
            surface.set_facecolor(colors[self.triangles].mean(axis=1) / 255)
        pyplot.show()
