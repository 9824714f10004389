"""The map to the sphere: how far it is from an isometry, and what a surface made from it is worth."""

import json

from .processes import require
from .product import stage_seconds
from .report import Section
from .tables import Column, Table

SHAPES = ("sphere", "ellipsoid", "head", "bird", "hand", "animal", "dumbbell", "star", "snake",
          "plate", "torus", "bowl", "pair")  # fmt: skip
REMESH_POINTS = 163842  # a geodesic sphere of frequency 128
IMAGE_SIDE = 405  # about as many pixels

# Stages that belong to the map and what is made from it, not to the meshing before.
PRODUCT_STAGES = ("read", "map", "atlas", "image", "write")

MAPS = [
    Column("model", "cloud"),
    Column("vertices", "vertices"),
    Column("flipped_before", "flipped triangles, embedding"),
    Column("flipped", "map"),
    Column("area_before", "area distortion, embedding", 2),
    Column("area", "map", 3),
    Column("area_95", "95 %", 2),
    Column("area_max", "max", 1),
    Column("angle_before", "angle distortion, embedding", 3),
    Column("angle", "map", 3),
    Column("angle_95", "95 %", 2),
    Column("angle_max", "max", 1),
    Column("degrees", "angles off by [deg]", 1),
    Column("stretch", "stretch efficiency", 3),
    Column("seconds", "time [s]", 2, exact=False),
    Column("ratio", "of the meshing", 1, exact=False),
]

REMESHED = [
    Column("model", "cloud"),
    Column("made", "remeshed as"),
    Column("points", "points"),
    Column("sphere", "closed, manifold, genus 0"),
    Column("intersections", "self-intersections"),
    Column("rms", "RMS [%]", 4),
    Column("hausdorff", "Hausdorff [%]", 3),
    Column("mesh_rms", "RMS of the mesh [%]", 4),
    Column("mesh_hausdorff", "Hausdorff of the mesh [%]", 3),
    Column("seconds", "time [s]", 1, exact=False),
]


def map_row(report):
    """The columns of MAPS from a report of one of the tools that make a map."""
    before = report["embedding_distortion"]
    area, angle = report["area_distortion"], report["angle_distortion"]
    seconds = stage_seconds(report)
    meshing = sum(s for stage, s in seconds.items() if stage not in PRODUCT_STAGES)
    return {
        "vertices": report["vertices"],
        "flipped_before": before["flipped_triangles"],
        "flipped": report["flipped_triangles"],
        "area_before": before["area_distortion"]["mean"],
        "area": area["mean"],
        "area_95": area["p95"],
        "area_max": area["max"],
        "angle_before": before["angle_distortion"]["mean"],
        "angle": angle["mean"],
        "angle_95": angle["p95"],
        "angle_max": angle["max"],
        "degrees": report["mean_angle_difference_degrees"],
        "stretch": report["stretch_efficiency"],
        "seconds": seconds["map"],
        "ratio": seconds["map"] / meshing,
    }


def measure_map(programs, cloud, work):
    """What the default map of a cloud is like: a row of MAPS."""
    mesh = work / "map.glb"
    words = [programs.texture, cloud.points, mesh, "-size", 16, "-quiet", "-json", "-"]
    report = json.loads(require(words).output)
    mesh.unlink(missing_ok=True)
    return {"model": cloud.name, **map_row(report)}


def measure_remeshed(programs, cloud, work):
    """Rows of REMESHED: a grid on the sphere, and a geometry image read back."""
    mesh, image = work / "remeshed.ply", work / "image.tif"
    programs.reconstruct(cloud.points, mesh)
    of_mesh = programs.measure(mesh, cloud)
    rows = []
    for made, words in (
        ("geodesic sphere", [[cloud.points, mesh, "-points", REMESH_POINTS]]),
        ("geometry image", [[cloud.points, image, "-side", IMAGE_SIDE], [image, mesh]]),
    ):
        seconds = sum(require([programs.remesh, *w, "-quiet"]).seconds for w in words)
        quality = programs.measure_mesh(mesh, cloud)
        rows.append(
            {
                "model": cloud.name,
                "made": made,
                "points": quality["vertices"],
                "sphere": quality["closed_manifold_genus0"],
                "intersections": quality["self_intersecting_pairs"],
                "rms": quality["rms_percent"],
                "hausdorff": quality["hausdorff_percent"],
                "mesh_rms": of_mesh["rms_percent"],
                "mesh_hausdorff": of_mesh["hausdorff_percent"],
                "seconds": seconds,
            }
        )
    mesh.unlink(missing_ok=True)
    image.unlink(missing_ok=True)
    return rows


def section(context):
    names = context.choose(("hand_2000", "animal_2000"), [f"{shape}_10000" for shape in SHAPES])
    generated = Table("maps_generated", MAPS)
    for name in names:
        context.say(f"map: {name}")
        cloud = context.scan(name, truth=False)
        generated.rows.append(measure_map(context.programs, cloud, context.work))
    parts = [
        "The map of a finished mesh, made to be used, beside the embedding that the mesh came from "
        "(on the finished mesh; where the optimisation of the mesh moved a vertex, the embedding "
        "has flipped triangles). Area distortion is max(r, 1/r) of the ratio r of a triangle's "
        "share of the area on the sphere to that in space, angle distortion the ratio of the "
        "singular values; both weighted by area, 1 where there is none. `angles off by`: mean "
        "absolute difference of the angles at corners. Stretch efficiency: Praun and Hoppe 2003.\n",
        generated,
    ]
    remeshed = Table("remeshed", REMESHED, keys=2)
    if context.models:
        maps = Table("maps", MAPS)
        for cloud in context.models:
            context.say(f"map: {cloud.name}")
            maps.rows.append(measure_map(context.programs, cloud, context.work))
        parts.append(maps)
    chosen = [cloud for cloud in context.models if cloud.truth] or [
        context.scan(name) for name in context.choose(("hand_2000",), ("hand_10000", "igea"))
    ]
    for cloud in chosen:
        context.say(f"remesh: {cloud.name}")
        remeshed.rows += measure_remeshed(context.programs, cloud, context.work)
    parts += [
        f"\nThe surface between the points, sampled anew from the sphere: {REMESH_POINTS:,} points "
        f"of a geodesic grid, and a geometry image of {IMAGE_SIDE} x {IMAGE_SIDE} positions that "
        "was written and read back; both beside the true surface. Times are those of the whole "
        "tool, the meshing included.\n",
        remeshed,
    ]
    return Section("The map to the sphere", parts)
