"""Views of meshes and of their maps, panel by panel."""

import math
import struct

_FORMATS = {"float": "f", "float32": "f", "double": "d", "float64": "d", "char": "b", "int8": "b",
            "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
            "int": "i", "int32": "i", "uint": "I", "uint32": "I"}  # fmt: skip


def vertices(path):
    """The vertices (x, y, z) of a binary PLY file as the tools write it."""
    data = path.read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    count, layout = 0, "<"
    for line in data[:start].decode("ascii").splitlines():
        words = line.split()
        if words[:2] == ["element", "vertex"]:
            count = int(words[2])
        elif words[:1] == ["element"]:
            break
        elif words[:1] == ["property"]:
            layout += _FORMATS[words[1]]
    end = start + count * struct.calcsize(layout)
    return [fields[:3] for fields in struct.iter_unpack(layout, data[start:end])]


def centroid(points):
    return tuple(sum(axis) / len(points) for axis in zip(*points))


def camera(direction):
    """The renderer's -view for a camera in that direction from the scene."""
    length = math.hypot(*direction)
    x, y, z = (c / length for c in direction)
    elevation = math.degrees(math.asin(max(-1.0, min(1.0, z))))
    azimuth = math.degrees(math.atan2(x, -y))
    return ["-view", f"{azimuth:.2f},{max(-89.0, min(89.0, elevation)):.2f}"]


def close_up(point, zoom, direction=None):
    """Options for a view of the surroundings of a point, enlarged so many times."""
    focus = ["-focus", ",".join(f"{c:.6f}" for c in point), "-zoom", f"{zoom:g}"]
    return focus + (camera(direction) if direction is not None else [])


class Panels:
    """Pictures to be put into one grid, drawn one by one."""

    def __init__(self, renderer, folder, size=520):
        self.renderer = renderer
        self.folder = folder
        self.size = size
        self.pictures = []

    def add(self, mesh, caption="", options=()):
        path = self.folder / f"panel_{len(self.pictures)}.png"
        size = f"{self.size}x{self.size}"
        # Options first: those of the camera are for the inputs that follow.
        if self.renderer.draw(path, "-size", size, *options, mesh):
            self.pictures.append((path, caption))

    def save(self, path, columns, rows=None):
        """The file's name, or None if a panel could not be drawn."""
        if self.renderer.problem:
            return None
        from . import plots

        # What is said above a column is not said again below its pictures.
        pictures = [(file, "" if text in columns else text) for file, text in self.pictures]
        plots.panels(path, pictures, columns, rows)
        for picture, _ in self.pictures:
            picture.unlink()
        return path.name
