"""The classes that a result consists of, made from the core's table of results.

The build runs this file by itself, to write the classes that type checkers read.
"""

from __future__ import annotations

import json
import textwrap
from typing import Any

_Row = dict[str, Any]


class _FindingText:
    """What to print of a finding."""

    text: str
    option: str
    value: str

    def __str__(self) -> str:
        if not self.option:
            return self.text
        try:
            float(self.value)
        except ValueError:
            return f"{self.text}: try {self.option}={json.dumps(self.value)}"
        return f"{self.text}: try {self.option}={self.value}"


def _is_compared(row: _Row) -> bool:
    """Arrays have no truth."""
    return not any("Array" in field["type"] for field in row["fields"])


def _attributes(row: _Row) -> str:
    """The fields of a class as its docstring has them."""
    lines = ["Attributes", "----------"]
    for field in row["fields"]:
        lines += [f"{field['name']} : {field['type']}", f"    {field['help']}"]
    return "\n".join(lines)


def _public(table: list[_Row]) -> list[str]:
    """The classes but those that Result and Results are made of."""
    return [row["name"] for row in table if row["name"] not in ("LeftOut", "Surface")]


def stub(table: list[_Row]) -> str:
    """What type checkers read of this file."""
    text = (
        "from dataclasses import dataclass\n"
        "from typing import Any, Literal, Optional\n\n"
        "from ._arguments import ByteArray, FloatArray, IndexArray\n\n"
        f"__all__ = {_public(table)!r}\n\n"
        "def attributes(name: str) -> str: ...\n"
        "def make(name: str, fields: dict[str, Any]) -> dict[str, Any]: ...\n"
    )
    for row in table:
        compared = "" if _is_compared(row) else ", eq=False"
        fields = "".join(f"    {field['name']}: {field['type']}\n" for field in row["fields"])
        text += f"\n@dataclass(frozen=True{compared})\nclass {row['name']}:\n{fields}"
    return text


if __name__ == "__main__":
    import sys

    import _core  # type: ignore[import]  # the module that was just built, beside this file

    with open(sys.argv[1], "w", encoding="ascii") as file:
        file.write(stub(_core.result_table()))
else:
    from dataclasses import make_dataclass
    from typing import Literal, Optional  # noqa: F401  # in types of the table

    from . import _core
    from ._arguments import ByteArray, FloatArray, IndexArray  # noqa: F401

    _ROWS = {row["name"]: row for row in _core.result_table()}
    __all__ = _public(list(_ROWS.values()))

    for _name, _row in _ROWS.items():
        globals()[_name] = make_dataclass(
            _name,
            [(field["name"], field["type"]) for field in _row["fields"]],
            bases=(_FindingText,) if _name == "Finding" else (),
            namespace={
                "__doc__": "\n".join([*textwrap.wrap(_row["help"], 90), "", _attributes(_row)]),
                "__module__": __name__,
            },
            frozen=True,
            eq=_is_compared(_row),
        )

    def attributes(name: str) -> str:
        """The fields of a class as its docstring has them."""
        return _attributes(_ROWS[name])

    def make(name: str, fields: dict[str, Any]) -> dict[str, Any]:
        """Fields of a class, whose dictionaries become objects of theirs."""

        def made(of: str, value: Any) -> Any:
            if isinstance(value, tuple):
                return tuple(made(of, item) for item in value)
            return None if value is None else globals()[of](**make(of, value))

        structs = {field["name"]: field["struct"] for field in _ROWS[name]["fields"]}
        return {key: made(structs[key], value) if structs[key] else value for key, value in fields.items()}
