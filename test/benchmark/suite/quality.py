"""The referee: measures a mesh, whichever program made it.

A vertex is used if a triangle has it. Triangles with two equal corners are degenerate.
"""

import ctypes
import dataclasses

import numpy as np
from draw import read_ply

# Triangles that are thinner than this fraction of their length have no plane in double precision. They are left
# out of distances: their neighbours along the longest side are as near.
NEEDLE = 1e-9
BRIDGE = 3.0  # spacings from the truth, where a mesh no longer follows the surface


@dataclasses.dataclass
class Mesh:
    points: np.ndarray  # (n, 3)
    triangles: np.ndarray  # (m, 3), corners

    @staticmethod
    def read(path):
        points, _, triangles = read_ply(path)
        return Mesh(np.ascontiguousarray(points), np.ascontiguousarray(triangles, np.int32))

    def edges(self):
        """Of each triangle that is not degenerate its sides (m, 3, 2), the lower vertex first."""
        sides = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
        return sides[(sides[:, :, 0] != sides[:, :, 1]).all(axis=1)]

    def write(self, path):
        """To a PLY file, in single precision."""
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(self.points)}\n"
        head += "".join(f"property float {axis}\n" for axis in "xyz")
        head += f"element face {len(self.triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
        faces = np.empty(len(self.triangles), [("corners", "u1"), ("vertices", "<i4", 3)])
        faces["corners"], faces["vertices"] = 3, self.triangles
        path.write_bytes(head.encode() + self.points.astype("<f4").tobytes() + faces.tobytes())

    def normals(self):
        """Twice as long as the area of each triangle."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    def areas(self):
        return np.linalg.norm(self.normals(), axis=1) / 2

    def without_needles(self):
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        longest = np.max([np.linalg.norm(side, axis=1) for side in (b - a, c - b, a - c)], axis=0)
        return Mesh(self.points, self.triangles[2 * self.areas() > NEEDLE * longest**2])


def _percent(part, whole):
    return 100.0 * part / whole if whole else 0.0


class Referee:
    def __init__(self, library):
        self._library = ctypes.CDLL(str(library))

    def _call(self, function, *arguments):
        function = getattr(self._library, function)
        function.restype = ctypes.c_int64
        return function(*(argument.ctypes.data_as(ctypes.c_void_p) if isinstance(argument, np.ndarray)
                          else ctypes.c_int64(argument) for argument in arguments))  # fmt: skip

    def topology(self, mesh):
        edges = mesh.edges().reshape(-1, 2)
        counts = np.unique(edges @ [len(mesh.points), 1], return_counts=True)[1]
        figures = np.empty(4, np.int64)
        is_manifold = bool(self._call("check_topology", mesh.triangles, len(mesh.triangles), len(mesh.points), figures))
        parts, openings, euler, genus = figures.tolist()
        return {"sphere": is_manifold and (parts, openings, euler) == (1, 0, 2), "parts": parts, "openings": openings,
                "genus": genus if genus >= 0 else None, "boundary": int((counts == 1).sum()),
                "crowded": int((counts > 2).sum())}  # fmt: skip

    def intersections(self, mesh):
        return self._call("self_intersections", mesh.points, len(mesh.points), mesh.triangles, len(mesh.triangles))

    def nearest(self, mesh, points):
        """The distance of each point from a mesh without needles, and the nearest triangle."""
        points = np.ascontiguousarray(points)
        squares, nearest = np.empty(len(points)), np.empty(len(points), np.int64)
        self._call("find_nearest", mesh.points, len(mesh.points), mesh.triangles, len(mesh.triangles),
                   points, len(points), squares, nearest)  # fmt: skip
        return np.sqrt(squares), nearest

    def distances(self, mesh, truth, samples):
        """In both directions: distances [percent of the truth's diagonal], and angles between normals [degrees].

        Bridges: the area of the mesh that is farther than BRIDGE spacings from the truth [percent of the truth's
        area]. It means something if the truth is as fine as the cloud, with two triangles for each cell of four
        neighbouring rays. The spacing is then the side of a square with the area of the cell at the nearest place of
        the truth, the root of twice the area of a triangle. It grows with the distance from the sensor, and on a
        surface that is seen obliquely it is the mean of the short and the long distance of neighbours (geometric).

        The samples of each surface are one in each part of equal area, at random in its triangle (R. Osada
        et al., "Shape Distributions", 2002, equation 1).
        """
        random, found = np.random.default_rng(1), []
        for one, other in ((mesh, truth), (truth, mesh)):
            whole, surface = one.without_needles(), other.without_needles()
            if not len(whole.triangles) or not len(surface.triangles):
                return {"rms": None, "hausdorff": None, "normals": None, "bridges": None}
            ends = np.cumsum(whole.areas())
            places = (np.arange(samples) + random.random(samples)) / samples * ends[-1]
            chosen = np.minimum(np.searchsorted(ends, places, side="right"), len(ends) - 1)
            u, v = np.sqrt(random.random(samples)), random.random(samples)
            weights = np.stack([1 - u, u * (1 - v), u * v], axis=1)
            points = np.einsum("ij,ijk->ik", weights, one.points[whole.triangles[chosen]])
            distances, nearest = self.nearest(surface, points)
            normals = whole.normals()[chosen], surface.normals()[nearest]
            cosines = np.abs((normals[0] * normals[1]).sum(axis=1)) / np.prod(np.linalg.norm(normals, axis=2), axis=0)
            of_vertices = self.nearest(surface, one.points[np.unique(one.triangles)])[0]
            if other is truth:
                is_far = distances > BRIDGE * np.sqrt(2 * surface.areas()[nearest])
                bridges = _percent(is_far.mean() * ends[-1], truth.areas().sum())
            found.append((max(distances.max(), of_vertices.max()), (distances**2).mean(),
                          np.degrees(np.arccos(np.minimum(cosines, 1.0))).mean()))  # fmt: skip
        largest, square, angle = np.transpose(found)
        percent = 100.0 / np.linalg.norm(np.ptp(truth.points, axis=0))
        return {"rms": percent * float(np.sqrt(square.mean())), "hausdorff": percent * float(largest.max()),
                "normals": float(angle.mean()), "bridges": float(bridges)}  # fmt: skip

    def distortion(self, mesh, sphere):
        """Of the map to the same triangles on the sphere."""
        if not np.array_equal(sphere.triangles, mesh.triangles):
            raise ValueError("the sphere has other triangles than the mesh")
        figures = np.empty(2)
        self._call("map_distortion", mesh.points, len(mesh.points), mesh.triangles, len(mesh.triangles),
                   sphere.points, figures)  # fmt: skip
        solid, flat = mesh.areas(), Mesh(sphere.points, mesh.triangles).areas()
        good = (solid > 0) & (flat > 0)
        ratios = np.log2((flat / flat.sum())[good] / (solid / solid.sum())[good])
        return {"angle": figures[0], "area": float(np.sqrt(np.average(ratios**2, weights=solid[good]))),
                "inverted": _percent(figures[1], len(mesh.triangles))}  # fmt: skip


def compare(mesh, cloud, truth=None):
    """Points of the cloud that are used vertices, and edges of the truth that the mesh has, both at the same places
    in single precision [%]. Edges only if 99 % of the vertices of the truth are points of the cloud."""
    parts = [mesh.points, cloud] + ([truth.points] if truth else [])
    # Adding 0 makes 0 of -0.
    _, places = np.unique(np.concatenate(parts).astype(np.float32) + np.float32(0), axis=0, return_inverse=True)
    of_mesh, of_cloud, *of_truth = np.split(places, np.cumsum([len(part) for part in parts])[:-1])
    used = np.isin(of_cloud, of_mesh[mesh.edges()])
    found = {"points": len(cloud), "used": _percent(used.sum(), len(used))}
    if truth:
        vertices = np.unique(of_truth[0][truth.edges()])
        if np.isin(vertices, of_cloud).mean() >= 0.99:
            has, true = (np.unique(np.sort(of[one.edges()].reshape(-1, 2), axis=1) @ [len(places), 1])
                         for of, one in ((of_mesh, mesh), (of_truth[0], truth)))  # fmt: skip
            found["edges"] = _percent(np.isin(true, has).sum(), len(true))
    return found
