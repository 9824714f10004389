"""Quality against the truth, ours and the peers', on the same clouds in the same run."""

import json
import statistics

from .programs import Failure, in_turn, median_seconds

OURS = "ours"
PEERS = [  # label, program, method
    ("CGAL advancing front", "benchmark_peer_cgal", "advancing_front"),
    ("CGAL advancing front, filled", "benchmark_peer_cgal", "advancing_front_filled"),
    ("CGAL Poisson", "benchmark_peer_cgal", "poisson"),
    ("CGAL alpha wrap", "benchmark_peer_cgal", "alpha_wrap"),
    ("PCL greedy projection", "benchmark_peer_pcl", "gp3"),
    ("PCL Poisson", "benchmark_peer_pcl", "poisson"),
    ("Open3D ball pivoting", "benchmark_peer_open3d", "ball_pivoting"),
    ("Open3D Poisson", "benchmark_peer_open3d", "poisson"),
]

QUALITY = [("model", "cloud"), ("method", "method"), ("sphere", "closed, manifold, genus 0"),
           ("used", "points used [%]", 2), ("intersections", "self-intersections"),
           ("rms", "RMS [%]", 4), ("hausdorff", "Hausdorff [%]", 3),
           ("normals", "normals off by [deg]", 2), ("seconds", "time [s]", 2),
           ("megabytes", "memory [MB]", 0), ("failure", "remark")]  # fmt: skip
SUMMARY = [("method", "method"), ("clouds", "clouds"),
           ("spheres", "closed, manifold, genus 0, all points"),
           ("clean", "of these without self-intersections"),
           ("rms", "RMS, times ours (median)", 2), ("hausdorff", "Hausdorff, times ours (median)", 2),
           ("edges", "true edges (mean) [%]", 1), ("seconds", "time, times ours (median)", 2),
           ("megabytes", "memory, times ours (median)", 2)]  # fmt: skip
RACE = [("model", "cloud"), ("ours", "ours [s]", 2), ("single", "ours, one thread [s]", 2),
        ("gain", "one thread / all", 2), ("peer", "CGAL advancing front [s]", 2),
        ("ratio", "ours / advancing front", 2)]  # fmt: skip

# Scans, quick and in full.
GENERATED = (("animal_2000",), ("hand_10000", "animal_10000", "star_10000", "plate_10000", "tweety",
                                "max", "igea"))  # fmt: skip
WITH_PEERS = (("animal_2000",), ("hand_10000",))
RACES = (("animal_2000",), ("hand_10000", "head_134345", "head_1000000"))
# Pictures of larger meshes take long to draw and show no more.
MAX_DRAWN_BYTES = 200000


def _run_ours(context, cloud, mesh, report):
    return [context.programs.reconstruction, cloud.points, mesh, "-quiet", "-json", report]


def _compare(context, cloud, peers, rows, parameters):
    """Adds a row for each method on one cloud; returns a line with its picture, if there is one."""
    methods = [(OURS, None, None), *peers]
    meshes = [context.work / f"compare_{index}.ply" for index in range(len(methods))]
    reports = [mesh.with_suffix(".json") for mesh in meshes]
    commands = [
        [program, method, cloud.points, mesh, report] if program
        else _run_ours(context, cloud, mesh, report)
        for (_, program, method), mesh, report in zip(methods, meshes, reports)
    ]  # fmt: skip
    runs = in_turn(commands, context.choose(1, 3), timeout=60.0)
    drawn = []
    for (label, program, _), mesh, report, done in zip(methods, meshes, reports, runs):
        row = {"model": cloud.name, "method": label}
        rows.append(row)
        if done[-1].problem:
            row["failure"] = done[-1].problem
            if context.quick or not program:
                raise Failure(f"{label} on {cloud.name}: {done[-1].problem}", "run it alone")
            continue
        told = json.loads(report.read_text())
        row["seconds"] = median_seconds(done)
        row["megabytes"] = told["peak_memory_bytes"] / 1e6
        if program:
            row["reconstruction_seconds"] = told["reconstruction_seconds"]
            parameters[label] = {"method": label, "library": told["library"],
                                 "parameters": told["parameters"]}  # fmt: skip
        row.update(context.programs.measure(mesh, cloud))
        drawn.append((mesh, label))
    picture = ""
    if peers and cloud.points.stat().st_size < MAX_DRAWN_BYTES:
        from .drawing import Pictures

        pictures = Pictures(context.out / f"methods_{cloud.name}.png")
        for begin in range(0, len(drawn), 5):
            pictures.row(*zip(*drawn[begin : begin + 5]), up=cloud.up)
        picture = f"![{cloud.name}, by each method, flat shaded]({pictures.save()})\n"
    for mesh in meshes:
        mesh.unlink(missing_ok=True)
    return picture


