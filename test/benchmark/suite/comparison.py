"""Quality against the truth, ours and the peers', on the same clouds in the same run."""

import json
import statistics

from .programs import Failure, busy_cores, in_turn, is_sound, median_seconds

OURS = "ours"
FRONT = "CGAL advancing front"  # the fastest peer whose mesh has all points
ORGANIZED = "PCL organized mesh"  # of neighbours in an image alone
PEERS = {  # program and method
    FRONT: ("benchmark_peer_cgal", "advancing_front"),
    "CGAL advancing front, filled": ("benchmark_peer_cgal", "advancing_front_filled"),
    "CGAL Poisson": ("benchmark_peer_cgal", "poisson"),
    "CGAL alpha wrap": ("benchmark_peer_cgal", "alpha_wrap"),
    "PCL greedy projection": ("benchmark_peer_pcl", "gp3"),
    "PCL Poisson": ("benchmark_peer_pcl", "poisson"),
    ORGANIZED: ("benchmark_peer_pcl", "organized"),
    "Open3D ball pivoting": ("benchmark_peer_open3d", "ball_pivoting"),
    "Open3D Poisson": ("benchmark_peer_open3d", "poisson"),
}

QUALITY = [("model", "cloud"), ("method", "method"), ("sphere", "closed, manifold, genus 0"),
           ("used", "points used [%]", 2), ("intersections", "self-intersections"), ("rms", "RMS [%]", 4),
           ("hausdorff", "Hausdorff [%]", 3), ("normals", "normals off by [deg]", 2), ("seconds", "time [s]", 2),
           ("megabytes", "memory [MB]", 0), ("failure", "remark")]  # fmt: skip
SUMMARY = [("method", "method"), ("clouds", "clouds"), ("spheres", "closed, manifold, genus 0, all points"),
           ("clean", "of these without self-intersections"), ("rms", "RMS, times ours (median)", 2),
           ("hausdorff", "Hausdorff, times ours (median)", 2), ("edges", "true edges (mean) [%]", 1),
           ("seconds", "time, times ours (median)", 2), ("megabytes", "memory, times ours (median)", 2)]  # fmt: skip
HANDLES = [("model", "cloud"), ("method", "method"), ("true_genus", "true genus"), ("genus", "genus"),
           ("right", "closed, true genus, all points"),
           *(one for one in QUALITY if one[0] in ("intersections", "rms", "hausdorff", "seconds"))]  # fmt: skip
RACE = [("model", "cloud"), ("ours", "ours [s]", 2), ("single", "one thread [s]", 2), ("front", f"{FRONT} [s]", 2),
        ("gain", "one thread / ours", 2), ("ratio", "ours / front", 2), ("ours_busy", "ours, busy / alone", 2),
        ("single_busy", "one thread, busy / alone", 2), ("front_busy", "front, busy / alone", 2)]  # fmt: skip
PARAMETERS = [("method", "method"), ("library", "library"), ("parameters", "parameters")]

# Scans, quick and in full.
GENERATED = (("animal_2000",), ("hand_10000", "animal_10000", "tweety", "max", "igea"))
WITH_PEERS = (("animal_2000",), ("hand_10000",))
WITH_HANDLES = (("chair_2000",), ("torus_10000", "chair_10000"))
RACES = (("animal_2000",), ("hand_10000", "head_134345", "head_1000000"))


def find_peers(context, labels=PEERS):
    """The programs of those that were built; quick: of PCL alone."""
    return {label: context.programs.find(PEERS[label][0], required=False) for label in labels
            if PEERS[label][0] == "benchmark_peer_pcl" or not context.quick}  # fmt: skip


def compare(context, cloud, peers, parameters, options=(), repeats=1, timeout=60.0):
    """A row for each method on one cloud, and its mesh if it made one; adds the parameters of the peers.

    All get the points alone, but for the organized mesh, which gets the image. It is left out where the cloud has no such
    file, and fails where the file is no image: an airborne scan.
    """
    programs = {OURS: context.programs.reconstruction,
                **{label: found for label, found in peers.items() if found and (label != ORGANIZED or cloud.image)}}
    meshes = [context.work / f"compare_{index}.ply" for index in range(len(programs))]
    commands = [[program, PEERS[label][1], cloud.image if label == ORGANIZED else cloud.points, mesh]
                if label != OURS
                else [program, cloud.points, mesh, "-quiet", "-json", "-", *options]
                for (label, program), mesh in zip(programs.items(), meshes)]  # fmt: skip
    compared = []
    for label, mesh, done in zip(programs, meshes, in_turn(commands, repeats, timeout)):
        row, problem = {"model": cloud.name, "method": label}, done[-1].problem
        compared.append((row, None if problem else mesh))
        if problem and context.quick:
            raise Failure(f"{label} on {cloud.name}: {problem}", "run it alone")
        if problem:
            row["failure"] = problem
            continue
        output = done[-1].output
        told = json.loads(output if label == OURS else output.splitlines()[-1])  # libraries print, too
        row.update(seconds=median_seconds(done), megabytes=told["peak_memory_bytes"] / 1e6)
        if label == OURS:
            row.update(sound=is_sound(told), view=told["view"] is not None)
        else:
            parameters[label] = {"method": label, "library": told["library"], "parameters": told["parameters"]}
        row.update(context.programs.measure(mesh, cloud))
    return compared


