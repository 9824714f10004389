"""Time, memory and throughput over the number of points, and over the number of threads."""

import math
import os
import statistics
import time

from .machine import available_memory
from .product import stage_seconds
from .report import Figure, Section
from .tables import Column, Table

# What a stage cannot do without, for each point: bytes that it moves once it has everything at
# hand, and steps, each some ten arithmetic operations with a comparison (a distance, an orientation,
# the side of a bisector). By hand, for a mesh of 2 triangles and a graph of 6 neighbours a point.
LEAST = {
    "read": (12 + 16, 0, "12 bytes in, 16 out"),
    "neighbors": (6 * 2 * 16 + 14 * 2 * 12, 70, "6 passes of a radix sort, 14 levels of a k-d tree, "
                  "some 70 distances for 12 neighbours"),
    "graph": (13 * 4 + 6 * 12, 110, "the plane through 10 points, 11 bisectors against 6 corners, "
              "both ends of 6 edges"),
    "embedding": (10 * (6 * 44 + 64) + 400, 60, "10 sweeps over 6 edges (44 bytes each) and the "
                  "point; a hierarchy of a third more points"),
    "triangulation": (2 * 24 + 32, 25, "one search, 3 flips with the circles that ask for them"),
    "optimization": (6 * 24 + 2 * 64, 170, "3 flips tried, 2 normals, 18 angles for the usual one, "
                     "the triangles near 2 others"),
    "check": (6 * 12 + 2 * 24, 40, "the edges twice, the 2-ring of the graph for edges outside it, "
              "2 volumes"),
    "write": (12 + 2 * 13, 0, "12 bytes a point, 13 a triangle"),
}  # fmt: skip
STEP = 1.0  # [ns] of one core of some 3 GHz

STAGES = ("read", "neighbors", "graph", "embedding", "triangulation", "optimization", "check",
          "write")  # fmt: skip
BYTES_A_POINT = 1500  # more than the product takes: what does not fit is not tried


def _stage_columns():
    return [Column(stage, f"{stage} [s]", 3, exact=False, quoted=False) for stage in STAGES]


def _measure(context, cloud, repeats, threads=None):
    """Medians of the stages' seconds, of the whole process, and its peak memory."""
    mesh = context.work / "scaling.ply"
    runs = []
    for _ in range(repeats):
        process, report = context.programs.reconstruct(cloud.points, mesh, threads=threads)
        runs.append((process, stage_seconds(report), report))
        if process.seconds > 5.0:
            break
    row = {s: statistics.median(run[1].get(s, 0.0) for run in runs) for s in STAGES}
    row["seconds"] = statistics.median(run[0].seconds for run in runs)
    row["peak"] = max(run[2]["peak_memory_bytes"] for run in runs)
    row["intersections"] = runs[-1][2]["self_intersections"]
    row["count"] = runs[-1][2]["vertices"]
    mesh.unlink(missing_ok=True)
    return row


def growth(context):
    from . import plots

    table = Table(
        "scaling",
        [
            Column("points", "points"),
            Column("seconds", "time [s]", 2, exact=False),
            Column("throughput", "points a second", 0, exact=False),
            Column("unit", "time / (n log2 n) [ns]", 0, exact=False),
            Column("bytes", "peak memory [bytes a point]", 0, exact=False),
            Column("intersections", "self-intersections"),
            *_stage_columns(),
        ],
    )
    sizes = [1000, 10000, 100000] + context.choose([], [134345, 1000000])
    if context.large:
        sizes.append(10000000)
    skipped = []
    for n in sizes:
        if n * BYTES_A_POINT > available_memory():
            skipped.append(f"{n:,}")
            continue
        context.say(f"scaling: {n:,} points")
        cloud = context.scan(f"head_{n}", truth=False)
        row = _measure(context, cloud, 3)
        if n > 1000000:
            cloud.points.unlink()
        row.update(
            points=n,
            throughput=n / row["seconds"],
            unit=1e9 * row["seconds"] / (n * math.log2(n)),
            bytes=row["peak"] / n,
        )
        table.rows.append(row)
    # From 10,000 on: below, the start of a process counts.
    rows = [row for row in table.rows if row["points"] >= 10000]
    x = [math.log(row["points"] * math.log(row["points"])) for row in rows]
    slopes = {}
    for stage in ("seconds", *STAGES):
        y = [math.log(max(row[stage], 1e-9)) for row in rows]
        slopes[stage] = statistics.linear_regression(x, y).slope
    plot = plots.Lines(panels=2)
    points = [row["points"] for row in table.rows]
    for color, stage in enumerate(STAGES):
        plot.curve(0, points, [row[stage] for row in table.rows], stage, color, "-", "o")
    plot.curve(0, points, [row["seconds"] for row in table.rows], "whole process", 7, "--")
    plot.label(0, "points", "seconds", "time of each stage")
    plot.curve(1, points, [row["bytes"] for row in table.rows], "process, peak", 0, "-", "o")
    plot.curve(1, points, [2000.0] * len(points), "bound: 2 KB a point", 1, "--")
    plot.label(1, "points", "bytes a point", "memory")
    left_out = f" Left out, as they do not fit the memory: {', '.join(skipped)}." if skipped else ""
    return [
        "### Over the number of points\n",
        "Generated heads, default options, all threads. An exponent of 1 is a cost of n log n; "
        f"fitted from 10,000 points up it is {slopes['seconds']:.2f} for the whole process, by "
        "stage "
        + ", ".join(f"{stage} {slopes[stage]:.2f}" for stage in STAGES)
        + f". The memory of a process of 1,000 points is that of its libraries.{left_out}\n",
        table,
        Figure(context.save_plot(plot, "scaling"), "Time and memory over n", "Logarithmic axes."),
    ]


