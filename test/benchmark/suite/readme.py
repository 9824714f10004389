"""The numbers in the README: written from a report, and checked against one."""

import dataclasses
import re

from .processes import Failure
from .files import write_file
from .tables import Column, Table, number, parse_markdown

BEGIN = "<!-- benchmark: written by tools/benchmark.sh, checked by a test -->"
END = "<!-- benchmark: end -->"
# How far times and sizes of memory may be from those of another run before they count as stale.
TIME_FACTOR = 2.0

# The tables that the README quotes, with the sentence before each. What a cloud's name stands for
# is in the report.
QUOTED = {
    "table1": "The paper's Table 1, on generated scans of the same sizes:",
    "generated": "Our meshes of generated scans, beside the true surface (distances in percent of "
    "the diagonal of its bounding box):",
    "models_summary": "Beside other methods, which get the points alone, too, on the real models "
    "below:",
    "maps": "The map to the sphere of the finished meshes, beside the embedding that they come from "
    "(area distortion max(r, 1/r) of a triangle's share r of the area, angle distortion the ratio "
    "of the singular values, both weighted by area; 1: none):",
    "maps_generated": "The same on generated scans:",
    "remeshed": "Remeshed from the sphere, beside the true surface:",
    "race": "In turn with the fastest peer, whole processes:",
    "scaling": "Over the number of points:",
    "budget": "Where the time goes, beside the least that each stage could take (counted by hand, "
    "for one core that copies as fast as this one):",
    "references": "Every stage beside a plain reference, as one would write it first, on generated "
    "scans of a hand:",
    "triangulation": "The two triangulations of the sphere, one thread:",
}
OURS = "ours"


def results_of(tables):
    """Tables as they are in results.json."""
    return {
        "tables": [
            {
                "name": table.name,
                "keys": table.keys,
                "columns": [dataclasses.asdict(column) for column in table.columns],
                "rows": table.rows,
            }
            for table in tables
        ]
    }


def tables_of(results):
    """The tables in results.json."""
    tables = {}
    for data in results["tables"]:
        columns = [Column(**column) for column in data["columns"]]
        tables[data["name"]] = Table(data["name"], columns, data["rows"], data["keys"])
    return tables


def block(results):
    """The part of the README that quotes a report."""
    lines = [BEGIN, "", results["sentence"], ""]
    tables = tables_of(results)
    for name, sentence in QUOTED.items():
        if name in tables:
            table = tables[name]
            if name == "generated":
                table.rows = [row for row in table.rows if row.get("method", OURS) == OURS]
            lines += [sentence, "", f"<!-- table: {name} -->", table.markdown(quoted=True)]
    return "\n".join(lines + [END])


def _split(text, path):
    before, begin, rest = text.partition(BEGIN)
    inside, end, after = rest.partition(END)
    if not begin or not end:
        raise Failure(f"'{path}' has no part for benchmarks", f"put {BEGIN} and {END} into it")
    return before, inside, after


def update(path, results):
    """Writes the numbers of a report; returns the tables that were there and are not any more."""
    before, _, after = _split(path.read_text(), path)
    old = quoted_tables(path)
    write_file(path, before + block(results) + after)
    return sorted(old.keys() - quoted_tables(path).keys())


def quoted_tables(path):
    """Name -> (titles, rows) of the tables that the README quotes."""
    _, inside, _ = _split(path.read_text(), path)
    found = re.findall(r"<!-- table: (\w+) -->\n((?:\|.*\n)+)", inside)
    return {name: parse_markdown(text) for name, text in found}


def quoted_commit(path):
    """The commit of the report that the README quotes, None if it does not say."""
    _, inside, _ = _split(path.read_text(), path)
    found = re.search(r"Measured at commit `([0-9a-f]{7,40})`", inside)
    return found.group(1) if found else None


def agree(column, said, measured):
    """Is a number in the README still that of a report?

    A measure may be off by 2 % and a unit of its last digit, for other processors round the
    functions of the mathematical library differently; small counts have to be equal.
    """
    if said == measured:
        return True
    a, b = number(said), number(measured)
    if a is None or b is None:
        return False
    if not column.exact:
        return a <= TIME_FACTOR * b and b <= TIME_FACTOR * a
    unit = 10.0 ** -len(said.partition(".")[2]) if "." in said else 0.0
    return abs(a - b) <= 1.001 * unit + 0.02 * min(a, b)


def check(path, results, times=True):
    """Compares the README with a report: what differs, and how many cells were compared.

    Rows that the report does not have are not compared, times and memory only if asked for.
    """
    differences = []
    compared = 0
    tables = tables_of(results)
    for name, (titles, quoted_rows) in quoted_tables(path).items():
        if name not in tables:
            continue
        table = tables[name]
        columns = [column for column in table.columns if column.quoted]
        if titles != [column.title for column in columns]:
            differences.append(f"{name}: the columns are not those of the report")
            continue
        measured = {tuple(row[: table.keys]): row for row in table.cells(quoted=True)[1]}
        for row in quoted_rows:
            key = tuple(row[: table.keys])
            for column, said, now in zip(columns, row, measured.get(key, ())):
                if not (column.exact or times):
                    continue
                compared += 1
                if not agree(column, said, now):
                    differences.append(
                        f"{name}, {' '.join(key)}, {column.title}: the README says {said}, "
                        f"measured is {now}"
                    )
    return differences, compared
