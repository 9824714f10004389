"""The part of spherical_param that is in C++; use the package's own functions."""

from typing import Any

__version__: str
has_report: bool

def __getattr__(name: str) -> Any: ...
