"""Quality against the truth, ours and the peers', on the same clouds in the same run."""

import json
import statistics

from .pictures import Panels
from .processes import in_turn, median_seconds, run
from .readme import OURS
from .report import Figure, Section
from .tables import Column, Table

PEERS = ("benchmark_peer_cgal", "benchmark_peer_pcl", "benchmark_peer_open3d")

QUALITY = [
    Column("model", "cloud"),
    Column("method", "method"),
    Column("points", "points", quoted=False),
    Column("sphere", "closed, manifold, genus 0"),
    Column("used", "points used [%]", 2),
    Column("intersections", "self-intersections"),
    Column("rms", "RMS [%]", 4),
    Column("hausdorff", "Hausdorff [%]", 3),
    Column("normals", "normals off by [deg]", 2),
    Column("edges", "true edges [%]", 1, quoted=False),
    Column("min_angle", "mean least angle [deg]", 1, quoted=False),
    Column("needles", "triangles below 10 deg [%]", 1, quoted=False),
    Column("seconds", "time [s]", 2, exact=False),
    Column("reconstruction", "of it reconstruction [s]", 2, exact=False, quoted=False),
    Column("megabytes", "memory [MB]", 0, exact=False),
    Column("failure", "remark", quoted=False),
]

MAP = [
    Column("model", "cloud"),
    Column("method", "map"),
    Column("residual", "Laplacian left"),
    Column("angle", "angle distortion, mean", 3),
    Column("angle_95", "95 %", 2, quoted=False),
    Column("area", "area distortion, rms log2", 2),
    Column("inverted", "inverted triangles [%]", 3),
    Column("collapsed", "collapsed in single precision", quoted=False),
]


def peers(programs):
    """(label, program, method) of every peer that was built, and what is missing."""
    found, missing = [], []
    for name in PEERS:
        program = programs.optional(name)
        listed = run([program, "-list"]) if program else None
        if listed and listed.good:
            found += [(one["label"], program, one["method"]) for one in json.loads(listed.output)]
        else:
            missing.append(name.rpartition("_")[2])
    return found, missing


def quality_row(quality):
    """The columns of QUALITY that come from the referee."""
    return {
        "points": quality["cloud_points"],
        "sphere": quality["closed_manifold_genus0"],
        "used": quality["points_used_percent"],
        "intersections": quality["self_intersecting_pairs"],
        "rms": quality.get("rms_percent"),
        "hausdorff": quality.get("hausdorff_percent"),
        "normals": quality.get("normal_deviation_degrees"),
        "edges": quality.get("edges_reproduced_percent"),
        "min_angle": quality["min_angle_mean_degrees"],
        "needles": quality["min_angle_below_10_percent"],
    }


def _compare(context, cloud, with_peers, tables, parameters, panels=None):
    """All methods on one cloud; `panels` for pictures of what they make.

    Our own maps to the sphere as well, with and without the optimisation of the mesh.
    """
    table, maps = tables
    methods = [(OURS, None, None), *with_peers]
    meshes = [context.work / f"compare_{index}.ply" for index in range(len(methods))]
    sphere = context.work / "compare_sphere.ply"
    for mesh in meshes:
        mesh.unlink(missing_ok=True)
    commands = []
    for (_, program, method), mesh in zip(methods, meshes):
        if program is None:
            commands.append([context.programs.reconstruction, cloud.points, mesh, "-quiet",
                             "-json", "-"])  # fmt: skip
        else:
            commands.append([program, method, cloud.points, mesh])
    runs = in_turn(commands, context.choose(1, 3), timeout=context.timeout)
    for (label, program, _), mesh, done in zip(methods, meshes, runs):
        row = {"model": cloud.name, "method": label}
        table.rows.append(row)
        last = done[-1]
        if not last.good:
            said = last.errors.strip().splitlines()
            row["failure"] = (
                f"not done after {context.timeout:.0f} s" if last.timed_out
                else said[0] if said else f"exit code {last.exit_code}"
            )  # fmt: skip
            continue
        row["seconds"] = statistics.median(one.seconds for one in done)
        reports = [json.loads(one.output) for one in done]
        row["megabytes"] = max(report["peak_memory_bytes"] for report in reports) / 1e6
        if program is not None:
            row["reconstruction"] = statistics.median(
                report["seconds"]["reconstruction"] for report in reports
            )
            parameters[label] = reports[0]["library"], reports[0]["parameters"]
        row.update(quality_row(context.programs.measure(mesh, cloud)))
        if panels:
            # Ours stand on their z axis; most models that go round have y pointing up.
            up = "z" if cloud.generated else "y"
            panels.add(mesh, label, ["-up", up, "-view", "25,15", "-edges", "off"])
    for name, options in (
        ("default", ()),
        ("before the optimisation", ("-optimize", "none")),
        ("the same, converged", ("-optimize", "none", "-tolerance", "1e-8")),
    ):
        _, report = context.programs.reconstruct(
            cloud.points, meshes[0], "-attempts", "1", *options, sphere=sphere
        )
        quality = context.programs.measure_map(meshes[0], sphere)
        maps.rows.append(
            {
                "model": cloud.name,
                "method": name,
                "residual": f"{report['residual']:.0e}",
                **context.distortion(quality),
            }
        )
    for path in (*meshes, sphere):
        path.unlink(missing_ok=True)


