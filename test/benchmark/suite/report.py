"""The report: texts, pictures and tables in their order, a CSV file for each table, and tables in the documents."""

import csv
import math
import pathlib
import re
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[3]
# The documents whose tables --update-doc replaces: what follows a mark <!-- NAME -->, up to the next blank line.
DOCUMENTS = [ROOT / "README.md", ROOT / "doc" / "reference.md", ROOT / "doc" / "gallery" / "README.md"]
MARK = re.compile(r"<!-- (\w+) -->\n(?:[^\n]+\n)*")


def markdown(columns, rows):
    """A table of dictionaries. Columns are (key, title with unit[, digits after the point])."""
    lines = [[column[1] for column in columns]]
    numeric = [any(isinstance(row.get(column[0]), (int, float)) for row in rows) for column in columns]
    lines.append(["---:" if number else "---" for number in numeric])
    lines += [[_cell(row.get(column[0]), *column[2:]) for column in columns] for row in rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def _cell(value, digits=None):
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:,.{digits}f}" if isinstance(value, float) and digits is not None else str(value)


class Report:
    def __init__(self, folder):
        self.folder = folder
        self.paragraphs = []
        self.blocks = {}  # what the documents may have, by the name of its mark

    def text(self, text):
        self.paragraphs.append(textwrap.dedent(text).strip())

    def table(self, name, columns, rows):
        """A table, unless there are no rows; without columns that have no value. The CSV file has all values, not
        rounded, also those without a column."""
        if not rows:
            return
        columns = [column for column in columns if any(row.get(column[0]) is not None for row in rows)]
        self.blocks[name] = markdown(columns, rows)
        self.text(f"{self.blocks[name]}\n[{name}.csv]({name}.csv)")
        with (self.folder / f"{name}.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, dict.fromkeys(key for row in rows for key in row), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)

    def write(self):
        (self.folder / "report.md").write_text("\n\n".join(filter(None, self.paragraphs)) + "\n")

    def update_documents(self):
        for path in DOCUMENTS:
            path.write_text(MARK.sub(
                lambda found: f"<!-- {found[1]} -->\n{self.blocks[found[1]]}" if found[1] in self.blocks
                else found[0], path.read_text()))  # fmt: skip
