"""Plots and panels of pictures, by matplotlib."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

# Colours that differ for colour-blind readers as well (Okabe and Ito 2008).
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")


def _save(figure, path):
    # Without date and random identifiers, so that the same data give the same file.
    matplotlib.rcParams["svg.hashsalt"] = path.stem
    figure.savefig(path, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


class Lines:
    """One plot of curves, or several side by side."""

    def __init__(self, panels=1, size=(6.0, 4.0)):
        self.figure, axes = plt.subplots(1, panels, figsize=(size[0] * panels, size[1]))
        self.axes = [axes] if panels == 1 else list(axes)

    def curve(self, panel, x, y, label, color, style="-", marker=None):
        self.axes[panel].plot(x, y, style, color=COLORS[color % len(COLORS)], label=label,
                              marker=marker, markersize=4, linewidth=1.4)  # fmt: skip

    def label(self, panel, x, y, title, logarithmic=("x", "y")):
        axes = self.axes[panel]
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        axes.set_title(title, fontsize=10)
        if "x" in logarithmic:
            axes.set_xscale("log")
        if "y" in logarithmic:
            axes.set_yscale("log")
        axes.grid(True, which="major", alpha=0.3)
        axes.legend(fontsize=8)

    def save(self, path):
        _save(self.figure, path)


def bars(path, rows, parts, values, title, unit):
    """Stacked bars, one a row, of values[row][part]."""
    figure, axes = plt.subplots(figsize=(7.5, 0.6 + 0.5 * len(rows)))
    left = [0.0] * len(rows)
    for index, part in enumerate(parts):
        widths = [values[row][index] for row in rows]
        axes.barh(rows, widths, left=left, label=part, color=COLORS[index % len(COLORS)])
        left = [a + b for a, b in zip(left, widths)]
    axes.invert_yaxis()
    axes.set_xlabel(unit)
    axes.set_title(title, fontsize=10)
    axes.legend(fontsize=7, ncol=4, loc="upper center", bbox_to_anchor=(0.5, -0.35))
    _save(figure, path)


def panels(path, pictures, columns, rows=None):
    """Pictures with captions in a grid: `columns` and `rows` are the titles at its edges."""
    count = len(columns)
    height = len(pictures) // count
    figure, grid = plt.subplots(height, count, figsize=(2.6 * count, 2.6 * height), squeeze=False)
    for index, (picture, caption) in enumerate(pictures):
        axes = grid[index // count][index % count]
        axes.imshow(plt.imread(picture))
        axes.set_xticks([])
        axes.set_yticks([])
        for side in axes.spines.values():
            side.set_visible(False)
        if caption:
            axes.set_xlabel(caption, fontsize=7)
    for index, title in enumerate(columns):
        grid[0][index].set_title(title, fontsize=9)
    for index, title in enumerate(rows or []):
        grid[index][0].set_ylabel(title, fontsize=9)
    figure.tight_layout(pad=0.4)
    figure.savefig(path, dpi=160, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)
