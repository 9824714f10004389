#!/usr/bin/python3
"""Draws point clouds and meshes from PLY files side by side into one PNG picture.

    tools/draw.py OUT.png FILE... [options]

Captions and views are given once for each file, in order; the last view holds for the files that follow. The
projection is orthographic. A value that begins with a minus sign is written --view=-30,10. Needs the Debian packages
python3-numpy and python3-matplotlib.
"""

import argparse
import os
import pathlib
import sys

try:
    import matplotlib
    import numpy as np

    matplotlib.use("Agg")
    from matplotlib import collections, image, pyplot
except ImportError as error:
    sys.exit(f"draw.py: {error}\ndraw.py: install the Debian packages python3-numpy and python3-matplotlib")

TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
         "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
         "float32": "f4", "float64": "f8"}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
# Drawn this many times larger, without antialiasing, and reduced at the end: triangles that are antialiased one by one
# show seams.
SCALE = 3
BACK = (0.95, 0.62, 0.42)  # the colour of triangles seen from behind, with --back


def read_element(data, at, count, properties):
    """Columns of one element by their names, and where the next element begins."""

    def layout(start):
        fields = []
        for name, value_type, length_type in properties:
            shape = ()
            if length_type:
                shape = (int(np.frombuffer(data, length_type, 1, start)[0]),)
                fields.append((f"length of {name}", length_type))
                start += np.dtype(length_type).itemsize
            fields.append((name, value_type, shape))
            start += np.dtype((value_type, shape)).itemsize
        return np.dtype(fields)

    if count < 0:
        raise ValueError("a negative number of elements")
    if count == 0 or not properties:
        return {}, at
    # Usually all rows have the layout of the first one. Otherwise they are read one by one.
    row = layout(at)
    if len(data) >= at + count * row.itemsize:
        table = np.frombuffer(data, row, count, at)
        if all((table[name] == table[name][0]).all() for name in row.names if name.startswith("length of ")):
            return {name: table[name] for name, _, _ in properties}, at + count * row.itemsize
    rows = []
    for _ in range(count):
        row = layout(at)
        rows.append(np.frombuffer(data, row, 1, at)[0])
        at += row.itemsize
    return {name: [entry[name] for entry in rows] for name, _, _ in properties}, at


def read_ply(path):
    """Points (n, 3), colours (n, 3) in [0, 1] or None, and triangles (m, 3); ValueError and the like."""
    with open(path, "rb") as file:
        head, found, body = file.read().partition(b"end_header")
    lines = [line.split() for line in head.decode("ascii").splitlines()]
    if not found or lines[0] != ["ply"]:
        raise ValueError("no header of a PLY file")
    order = next(ORDERS[words[1]] for words in lines if words[:1] == ["format"])
    body = body[body.index(b"\n") + 1 :]
    if not order:  # Text becomes an array of doubles, which is then read like a binary file.
        body = np.array(body.split(), float).tobytes()
    elements, at = {}, 0
    for words in lines:
        if words[:1] == ["element"]:
            elements[words[1]] = int(words[2]), []
        elif words[:1] == ["property"]:
            types = [order + TYPES[word] if order else "f8" for word in words[-2:0:-1] if word != "list"]
            list(elements.values())[-1][1].append((words[-1], types[0], types[1] if len(types) > 1 else None))
    for name, (count, properties) in elements.items():
        elements[name], at = read_element(body, at, count, properties)
    vertex, faces = elements["vertex"], elements.get("face", {})
    points, colors = np.stack([vertex[axis] for axis in "xyz"], axis=1).astype(float), None
    if "red" in vertex:
        colors = np.stack([vertex[name] for name in ("red", "green", "blue")], axis=1) / 255.0
    polygons = faces.get("vertex_indices", faces.get("vertex_index", []))
    fans = [np.stack([p[..., 0], p[..., i], p[..., i + 1]], axis=-1).reshape(-1, 3)
            for p in ([polygons] if isinstance(polygons, np.ndarray) else polygons)
            for i in range(1, p.shape[-1] - 1)]  # fmt: skip
    triangles = np.concatenate(fans).astype(np.int64) if fans else np.empty((0, 3), np.int64)
    if len(triangles) and not (0 <= triangles.min() and triangles.max() < len(points)):
        raise ValueError("a triangle has a vertex that does not exist")
    good = np.isfinite(points).all(axis=1)
    points[~good] = points[good][0]  # IndexError without any finite point
    return points, colors, triangles[good[triangles].all(axis=1)]


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


def draw(out, views, size, captions):
    """Draws views (dictionaries of draw_view's arguments) side by side."""
    # In inches; matplotlib rounds the pixels down.
    figure = pyplot.figure(figsize=[(pixels * SCALE + 0.1) / 100 for pixels in size], dpi=100)
    margin = 34 / size[1] if captions else 0.0
    for i, view in enumerate(views):
        draw_view(figure.add_axes([i / len(views), margin, 1 / len(views), 1 - margin]), **view)
    for i, caption in enumerate(captions[: len(views)]):
        figure.text((i + 0.5) / len(views), margin / 2, caption, ha="center", va="center", color="0.25",
                    fontsize=10 * SCALE)  # fmt: skip
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(np.uint16)
    pyplot.close(figure)
    pixels = pixels.reshape(size[1], SCALE, size[0], SCALE, 3).mean(axis=(1, 3)).round().astype(np.uint8)
    try:
        image.imsave(f"{out}.part", pixels, format="png")
        os.replace(f"{out}.part", out)
    finally:
        pathlib.Path(f"{out}.part").unlink(missing_ok=True)


def numbers(text):
    values = [float(word) for word in text.replace("x", ",").split(",")]
    if not np.isfinite(values).all():
        raise ValueError(text)
    return values


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
    if len(size) != 2 or not all(50 <= pixels <= 5000 for pixels in size):
        parser.error("--size: give a width and a height of 50 to 5000 pixels, such as 1320x440")
    turns = words.view or [(25, 20)]
    if any(len(turn) != 2 for turn in turns):
        parser.error("--view: give 2 numbers with commas between them")
    path = words.colors
    try:
        tints = direction_colors(read_ply(path)[0]) if path else []
        views = []
        for i, path in enumerate(words.files):
            points, colors, triangles = read_ply(path)
            views.append({"points": points, "triangles": triangles, "edges": words.edges, "back": words.back,
                          "view": turns[min(i, len(turns) - 1)],
                          "colors": tints if len(tints) == len(points) else colors})  # fmt: skip
        path = words.out
        draw(path, views, size, words.caption)
    except OSError as error:
        sys.exit(f"draw.py: {path}: {error.strerror or error}\ndraw.py: give a path that exists and may be used")
    except (ValueError, LookupError, TypeError, StopIteration, OverflowError, MemoryError) as error:
        cause = " ".join(str(error).split()) or type(error).__name__
        sys.exit(f"draw.py: {path}: cannot be drawn ({cause})\n"
                 "draw.py: give PLY files that are complete, with finite vertices x, y and z")  # fmt: skip


if __name__ == "__main__":
    main()
