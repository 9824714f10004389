"""The report: sections of text, tables and figures, written to a folder."""

import csv
import dataclasses
import math
import os
import re


@dataclasses.dataclass
class Table:
    """Rows of values. Columns are (key, title with unit[, digits after the point])."""

    name: str  # of its file, and its mark in doc/benchmarks.md
    columns: list
    rows: list[dict] = dataclasses.field(default_factory=list)

    def markdown(self):
        lines = [[column[1] for column in self.columns]]
        numeric = [any(isinstance(row.get(c[0]), (int, float)) for row in self.rows)
                   for c in self.columns]  # fmt: skip
        lines.append(["---:" if number else "---" for number in numeric])
        lines += [[_cell(row.get(c[0]), *c[2:]) for c in self.columns] for row in self.rows]
        return "".join("| " + " | ".join(line) + " |\n" for line in lines)

    def write_csv(self, path):
        """All values of the rows, not rounded, also those that have no column."""
        keys = dict.fromkeys(key for row in self.rows for key in row)
        with path.open("w", newline="") as file:
            writer = csv.DictWriter(file, keys, lineterminator="\n")
            writer.writeheader()
            writer.writerows(self.rows)


def _cell(value, digits=None):
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:,.{digits}f}" if isinstance(value, float) and digits is not None else str(value)


@dataclasses.dataclass
class Figure:
    """A plot or picture with the text under it."""

    file: str  # in the folder of the report
    title: str
    text: str

    def markdown(self):
        return f"![{self.title}]({self.file})\n\n**{self.title}.** {self.text}\n"


@dataclasses.dataclass
class Section:
    title: str
    parts: list  # str, Table or Figure


def _write(path, text):
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    os.replace(part, path)


def write_report(folder, provenance, sections):
    """Writes report.md and a CSV file for each table; returns the tables by name."""
    lines = [
        "# Benchmark report of pcl_spherical_param\n",
        provenance + "\n",
        "Times are wall times of whole processes, the median of several runs, unless the text says "
        "otherwise. Lengths are in percent of the diagonal of the bounding box of the true surface. "
        "`-`: not defined, or not known.\n",
    ]
    tables = {}
    for section in sections:
        lines.append(f"## {section.title}\n")
        for part in section.parts:
            lines.append(part.strip() + "\n" if isinstance(part, str) else part.markdown())
            if isinstance(part, Table):
                tables[part.name] = part
                part.write_csv(folder / f"{part.name}.csv")
                lines.append(f"[{part.name}.csv]({part.name}.csv)\n")
    _write(folder / "report.md", "\n".join(lines))
    return tables


def update_doc(path, provenance, tables):
    """Replaces what follows each mark <!-- NAME --> in a page, up to the next blank line."""
    blocks = {"provenance": provenance + "\n"}
    blocks.update((name, table.markdown()) for name, table in tables.items())
    text = re.sub(r"<!-- (\w+) -->\n(?:[^\n]+\n)*",
                  lambda found: f"<!-- {found[1]} -->\n{blocks[found[1]]}"
                  if found[1] in blocks else found[0], path.read_text())  # fmt: skip
    _write(path, text)
