"""Plots by matplotlib, and pictures of meshes by tools/draw.py."""

import importlib.util
import math
import pathlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

_spec = importlib.util.spec_from_file_location(
    "draw", pathlib.Path(__file__).parents[3] / "tools" / "draw.py")  # fmt: skip
_draw = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(_draw)
read_ply = _draw.read_ply

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
    """Rows of views of meshes in one picture."""

    def __init__(self, path, size=300):
        self.path = path
        self.size = size  # of a view [pixels]
        self.rows = []

    def row(self, files, captions, view=((25, 15),), focus=(), zoom=(), up="z", colors=None,
            edges=False, back=False):  # fmt: skip
        """Options are those of tools/draw.py; a list has a value for each file, or one for all."""
        words = [self.path, *files, "--up", up, "--size", f"{self.size * len(files)}x{self.size}"]
        words += [f"--caption={caption}" for caption in captions]
        for name, values in (("view", view), ("focus", focus), ("zoom", zoom)):
            words += [f"--{name}={','.join(f'{x:.6f}' for x in value)}" for value in values]
        words += ["--colors", colors] if colors else []
        words += ["--edges"] if edges else []
        words += ["--back"] if back else []
        _draw.main([str(word) for word in words])
        self.rows.append(plt.imread(self.path)[:, :, :3])

    def save(self):
        width = max(row.shape[1] for row in self.rows)
        rows = [np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0)), constant_values=1.0)
                for row in self.rows]  # fmt: skip
        plt.imsave(self.path, np.concatenate(rows))
        return self.path.name


def close_up(places, factor, directions):
    """Options of views of the surroundings of places from directions."""
    views = []
    for x, y, z in directions:
        elevation = math.asin(max(-1.0, min(1.0, z / math.hypot(x, y, z))))
        views.append((math.degrees(math.atan2(x, -y)), math.degrees(elevation)))
    return {"view": views, "focus": places, "zoom": [(factor,)]}
