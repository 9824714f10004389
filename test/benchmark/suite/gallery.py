"""The gallery: clouds, real and generated, and what each method makes of them, side by side."""

import bz2
import dataclasses
import json
import pathlib

import numpy as np

from .programs import Cloud, Failure, run
from .report import Table

PEERS = [  # label, program, method
    ("PCL Poisson", "benchmark_peer_pcl", "poisson"),
    ("PCL greedy projection", "benchmark_peer_pcl", "gp3"),
    ("Open3D ball pivoting", "benchmark_peer_open3d", "ball_pivoting"),
]
COLUMNS = [("cloud", "cloud"), ("method", "method"), ("triangles", "triangles"), ("boundary", "boundary edges"),
           ("crowded", "edges of three or more triangles"),
           ("sphere", "closed, manifold, genus 0"), ("intersections", "self-intersections"),
           ("used", "points used [%]", 1), ("seconds", "time [s]", 1),
           ("failure", "remark")]  # fmt: skip
CAPTION = ("{method}: {triangles:,} triangles\n"
           "{boundary:,} boundary edges, {intersections:,} self-intersections")  # fmt: skip

PCL = "/usr/share/doc/python3-pcl/examples/pcldata/tutorials/"
OPENCV = "/usr/share/doc/opencv-doc/examples/surface_matching/data/"
PETSC = "/usr/share/petsc/3.18/share/petsc/datafiles/meshes/"
# Axes and signs that turn a cloud so that z points up.
X_UP, Y_UP, Z_UP = ((1, 2, 0), (1, 1, 1)), ((0, 2, 1), (1, -1, 1)), ((0, 1, 2), (1, 1, 1))


@dataclasses.dataclass
class Row:
    name: str
    options: str  # of our tool
    view: tuple  # azimuth and elevation [degrees]
    what: str
    see: str  # written by somebody who looked at the picture
    source: str = ""  # a file of a package
    axes: tuple = Z_UP  # of that file
    stride: int = 1  # along both axes of an image
    scan: tuple = ()  # without a file: generated shape, its points, noise, and strays [%]
    images: int = 0  # depth images of that shape, which are merged


ROWS = [
    Row("horse", "", (120, 10),
        "A horse, scanned whole: vertices of a mesh of the package libpetsc3.18-dev-examples "
        "(BSD-2-Clause).",
        "Ours and Poisson's look alike; Poisson's has a few boundary edges, and passes near the points. "
        "The other two leave a gap below the neck and pinholes.",
        PETSC + "horse.ply.bz2"),
    Row("dinosaur", "", (20, 10),
        "A toy, scanned but for parts of its feet and legs: vertices of a mesh of OpenCV's samples for "
        "surface matching, package opencv-doc (Apache-2.0 and BSD-3-Clause).",
        "Ours is closed and keeps the folds of the skin; it ties loose points between the feet to the "
        "body by a thread. Poisson's is as good where there are points; it swells "
        "below a foot and makes blobs of loose points. The other two leave gaps and pinholes.",
        OPENCV + "parasaurolophus_low_normals2.ply", X_UP),
    Row("carton", "-surface open", (10, 25),
        "A carton of milk from one side: a cloud of PCL's tutorial on correspondence grouping, package "
        "python3-pcl (BSD-3-Clause).",
        "Ours and greedy projection keep the sheet with its outline and its noise. Greedy projection is "
        "faster and here nearly as good: some of its triangles intersect. Ball pivoting leaves holes. "
        "Poisson's is smoother, and goes on beyond the carton.",
        PCL + "correspondence_grouping/milk.pcd", Y_UP),
    Row("floor", "-surface open -parts each", (0, 20),
        "Cartons and bottles on a floor, an image of 640 x 480 points, of which every second pixel of "
        "every second line is taken: another cloud of that tutorial.",
        "Ours keeps the shadows of the objects open and the floor whole. Some of its triangles at the "
        "edges of shadows intersect or face away. Far from the camera the lines of pixels are wide "
        "apart; there greedy projection and ball pivoting leave holes. Poisson's has neither shadows "
        "nor an end.",
        PCL + "correspondence_grouping/milk_cartoon_all_small_clorox.pcd", Y_UP, 2),
    Row("toys", "-surface open -parts each", (0, 0),
        "Toys that cover each other, from one side: vertices of a mesh of OpenCV's samples for surface "
        "matching.",
        "Ours fails. Two toys touch in the scan and are one part of more than half of the points. It "
        "collapses on the sphere and comes back folded, and the tool calls the mesh not usable. In the "
        "other parts few triangles intersect. "
        "Greedy projection and ball pivoting mesh all toys well, and faster. Poisson fills what is "
        "between the toys.",
        OPENCV + "rs1_normals.ply", Y_UP),
    Row("lamp", "", (0, 20),
        "A street lamp, thin and noisy: another cloud of the package python3-pcl.",
        "No method makes a lamp of it. Ours is closed but folded, with a sail across the arm, and the "
        "tool calls it not usable. Greedy projection and ball pivoting leave shreds, which are closer to the "
        "pole. Poisson's is a sheet.",
        PCL + "lamppost.pcd"),
    Row("rabbit", "-surface open", (60, 15),
        "A generated scan without noise, with four openings.",
        "Ours, greedy projection and ball pivoting are equally good: the openings stay open. Poisson "
        "closes them.",
        scan=("holed", 12000, 0, 0)),
    Row("noise", "-smoothing 30", (30, 10),
        "A generated scan with noise along the normal of 1.5 times the mean distance of neighbours.",
        "Ours finds all limbs and is then smoothed, which moves all points and makes ears and tail "
        "thin. Poisson's has the shape without smoothing and follows the noise at the depth of this "
        "page; a smaller depth is smoother and coarser. The other two need less noise.",
        scan=("animal", 12000, 1.5, 0)),
    Row("strays", "-outliers auto", (0, 10),
        "A generated scan with one percent of stray points.",
        "Ours leaves the strays out and has all else. Poisson's is as clean. Greedy projection makes "
        "triangles of some strays, and both others join some to the hand.",
        scan=("hand", 20000, 0, 1)),
    Row("raw", "-smoothing 5", (30, 10),
        "Eight generated depth images, merged: noise along the rays, a small registration error of each "
        "image, so two and more layers, and density that changes with the angle.",
        "Ours and Poisson's are both good: ours is smoother, Poisson's keeps more of ears and feet. The other "
        "two mesh all layers at once, and leave holes.",
        scan=("animal", 200000, 0, 0), images=8),
]  # fmt: skip
QUICK = ("rabbit",)

