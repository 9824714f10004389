"""The clouds of the gallery and of the table of real scans."""

import bz2
import dataclasses
import pathlib

import draw
import numpy as np

from .programs import Cloud, Failure
from .quality import Mesh

PCL = "/usr/share/doc/python3-pcl/examples/pcldata/tutorials/"
OPENCV = "/usr/share/doc/opencv-doc/examples/surface_matching/data/"
PETSC = "/usr/share/petsc/3.18/share/petsc/datafiles/meshes/"
# Axes and signs that turn a picture so that z points up; FORWARD: a camera looks along z, and y points down.
X_UP, Y_UP, Z_UP = ((1, 2, 0), (1, 1, 1)), ((0, 2, 1), (1, -1, 1)), ((0, 1, 2), (1, 1, 1))
FORWARD = (0, 2, 1), (1, 1, -1)


@dataclasses.dataclass
class Row:
    name: str
    options: str = ""  # of our tool
    view: tuple = ()  # azimuth and elevation [degrees]
    source: str = ""  # a file of a package
    axes: tuple = Z_UP  # of that file
    stride: int = 1  # along both axes of an image
    scan: tuple = ()  # without a file: generated shape with its points, noise, and strays [%]
    views: int = 0  # of cameras around that shape, which are merged
    seen: tuple = ()  # without a shape, a generated scene: the view of the cloud


ROWS = [
    Row("desk", "", (55, 25), axes=FORWARD, seen=(0, 0)),
    Row("yard", "", (30, 50), seen=(30, 50)),
    Row("town", "", (30, 50), seen=(30, 50)),
    Row("jaw", "", (60, 15), axes=FORWARD, seen=(0, 0)),
    Row("horse", "", (120, 10), PETSC + "horse.ply.bz2"),
    Row("dinosaur", "", (20, 10), OPENCV + "parasaurolophus_low_normals2.ply", X_UP),
    Row("carton", "", (10, 25), PCL + "correspondence_grouping/milk.pcd", Y_UP),
    Row("floor", "", (0, 20), PCL + "correspondence_grouping/milk_cartoon_all_small_clorox.pcd", Y_UP, 2),
    Row("toys", "", (0, 0), OPENCV + "rs1_normals.ply", Y_UP),
    Row("lamp", "", (0, 20), PCL + "lamppost.pcd"),
    Row("rabbit", "", (60, 15), scan=("holed_12000", 0, 0)),
    Row("noise", "-smoothing 30", (30, 10), scan=("animal_12000", 1.5, 0)),
    Row("strays", "", (0, 10), scan=("hand_20000", 0, 1)),
    Row("raw", "", (30, 10), scan=("animal_15000", 0.5, 0), views=8),
]
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
    points = draw.read_ply(programs.scan(name, noise, truth=False, views=row.views).points)[0]
    low, high = points.min(axis=0), points.max(axis=0)
    random = np.random.default_rng(1).random((len(points) * strays // 100, 3))
    return np.concatenate([points, low + random * (high - low)])


def load(context, row):
    """The cloud of a row, in a file that all methods read."""
    if row.seen:
        return context.programs.view(row.name)
    points = _read(row, context.work) if row.source else _generate(row, context.programs)
    cloud = Cloud(row.name, context.work / f"{row.name}.ply")
    Mesh(points[np.isfinite(points).all(axis=1)], np.empty((0, 3))).write(cloud.points)
    return cloud
