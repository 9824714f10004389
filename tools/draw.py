#!/usr/bin/python3
"""Draws point clouds and triangle meshes from PLY files side by side into one PNG picture.

    tools/draw.py OUT.png FILE... [options]

Captions and views are given once for each file, in order; the last view holds for the files that follow. The
projection is orthographic. A value that begins with a minus sign is written --view=-30,10. Needs the Debian packages
python3-meshio and python3-matplotlib, which brings python3-pil.
"""

import argparse
import os
import pathlib

import matplotlib
import meshio
import numpy as np
from PIL import Image

matplotlib.use("Agg")
from matplotlib import collections, pyplot  # noqa: E402  the backend has to be chosen first

# Drawn this many times larger, without antialiasing, and reduced at the end: triangles that are antialiased one by one
# show seams.
SCALE = 3
BACK = (0.95, 0.62, 0.42)  # the colour of triangles seen from behind, with --back


def read_ply(path):
    """Points (n, 3), colours (n, 3) in [0, 1] or None, and triangles (m, 3)."""
    mesh = meshio.read(path, "ply")
    faces, colors = mesh.cells_dict, None
    if set(faces) - {"triangle"}:
        raise ValueError(f"{path}: not all faces are triangles")
    if "red" in mesh.point_data:
        colors = np.stack([mesh.point_data[name] for name in ("red", "green", "blue")], axis=1) / 255.0
    return mesh.points.astype(float), colors, faces.get("triangle", np.empty((0, 3))).astype(np.int64)


def direction_colors(points):
    """A colour for each point by its direction from the middle of all points."""
    away = points - (points.min(axis=0) + points.max(axis=0)) / 2
    return 0.66 + 0.32 * away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-300)


def draw_view(axes, points, colors, triangles, view, edges, back):
    """Draws one cloud or mesh; azimuth and elevation of the view in degrees."""
    a, e = np.radians(view)
    camera = np.array([[np.cos(a), np.sin(a), 0.0],
                       [-np.sin(a) * np.sin(e), np.cos(a) * np.sin(e), np.cos(e)],
                       [np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)]])  # fmt: skip
    seen = points @ camera.T
    colors = np.broadcast_to(np.array([0.74, 0.79, 0.86]) if colors is None else colors, points.shape)
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle = (low + high)[:2] / 2
    box = axes.get_window_extent()
    unit = max((high - low)[0] / box.width, (high - low)[1] / box.height, 1e-300) / 0.94
    half = np.array([box.width, box.height]) * unit / 2
    axes.set(xlim=(middle[0] - half[0], middle[0] + half[0]), ylim=(middle[1] - half[1], middle[1] + half[1]))
    axes.axis("off")
    if len(triangles):
        triangles = triangles[np.argsort(seen[triangles][:, :, 2].mean(axis=1))]
        corners = seen[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        # An open sheet has no outside: it is turned to show its front. Of a closed mesh as much faces away.
        if normals[:, 2].sum() < -0.1 * np.abs(normals[:, 2]).sum():
            normals = -normals
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        # Both sides are lit alike, because meshes of other programs need not be oriented.
        behind = normals[:, 2:] < 0
        normals *= np.where(behind, -1.0, 1.0)
        tints = np.where(behind & back, BACK, colors[triangles].mean(axis=1))
        shade = 0.5 + 0.33 * normals[:, 2:] + 0.25 * np.clip(normals @ [[-0.48], [0.6], [0.64]], 0, 1)
        faces = np.clip(tints * shade, 0, 1)
        axes.add_collection(collections.PolyCollection(
            corners[:, :, :2], facecolors=faces, antialiaseds=False, closed=False,
            edgecolors=faces * 0.75 if edges else "none", linewidths=0.4 * SCALE if edges else 0))  # fmt: skip
    else:
        depth = (high[2] - seen[:, 2]) / max(high[2] - low[2], 1e-300)
        order = np.argsort(-depth)
        fade = 0.65 * depth[order, None] ** 0.7
        # About half of the silhouette is covered, whatever the number of points.
        width = 0.46 * np.sqrt(np.prod((high - low)[:2]) / len(points)) / unit * 72 / axes.figure.dpi
        axes.scatter(*seen[order, :2].T, c=np.clip(0.7 * colors[order] * (1 - fade) + fade, 0, 1), linewidths=0,
                     s=np.clip(width, 0.8 * SCALE, 3.5 * SCALE) ** 2, antialiased=False)  # fmt: skip


def save(path, picture):
    """256 colours are enough, for a third of the bytes. Without dithering shades become patches."""
    colors = picture.quantize(256, method=Image.Quantize.FASTOCTREE)  # keeps white and the colour of the back
    picture.quantize(palette=colors, dither=Image.Dither.FLOYDSTEINBERG).save(f"{path}.part", "PNG", optimize=True)
    os.replace(f"{path}.part", path)


def draw(out, views, size, captions, columns=None):
    """Draws views (dictionaries of draw_view's arguments) side by side, in rows of `columns` if that is given."""
    columns = columns or len(views)
    rows = -(-len(views) // columns)
    places = [(i % columns / columns, 1 - (i // columns + 1) / rows) for i in range(len(views))]
    # In inches; matplotlib rounds the pixels down.
    figure = pyplot.figure(figsize=[(pixels * SCALE + 0.1) / 100 for pixels in size], dpi=100)
    margin = 34 / size[1] if captions else 0.0
    for (x, y), view in zip(places, views):
        draw_view(figure.add_axes([x, y + margin, 1 / columns, 1 / rows - margin]), **view)
    for (x, y), caption in zip(places, captions):
        figure.text(x + 0.5 / columns, y + margin / 2, caption, ha="center", va="center", color="0.25",
                    fontsize=10 * SCALE)  # fmt: skip
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    pyplot.close(figure)
    save(out, picture.reduce(SCALE))


def numbers(text):
    return [float(word) for word in text.replace("x", ",").split(",")]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", metavar="OUT.png")
    parser.add_argument("files", metavar="FILE", nargs="+")
    parser.add_argument("--size", type=numbers, metavar="WxH", help="pixels (default 440x440 for each file)")
    parser.add_argument("--caption", action="append", default=[], metavar="TEXT", help="below a file's view")
    parser.add_argument("--colors", metavar="FILE", help="colour each point by the direction of the same point of "
                        "FILE, in all files with as many points")  # fmt: skip
    parser.add_argument("--view", action="append", type=numbers, metavar="AZ,EL", help="degrees (default 25,20)")
    parser.add_argument("--edges", action="store_true", help="draw the edges of the triangles")
    parser.add_argument("--back", action="store_true", help="draw triangles seen from behind in another colour")
    words = parser.parse_intermixed_args(arguments)
    size = [int(pixels) for pixels in words.size or (440 * len(words.files), 440)]
    turns = words.view or [(25, 20)]
    tints = direction_colors(read_ply(words.colors)[0]) if words.colors else []
    views = []
    for i, path in enumerate(words.files):
        points, colors, triangles = read_ply(path)
        views.append({"points": points, "triangles": triangles, "edges": words.edges, "back": words.back,
                      "view": turns[min(i, len(turns) - 1)],
                      "colors": tints if len(tints) == len(points) else colors})  # fmt: skip
    draw(words.out, views, size, words.caption)


if __name__ == "__main__":
    main()