def summarize(rows):
    """What each method did on all clouds, beside ours on the same cloud."""
    ours = {row["model"]: row for row in rows if row["method"] == OURS}
    summary = []
    for method in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == method]
        good = [row for row in own if row.get("sphere") and row["used"] == 100.0]
        entry = {"method": method, "clouds": len(own), "spheres": len(good),
                 "clean": sum(row["intersections"] == 0 for row in good)}  # fmt: skip
        for key in ("rms", "hausdorff", "seconds", "megabytes"):
            ratios = [row[key] / ours[row["model"]][key] for row in own
                      if row.get(key) and ours[row["model"]].get(key)]  # fmt: skip
            entry[key] = statistics.median(ratios) if ratios else None
        edges = [row["edges"] for row in own if row.get("edges") is not None]
        entry["edges"] = statistics.mean(edges) if edges else None
        summary.append(entry)
    return summary


def race(context, clouds):
    """Ours, on one thread and on all, and the fastest peer that keeps all points, in turn."""
    peer = None if context.quick else context.programs.find("benchmark_peer_cgal", required=False)
    rows = []
    mesh = context.work / "race.ply"
    for cloud in clouds:
        ours = [context.programs.reconstruction, cloud.points, mesh, "-quiet"]
        commands = [ours, [*ours, "-threads", "1"]]
        if peer:
            report = mesh.with_suffix(".json")
            commands.append([peer, "advancing_front", cloud.points, mesh, report])
        runs = in_turn(commands, context.choose(1, 5), long_run=4.0)
        seconds = [median_seconds(done) for done in runs]
        row = {"model": cloud.name, "ours": seconds[0], "single": seconds[1],
               "gain": seconds[1] / seconds[0]}  # fmt: skip
        if peer:
            row.update(peer=seconds[2], ratio=seconds[0] / seconds[2])
        rows.append(row)
    mesh.unlink(missing_ok=True)
    context.report.add("race", RACE, rows)


def section(context):
    programs, report = context.programs, context.report
    found = [(label, programs.find(name, required=False), method) for label, name, method in PEERS
             if name == "benchmark_peer_pcl" or not context.quick]  # fmt: skip
    peers = [peer for peer in found if peer[1]]
    missing = ", ".join(label for label, program, _ in found if not program)
    report.facts["missing_peers"] = f"Not built, hence not compared: {missing}." if missing else ""
    generated = [programs.scan(name) for name in context.choose(*GENERATED)]
    parameters = {}
    for name, clouds, with_peers in (
        ("models", context.models, {cloud.name for cloud in context.models}),
        ("generated", generated, context.choose(*WITH_PEERS)),
    ):
        rows, pictures = [], ""
        for cloud in clouds:
            others = peers if cloud.name in with_peers else []
            context.say(f"{name}: {cloud.name}, {len(others) + 1} methods")
            pictures += _compare(context, cloud, others, rows, parameters)
        report.facts[f"{name}_pictures"] = pictures
        report.add(f"{name}_summary", SUMMARY, summarize(rows))
        report.add(name, QUALITY, rows)
    context.say("in turn with the fastest peer")
    scans = [programs.scan(name, truth=False) for name in context.choose(*RACES)]
    race(context, context.models + scans)
    columns = [("method", "method"), ("library", "library"), ("parameters", "parameters")]
    report.add("peers", columns, list(parameters.values()))
