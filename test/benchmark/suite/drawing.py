"""Plots by matplotlib, and pictures of meshes by tools/draw.py."""

import math

import draw
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

# Colours that differ for colour-blind readers as well (Okabe and Ito 2008).
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def plot(path, curves, x, y, title):
    """Lists of numbers by their labels over 1, 2, ...; those whose label begins with "default" are dashed."""
    figure, axes = plt.subplots(figsize=(6.0, 4.0))
    for color, (label, values) in zip(COLORS, curves.items()):
        style = {"linestyle": "--", "marker": "o"} if label.startswith("default") else {}
        axes.plot(range(1, len(values) + 1), values, color=color, label=label, markersize=4, linewidth=1.4, **style)
    axes.set(xlabel=x, ylabel=y, xscale="log", yscale="log")
    axes.set_title(title, fontsize=10)
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=8)
    # Without date and random identifiers: the same data give the same file.
    matplotlib.rcParams["svg.hashsalt"] = path.stem
    figure.savefig(path, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)
    return path.name


def vertices(path):
    return draw.read_ply(path)[0]


class Pictures:
    """Rows of views of meshes in one picture."""

    def __init__(self, path, size=300):
        self.path = path
        self.size = size  # of a view [pixels]
        self.rows = []

    def row(self, files, captions, view=((25, 15),), focus=(), zoom=(), colors=None, switches=()):
        """Options are those of tools/draw.py; a list has a value for each file, or one for all."""
        words = [self.path, *files, "--size", f"{self.size * len(files)}x{self.size}", *switches]
        words += [f"--caption={caption}" for caption in captions]
        for name, values in (("view", view), ("focus", focus), ("zoom", zoom)):
            words += [f"--{name}={','.join(f'{x:.6f}' for x in value)}" for value in values]
        words += ["--colors", colors] if colors else []
        draw.main([str(word) for word in words])
        self.rows.append(plt.imread(self.path)[:, :, :3])

    def save(self):
        width = max(row.shape[1] for row in self.rows)
        rows = [np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0)), constant_values=1.0) for row in self.rows]
        plt.imsave(self.path, np.concatenate(rows))
        return self.path.name


def close_up(places, factor, directions):
    """Options of views of the surroundings of places from directions."""
    views = []
    for x, y, z in directions:
        elevation = math.asin(max(-1.0, min(1.0, z / math.hypot(x, y, z))))
        views.append((math.degrees(math.atan2(x, -y)), math.degrees(elevation)))
    return {"view": views, "focus": places, "zoom": [(factor,)]}