def threads(context):
    from . import plots

    cores = len(os.sched_getaffinity(0))
    counts = sorted({1, cores} | {2**i for i in range(12) if 2**i < cores})
    table = Table(
        "threads",
        [
            Column("threads", "threads"),
            Column("seconds", "time [s]", 2, exact=False),
            Column("speedup", "times as fast as one", 2, exact=False),
            *_stage_columns(),
        ],
    )
    cloud = context.scan(context.choose("head_100000", "igea"), truth=False)
    for count in counts:
        context.say(f"scaling: {count} threads")
        row = _measure(context, cloud, context.choose(1, 5), threads=count)
        row["threads"] = count
        row["speedup"] = table.rows[0]["seconds"] / row["seconds"] if table.rows else 1.0
        table.rows.append(row)
    names = [f"{row['threads']} thread{'s' if row['threads'] > 1 else ''}" for row in table.rows]
    values = {n: [row[s] for s in STAGES] for n, row in zip(names, table.rows)}
    plots.bars(context.out / "threads.svg", names, STAGES, values, cloud.name, "seconds")
    return [
        "### Over the number of threads\n",
        f"{cloud.name}; the mesh is the same, byte by byte, for any number.\n",
        table,
        Figure("threads.svg", "Stages over threads", "Seconds of each stage, one after the other."),
        *budget(cloud, table.rows),
    ]


def _bandwidth():
    """Bytes that one core copies in a nanosecond, read and written: the best of some copies."""
    source = bytearray(1 << 27)
    best = math.inf
    for _ in range(5):
        begin = time.perf_counter()
        copy = bytes(source)
        best = min(best, time.perf_counter() - begin)
        del copy
    return 2e-9 * len(source) / best


def budget(cloud, rows):
    """What each stage takes, beside the least that it could take."""
    bandwidth = _bandwidth()
    table = Table(
        "budget",
        [
            Column("stage", "stage"),
            Column("one", "one thread [ns a point]", 0, exact=False),
            Column("all", "all threads [ns a point]", 0, exact=False),
            Column("least", "least, one thread [ns a point]", 0, exact=False),
            Column("times", "one thread / least", 1, exact=False),
            Column("what", "what it cannot do without, for each point"),
        ],
    )
    for stage in STAGES:
        moved, steps, what = LEAST[stage]
        least = moved / bandwidth + STEP * steps
        one, every = (1e9 * row[stage] / row["count"] for row in (rows[0], rows[-1]))
        table.rows.append(
            {
                "stage": stage,
                "one": one,
                "all": every,
                "least": least,
                "times": one / least,
                "what": what,
            }
        )
    return [
        "### Where the time goes\n",
        f"{cloud.name}. The least is counted by hand, at {bandwidth:.0f} bytes a nanosecond that "
        f"one core copies here, and {STEP:.0f} ns a step of some ten operations: what is many times "
        "as long has something left to gain.\n",
        table,
    ]


def section(context):
    return Section("Scaling", growth(context) + threads(context))
