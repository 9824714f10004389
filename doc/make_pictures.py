#!/usr/bin/python3
"""Makes the pictures of the documentation: from generated scans, by the tools as they are built.

    doc/make_pictures.py [NAME...]       default: all of them, into doc/pictures

Needs a release build with the renderer, the packages of tools/packages-docs.txt,
tools/packages-benchmark.txt (matplotlib) and tools/packages.txt (xvfb), and, for "migration", what
tools/test_docs.sh leaves in build. Pictures are reduced to some 128 colours, to stay small.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "release"
PICTURES = ROOT / "doc" / "pictures"
TYPES = {"float": "f4", "float32": "f4", "double": "f8", "uchar": "u1", "uint8": "u1", "int": "i4",
         "int32": "i4"}  # fmt: skip
# Colours of pictures that need few, or more than others.
COLORS = {"embedding": 256, "pipeline": 256, "triangulation": 48}
work = pathlib.Path()


def run(program, *arguments):
    """Runs one of our programs in the work folder; its output."""
    command = [BUILD / "bin" / f"pcl_spherical_param_{program}", *arguments]
    if program == "render" and shutil.which("xvfb-run"):
        command = ["xvfb-run", "-a", *command]
    # Two virtual displays that start at once may take the same number.
    for _ in range(5 if command[0] == "xvfb-run" else 1):
        done = subprocess.run([str(word) for word in command], cwd=work, capture_output=True, text=True)
        if done.returncode == 0:
            break
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def scan(shape, points, *options, name=None):
    file = f"{name or shape}.ply"
    run("scan", shape, file, "-points", points, *options)
    return file


def mesh(cloud, name, *options):
    """Meshes a cloud; the report of the tool."""
    run("reconstruction", cloud, f"{name}.ply", "-json", f"{name}.json", *options)
    return json.loads((work / f"{name}.json").read_text())


def render(name, size, *arguments):
    run("render", f"{name}.png", "-size", size, *arguments)
    return Image.open(work / f"{name}.png").convert("RGB")


def save(picture, name):
    path = PICTURES / f"{name}.png"
    picture.quantize(COLORS.get(name, 128)).save(path, optimize=True)
    print(f"{path.name}: {path.stat().st_size // 1024} KB, {picture.size[0]} x {picture.size[1]}")


def join(pictures, columns=None):
    """Puts pictures of one size into a grid."""
    columns = columns or len(pictures)
    width, height = pictures[0].size
    sheet = Image.new("RGB", (width * columns, height * -(-len(pictures) // columns)), "white")
    for i, picture in enumerate(pictures):
        sheet.paste(picture, (width * (i % columns), height * (i // columns)))
    return sheet


def vertices(file):
    """The points of a PLY file, and its colours or None."""
    data = (work / file).read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    count, fields, text = 0, [], b"format ascii" in data[:start]
    for line in data[:start].decode("ascii").splitlines():
        words = line.split()
        if words[:2] == ["element", "vertex"]:
            count = int(words[2])
        elif words[:1] == ["element"]:
            break
        elif words[:1] == ["property"]:
            fields.append((words[2], "<" + TYPES[words[1]]))
    if text:
        rows = np.array([line.split()[: len(fields)] for line in
                         data[start:].decode("ascii").splitlines()[:count]], dtype=float)  # fmt: skip
        table = {name: rows[:, i] for i, (name, _) in enumerate(fields)}
    else:
        table = np.frombuffer(data, np.dtype(fields), count, start)
    points = np.stack([table[axis] for axis in "xyz"], axis=1).astype(float)
    return points


def paint(mesh_file, colors, name):
    """Writes a mesh again, with a colour for each vertex."""
    data = (work / mesh_file).read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    points = vertices(mesh_file).astype("<f4")
    header = data[:start].decode("ascii").splitlines()
    at = next(i for i, line in enumerate(header) if line.startswith("element face"))
    size = 0
    for line in header[:at]:
        if line.startswith("property"):
            size += int(TYPES[line.split()[1]][1])
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property float {axis}" for axis in "xyz"]
    head += [f"property uchar {color}" for color in ("red", "green", "blue")] + header[at:]
    rows = np.zeros(len(points), [("p", "<f4", 3), ("c", "u1", 3)])
    rows["p"], rows["c"] = points, np.clip(255 * np.asarray(colors), 0, 255)
    faces = data[start + size * len(points) :]
    (work / f"{name}.ply").write_bytes(("\n".join(head) + "\n").encode() + rows.tobytes() + faces)
    return f"{name}.ply"


def count(number, what="self-intersection"):
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def intersections(report):
    return count(report["self_intersections"])


def graph(cloud, kind, k):
    """The edges of a neighbour graph, by a small program that uses the installed core."""
    program = work / "graph_edges"
    if not program.exists():
        prefix = work / "prefix"
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], check=True,
                       stdout=subprocess.DEVNULL)  # fmt: skip
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "spherical_param_core"],
                               env={"PKG_CONFIG_PATH": str(next(prefix.rglob("pkgconfig"))),
                                    "PATH": "/usr/bin:/bin"},
                               check=True, capture_output=True, text=True).stdout.split()  # fmt: skip
        library = next(word[2:] for word in flags if word.startswith("-L"))
        subprocess.run(["c++", "-std=c++17", "-O2", PICTURES / "graph_edges.cpp", "-o", program,
                        *flags, f"-Wl,-rpath,{library}"], check=True)  # fmt: skip
    np.savetxt(work / "cloud.xyz", vertices(cloud), fmt="%.9g")
    out = subprocess.run([program, work / "cloud.xyz", kind, str(k)], check=True,
                         capture_output=True, text=True).stdout  # fmt: skip
    return np.array([line.split() for line in out.splitlines()], dtype=int)


def draw_graph(axes, points, edges, box=None):
    """Edges seen from the front, the far ones paler."""
    depth = points[edges].mean(axis=1)[:, 1]
    low, high = depth.min(), depth.max()
    for (a, b), d in sorted(zip(edges.tolist(), depth), key=lambda item: -item[1]):
        shade = 0.15 + 0.75 * (d - low) / (high - low)
        axes.plot(points[[a, b], 0], points[[a, b], 2], color=(shade * 0.9, shade, min(1.0, shade + 0.15)),
                  linewidth=0.6 if box is None else 0.9)  # fmt: skip
    axes.set_aspect("equal")
    axes.axis("off")
    if box is not None:
        axes.set_xlim(box[0], box[1])
        axes.set_ylim(box[2], box[3])


def figure_image(figure):
    file = work / "figure.png"
    figure.savefig(file, dpi=100)
    plt.close(figure)
    return Image.open(file).convert("RGB")


def captioned(axes, text):
    axes.set_title(text, fontsize=11, color="0.25")


FRONT = ["-view", "0,0"]


def pipeline():
    cloud = scan("hand", 4000)
    mesh(cloud, "first", "-optimize", "none", "-attempts", "1", "-sphere", "sphere.ply")
    mesh(cloud, "last")
    edges = graph(cloud, "delaunay", 12)
    panels = [
        (render("p0", "300x300", cloud, *FRONT), "points"),
        (None, "neighbour graph"),
        (render("p2", "300x300", "sphere.ply", "-colors", "sphere.ply", *FRONT), "embedding, triangulated"),
        (render("p3", "300x300", "first.ply", "-edges", "off", "-colors", "sphere.ply", *FRONT), "first mesh"),
        (render("p4", "300x300", "last.ply", "-edges", "off", "-colors", "sphere.ply", *FRONT), "optimised mesh"),
    ]  # fmt: skip
    figure, rows = plt.subplots(1, len(panels), figsize=(14, 3.1))
    for i, (axes, (picture, text)) in enumerate(zip(rows, panels)):
        if picture is None:
            draw_graph(axes, vertices(cloud), edges)
        else:
            axes.imshow(picture)
            axes.axis("off")
        captioned(axes, f"{i + 1}. {text}")
    figure.subplots_adjust(left=0.005, right=0.995, bottom=0.01, top=0.9, wspace=0.08)
    save(figure_image(figure), "pipeline")


def neighbour_graph():
    cloud = scan("hand", 3000)
    points = vertices(cloud)
    # Between two fingers, where both sheets are near to each other.
    box = (-0.2, 0.3, -0.05, 0.45)
    figure, rows = plt.subplots(1, 2, figsize=(9, 4.8))
    for axes, kind, k, text in zip(rows, ("knn", "delaunay"), (25, 12),
                                   ("25 nearest neighbours", "local Delaunay neighbourhoods")):  # fmt: skip
        edges = graph(cloud, kind, k)
        draw_graph(axes, points, edges, box)
        captioned(axes, f"{text}: {2 * len(edges) / len(points):.1f} edges a point")
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.92, wspace=0.04)
    save(figure_image(figure), "neighbour_graph")


def embedding():
    cloud = scan("hand", 8000)
    views = []
    for name, text, options in (
        ("iteration", "the paper's iteration", ["-solver", "iterative", "-graph", "knn"]),
        ("multilevel", "coarse to fine", []),
    ):
        report = mesh(cloud, name, "-optimize", "none", "-attempts", "1", "-sphere",
                      f"{name}_sphere.ply", *options)  # fmt: skip
        views += ["-caption", f"{text}: sphere", f"{name}_sphere.ply", *FRONT,
                  "-caption", f"its mesh: {intersections(report)}", f"{name}.ply", *FRONT]  # fmt: skip
    save(render("embedding", "1320x350", "-colors", "multilevel_sphere.ply", "-edges", "off", *views),
         "embedding")  # fmt: skip


def triangulation():
    cloud = scan("snake", 8000)
    mesh(cloud, "snake_mesh", "-optimize", "none", "-attempts", "1", "-sphere", "snake_sphere.ply")
    points = vertices("snake_sphere.ply")
    # The direction in which the points are densest.
    tree = points @ points.T
    np.fill_diagonal(tree, -1)
    tip = points[np.argmax(tree.max(axis=1))]
    azimuth = float(np.degrees(np.arctan2(tip[0], -tip[1])))
    elevation = float(np.degrees(np.arcsin(tip[2])))
    look = ["-view", f"{azimuth:.3f},{min(89, max(-89, elevation)):.3f}"]
    focus = ["-focus", ",".join(f"{c:.9f}" for c in tip)]
    views = ["-caption", "all of the sphere", "snake_sphere.ply", *look, "-zoom", "1"]
    for zoom in (30, 1000):
        views += [*focus, "-zoom", str(zoom), "-caption", f"{zoom:,} times larger", "snake_sphere.ply"]
    save(render("triangulation", "1200x400", "-edges", "on", *look, *views), "triangulation")


def optimisation():
    cloud = scan("hand", 8000)
    views = []
    for method in ("none", "flips", "full"):
        report = mesh(cloud, method, "-optimize", method, "-attempts", "1", "-solver", "iterative", "-graph", "knn")
        views += ["-caption", f"{method}: {intersections(report)}", f"{method}.ply"]
    save(render("optimisation", "1200x400", *FRONT, "-focus", "0,0,0.15", "-zoom", "2.2", "-edges", "off", *views),
         "optimisation")  # fmt: skip


def smoothing():
    cloud = scan("animal", 12000, "-noise", "1.5")
    views = []
    for steps in (0, 5, 30):
        report = mesh(cloud, f"smooth_{steps}", *(["-smooth", steps] if steps else []))
        hits = report["smoothing"]["self_intersections"] if steps else report["self_intersections"]
        views += ["-caption", f"{steps or 'no'} steps: {count(hits)}", f"smooth_{steps}.ply"]
    save(render("smoothing", "1200x380", "-edges", "off", "-view", "30,10", *views), "smoothing")


def outliers():
    raw_scan()
    save(join([render("with", "500x380", "-caption", "as scanned, 100 outliers", "scan.ply", "-view", "30,10"),
               render("without", "500x380", "-caption", "-outliers 4 leaves out 99", "kept.ply", "-view", "30,10")]),
         "outliers")  # fmt: skip


def raw_scan():
    """The scan of the tutorial, and what its steps make of it."""
    if (work / "scan.ply").exists():
        return
    run("scan", "animal", "clean.xyz", "-points", 20000, "-noise", "0.5")
    subprocess.run([ROOT / "doc/tutorials/raw_scan/make_scan.py", "clean.xyz", "scan.ply", "100"],
                   cwd=work, check=True)  # fmt: skip
    mesh("scan.ply", "raw")
    mesh("scan.ply", "kept", "-outliers", "4")
    mesh("scan.ply", "smooth", "-outliers", "4", "-smooth", "5")


def tutorial():
    raw_scan()
    look = ["-view", "30,10"]
    left = render("t1", "520x400", "-caption", "the scan", "scan.ply", *look)
    hits = json.loads((work / "raw.json").read_text())
    right = render("t2", "520x400", "-edges", "off", "-caption", f"meshed as it is: {intersections(hits)}", "raw.ply", *look)  # fmt: skip
    save(join([left, right]), "tutorial_scan")
    close = [*look, "-zoom", "3", "-focus", "0.3,-0.05,0.15"]
    hits = json.loads((work / "kept.json").read_text())
    caption = f"without outliers: {intersections(hits)}"
    save(join([render("t3", "520x400", "-edges", "off", "-caption", caption, "kept.ply", *look),
               render("t4", "520x400", "-edges", "off", "-caption", "closer", "kept.ply", *close)]),
         "tutorial_mesh")  # fmt: skip
    hits = json.loads((work / "smooth.json").read_text())["smoothing"]["self_intersections"]
    save(join([render("t5", "520x400", "-edges", "off", "-caption", f"5 steps: {count(hits)}", "smooth.ply", *look),
               render("t6", "520x400", "-edges", "off", "-caption", "closer", "smooth.ply", *close)]),
         "tutorial_smooth")  # fmt: skip
    run("texture", "scan.ply", "model.obj", "-outliers", "4", "-smooth", "5", "-size", "400")
    save(Image.open(work / "model.png").convert("RGB"), "tutorial_texture")


def checks():
    views = []
    for shape, look in (("torus", "30,40"), ("bowl", "30,20"), ("pair", "20,15")):
        cloud = scan(shape, 4000)
        report = mesh(cloud, f"{shape}_mesh", "-attempts", "1")
        kind = report["surface"] if isinstance(report.get("surface"), str) else ""
        text = {"torus": "a torus: handles", "bowl": "a bowl: open", "pair": "a pair: several parts"}[shape]
        views += ["-view", look, "-caption", text, f"{shape}_mesh.ply"]
        print("  ", shape, kind, json.dumps(report.get("diagnosis", ""))[:300])
    save(render("checks", "1200x400", "-edges", "on", *views), "checks")


def checker(directions, cells=8):
    """A checkerboard on the faces of a cube around the sphere."""
    largest = np.abs(directions).max(axis=1, keepdims=True)
    place = np.arctan(directions / largest) / (np.pi / 4)
    side = np.argmax(np.abs(directions), axis=1)
    cell = np.floor((place + 1) * cells / 2 + 1e-9).astype(int)
    cell[np.arange(len(cell)), side] = 0
    dark = (cell.sum(axis=1) % 2).astype(bool)
    tint = 0.62 + 0.34 * directions
    return np.where(dark[:, None], 0.45 * tint, tint)


def sphere_map():
    cloud = scan("animal", 15000)
    views = []
    for weight, text in ((0, "angles kept"), (0.85, "default"), (1, "areas kept")):
        name = f"map_{weight}"
        run("remesh", cloud, f"{name}.ply", "-points", 163842, "-fit", "linear", "-sphere",
            f"{name}_sphere.ply", "-json", f"{name}.json", "-area-weight", weight, "-map-sweeps", 15)  # fmt: skip
        directions = vertices(f"{name}_sphere.ply")
        paint(f"{name}.ply", checker(directions), f"{name}_painted")
        views += ["-caption", f"area weight {weight}: {text}", f"{name}_painted.ply"]
    save(render("sphere_map", "1200x400", "-edges", "off", "-view", "30,10", *views), "sphere_map")


def resampling():
    cloud = scan("animal", 6000)
    mesh(cloud, "animal_mesh")
    run("remesh", cloud, "geodesic.ply", "-points", 5762)
    run("remesh", cloud, "octahedral.ply", "-points", 5778, "-grid", "octahedral")
    run("remesh", cloud, "even.ply", "-points", 6000, "-grid", "even")
    views = []
    for text, file in (("mesh of the cloud", "animal_mesh.ply"), ("icosahedral", "geodesic.ply"),
                       ("octahedral", "octahedral.ply"), ("even cloud", "even.ply")):  # fmt: skip
        views += ["-caption", text, file]
    save(render("resampling", "1320x340", "-edges", "on", "-view", "30,10", *views), "resampling")


def texture_atlas():
    raw_scan()
    images = []
    for chart in ("equirectangular", "octahedral", "cube"):
        run("texture", "scan.ply", f"{chart}.obj", "-outliers", "4", "-smooth", "5", "-chart", chart, "-size", "320")  # fmt: skip
        images.append((chart, Image.open(work / f"{chart}.png").convert("RGB")))
    width = sum(image.size[0] for _, image in images) + 40
    sheet = Image.new("RGB", (width, 320), "white")
    x = 0
    for _, image in images:
        sheet.paste(image, (x, 0))
        x += image.size[0] + 20
    save(sheet, "texture_atlas")


def morphing():
    scan("head", 8000)
    scan("hand", 8000)
    run("morph", "head.ply", "hand.ply", "frame.ply", "-frames", "5", "-match", "-connectivity", "resampled")
    views = []
    for i in range(5):
        views += ["-caption", f"t = {i / 4:g}", f"frame_{i:03d}.ply"]
    save(render("morphing", "1400x300", "-edges", "off", *FRONT, *views), "morphing")


def harmonics():
    cloud = scan("animal", 10000)
    views = []
    for degree in (4, 12, 32, 96):
        run("remesh", cloud, f"degree_{degree}.ply", "-series", "-degree", degree, "-points", 20000)
        views += ["-caption", f"degree {degree}: {(degree + 1) ** 2:,} x 3 numbers", f"degree_{degree}.ply"]
    save(render("harmonics", "1320x340", "-edges", "off", "-view", "30,10", *views), "spherical_harmonics")


def scans():
    shapes = ["sphere", "ellipsoid", "head", "bird", "hand", "animal", "dumbbell", "star", "snake", "plate",
              "torus", "bowl", "pair"]  # fmt: skip
    pictures = []
    for shape in shapes:
        cloud = scan(shape, 3000)
        pictures.append(render(shape, "190x190", "-caption", shape, cloud, "-view", "25,15"))
    save(join(pictures, 7), "scans")


def reconstruction():
    cloud = scan("bird", 20000)
    mesh(cloud, "mesh", "-sphere", "sphere.ply")
    save(render("r", "1320x440", "-colors", "sphere.ply", "-edges", "off", "-view", "25,20", "-caption", "points",
                cloud, "-caption", "mesh", "mesh.ply", "-caption", "-sphere", "sphere.ply"), "reconstruction")  # fmt: skip


def open_edges(file):
    """Counts the edges of a PCL mesh that have not two triangles."""
    data = (work / file).read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    header, size = data[:start].decode("ascii").splitlines(), 0
    at = next(i for i, line in enumerate(header) if line.startswith("element face"))
    points = next(int(line.split()[2]) for line in header if line.startswith("element vertex"))
    size = sum(int(TYPES[line.split()[1]][1]) for line in header[:at] if line.startswith("property"))
    layout = np.dtype([("n", "u1"), ("v", "<i4", 3)])
    triangles = np.frombuffer(data, layout, int(header[at].split()[2]), start + points * size)["v"]
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] != 2).sum())


def migration():
    cloud = scan("hand", 10000, "-noise", "0.5", name="migration")
    examples = ROOT / "build" / "docs" / "migration"
    views = []
    for program, text in (("before", "Greedy"), ("after", "Spherical")):
        subprocess.run([examples / program, cloud, f"{program}.ply"], cwd=work, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        views += ["-caption", f"{text}: {open_edges(f'{program}.ply')} open or crowded edges", f"{program}.ply"]
    save(render("m", "1000x480", "-edges", "off", *FRONT, *views), "migration")


ALL = [pipeline, neighbour_graph, embedding, triangulation, optimisation, smoothing, outliers, checks,
       sphere_map, resampling, texture_atlas, morphing, harmonics, scans, reconstruction, tutorial,
       migration]  # fmt: skip


def main(names):
    global work
    known = {picture.__name__: picture for picture in ALL}
    for name in names:
        if name not in known:
            sys.exit(f"there is no picture {name}; there are {', '.join(known)}")
    for picture in [known[name] for name in names] or ALL:
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            picture()


if __name__ == "__main__":
    main(sys.argv[1:])
