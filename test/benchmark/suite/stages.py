"""The stages one by one, also beside plain references, and the two ways to triangulate the sphere."""

import json

from .processes import require
from .report import Section
from .tables import Column, Table


def _stages(context, program):
    output = context.work / "stages.json"
    command = [program, f"--benchmark_out={output}", "--benchmark_out_format=json"]
    # By the number of points, which follows the name.
    command += context.choose(["--benchmark_filter=/10000(/|$)", "--benchmark_min_time=0.02"], [])
    require(command)
    table = Table(
        "stages",
        [
            Column("name", "stage, points, threads"),
            Column("milliseconds", "time [ms]", 3, exact=False),
            Column("nanoseconds", "a point [ns]", 0, exact=False),
        ],
    )
    for one in json.loads(output.read_text())["benchmarks"]:
        rate = one.get("items_per_second")
        table.rows.append(
            {
                "name": one["name"].removesuffix("/real_time"),
                "milliseconds": one["real_time"],
                "nanoseconds": 1e9 / rate if rate else None,
            }
        )
    return [
        "By Google Benchmark, on generated hands, one thread where no number of threads is said. "
        "`benchmark_stages --benchmark_filter=NAME` repeats one of them.\n",
        table,
    ]


def _triangulation(context, program):
    sizes = context.choose(("10000", "100000"), ("10000", "100000", "1000000"))
    report = json.loads(require([program, "-json", *sizes]).output)
    table = Table(
        "triangulation",
        [
            Column("points", "points"),
            Column("incremental", "incremental [us a point]", 2, exact=False),
            Column("qhull", "qhull [us a point]", 2, exact=False),
            Column("ratio", "qhull / incremental", 1, exact=False),
            Column("incremental_mib", "memory, incremental [MiB]", 0, exact=False, quoted=False),
            Column("qhull_mib", "qhull [MiB]", 0, exact=False, quoted=False),
            Column("same", "the same triangles"),
        ],
    )
    for size in report["sizes"]:
        table.rows.append(
            {
                "points": size["points"],
                "incremental": size["incremental"]["microseconds_per_point"],
                "qhull": size["qhull"]["microseconds_per_point"],
                "ratio": size["qhull_over_incremental"],
                "incremental_mib": size["incremental"]["peak_mib"],
                "qhull_mib": size["qhull"]["peak_mib"],
                "same": size["same_triangles"],
            }
        )
    return [
        "### Triangulation of the sphere\n",
        "Uniformly random points on one thread, both methods in turn.\n",
        table,
    ]


def references_table(report):
    """A report of benchmark_reference_paths as a table."""
    threads = report["threads"]
    table = Table(
        "references",
        [
            Column("stage", "stage"),
            Column("points", "points"),
            Column("plain", "plain reference"),
            Column("reference", "reference [ms]", 2, exact=False),
            Column("one", "ours, 1 thread [ms]", 2, exact=False),
            # Not by their number: the README may be checked on another machine.
            Column("all", "ours, all threads [ms]", 2, exact=False),
            Column("ratio", "reference / all threads", 1, exact=False),
            Column("same", "the same output"),
        ],
        keys=2,
    )
    for one in report["stages"]:
        table.rows.append(
            {
                "stage": one["stage"],
                "points": one["points"],
                "plain": one["reference"],
                "reference": 1e3 * one["reference_seconds"],
                "one": 1e3 * one["one_thread_seconds"],
                "all": 1e3 * one["all_threads_seconds"],
                "ratio": one["reference_over_all_threads"],
                "same": one["same_output"],
            }
        )
    return [
        "### Plain references\n",
        "Each stage as one would write it first, on one thread, beside ours on one and on "
        f"{threads} threads: on {report['data']}, medians of {report['repetitions']}. `one thread` "
        "is ours itself. The output is the same to the last bit, but for neighbours, which may be "
        "others at the same distance.\n",
        table,
    ]


def _references(context, program):
    sizes = context.choose(("10000",), ("10000", "100000"))
    # Fails, with the stage, if an output is not the same.
    return references_table(json.loads(require([program, "-json", *sizes]).output))


def section(context):
    parts = []
    for name, make in (
        ("stages", _stages),
        ("reference_paths", _references),
        ("triangulation_methods", _triangulation),
    ):
        program = context.programs.optional(f"benchmark_{name}")
        if program is None:
            parts.append(f"benchmark_{name} is not built: Google Benchmark was not found.\n")
            continue
        context.say(f"stages: {name.replace('_', ' ')}")
        parts += make(context, program)
    return Section("Stages, one by one", parts)