def summarize(rows):
    """What each method did on all clouds, beside ours on the same cloud."""
    ours = {row["model"]: row for row in rows if row["method"] == OURS}
    summary = []
    for method in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == method]
        good = [row for row in own if row.get("sphere") and row["used"] == 100.0]
        entry = {"method": method, "clouds": len(own), "meshes": sum("failure" not in row for row in own),
                 "spheres": len(good), "clean": sum(row["intersections"] == 0 for row in good),
                 "whole": sum(row.get("intersections") == 0 for row in own),
                 "right": sum(row.get("right", False) for row in own)}  # fmt: skip
        for key in ("rms", "hausdorff", "seconds", "megabytes"):
            pairs = [(row.get(key), ours[row["model"]].get(key)) for row in own]
            ratios = [one / other for one, other in pairs if one and other]
            entry[key] = statistics.median(ratios) if ratios else None
        for key, average in (("edges", statistics.mean), ("used", statistics.median), ("bridges", statistics.median)):
            known = [row[key] for row in own if row.get(key) is not None]
            entry[key] = average(known) if known else None
        summary.append(entry)
    return summary


def _median_times(context, commands):
    runs = in_turn(commands.values(), context.choose(1, 5), long_run=4.0)
    return dict(zip(commands, map(median_seconds, runs)))


def race(context, clouds):
    """Ours, on all threads and on one, and the front in turn: alone, and beside busy processes."""
    front, mesh = find_peers(context, [FRONT]).get(FRONT), context.work / "race.ply"
    rows = []
    for cloud in clouds:
        ours = [context.programs.reconstruction, cloud.points, mesh, "-quiet"]
        commands = {"ours": ours, "single": [*ours, "-threads", "1"]}
        commands.update({"front": [front, PEERS[FRONT][1], cloud.points, mesh]} if front else {})
        alone = _median_times(context, commands)
        with busy_cores():
            busy = {f"{name}_busy": s / alone[name] for name, s in _median_times(context, commands).items()}
        ratio = {"ratio": alone["ours"] / alone["front"]} if front else {}
        rows.append({"model": cloud.name, **alone, "gain": alone["single"] / alone["ours"], **ratio, **busy})
    context.report.table("race", RACE, rows)


def section(context):
    programs, report = context.programs, context.report
    peers = find_peers(context)
    report.text("""
        Each method gets the points alone. Methods that need normals estimate them with their own library; that is part
        of the time. *Closed, manifold, genus 0* is judged by a referee of the suite on the file that was written.
        Self-intersections are pairs of triangles, in exact arithmetic. *True edges* are those of the mesh whose
        vertices are the points of the cloud.""")
    generated = [programs.scan(name) for name in context.choose(*GENERATED)]
    parameters = {}
    for name, title, clouds, with_peers in (
        ("models", "Models", context.models, [cloud.name for cloud in context.models]),
        ("generated", "Generated scans", generated, context.choose(*WITH_PEERS)),
    ):
        rows = []
        report.text(f"### {title}" if clouds else "")
        for cloud in clouds:
            context.say(f"{name}: {cloud.name}")
            used = peers if cloud.name in with_peers else {}
            rows += [row for row, _ in compare(context, cloud, used, parameters, repeats=context.choose(1, 3))]
        report.table(f"{name}_summary", SUMMARY, summarize(rows))
        report.table(name, QUALITY, rows)
    rows = []
    for cloud in [programs.scan(name) for name in context.choose(*WITH_HANDLES)] + context.handles:
        context.say(f"handles: {cloud.name}")
        genus = programs.true_genus(cloud)
        for row, _ in compare(context, cloud, find_peers(context, [FRONT]), parameters, repeats=context.choose(1, 3)):
            found = [row.get(key) for key in ("parts", "openings", "genus", "used")]
            rows.append({**row, "true_genus": genus, "right": found == [1, 0, genus, 100.0]})
    report.text("""
        ### Objects with handles

        *Genus*: `-` if the mesh is not manifold and oriented.""")
    report.table("handles", HANDLES, rows)
    context.say("in turn with the fastest peer")
    report.text("""
        ### In turn with the fastest peer

        Whole processes in turn; medians of 5, or one run if it takes longer than 4 s. *Busy*: beside a busy process on
        each core.""")
    race(context, context.models + [programs.scan(name, truth=False) for name in context.choose(*RACES)])
    missing = ", ".join(label for label, program in peers.items() if not program)
    report.text("### Parameters of the peers")
    report.text(f"Not built, hence not compared: {missing}." if missing else "")
    report.table("peers", PARAMETERS, list(parameters.values()))
