"""The keywords of reconstruct(), made from the core's table of options.

The build runs this file by itself, to write the types of reconstruct() that type checkers read.
"""

from __future__ import annotations

from typing import Any

#: Options that are no rows of the table: name, type, default, range and help.
OTHERS = (
    (
        "details",
        "bool",
        False,
        "bool",
        "Fill ``Result.vertex_residuals`` and ``Diagnosis.triangle_marks``.",
    ),
    (
        "parts",
        'Literal["all", "largest", "each"]',
        "all",
        "all, largest or each",
        """Surfaces of the cloud that are meshed: all as one, that of most points, or each by itself:
        then a tuple of results is returned, the largest first. See find_parts.""",
    ),
    (
        "min_points",
        "SupportsIndex",
        50,
        "an integer from 4 up",
        "Parts of fewer points are left out, unless all are meshed as one.",
    ),
    (
        "outliers",
        'Union[SupportsFloat, Literal["auto"], None]',
        None,
        '"auto" or a number from 0 to 1000',
        "Leave out stray points, or those that find_outliers finds by this ``sigma``.",
    ),
    (
        "progress",
        "Progress",
        None,
        "True, or callable(stage, fraction)",
        """True: a bar on the standard error. A function is called from the calling thread during the
        work. ``stage`` is "read", "consolidation", "neighbors", "graph", "outliers",
        "openings", "embedding", "triangulation", "optimization", "smoothing" or "quality";
        ``fraction``, in [0, 1], is that of the stage's current loop. If it returns False, the work
        ends with Cancelled; if it raises, with that exception.""",
    ),
)


def keywords(table: list[dict[str, Any]]) -> list[tuple[str, str, Any, str, str]]:
    """Name, type, default, range and help of each keyword."""
    rows = []
    for row in table:
        kind = "SupportsIndex" if row["is_integer"] else "SupportsFloat"
        if row["choices"]:
            kind = "Literal[" + ", ".join(f'"{name}"' for name in row["choices"]) + "]"
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

    def overload(parts: str, result: str) -> str:
        parameters = [
            parts if name == "parts" else f"{name}: {kind} = ..."
            for name, kind, *_ in keywords(table)
        ]
        lines = "".join(f"    {parameter},\n" for parameter in ["points: CloudLike", "*", *parameters])
        return f"@overload\ndef reconstruct(\n{lines}) -> {result}: ...\n"

    return f'''from typing import Literal, Optional, SupportsFloat, SupportsIndex, Union, overload

from ._clouds import CloudLike
from ._progress import Progress
from ._results import Result

{overload('parts: Literal["all", "largest"] = ...', "Result")}
{overload('parts: Literal["each"]', "tuple[Result, ...]")}'''


if __name__ == "__main__":
    import sys

    import _core  # type: ignore[import]  # the module that was just built, beside this file

    with open(sys.argv[1], "w", encoding="ascii") as file:
        file.write(stub(_core.option_table()))