HEAD = """# Gallery

Clouds, the meshes that we make of them, and those of PCL's Poisson reconstruction, PCL's greedy projection and Open3D's
ball pivoting. Six clouds are real, from Debian packages with a free licence, which do not say what they were scanned
with; the vertices of a scanned mesh count as a cloud. Four are generated.

All methods get the points alone, with z pointing up. The parameters of the others are the same for all clouds, and
those of ours are its defaults and the options that are printed. Times are of one run, from file to file: on a busy
machine they vary by a factor of several, and give the order of magnitude only. Triangles that are seen from behind are
orange: the inside of an open mesh, or a mesh that is not oriented. Parts of a mesh that are not connected may differ in
this by chance.

"""


def _read(row, work):
    path = pathlib.Path(row.source)
    if not path.is_file():
        raise Failure(f"there is no file '{path}'",
                      "run tools/setup.sh gallery where dpkg installs documentation")  # fmt: skip
    if path.suffix == ".pcd":
        import pcl  # of a package with clouds

        cloud = pcl.load(str(path))
        image = cloud.to_array().reshape(cloud.height, cloud.width, 3)
        return image[:: row.stride, :: row.stride].reshape(-1, 3)
    from .drawing import vertices

    if path.suffix == ".bz2":
        packed, path = path, work / path.stem
        path.write_bytes(bz2.decompress(packed.read_bytes()))
    return vertices(path)


