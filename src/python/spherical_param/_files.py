"""Meshes for other libraries, and into files."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Optional, Union

import numpy as np

from ._arguments import FloatArray, IndexArray
from ._errors import InvalidInput


class MeshExport:
    """What results that hold a mesh can be turned into."""

    vertices: FloatArray
    triangles: IndexArray

    def _export_points(self) -> FloatArray:
        """The points that the mesh has elsewhere."""
        return self.vertices

    def _export_normals(self) -> Optional[FloatArray]:
        return None

    def to_trimesh(self) -> Any:
        """The mesh as a ``trimesh.Trimesh``, vertices and triangles as they are.

        Raises ImportError without trimesh.
        """
        import trimesh

        return trimesh.Trimesh(
            self._export_points(),
            self.triangles,
            vertex_normals=self._export_normals(),
            process=False,
        )

    def to_open3d(self) -> Any:
        """The mesh as an ``open3d.geometry.TriangleMesh``. Raises ImportError without Open3D."""
        import open3d

        mesh = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(self._export_points()),
            open3d.utility.Vector3iVector(self.triangles),
        )
        normals = self._export_normals()
        if normals is not None:
            mesh.vertex_normals = open3d.utility.Vector3dVector(normals)
        return mesh

    def to_meshio(self) -> Any:
        """The mesh as a ``meshio.Mesh``. Raises ImportError without meshio."""
        import meshio

        normals = self._export_normals()
        return meshio.Mesh(
            self._export_points(),
            [("triangle", self.triangles)],
            point_data={} if normals is None else {"normals": normals},
        )

    def write(self, path: Union[str, os.PathLike[str]]) -> None:
        """Write the mesh into a file.

        A .ply is written by the package itself, binary and in double precision; other formats are
        left to meshio, trimesh or Open3D, the first of them that is installed. Under the given name
        the file is whole, or not there.

        Raises
        ------
        InvalidInput
            The format is not .ply, and none of these libraries is installed, or that one does not
            know it.
        OSError
            The file cannot be written.
        """
        name = os.fspath(path)
        folder, base = os.path.split(os.path.abspath(name))
        extension = os.path.splitext(base)[1].lower()
        # Of the same extension: other libraries take the format from it.
        with tempfile.TemporaryDirectory(prefix=".writing-", dir=folder) as scratch:
            part = os.path.join(scratch, "mesh" + extension)
            if extension == ".ply":
                self._write_ply(part)
            else:
                self._write_by_others(part, extension)
            os.replace(part, name)

    def _write_ply(self, path: str) -> None:
        columns = [self._export_points()]
        names = ["x", "y", "z"]
        normals = self._export_normals()
        if normals is not None:
            columns.append(normals)
            names += ["nx", "ny", "nz"]
        header = "ply\nformat binary_little_endian 1.0\ncomment spherical_param\n"
        header += f"element vertex {len(self.vertices)}\n"
        header += "".join(f"property double {name}\n" for name in names)
        header += f"element face {len(self.triangles)}\n"
        header += "property list uchar int vertex_indices\nend_header\n"
        faces = np.empty(len(self.triangles), dtype=[("count", "u1"), ("vertices", "<i4", (3,))])
        faces["count"] = 3
        faces["vertices"] = self.triangles
        with open(path, "wb") as file:
            file.write(header.encode("ascii"))
            file.write(np.hstack(columns).astype("<f8").tobytes())
            file.write(faces.tobytes())

    def _write_by_others(self, path: str, extension: str) -> None:
        failures = []
        for library in ("meshio", "trimesh", "open3d"):
            try:
                if library == "meshio":
                    self.to_meshio().write(path)
                elif library == "trimesh":
                    self.to_trimesh().export(path)
                else:
                    import open3d

                    open3d.io.write_triangle_mesh(path, self.to_open3d())
            except ImportError:
                continue
            except OSError:
                raise
            except Exception as error:  # each has its own
                failures.append(f"{library}: {error}")
                continue
            if os.path.exists(path):
                return
            failures.append(f"{library} wrote nothing")
        reason = "; ".join(failures) or "meshio, trimesh and Open3D are not installed"
        raise InvalidInput(
            f"a file {extension or 'without an extension'} cannot be written ({reason}); give one "
            "ending in .ply, or install meshio"
        )
