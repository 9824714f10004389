"""Time and memory over the number of points and of threads."""

import math
import os
import statistics
import time

from .machine import memory
from .programs import stage_seconds

# What a stage cannot do without, for each point: bytes that it moves if everything is at hand, and steps of some ten
# arithmetic operations with a comparison (a distance, an orientation, the side of a bisector). Counted by hand, for a
# mesh of 2 triangles and a graph of 6 neighbours a point.
LEAST = {
    "read": (12 + 16, 0, "12 bytes in, 16 out"),
    "neighbors": (6 * 2 * 16 + 14 * 2 * 12, 70,
                  "6 passes of a radix sort, 14 levels of a k-d tree, some 70 distances for 12 neighbours"),
    "graph": (13 * 4 + 6 * 12, 110,
              "the plane through 10 points, 11 bisectors against 6 corners, both ends of 6 edges"),
    "embedding": (10 * (6 * 44 + 64) + 400, 60,
                  "10 sweeps over 6 edges (44 bytes each) and the point; a hierarchy of a third more points"),
    "triangulation": (2 * 24 + 32, 25, "one search, 3 flips with the circles that ask for them"),
    "optimization": (6 * 24 + 2 * 64, 152, "3 flips tried, 2 normals, the triangles near 2 others"),
    "quality": (6 * 12 + 2 * 24, 40, "the edges twice, the 2-ring of the graph for edges outside it, 2 volumes"),
    "write": (12 + 2 * 13, 0, "12 bytes a point, 13 a triangle"),
}  # fmt: skip
STEP = 1.0  # [ns] of one core of some 3 GHz
BYTES_A_POINT = 1500  # more than the product takes: what does not fit is not tried

SCALING = [("points", "points"), ("seconds", "time [s]", 2), ("throughput", "points a second", 0),
           ("unit", "time / (n log2 n) [ns]", 0), ("bytes", "peak memory [bytes a point]", 0),
           ("intersections", "self-intersections")]  # fmt: skip
BUDGET = [("stage", "stage"), ("one", "one thread [ns a point]", 0), ("all", "all threads [ns a point]", 0),
          ("least", "least, one thread [ns a point]", 0), ("times", "one thread / least", 1),
          ("what", "what each point needs")]  # fmt: skip


def _measure(context, cloud, repeats, *options):
    """Medians of the stages' seconds, of the whole process, and its peak memory."""
    mesh = context.work / "scaling.ply"
    processes, stages = [], []
    while len(processes) < repeats and (not processes or processes[-1] < 5.0):
        process, report = context.programs.reconstruct(cloud, mesh, *options)
        processes.append(process.seconds)
        stages.append(stage_seconds(report))
    return {"points": report["vertices"], "seconds": statistics.median(processes),
            "peak": report["peak_memory_bytes"], "intersections": report["self_intersections"],
            **{s: statistics.median(run.get(s, 0.0) for run in stages) for s in LEAST}}  # fmt: skip


def growth(context):
    rows = []
    sizes = context.choose([1000, 10000], [1000, 10000, 100000, 134345, 1000000])
    for n in sizes + ([10000000] if context.large else []):
        if n * BYTES_A_POINT > memory("MemAvailable"):
            context.say(f"scaling: {n:,} points do not fit the memory")
            continue
        context.say(f"scaling: {n:,} points")
        cloud = context.programs.scan(f"head_{n}", truth=False)
        row = _measure(context, cloud, context.choose(1, 3))
        cloud.points.unlink()
        row.update(throughput=n / row["seconds"], bytes=row["peak"] / n, unit=1e9 * row["seconds"] / (n * math.log2(n)))
        rows.append(row)
    context.report.text("""
        ### Over the number of points

        Generated heads, default options, all threads. The memory of a process of 1,000 points is mostly that of its
        libraries. The file of the table has the time of each stage, too.""")
    context.report.table("scaling", SCALING, rows)


def _bandwidth():
    """Bytes that one core copies in a nanosecond, read and written: the best of some copies."""
    source, best = bytearray(1 << 27), math.inf
    for _ in range(5):
        begin = time.perf_counter()
        copy = bytes(source)
        best = min(best, time.perf_counter() - begin)
        del copy
    return 2e-9 * len(source) / best


def budget(context):
    """What each stage takes, beside the least that it could take."""
    cloud = context.programs.scan(context.choose("head_10000", "igea"), truth=False)
    threads = len(os.sched_getaffinity(0))
    single, full = (_measure(context, cloud, context.choose(1, 5), "-threads", count) for count in (1, threads))
    bandwidth = _bandwidth()
    rows = []
    for stage, (moved, steps, what) in LEAST.items():
        least = moved / bandwidth + STEP * steps
        one, every = (1e9 * row[stage] / row["points"] for row in (single, full))
        rows.append({"stage": stage, "one": one, "all": every, "least": least, "times": one / least, "what": what})
    context.report.text(f"""
        ### Budget of the stages

        Of {cloud.name}. The whole process takes {single["seconds"]:.2f} s on one thread and {full["seconds"]:.2f} s on
        all, for the same mesh. The least is counted by hand, at {bandwidth:.0f} bytes a nanosecond that one core copies
        here, and {STEP:.0f} ns a step of some ten operations. A stage that takes many times as long can still become
        faster.""")
    context.report.table("budget", BUDGET, rows)


def section(context):
    growth(context)
    context.say("scaling: budget of the stages")
    budget(context)
