"""The keywords of reconstruct(), made from the core's table of options.

The build runs this file by itself, to write the types of reconstruct() that type checkers read.
"""

from __future__ import annotations

from typing import Any

#: Options that are no rows of the table: name, type, default, range and help.
OTHERS = (
    (
        "columns",
        "Optional[str]",
        None,
        "names",
        """What the columns of a text file are, from the first on, e.g. "x,y,z,-,red,green,blue"; "-"
        is left out. None: what the file says, or looks like.""",
    ),
    (
        "details",
        "bool",
        False,
        "bool",
        """Fill ``Result.sphere`` also where the mesh is made without it, ``Result.vertex_residuals`` and
        ``Diagnosis.triangle_marks``.""",
    ),
    (
        "progress",
        "Progress",
        None,
        "True, or callable(stage, fraction)",
        """True: a bar on the standard error. A function is called from the calling thread during the
        work. ``stage`` is "read", "view", "neighbors", "graph", "outliers", "parts",
        "consolidation", "openings", "embedding", "triangulation", "optimization", "smoothing",
        "cleaning", "fill" or "quality"; ``fraction``, in [0, 1], is that of the stage's current
        loop. If it returns False, the work ends with Cancelled; if it raises, with that exception.""",
    ),
)


def keywords(table: list[dict[str, Any]]) -> list[tuple[str, str, Any, str, str]]:
    """Name, type, default, range and help of each keyword."""
    rows = []
    for row in table:
        kinds = []
        if row["choices"]:
            kinds.append("Literal[" + ", ".join(f'"{name}"' for name in row["choices"]) + "]")
        if row["is_number"]:
            kinds.append("SupportsIndex" if row["is_integer"] else "SupportsFloat")
        if row["is_point"]:
            kinds.append("Sequence[SupportsFloat]")
        kind = kinds[0] if len(kinds) == 1 else f"Union[{', '.join(kinds)}]"
        if row["optional"]:
            kind = f"Optional[{kind}]"
        rows.append((row["name"], kind, row["default"], row["range"], row["help"]))
    return rows + list(OTHERS)


def documentation(table: list[dict[str, Any]]) -> str:
    """The keywords as a section of a docstring has them."""
    return "\n".join(
        f"    {name} : {range_}, default {default!r}\n        {help_}"
        for name, _, default, range_, help_ in keywords(table)
    )


def stub(table: list[dict[str, Any]]) -> str:
    """What type checkers read of _reconstruct.py."""

    def overload(result: str, **given: str) -> str:
        parameters = [
            f"{name}: {given[name]}" if name in given else f"{name}: {kind} = ..." for name, kind, *_ in keywords(table)
        ]
        lines = "".join(f"    {parameter},\n" for parameter in ["points: CloudLike", "*", *parameters])
        return f"@overload\ndef reconstruct(\n{lines}) -> {result}: ...\n"

    as_topology = 'Literal["topology"] = ...'
    return f'''from collections.abc import Sequence
from typing import Literal, Optional, SupportsFloat, SupportsIndex, Union, overload

from ._clouds import CloudLike
from ._progress import Progress
from ._results import Result, Results

{overload("Result", parts='Literal["all", "largest"]')}
{overload("Results", parts='Literal["each"]')}
{overload("Result", parts=as_topology, topology='Literal["sphere"]')}
{overload("Union[Result, Results]", parts=as_topology, topology='Literal["scan"] = ...')}'''


if __name__ == "__main__":
    import sys

    import _core  # type: ignore[import]  # the module that was just built, beside this file

    with open(sys.argv[1], "w", encoding="ascii") as file:
        file.write(stub(_core.option_table()))
