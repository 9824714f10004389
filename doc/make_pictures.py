#!/usr/bin/python3
"""Makes the pictures of README and documentation from generated scans, by the tools and tools/draw.py.

    doc/make_pictures.py [NAME...]       default: all of them

Needs the tools of build/release, or of the folder in the environment variable TOOLS. .github/texture.png and
.github/report.png are screenshots.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
from random import Random

import numpy as np
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import draw as drawing  # noqa: E402

TOOLS = pathlib.Path(os.environ.get("TOOLS", ROOT / "build" / "release" / "bin")).resolve()
PICTURES = ROOT / "doc" / "pictures"
GITHUB = ROOT / ".github"
FRONT = "--view=0,0"
SIDE = "--view=30,10"
CAMERA = "0,-90"  # along z, y down
PAPER = ["-method", "paper"]


def call(*words):
    command = [str(word) for word in words]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: a mesh whose triangles intersect
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")


def run(program, *arguments):
    call(TOOLS / f"pcl_spherical_param_{program}", *arguments)


def scan(shape, points, *options):
    run("scan", shape, f"{shape}.ply", "-points", points, *options)
    return f"{shape}.ply"


def mesh(cloud, name, *options):
    """Meshes a cloud; how many pairs of triangles intersect in the mesh that is written."""
    run("reconstruction", cloud, f"{name}.ply", "-json", "report.json", *options)
    report = json.loads(pathlib.Path("report.json").read_text())
    count = report["self_intersections"]
    return f"{count:,} self-intersection{'' if count == 1 else 's'}"


def draw(path, size, views, *options):
    """Draws files with their captions."""
    words = [str(file) for file, _ in views] + [f"--caption={caption}" for _, caption in views]
    drawing.main([str(path), *words, f"--size={size}", *options])
    print(f"{path}: {os.path.getsize(path) // 1024} KB", flush=True)


def remesh():
    cloud = scan("hand", 6000)
    mesh(cloud, "mesh")
    run("remesh", cloud, "grid.ply", "-points", 10242)
    run("remesh", cloud, "series.ply", "-series", "-degree", 32, "-points", 10242)
    draw(GITHUB / "remesh.png", "1200x420", [("mesh.ply", "mesh of the cloud"), ("grid.ply", "remeshed"),
         ("series.ply", "spherical harmonics to degree 32")], "--edges", FRONT)  # fmt: skip


def morph():
    run("morph", scan("head", 6000), scan("animal", 6000), "frame.ply", "-frames", 5, "-match",
        "-connectivity", "resampled")  # fmt: skip
    draw(GITHUB / "morph.png", "1320x280", [(f"frame_{i:03d}.ply", f"t = {i / 4:g}") for i in range(5)], SIDE)


def pipeline():
    cloud = scan("hand", 4000)
    mesh(cloud, "mesh", "-sphere", "sphere.ply")
    draw(PICTURES / "pipeline.png", "1320x480", [(cloud, "points"), ("sphere.ply", "embedding, triangulated"),
         ("mesh.ply", "the same triangles in space, optimised")],
         "--colors=sphere.ply", "--edges", FRONT)  # fmt: skip


def openings():
    cloud = scan("holed", 4000)
    mesh(cloud, "closed", "-surface", "closed")
    mesh(cloud, "open", "-surface", "open", "-sphere", "sphere.ply")
    draw(PICTURES / "openings.png", "1320x400", [(cloud, "points"), ("closed.ply", "closed: the openings are filled"),
         ("open.ply", "open"), ("sphere.ply", "directions: room for the openings")],
         "--edges", "--view=60,15")  # fmt: skip


def embedding():
    cloud, views = scan("hand", 8000), []
    for name, text, options in (("paper", "the paper's iteration", PAPER), ("multilevel", "multilevel", [])):
        said = mesh(cloud, name, "-sphere", f"{name}_sphere.ply", *options)
        views += [(f"{name}_sphere.ply", text), (f"{name}.ply", f"its mesh: {said}")]
    draw(PICTURES / "embedding.png", "1320x350", views, "--colors=multilevel_sphere.ply", FRONT)


def smoothing():
    cloud = scan("animal", 12000, "-noise", 1.5)
    views = [(f"smooth_{steps}.ply", f"-smoothing {steps}: {mesh(cloud, f'smooth_{steps}', '-smoothing', steps)}")
             for steps in (1, 5, 30)]  # fmt: skip
    said = mesh(cloud, "smooth_0", "-consolidation", "none")
    draw(PICTURES / "smoothing.png", "1320x340", [("smooth_0.ply", f"as scanned: {said}"), *views], SIDE)


def consolidation():
    """Four scans of one surface, each with noise and a little off its place."""
    random, scans = Random(2), []
    for seed in range(1, 5):
        run("scan", "head", "one.xyz", "-points", 6000, "-noise", 0.4, "-seed", seed)
        points = np.loadtxt("one.xyz")
        scans.append(points + [random.gauss(0, 0.003 * np.ptp(points[:, 0])) for _ in range(3)])
    np.savetxt("scans.xyz", np.concatenate(scans), fmt="%.6g")
    views = []
    for name, options in (("plain", ["-consolidation", "none"]), ("smoothed", ["-smoothing", "5"]), ("auto", ["-consolidation", "auto"])):
        said = mesh("scans.xyz", name, *options)
        views.append((f"{name}.ply", f"{' '.join(options)}: {said}"))
    draw(PICTURES / "consolidation.png", "1260x420", views, "--view=25,5")


def symptoms():
    for name, cloud, options, view in (
        ("noise", scan("animal", 12000, "-noise", 0.6), ["-consolidation", "none"], SIDE),
        ("handle", scan("torus", 4000), ["-handles", "none"], "--view=30,40"),
    ):
        mesh(cloud, "before")
        run("reconstruction", cloud, "after.ply", *options)
        draw(PICTURES / f"symptom_{name}.png", "720x300", [("before.ply", "by default"),
             ("after.ply", " ".join(options))], view, *(["--edges"] if name == "handle" else []))  # fmt: skip


def depth_camera():
    cloud = scan("desk", 76800)
    run("reconstruction", cloud, "mesh.ply")
    draw(PICTURES / "depth_camera.png", "1260x400", [(cloud, "depth image"), ("mesh.ply", "its mesh as the camera sees it"),
         ("mesh.ply", "from above")], f"--view={CAMERA}", f"--view={CAMERA}", "--view=20,-55")  # fmt: skip


def recipes():
    """The guide's "I have a ...", in three rows."""
    for kind, shape, options in (
        ("depth", "desk", []), ("tripod", "yard", []), ("tile", "town", []), ("contours", "hand", ["-slices", 80]),
        ("turn", "animal", ["-views", 8, "-noise", 0.5, "-points", 20000]),
    ):  # fmt: skip
        run("scan", shape, f"{kind}.ply", *options)
        run("reconstruction", f"{kind}.ply", f"{kind}_mesh.ply")
    run("scan", "head", "points.ply", "-truth", "fine.ply")
    run("remesh", "fine.ply", "fine_mesh.ply", "-points", 2562)
    kinds = {"depth": ("depth image", CAMERA), "tripod": ("laser scan", "30,40"), "tile": ("airborne tile, enlarged", "30,30"),
             "turn": ("turntable scan", "30,10"), "contours": ("contours", "25,10"), "fine": ("a mesh", "25,10")}  # fmt: skip
    rows = []
    for row in (["depth", "tripod"], ["tile", "turn"], ["contours", "fine"]):
        views = [(f"{kind}{end}.ply", kinds[kind][0] if not end else "remeshed" if kind == "fine" else "its mesh")
                 for kind in row for end in ("", "_mesh")]  # fmt: skip
        draw("row.png", "1320x280", views, *(f"--view={kinds[kind][1]}" for kind in row for _ in range(2)),
             *(["--edges"] if "fine" in row else []))  # fmt: skip
        rows.append(Image.open("row.png").convert("RGB"))
    drawing.main(["near.png", "tile.ply", "tile_mesh.ply", "--size=1320x492", f"--view={kinds['tile'][1]}"])
    for left in (0, 330):  # the middle, twice as large
        near = Image.open("near.png").convert("RGB").crop((2 * left + 175, 133, 2 * left + 485, 359))
        rows[1].paste(Image.new("RGB", (330, 246), "white"), (left, 0))
        rows[1].paste(near, (left + 10, 10))
    drawing.save(PICTURES / "recipes.png", Image.fromarray(np.vstack(rows)))


def scans():
    shapes = ["head", "bird", "hand", "animal", "holed", "torus", "chair", "bowl"]
    run("scan", "jaw", "jaw.ply")
    draw(PICTURES / "scans.png", "1320x150", [*((scan(shape, 2500), shape) for shape in shapes), ("jaw.ply", "jaw")],
         *["--view=25,15"] * len(shapes), f"--view={CAMERA}")  # fmt: skip


ALL = [remesh, morph, pipeline, openings, embedding, smoothing, consolidation, symptoms, depth_camera,
       recipes, scans]  # fmt: skip


def main(names):
    known = {picture.__name__: picture for picture in ALL}
    for name in set(names) - set(known):
        sys.exit(f"there is no picture {name}\nthere are {', '.join(known)}")
    for picture in [known[name] for name in names] or ALL:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            picture()
            os.chdir(ROOT)


if __name__ == "__main__":
    main(sys.argv[1:])
