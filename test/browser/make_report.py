#!/usr/bin/python3
"""Writes a report of made-up data into a page, as the tool's -report does: for tests of the page.

make_report.py PAGE OUT.html [--levels N] [--decimated] [--sound] [--far N] [--residuals N]
               [--corrupt ARRAY] [--drop ARRAY]
"""
import argparse
import base64
import json
import math
import zlib

MARKER = "<!--DATA-->"


def icosphere(levels):
    golden = (1 + math.sqrt(5)) / 2
    points = []
    for a in (-1, 1):
        for b in (-golden, golden):
            points += [(0, a, b), (a, b, 0), (b, 0, a)]
    points = [unit(p) for p in points]
    edge = min(distance(points[0], p) for p in points[1:]) * 1.01
    triangles = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if max(distance(points[i], points[j]), distance(points[j], points[k]),
                       distance(points[i], points[k])) < edge:
                    outward = dot(cross(sub(points[j], points[i]), sub(points[k], points[i])),
                                  points[i]) > 0
                    triangles.append((i, j, k) if outward else (i, k, j))
    for _ in range(levels):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(unit([x + y for x, y in zip(points[a], points[b])]))
            return middles[key]

        finer = []
        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return points, triangles


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a):
    return math.sqrt(dot(a, a))


def distance(a, b):
    return length(sub(a, b))


def unit(a):
    size = length(a)
    return [x / size for x in a]


def bumpy(d):
    """A ball with five horns and ripples."""
    radius = 1 + 0.06 * math.sin(7 * d[0]) * math.cos(6 * d[1] + 2 * d[2])
    for horn in ((0, 0, 1), (0.9, 0.3, -0.3), (-0.8, 0.5, -0.33), (0.1, -0.95, -0.3),
                 (-0.4, 0, 0.9)):
        radius += 0.75 * math.exp(-14 * (1 - dot(d, unit(horn))))
    return [12.5 * radius * x + shift for x, shift in zip(d, (40, -7, 3))]


def twisted(d, amount):
    angle = amount * d[2]
    return [math.cos(angle) * d[0] - math.sin(angle) * d[1],
            math.sin(angle) * d[0] + math.cos(angle) * d[1], d[2]]


def area(points, t):
    return 0.5 * length(cross(sub(points[t[1]], points[t[0]]), sub(points[t[2]], points[t[0]])))


def stretch(source, target, t):
    """Ratio of the singular values of the map of one triangle."""
    def flat(points):
        u, v = sub(points[t[1]], points[t[0]]), sub(points[t[2]], points[t[0]])
        size = length(u)
        x = dot(u, v) / size
        return size, x, math.sqrt(max(dot(v, v) - x * x, 1e-30))
    su, sx, sy = flat(source)
    tu, tx, ty = flat(target)
    a, b, d = tu / su, (tx - tu * sx / su) / sy, ty / sy
    half, product = (a * a + b * b + d * d) / 2, a * d
    root = math.sqrt(max(half * half - product * product, 0))
    return math.sqrt((half + root) / max(half - root, 1e-30))


def smoothed_over_vertices(values, triangles, vertices):
    sums, counts = [0.0] * vertices, [0] * vertices
    for value, t in zip(values, triangles):
        for v in t:
            sums[v] += value
            counts[v] += 1
    return [s / c for s, c in zip(sums, counts)]


def encode(rows, kind):
    """Differences, planes, zlib, base64: see the decoder of the page."""
    width = {"u8": 1, "u16": 2, "u32": 4}[kind]
    mask = (1 << 8 * width) - 1
    components = len(rows[0])
    planes = bytearray()
    for c in range(components):
        column = [row[c] for row in rows]
        steps = [(b - a) & mask for a, b in zip([0] + column[:-1], column)]
        for byte in range(width):
            planes += bytes((s >> 8 * byte) & 255 for s in steps)
    return base64.b64encode(zlib.compress(bytes(planes), 9)).decode()


