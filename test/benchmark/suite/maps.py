"""The map to the sphere: its distortion, and the surface that is sampled from it."""

import json

from .programs import flat, require, stage_seconds

SPHERE = "-topology", "sphere"  # all clouds have a map
# Points of a geodesic sphere of frequency 32 or 128.
GRIDS = 10242, 163842
# Stages that belong to the map and what is made from it; all others are the meshing.
MAP_STAGES = ("read", "map", "atlas", "image", "write")

MAPS = [("model", "cloud"), ("vertices", "vertices"),
        ("embedding_distortion.flipped_triangles", "flipped triangles, embedding"), ("flipped_triangles", "map"),
        ("embedding_distortion.area_distortion.mean", "area distortion, embedding", 2),
        ("area_distortion.mean", "map", 3), ("area_distortion.max", "max", 1),
        ("embedding_distortion.angle_distortion.mean", "angle distortion, embedding", 3),
        ("angle_distortion.mean", "map", 3), ("angle_distortion.max", "max", 1),
        ("stretch_efficiency", "stretch efficiency", 3),
        ("seconds", "time [s]", 2), ("ratio", "of the meshing", 1)]  # fmt: skip
REMESHED = [("model", "cloud"), ("vertices", "points"), ("sphere", "closed, manifold, genus 0"),
            ("intersections", "self-intersections"), ("rms", "RMS [%]", 4), ("hausdorff", "Hausdorff [%]", 3),
            ("mesh_rms", "RMS of the mesh [%]", 4), ("mesh_hausdorff", "Hausdorff of the mesh [%]", 3),
            ("seconds", "time [s]", 1)]  # fmt: skip


def _remesh(context, *words):
    """Runs the tool: seconds of the whole process, and the tool's report."""
    done = require([context.programs.find("pcl_spherical_param_remesh"), *words, "-quiet", "-json", "-"])
    return done.seconds, json.loads(done.output)


def _remeshed_row(context, cloud, points):
    mesh = context.work / "remeshed.ply"
    context.programs.reconstruct(cloud, mesh, *SPHERE)
    of_mesh = context.programs.measure(mesh, cloud)
    seconds, _ = _remesh(context, cloud.points, mesh, "-points", points, *SPHERE)
    return {"model": cloud.name, "seconds": seconds, "mesh_rms": of_mesh["rms"],
            "mesh_hausdorff": of_mesh["hausdorff"],
            **context.programs.measure(mesh, cloud)}  # fmt: skip


def section(context):
    programs, report = context.programs, context.report
    report.text("""
        The map of a finished mesh beside the embedding that the mesh came from. The optimisation of the mesh moves
        vertices, so that the embedding has flipped triangles. Area distortion is max(r, 1/r) of the ratio r of a
        triangle's fraction of the area on the sphere to its fraction in space; angle distortion is the ratio of the
        singular values. Both are weighted by area and are 1 without distortion. Stretch efficiency: Praun
        and Hoppe 2003.""")
    generated = [programs.scan(name) for name in context.choose(("animal_2000",), ("hand_10000", "igea"))]
    rows = []
    for cloud in context.models or generated:
        context.say(f"map: {cloud.name}")
        told = _remesh(context, cloud.points, context.work / "map.ply", *SPHERE)[1]
        seconds = stage_seconds(told)
        meshing = sum(s for stage, s in seconds.items() if stage not in MAP_STAGES)
        rows.append({"model": cloud.name, **flat(told), "seconds": seconds["map"], "ratio": seconds["map"] / meshing})
    report.table("maps", MAPS, rows)
    by_size = sorted((one for one in context.models if one.truth), key=lambda one: one.points.stat().st_size)
    # The smallest, one in the middle, the largest: each takes ten seconds or more.
    half = len(by_size) // 2
    chosen = dict.fromkeys(by_size[:1] + by_size[half : half + 1] + by_size[-1:])
    points = context.choose(*GRIDS)
    rows = []
    for cloud in chosen or generated:
        context.say(f"remesh: {cloud.name}")
        rows.append(_remeshed_row(context, cloud, points))
    report.text(f"""
        ### The surface from the sphere

        The surface, sampled again from the sphere: {points:,} points of a geodesic grid. Times include the meshing.""")
    report.table("remeshed", REMESHED, rows)
