"""The report: report.md.in with its marks <!-- TABLE --> and {FACT} filled, and a CSV file for each table."""

import csv
import dataclasses
import math
import os
import pathlib
import re

MARK = re.compile(r"<!-- (\w+) -->\n(?:[^\n]+\n)*")
FACT = re.compile(r"\{(\w+)(?::([^}]*))?\}")


@dataclasses.dataclass
class Table:
    """Rows of values. Columns are (key, title with unit[, digits after the point])."""

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


def _write(path, text):
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    os.replace(part, path)


class Report:
    def __init__(self, folder):
        self.folder = folder
        self.tables, self.facts = {}, {}

    def add(self, name, columns, rows):
        """A table, unless there are no rows."""
        if rows:
            self.tables[name] = Table(columns, rows)

    def write(self):
        """Parts of report.md.in whose tables or facts are missing are left out."""
        for name, table in self.tables.items():
            table.write_csv(self.folder / f"{name}.csv")
        text = pathlib.Path(__file__).with_name("report.md.in").read_text()
        pages = []
        for section in re.split(r"^(?=## )", text, flags=re.MULTILINE):
            head, *parts = re.split(r"^(?=### )", section, flags=re.MULTILINE)
            made = [self._filled(part) for part in parts if self._has_all(part)]
            pages += [self._filled(head), *made] if made or not parts else []
        _write(self.folder / "report.md", "".join(pages))

    def _has_all(self, text):
        return (all(found[1] in self.tables for found in MARK.finditer(text))
                and all(found[1] in self.facts for found in FACT.finditer(text)))  # fmt: skip

    def _filled(self, text):
        text = FACT.sub(lambda found: format(self.facts[found[1]], found[2] or ""), text)
        return MARK.sub(lambda found: self.tables[found[1]].markdown()
                        + f"\n[{found[1]}.csv]({found[1]}.csv)\n", text)  # fmt: skip

    def update_doc(self, path):
        """Replaces what follows each mark in a page, up to the next blank line."""
        blocks = {name: table.markdown() for name, table in self.tables.items()}
        blocks["provenance"] = self.facts["provenance"] + "\n"
        _write(path, MARK.sub(
            lambda found: f"<!-- {found[1]} -->\n{blocks[found[1]]}" if found[1] in blocks
            else found[0], path.read_text()))  # fmt: skip
