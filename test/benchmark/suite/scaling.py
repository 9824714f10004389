"""Time and memory over the number of points."""

import math
import statistics

from .machine import memory
from .programs import stage_seconds, surfaces_of

BYTES_A_POINT = 1500  # more than the product takes: what does not fit is not tried

SCALING = [("scan", "scan"), ("points", "points"), ("seconds", "time [s]", 2), ("throughput", "points a second", 0),
           ("unit", "time / (n log2 n) [ns]", 0), ("bytes", "peak memory [bytes a point]", 0),
           ("intersections", "self-intersections")]  # fmt: skip


def _measure(context, shape, n):
    """Medians of the whole process and of its stages, and its peak memory."""
    cloud = context.programs.scan(f"{shape}_{n}", truth=False)
    processes, stages = [], []
    while len(processes) < context.choose(1, 3) and (not processes or processes[-1] < 5.0):
        process, report = context.programs.reconstruct(cloud, context.work / "scaling.ply")
        processes.append(process.seconds)
        stages.append(stage_seconds(report))
    cloud.points.unlink()
    n = report["points"]  # of a scene about as many as were wanted
    seconds = statistics.median(processes)
    return {"scan": shape, "points": n, "seconds": seconds, "throughput": n / seconds,
            "unit": 1e9 * seconds / (n * math.log2(n)), "bytes": report["peak_memory_bytes"] / n,
            "intersections": sum(one["self_intersections"] for one in surfaces_of(report)),
            **{stage: statistics.median(run[stage] for run in stages) for stage in stages[0]}}  # fmt: skip


def section(context):
    rows = []
    sizes = context.choose([1000, 10000], [1000, 10000, 100000, 134345, 1000000])
    runs = [("head", n) for n in sizes] + [(shape, 10000000) for shape in ("head", "town") if context.large]
    for shape, n in runs:
        if n * BYTES_A_POINT > memory("MemAvailable"):
            context.say(f"scaling: {shape}: {n:,} points do not fit the memory")
            continue
        context.say(f"scaling: {shape}, {n:,} points")
        rows.append(_measure(context, shape, n))
    context.report.text("""
        Generated heads, and with `--large` an airborne scan (town). Default options, all threads. The memory of a
        process of 1,000 points is mostly that of its libraries. The file of the table has the time of each stage, too.""")
    context.report.table("scaling", SCALING, rows)
