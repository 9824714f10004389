"""Writes the modules of the package that follow from the tables of the core, after each build of its module _core.

    make_types.py PACKAGE

_figures.py has the classes that a result consists of; _reconstruct.pyi has the keywords of reconstruct() and their types.
"""

import sys
import textwrap
from pathlib import Path

FIGURES = '''"""The classes that a result consists of. make_types.py wrote them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Optional

from ._arguments import ByteArray, FloatArray, IndexArray
from ._findings import FindingText

__all__ = {names}
'''

RECONSTRUCT = '''from collections.abc import Sequence
from typing import Literal, Optional, SupportsFloat, SupportsIndex, Union, overload

from ._clouds import CloudLike
from ._progress import Progress
from ._results import Result, Results
'''


def class_of(row):
    """A struct as a class."""
    fields = row["fields"]
    # Arrays cannot be compared by ==.
    compared = "eq=False, " if any("Array" in field["type"] for field in fields) else ""
    base = "(FindingText)" if row["name"] == "Finding" else ""
    documentation = "".join(f"    {field['name']} : {field['type']}\n        {field['help']}\n" for field in fields)
    return (
        f"\n\n@dataclass({compared}frozen=True)\n"
        f"class {row['name']}{base}:\n"
        f'    """{textwrap.fill(row["help"], 110)}\n\n'
        f"    Attributes\n    ----------\n{documentation}"
        '    """\n\n' + "".join(f"    {field['name']}: {field['type']}\n" for field in fields)
    )


def type_of(row):
    """What an option may be given as."""
    kinds = []
    if row["choices"]:
        kinds.append("Literal[" + ", ".join(f'"{name}"' for name in row["choices"]) + "]")
    if row["is_number"]:
        kinds.append("SupportsIndex" if row["is_integer"] else "SupportsFloat")
    if row["is_point"]:
        kinds.append("Sequence[SupportsFloat]")
    if row["optional"]:
        kinds.append("None")
    return f"Union[{', '.join(kinds)}]"


def overload(table, result, **given):
    """reconstruct() with some options of a given type, and what it returns for them."""
    types = {row["name"]: f"{type_of(row)} = ..." for row in table} | given
    types |= {"columns": "Optional[str] = ...", "details": "bool = ...", "progress": "Progress = ..."}
    lines = "".join(f"    {name}: {kind},\n" for name, kind in types.items())
    return f"\n@overload\ndef reconstruct(\n    points: CloudLike,\n    *,\n{lines}) -> {result}: ...\n"


def main():
    package = Path(sys.argv[1])
    sys.path.insert(0, str(package))
    import _core

    rows = _core.result_table()
    # Result and Results have the fields of the others.
    names = [row["name"] for row in rows if row["name"] not in ("LeftOut", "Surface")]
    figures = FIGURES.format(names=names) + "".join(map(class_of, rows))
    (package / "_figures.py").write_text(figures, encoding="ascii")

    table = _core.option_table()
    as_topology = 'Literal["topology"] = ...'
    overloads = [
        overload(table, "Result", parts='Literal["all", "largest"]'),
        overload(table, "Results", parts='Literal["each"]'),
        overload(table, "Result", parts=as_topology, topology='Literal["sphere"]'),
        overload(table, "Union[Result, Results]", parts=as_topology, topology='Literal["scan"] = ...'),
    ]
    (package / "_reconstruct.pyi").write_text(RECONSTRUCT + "".join(overloads), encoding="ascii")


main()
