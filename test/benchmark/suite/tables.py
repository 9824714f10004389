"""Tables that can be written, read again and compared."""

import csv
import dataclasses
import io
import math


@dataclasses.dataclass(frozen=True)
class Column:
    """One column: how its values are printed, and whether they come out the same in each run."""

    key: str  # of the value in a row
    title: str  # with its unit in brackets
    digits: int | None = None  # after the point; None: as it is
    exact: bool = True  # False: a time or a size of memory, which differs from run to run
    quoted: bool = True  # part of the README, too

    def cell(self, row):
        value = row.get(self.key)
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            return "-"
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, int):
            return f"{value:,}"
        if isinstance(value, float) and self.digits is not None:
            return f"{value:,.{self.digits}f}"
        return str(value)


@dataclasses.dataclass
class Table:
    """Rows of values under columns; the first `keys` columns name a row."""

    name: str  # of its file, and in the README
    columns: list[Column]
    rows: list[dict] = dataclasses.field(default_factory=list)
    keys: int = 1

    def cells(self, quoted=False):
        """Titles and rows as text; of the quoted columns only, if wanted."""
        columns = [c for c in self.columns if c.quoted or not quoted]
        return [c.title for c in columns], [[c.cell(row) for c in columns] for row in self.rows]

    def markdown(self, quoted=False):
        titles, rows = self.cells(quoted)
        columns = [c for c in self.columns if c.quoted or not quoted]
        numbers = [
            bool(self.rows) and any(isinstance(row.get(c.key), (int, float)) for row in self.rows)
            for c in columns
        ]
        lines = [titles, ["---:" if number else "---" for number in numbers], *rows]
        return "".join("| " + " | ".join(line) + " |\n" for line in lines)

    def csv(self):
        """With unrounded numbers."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([column.key for column in self.columns])
        for row in self.rows:
            writer.writerow(["" if row.get(c.key) is None else row[c.key] for c in self.columns])
        return text.getvalue()


def parse_markdown(text):
    """Titles and rows of cells of a table as markdown() writes it."""
    lines = [line.strip() for line in text.strip().splitlines()]
    split = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return split[0], split[2:]


def number(cell):
    """The number in a cell, None if there is none."""
    try:
        return float(cell.replace(",", ""))
    except ValueError:
        return None
