"""Plots by matplotlib, and pictures of meshes by tools/draw.py."""

import importlib.util
import math
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

_spec = importlib.util.spec_from_file_location(
    "draw", pathlib.Path(__file__).parents[3] / "tools" / "draw.py")  # fmt: skip
_draw = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(_draw)

# Colours that differ for colour-blind readers as well (Okabe and Ito 2008).
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")


class Plot:
    """Panels of curves side by side, or one of stacked bars."""

    def __init__(self, panels=1, size=(6.0, 4.0)):
        self.figure, axes = plt.subplots(
            1, panels, figsize=(size[0] * panels, size[1]), squeeze=False)  # fmt: skip
        self.axes = axes[0]

    def curve(self, panel, x, y, label, color, style="-", marker=None):
        self.axes[panel].plot(x, y, style, color=COLORS[color % len(COLORS)], label=label,
                              marker=marker, markersize=4, linewidth=1.4)  # fmt: skip

    def bars(self, rows, parts, values):
        """values[row][part], stacked from left to right."""
        left = [0.0] * len(rows)
        for index, part in enumerate(parts):
            widths = [row[index] for row in values]
            self.axes[0].barh(rows, widths, left=left, label=part, color=COLORS[index])
            left = [a + b for a, b in zip(left, widths)]

    def label(self, panel, x, y, title, logarithmic=True):
        axes = self.axes[panel]
        axes.set(xlabel=x, ylabel=y)
        axes.set_title(title, fontsize=10)
        if logarithmic:
            axes.set(xscale="log", yscale="log")
        axes.grid(True, which="major", alpha=0.3)
        axes.legend(fontsize=8)

    def save(self, path):
        """Without date and random identifiers: the same data give the same file."""
        matplotlib.rcParams["svg.hashsalt"] = path.stem
        self.figure.savefig(path, bbox_inches="tight", metadata={"Date": None})
        plt.close(self.figure)
        return path.name


def vertices(path):
    return _draw.read_ply(path)[0]


class Pictures:
    """Views of meshes, put into the rows of one picture."""

    def __init__(self, columns, size=300):
        self.columns, self.size = columns, size
        self.views, self.captions = [], []

    def add(self, mesh, caption, view=(25, 15), up="z", **options):
        """Other options are those of tools/draw.py: focus, zoom, edges."""
        points, _, triangles = _draw.read_ply(mesh)
        self.views.append({"points": points, "colors": None, "triangles": triangles, "view": view,
                           "up": up, **options})  # fmt: skip
        self.captions.append(caption)

    def add_map(self, sphere, mesh, caption, **options):
        """The sphere, each vertex in the colour of its direction on the mesh."""
        self.add(sphere, caption, **options)
        self.views[-1]["colors"] = _draw.direction_colors(vertices(mesh))

    def save(self, path):
        rows = -(-len(self.views) // self.columns)
        _draw.draw(path, self.views, (self.size * self.columns, self.size * rows), self.columns,
                   self.captions)  # fmt: skip
        return path.name


def close_up(point, zoom, direction):
    """Options of a view of the surroundings of a point from a direction."""
    length = math.hypot(*direction)
    x, y, z = (c / length for c in direction)
    view = math.degrees(math.atan2(x, -y)), math.degrees(math.asin(max(-1.0, min(1.0, z))))
    return {"view": view, "focus": point, "zoom": zoom}