def section(context):
    found, missing = peers(context.programs)
    parts = [
        "Each method gets the points alone. Those that need normals estimate them by their own "
        "library; that is part of the time. *Closed, manifold, genus 0* is judged by a referee of "
        "the suite on the file that was written, not by the product; self-intersections are pairs "
        "of triangles, in exact arithmetic. `true edges` are those of the mesh that the cloud's "
        "points were taken from, where they were.\n"
    ]
    if missing:
        parts.append(f"Not built here, hence not compared: {', '.join(missing)}.\n")
    parameters = {}
    if context.models:
        context.say(f"{len(context.models)} models, {len(found) + 1} methods")
        tables = Table("models", QUALITY, keys=2), Table("models_map", MAP, keys=2)
        figures = []
        for cloud in context.models:
            context.say(f"  {cloud.name}")
            panels = Panels(context.renderer, context.work)
            _compare(context, cloud, found, tables, parameters, panels)
            figures.append(_figure(context, cloud, panels))
        parts += ["### Models\n", _summary(tables[0]), tables[0], tables[1], *figures]
    tables = Table("generated", QUALITY, keys=2), Table("generated_map", MAP, keys=2)
    names = context.choose(("hand_5000", "animal_5000"),
                           ("hand_10000", "animal_10000", "star_10000", "plate_10000",
                            "tweety", "max", "igea"))  # fmt: skip
    contested = context.choose(("animal_5000",), ("hand_10000", "tweety", "igea"))
    figures = []
    for name in names:
        cloud = context.scan(name)
        others = found if name in contested else []
        context.say(f"generated scan {name}: {len(others) + 1} methods")
        panels = Panels(context.renderer, context.work)
        _compare(context, cloud, others, tables, parameters, panels if others else None)
        if others:
            figures.append(_figure(context, cloud, panels))
    parts += ["### Generated scans\n", _summary(tables[0]), tables[0], tables[1], *figures]
    context.say("in turn with the fastest peer")
    by_size = sorted(context.models, key=lambda cloud: cloud.points.stat().st_size)
    names = context.choose(("animal_5000",), ("hand_10000", "head_134345", "head_1000000"))
    scans = [context.scan(name, truth=False) for name in names]
    parts += _race(context, by_size[-1:] + scans)
    used = Table("peers", [Column("method", "method"), Column("library", "library"),
                           Column("parameters", "parameters")])  # fmt: skip
    for label, (library, text) in parameters.items():
        used.rows.append({"method": label, "library": library, "parameters": text})
    parts += ["### Parameters of the peers\n", used]
    return Section("Quality, and the peers", parts)


def _figure(context, cloud, panels):
    file = panels.save(
        context.out / f"methods_{cloud.name}.png", [label for _, label in panels.pictures]
    )
    return Figure(
        file,
        f"{cloud.name}, by each method",
        "Flat shaded; where a surface is open or turned inside out, its inside is seen.",
        context.renderer.problem or "",
    )


def _race(context, clouds):
    """Ours, on one thread and on all, and the fastest peer that keeps all points, in turn."""
    peer = context.programs.optional("benchmark_peer_cgal")
    table = Table(
        "race",
        [
            Column("model", "cloud"),
            Column("ours", "ours [s]", 2, exact=False),
            Column("single", "ours, one thread [s]", 2, exact=False),
            Column("gain", "one thread / all", 2, exact=False),
            Column("peer", "CGAL advancing front [s]", 2, exact=False),
            Column("ratio", "ours / advancing front", 2, exact=False),
        ],
    )
    mesh = context.work / "race.ply"
    for cloud in clouds:
        ours = [context.programs.reconstruction, cloud.points, mesh, "-quiet"]
        commands = [ours, ["env", "OMP_NUM_THREADS=1", *ours]]
        if peer:
            commands.append([peer, "advancing_front", cloud.points, mesh])
        runs = in_turn(commands, context.choose(1, 5), timeout=context.timeout)
        seconds = [median_seconds(done) for done in runs]
        row = {
            "model": cloud.name,
            "ours": seconds[0],
            "single": seconds[1],
            "gain": statistics.median(b.seconds / a.seconds for a, b in zip(runs[0], runs[1])),
        }
        if peer:
            row["peer"] = seconds[2]
            row["ratio"] = statistics.median(
                a.seconds / b.seconds for a, b in zip(runs[0], runs[2])
            )
        table.rows.append(row)
    mesh.unlink(missing_ok=True)
    return [
        "### Against the fastest peer, in turn\n",
        "Whole processes, one after the other; medians of 5 (one, where it takes longer than 4 s), "
        "ratios those of the pairs.\n",
        table,
    ]


def _summary(table):
    """What each method did on all clouds where it and ours were run."""
    summary = Table(
        f"{table.name}_summary",
        [
            Column("method", "method"),
            Column("clouds", "clouds"),
            Column("spheres", "closed, manifold, genus 0, all points"),
            Column("clean", "of these without self-intersections"),
            Column("rms", "RMS, times ours (median)", 2),
            Column("hausdorff", "Hausdorff, times ours (median)", 2),
            Column("edges", "true edges (mean) [%]", 1),
            Column("seconds", "time, times ours (median)", 2, exact=False),
            Column("megabytes", "memory, times ours (median)", 2, exact=False),
        ],
    )
    ours = {row["model"]: row for row in table.rows if row["method"] == OURS}
    methods = dict.fromkeys(row["method"] for row in table.rows)
    for method in methods:
        rows = [row for row in table.rows if row["method"] == method]
        good = [row for row in rows if row.get("sphere") and row["used"] == 100.0]
        entry = {
            "method": method,
            "clouds": len(rows),
            "spheres": len(good),
            "clean": sum(row["intersections"] == 0 for row in good),
        }
        for key in ("rms", "hausdorff", "seconds", "megabytes"):
            ratios = [row[key] / ours[row["model"]][key] for row in rows
                      if row.get(key) and ours[row["model"]].get(key)]  # fmt: skip
            entry[key] = statistics.median(ratios) if ratios else None
        edges = [row["edges"] for row in rows if row.get("edges") is not None]
        entry["edges"] = statistics.mean(edges) if edges else None
        summary.rows.append(entry)
    return summary