def _generate(row, programs):
    from .drawing import vertices

    shape, count, noise, strays = row.scan
    points = vertices(programs.scan(f"{shape}_{count}", noise, truth=False).points)
    low, high = points.min(axis=0), points.max(axis=0)
    random = np.random.default_rng(1).random((count * strays // 100, 3))
    return np.concatenate([points, low + random * (high - low)])


def _depth_images(points, images):
    """What cameras around an object see of its dense points, merged: one point a pixel, the nearest."""
    random = np.random.default_rng(1)
    pixel = np.linalg.norm(np.ptp(points, axis=0)) / 120
    seen = []
    for image in range(images):
        angle = 2 * np.pi * image / images
        toward = np.array([np.cos(angle), np.sin(angle), 0.7 * (-1) ** image])
        toward /= np.linalg.norm(toward)
        right = np.array([-np.sin(angle), np.cos(angle), 0.0])
        pixels = np.floor(points @ np.stack([right, np.cross(toward, right)], axis=1) / pixel)
        order = np.argsort(-(points @ toward), kind="stable")
        _, first = np.unique(pixels[order], axis=0, return_index=True)
        noise = random.normal(0, 0.3 * pixel, (len(first), 1)) * toward
        seen.append(points[order[first]] + noise + random.normal(0, 0.2 * pixel, 3))
    return np.concatenate(seen)


def _cloud(context, row):
    """The points of a row, turned, in a file that all methods read; and their number."""
    points = _read(row, context.work) if row.source else _generate(row, context.programs)
    if row.images:
        points = _depth_images(points, row.images)
    order, signs = row.axes
    points = points[np.isfinite(points).all(axis=1)][:, order] * signs
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path = context.work / f"{row.name}.ply"
    path.write_bytes(head.encode() + points.astype("<f4").tobytes())
    return Cloud(row.name, path), len(points)


def _edges(mesh):
    """How many edges belong to one triangle, and how many to three or more."""
    from .drawing import read_ply

    edges = np.sort(read_ply(mesh)[2][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, triangles = np.unique(edges, axis=0, return_counts=True)
    return {"boundary": int((triangles == 1).sum()), "crowded": int((triangles > 2).sum())}


def _draw(path, files, captions, view):
    from PIL import Image

    from .drawing import Pictures

    pictures = Pictures(path, size=360)
    pictures.row(files, captions, view=[view], back=True)
    pictures.save()
    # 256 colours are enough, for a third of the bytes. Without dithering shades become patches.
    image = Image.open(path).convert("RGB")
    colors = image.quantize(256, method=Image.Quantize.FASTOCTREE)  # keeps white and orange
    image.quantize(palette=colors, dither=Image.Dither.FLOYDSTEINBERG).save(path, optimize=True)


def _compare(context, row, peers, parameters):
    """Draws a row, and returns its part of the page and its numbers."""
    cloud, count = _cloud(context, row)
    files, captions, rows = [cloud.points], [f"{count:,} points\n"], []
    for label, program, method in [("ours", None, None), *peers]:
        mesh = context.work / f"{row.name}_{len(rows)}.ply"
        report = mesh.with_suffix(".json")
        if program:
            command = [program, method, cloud.points, mesh, report]
        else:
            command = [context.programs.reconstruction, cloud.points, mesh, "-quiet"]
            command += row.options.split()
        done = run(command, timeout=120.0)
        rows.append({"cloud": row.name, "method": label, "seconds": done.seconds})
        if done.problem:
            rows[-1]["failure"] = done.problem
            if context.quick or not program:
                raise Failure(f"{label} on {cloud.name}: {done.problem}", "run it alone")
            continue
        if program:
            told = json.loads(report.read_text())
            parameters[label] = f"{told['library']}: {told['parameters']}"
        rows[-1].update(context.programs.measure(mesh, cloud), **_edges(mesh))
        files.append(mesh)
        captions.append(CAPTION.format(**rows[-1]))
    _draw(context.out / "gallery" / f"{row.name}.png", files, captions, row.view)
    command = f"pcl_spherical_param_reconstruction {row.name}.ply mesh.ply {row.options}".strip()
    picture = f"![{row.name}: the cloud and the mesh of each method]({row.name}.png)"
    return f"**{row.name.capitalize()}.** {row.what} `{command}`: {row.see}\n{picture}\n\n", rows


def section(context):
    peers = [(label, program, method) for label, name, method in PEERS
             if (program := context.programs.find(name, required=False))]  # fmt: skip
    folder = context.out / "gallery"
    folder.mkdir(exist_ok=True)
    page, rows, parameters = HEAD, [], {}
    for row in ROWS:
        if not context.quick or row.name in QUICK:
            context.say(f"gallery: {row.name}, {len(peers) + 1} methods")
            text, new_rows = _compare(context, row, peers, parameters)
            page, rows = page + text, rows + new_rows
    columns = [column for column in COLUMNS if any(row.get(column[0]) is not None for row in rows)]
    page += f"## Numbers\n\n{Table(columns, rows).markdown()}\n## Parameters\n\n"
    page += "".join(f"- {name}: {text}\n" for name, text in parameters.items())
    page += f"\n{context.report.facts['provenance']}\n"
    (folder / "README.md").write_text(page)
    context.report.facts["gallery"] = "gallery/README.md"
