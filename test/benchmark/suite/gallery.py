"""What each method makes of real and generated clouds, side by side. doc/gallery/README.md describes them."""

import bz2
import dataclasses
import pathlib

import draw
import numpy as np

from .comparison import FRONT, compare, find_peers
from .programs import Cloud, Failure

PEERS = ("PCL Poisson", "PCL greedy projection", "Open3D ball pivoting")
COLUMNS = [("cloud", "cloud"), ("method", "method"), ("triangles", "triangles"), ("boundary", "boundary edges"),
           ("crowded", "edges of three or more triangles"), ("sphere", "closed, manifold, genus 0"),
           ("intersections", "self-intersections"), ("used", "points used [%]", 1), ("seconds", "time [s]", 1),
           ("failure", "remark")]  # fmt: skip
SCANS = [("model", "cloud"), ("points", "points"), ("method", "method"), ("sound", "sound by our verdict"),
         ("used", "points used [%]", 2), ("parts", "parts"), ("openings", "openings"), ("genus", "handles"),
         ("intersections", "self-intersections"), ("seconds", "time [s]", 2), ("failure", "remark")]  # fmt: skip
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
    options: str = ""  # of our tool
    view: tuple = ()  # azimuth and elevation [degrees]
    source: str = ""  # a file of a package
    axes: tuple = Z_UP  # of that file
    stride: int = 1  # along both axes of an image
    scan: tuple = ()  # without a file: generated shape with its points, noise, and strays [%]
    images: int = 0  # depth images of that shape, which are merged


ROWS = [
    Row("horse", "", (120, 10), PETSC + "horse.ply.bz2"),
    Row("dinosaur", "", (20, 10), OPENCV + "parasaurolophus_low_normals2.ply", X_UP),
    Row("carton", "", (10, 25), PCL + "correspondence_grouping/milk.pcd", Y_UP),
    Row("floor", "", (0, 20), PCL + "correspondence_grouping/milk_cartoon_all_small_clorox.pcd", Y_UP, 2),
    Row("toys", "", (0, 0), OPENCV + "rs1_normals.ply", Y_UP),
    Row("lamp", "", (0, 20), PCL + "lamppost.pcd"),
    Row("rabbit", "", (60, 15), scan=("holed_12000", 0, 0)),
    Row("noise", "-smoothing 30", (30, 10), scan=("animal_12000", 1.5, 0)),
    Row("strays", "", (0, 10), scan=("hand_20000", 0, 1)),
    Row("raw", "-consolidation auto", (30, 10), scan=("animal_200000", 0, 0), images=8),
]  # fmt: skip
# The other clouds of these packages, for the table of scans.
OTHERS = [
    Row("bun0", source=PCL + "../../official/Surface/bun0.pcd"),
    Row("table", source=PCL + "table_scene_lms400.pcd"),
    Row("mug", source=PCL + "table_scene_mug_stereo_textured.pcd"),
    Row("dinosaur, coarse", source=OPENCV + "parasaurolophus_6700.ply"),
    Row("toys, again", source=OPENCV + "rs22_proc2.ply"),
]


def _read(row, work):
    path = pathlib.Path(row.source)
    if not path.is_file():
        raise Failure(f"there is no file '{path}'", "run tools/setup.sh gallery where dpkg installs documentation")
    if path.suffix == ".pcd":
        import pcl  # of a package with clouds

        cloud = pcl.load(str(path))
        image = cloud.to_array().reshape(cloud.height, cloud.width, 3)
        return image[:: row.stride, :: row.stride].reshape(-1, 3)
    if path.suffix == ".bz2":
        packed, path = path, work / path.stem
        path.write_bytes(bz2.decompress(packed.read_bytes()))
    return draw.read_ply(path)[0]


def _generate(row, programs):
    name, noise, strays = row.scan
    points = draw.read_ply(programs.scan(name, noise, truth=False).points)[0]
    low, high = points.min(axis=0), points.max(axis=0)
    random = np.random.default_rng(1).random((len(points) * strays // 100, 3))
    points = np.concatenate([points, low + random * (high - low)])
    return _depth_images(points, row.images) if row.images else points


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
    order, signs = row.axes
    points = points[np.isfinite(points).all(axis=1)][:, order] * signs
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path = context.work / f"{row.name}.ply"
    path.write_bytes(head.encode() + points.astype("<f4").tobytes())
    return Cloud(row.name, path), len(points)


def scans(context):
    """All real scans by default options, beside the fastest peer."""
    real = [row for row in ROWS if row.source] + OTHERS
    real += [Row(path.stem, source=str(path)) for path in context.scans]
    rows, parameters = [], {}
    for row in context.choose([row for row in ROWS if row.name == "rabbit"], real):
        context.say(f"scans: {row.name}")
        cloud = _cloud(context, row)[0]
        compared = compare(context, cloud, find_peers(context, [FRONT]), parameters, timeout=300.0)
        rows += [found for found, _ in compared]
    context.report.text("""
        ### Real scans

        By default options. *Sound* is our own verdict, the referee counts all else. Handles are those of all parts, `-`
        if the mesh is not manifold and oriented.""")
    context.report.table("scans", SCANS, rows)


def section(context):
    folder, report, parameters, all_rows = context.out / "gallery", context.report, {}, []
    folder.mkdir(exist_ok=True)
    for row in context.choose([row for row in ROWS if row.name == "rabbit"], ROWS):
        context.say(f"gallery: {row.name}")
        cloud, count = _cloud(context, row)
        compared = compare(context, cloud, find_peers(context, PEERS), parameters, row.options.split(), timeout=120.0)
        all_rows += [{"cloud": row.name, **one} for one, _ in compared]
        made = [(mesh, CAPTION.format(**one)) for one, mesh in compared if mesh]
        files, captions = zip((cloud.points, f"{count:,} points\n"), *made)
        draw.main([str(folder / f"{row.name}.png"), *map(str, files), f"--size={360 * len(files)}x360", "--back",
                   f"--view={row.view[0]},{row.view[1]}",
                   *(f"--caption={caption}" for caption in captions)])  # fmt: skip
        report.text(f"![{row.name}: the cloud and the mesh of each method](gallery/{row.name}.png)")
    report.table("gallery", COLUMNS, all_rows)
    scans(context)
    report.blocks["gallery_provenance"] = report.blocks["provenance"]
    report.blocks["gallery_parameters"] = "".join(
        f"- {one['method']}: {one['library']}: {one['parameters']}\n" for one in parameters.values())
