"""The report: sections with text, tables, plots and pictures, written to a folder."""

import dataclasses
import json

from .files import write_file
from .readme import results_of
from .tables import Table


@dataclasses.dataclass
class Figure:
    """A plot or picture with the text under it."""

    file: str | None  # in the folder of the report; None: it could not be drawn
    title: str
    text: str
    missing: str = ""  # why there is no file


@dataclasses.dataclass
class Section:
    title: str
    parts: list = dataclasses.field(default_factory=list)  # str, Table or Figure

    def tables(self):
        return [part for part in self.parts if isinstance(part, Table)]


def _markdown(part):
    if isinstance(part, Table):
        return f"{part.markdown()}\n([{part.name}.csv]({part.name}.csv))\n"
    if isinstance(part, Figure):
        image = f"![{part.title}]({part.file})" if part.file else f"(not drawn: {part.missing})"
        return f"{image}\n\n**{part.title}.** {part.text}\n"
    return f"{part}\n"


def write_report(folder, provenance, sections, seconds):
    """Writes tables as CSV, all of it as report.md, and results.json to check the README by."""
    tables = [table for section in sections for table in section.tables()]
    for table in tables:
        write_file(folder / f"{table.name}.csv", table.csv())
    lines = [
        "# Benchmark report of pcl_spherical_param\n",
        f"{provenance.sentence()} It took {seconds / 60:.1f} minutes.\n",
        "Times are wall times of whole processes, the median of several runs in turn, unless said. "
        "Lengths are in percent of the diagonal of the bounding box of the true surface. `-`: not "
        "defined, or not known.\n",
    ]
    for section in sections:
        lines.append(f"## {section.title}\n")
        lines += [_markdown(part) for part in section.parts]
    write_file(folder / "report.md", "\n".join(lines))
    results = {
        "provenance": dataclasses.asdict(provenance),
        "sentence": provenance.sentence(),
        **results_of(tables),
    }
    write_file(folder / "results.json", json.dumps(results, indent=1) + "\n")
