"""Clouds with clean meshes beside a list of them, so that no later change loses one unseen.

A mesh is clean if the tool finds no fault in it and the referee no triangles that intersect.
"""

import concurrent.futures
import os
import pathlib

from .programs import Cloud, Failure, is_sound, surfaces_of

LIST = pathlib.Path(__file__).parents[1] / "clean.txt"
NUMBERS = ("points", "surfaces", "openings", "handles", "points left out", "triangles left out")
CLEAN = [(title, title) for title in ("cloud", "result", "remark", *NUMBERS)]
RESULTS = ("lost", "not found", "other points", "changed", "newly clean", "not clean", "as before")


def _read(path):
    entries = {}
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            try:
                name, *numbers = line.rsplit(maxsplit=len(NUMBERS))
                entries[name] = dict(zip(NUMBERS, map(int, numbers), strict=True))
            except ValueError:
                raise Failure(f"{path}: '{line}' is not a name and {len(NUMBERS)} numbers",
                              "correct or remove the line") from None  # fmt: skip
    return entries


def _write(path, entries):
    """Replaces the entries. Comments stay."""
    old = path.read_text().splitlines() if path.is_file() else []
    lines = [line for line in old if line.startswith("#")] or [f"# name, {', '.join(NUMBERS)}"]
    lines += [f"{name:24} {' '.join(map(str, numbers.values()))}" for name, numbers in sorted(entries.items())]
    path.write_text("\n".join(lines) + "\n")


def _find(folders):
    paths = sorted(path for folder in folders for path in folder.iterdir() if path.suffix in (".pcd", ".ply", ".xyz"))
    clouds = {path.stem: path for path in paths}
    for path in paths:
        if clouds[path.stem] is not path:
            raise Failure(f"{path} and {clouds[path.stem]} have one name", "rename one of them")
    return clouds


def _measure(context, path):
    """The numbers of the default's mesh, and why it is not clean, or ""."""
    mesh = context.work / f"clean_{path.stem}.ply"
    try:
        told = context.programs.reconstruct(Cloud(path.stem, path), mesh, "-threads", 1)[1]
        # The referee also compares the surfaces with each other.
        pairs = context.programs.measure(mesh)["intersections"] if is_sound(told) else 0
    except Failure as failure:
        return {}, failure.args[0]
    mesh.unlink()
    surfaces = surfaces_of(told)
    numbers = (told["points"], len(surfaces), sum(one["boundary_loops"] for one in surfaces),
               sum(one["genus"] or 0 for one in surfaces), sum(map(len, told["left_out"].values())),
               sum(one["left_out_triangles"] for one in surfaces))  # fmt: skip
    fault = f"{pairs} self-intersections" if pairs else "" if is_sound(told) else told["verdict"]
    return dict(zip(NUMBERS, numbers)), fault


def _compare(before, now, fault):
    """One of RESULTS, and a remark."""
    if not before:
        return ("not clean" if fault else "newly clean"), fault
    changes = [f"{title} {before[title]} -> {now[title]}" for title in now if now[title] != before[title]]
    remark = "; ".join(filter(None, [*changes, fault]))
    if now and now["points"] != before["points"]:
        return "other points", remark
    if fault or any(now[title] > before[title] for title in NUMBERS if "left out" in title):
        return "lost", remark
    return ("changed" if changes else "as before"), remark


def section(context):
    """Listed clouds that are found; to update the list, all that are found."""
    path, is_update = context.arguments.clean_list, context.arguments.update_clean
    entries = _read(path) if path.is_file() or not is_update else {}
    clouds = _find(context.arguments.clean)
    names = [name for name in clouds if is_update or name in entries]
    if not names:
        raise Failure(f"none of the clouds of {path} was found", "give their folders by --clean")
    context.say(f"clean: {len(names)} clouds")
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        measured = pool.map(lambda name: _measure(context, clouds[name]), names)
    rows = [{"cloud": name, "result": "not found"} for name in entries if name not in clouds]
    for name, (now, fault) in zip(names, measured):
        result, remark = _compare(entries.get(name), now, fault)
        rows.append({"cloud": name, "result": result, "remark": remark, **now})
        if is_update and not fault and result != "lost":
            entries[name] = now
    if is_update:
        _write(path, entries)
    rows.sort(key=lambda row: RESULTS.index(row["result"]))
    for row in rows:
        if row["result"] != "as before":
            context.say(f"{row['result']}: {row['cloud']} {row.get('remark', '')}".rstrip())
    found = [row["result"] for row in rows]
    counts = ", ".join(f"{found.count(result)} {result}" for result in RESULTS if result in found)
    context.say(f"clean: {counts}")
    context.report.text(f"{counts}. *Lost*: faults, or triangles that intersect, or more is left out than when the "
                        "list was written.")  # fmt: skip
    context.report.table("clean", CLEAN, rows)
    context.lost = [row["cloud"] for row in rows if row["result"] == "lost"]