class Report:
    def __init__(self):
        self.about = {}
        self.texts = {}

    def integers(self, name, rows, kind):
        self.about[name] = {"type": kind, "components": len(rows[0]), "count": len(rows)}
        self.texts[name] = encode(rows, kind)

    def numbers(self, name, rows, kind, low=None, high=None):
        components = range(len(rows[0]))
        low = low or [min(row[c] for row in rows) for c in components]
        high = high or [max(row[c] for row in rows) for c in components]
        steps = 255 if kind == "u8" else 65535
        self.integers(name, [[round((min(max(row[c], low[c]), high[c]) - low[c]) /
                                    (high[c] - low[c]) * steps) for c in components]
                             for row in rows], kind)
        self.about[name].update({"min": low, "max": high})


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page")
    parser.add_argument("out")
    parser.add_argument("--levels", type=int, default=5)
    parser.add_argument("--decimated", action="store_true")
    parser.add_argument("--sound", action="store_true", help="no fault, and little in the file")
    parser.add_argument("--far", type=int, default=0, help="so many outliers far off")
    parser.add_argument("--residuals", type=int, default=60, help="residuals of the solver")
    parser.add_argument("--corrupt", help="name of an array to damage")
    parser.add_argument("--drop", help="name of an array to leave out of the file")
    options = parser.parse_args()

    directions, triangles = icosphere(options.levels)
    vertices = len(directions)
    points = [bumpy(d) for d in directions]
    # Turned by a quarter about x: a sphere lies as it likes.
    sphere = [[d[0], -d[2], d[1]] for d in (twisted(d, 0.8) for d in directions)]
    total, total_sphere = (sum(area(p, t) for t in triangles) for p in (points, sphere))
    ratio = [math.log2(area(sphere, t) / total_sphere * total / area(points, t))
             for t in triangles]
    sheared = [stretch(points, sphere, t) for t in triangles]
    flags = [0] * len(triangles)
    if not options.sound:
        for i, t in enumerate(triangles):
            middle = unit([sum(points[v][c] for v in t) - 3 * s for c, s in ((0, 40), (1, -7),
                                                                              (2, 3))])
            flags[i] = ((dot(middle, unit((0.9, 0.3, -0.3))) > 0.9995) * 1 |
                        (dot(middle, unit((0.3, 0.8, 0.5))) > 0.985) * 2 |
                        (dot(middle, unit((-0.6, -0.6, 0.3))) > 0.993) * 4 |
                        (i % 1999 == 0) * 16)

    report = Report()
    report.numbers("positions", points, "u16")
    report.numbers("sphere", sphere, "u16", [-1] * 3, [1] * 3)
    report.integers("triangles", triangles, "u32")
    per_vertex = [[x] for x in smoothed_over_vertices(ratio, triangles, vertices)]
    report.numbers("area_distortion", per_vertex, "u16", [-1.75], [1.5])
    per_vertex = [[x] for x in smoothed_over_vertices(sheared, triangles, vertices)]
    report.numbers("angle_distortion", per_vertex, "u8", [1.0], [3.5])
    report.numbers("residual", [[-7 + 2 * math.sin(3 * p[0]) * p[1]] for p in directions], "u8")
    report.integers("suspicious", [[f] for f in flags], "u8")
    history, frames = None, []
    if not options.sound:
        report.integers("colors", [[int(127 + 120 * math.sin(5 * d[0])), int(127 + 120 * d[1]),
                                    int(127 + 120 * d[2])] for d in directions], "u8")
        noise = [0.05 * math.sin(12.9898 * i) for i in range(vertices)]
        cloud = [[x + n * d for x, d in zip(p, e)] for p, e, n in zip(points, directions, noise)]
        strays = [[x + 0.25 * (x - s) for x, s in zip(points[i], (40, -7, 3))]
                  for i in range(5, vertices, vertices // 12)]
        strays += [[s + 50 * x for s, x in zip((40, -7, 3), unit([math.sin(i), math.cos(i), 0.5]))]
                   for i in range(options.far)]
        report.numbers("cloud", cloud + strays, "u16")
        report.integers("cloud_removed", [[0]] * vertices + [[1]] * len(strays), "u8")
        coarse, coarse_triangles = icosphere(max(options.levels - 1, 1))
        report.integers("history_triangles", coarse_triangles, "u32")
        report.numbers("history_positions", [bumpy(d) for d in coarse], "u16")
        rows, count = [], 24
        for k in range(count):
            s = 1 - k / (count - 1)
            frames.append({"level": 2 - k // 8, "nodes": [162, 642, 2562][k // 8],
                           "step": "start" if k % 8 == 0 else "sweep" if k % 8 < 4 else "newton",
                           "iteration": k % 8,
                           "residual": None if k == 0 else 0.3 * 10 ** (-0.9 * (k % 8) - k // 8)})
            for d in coarse:
                x, y, z = twisted(d, 0.8 + 2.5 * s * s)
                bent = unit([x + s * 1.2 * z * z - 0.3 * s, y, z * (1 - 0.6 * s) + 0.001])
                rows.append([bent[0], -bent[2], bent[1]])
        frames[-1]["step"] = "end"
        report.numbers("history_frames", rows, "u16", [-1] * 3, [1] * 3)
        history = {"vertices": len(coarse), "triangles": len(coarse_triangles), "frames": frames}

    crossing = 0 if options.sound else sum(1 for f in flags if f & 1) // 2
    summary = ("Looks like a closed genus-0 surface." if options.sound else
               "Looks like an open surface, closed by 1 lid of 7.31 at (43.8, 5.2, 10.1).")
    factor = 25 if options.decimated else 1
    data = {
        "format": 1,
        "tool": {"name": "pcl_spherical_param_reconstruction", "version": "0.1.0"},
        "command": "pcl_spherical_param_reconstruction 'bumpy </script> & scan.ply' mesh.ply "
                   "-smooth 5",
        "report": {
            "version": "0.1.0", "input": "scans/bumpy </script> & scan.ply", "output": "mesh.ply",
            "options": {"graph": "delaunay", "k": 12, "solver": "multilevel", "weights": "adaptive",
                        "exponent": 3.0, "tolerance": None, "lambda": 0.5, "seed": 1, "smooth": 5,
                        "ascii": False},
            "points": vertices + 13, "ignored_points": 1, "outliers": {"count": 12},
            "duplicates": 0,
            "vertices": vertices * factor, "triangles": len(triangles) * factor,
            "closed": True, "manifold": True, "oriented": True, "components": 1, "genus": 0,
            "volume": 13207.4, "area": 3391.02, "self_intersections": crossing,
            "measures": {"mean_edge_length": 0.61, "bounding_box": {"min": [20, -27, -12],
                                                                    "max": [60, 14, 26]}},
            "diagnosis": {"kind": "closed genus 0" if options.sound else "open",
                          "looks_closed_genus0": options.sound, "summary": summary},
            "edges_outside_graph": 0.0012, "residual": 7.15e-7, "stop_reason": "unfinished",
            "residuals": [] if options.sound else [
                10 ** (-4.8 * i / options.residuals) for i in range(options.residuals)],
            "graph": {"edges": 3 * vertices},
            "embedding": {"energy": 77.45, "starts": 2, "levels": [
                {"nodes": vertices, "edges": 30720, "sweeps": 10, "newton_iterations": 2,
                 "linear_iterations": 8, "residual": 7.2e-7},
                {"nodes": 2562, "edges": 7680, "sweeps": 10, "newton_iterations": 4,
                 "linear_iterations": 24, "residual": 3.1e-11},
                {"nodes": 642, "edges": 1920, "sweeps": 3, "newton_iterations": 7,
                 "linear_iterations": 22, "residual": 2.9e-8}]},
            "attempts": [], "smoothing": {"steps": 5, "max_displacement": 0.015,
                                          "self_intersections": 0},
            "stages": [{"name": n, "seconds": s} for n, s in (
                ("read", .012), ("neighbors", .081), ("graph", .104), ("hierarchy", .02),
                ("embedding", .62), ("triangulation", .09), ("optimization", .41),
                ("diagnosis", .13), ("smoothing", .055), ("write", .018))],
            "peak_memory_bytes": 84597248,
            "warnings": [] if options.sound else [
                summary + " The mesh is closed all the same.", "1 point is not finite."],
        },
        "mesh": {"vertices": vertices * factor, "triangles": len(triangles) * factor,
                 "shown_vertices": vertices, "shown_triangles": len(triangles),
                 "decimated": options.decimated, "sphere_of": "embedding"},
        "history": history,
        "arrays": report.about,
    }
    if options.corrupt:
        text = report.texts[options.corrupt]
        report.texts[options.corrupt] = text[:len(text) // 2] + "AAAA" + text[len(text) // 2 + 4:-8]
    if options.drop:
        del report.texts[options.drop]

    parts = ['<script type="application/json" id="report-data">' +
             json.dumps(data).replace("<", "\\u003c") + "</script>"]
    parts += [f'<script type="text/plain" id="array-{name}">{text}</script>'
              for name, text in report.texts.items()]
    with open(options.page, encoding="utf-8") as file:
        before, after = file.read().split(MARKER)
    with open(options.out, "w", encoding="utf-8") as file:
        file.write(before + "\n".join(parts) + after)


if __name__ == "__main__":
    main()
