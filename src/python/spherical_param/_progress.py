"""How far the work is: the caller's function, or a bar."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import Callable, Iterator, Optional, Union

from ._errors import InvalidInput

#: Called with (stage, fraction); False ends the work.
ProgressFunction = Callable[[str, float], object]
#: True: a bar.
Progress = Union[bool, ProgressFunction, None]


class _Bar:
    """A bar for each stage, on the standard error."""

    def __init__(self) -> None:
        self._stage = ""

    def __call__(self, stage: str, fraction: float) -> None:
        if stage != self._stage:
            self.close()
            self._stage = stage
            self._drawn = 0.0
        self._percent = int(100 * fraction)
        if time.monotonic() > self._drawn + 0.1:
            self._draw()

    def close(self) -> None:
        if self._stage:
            self._draw()
            print(file=sys.stderr, flush=True)

    def _draw(self) -> None:
        self._drawn = time.monotonic()
        bar = ("#" * (self._percent // 4)).ljust(25)
        print(f"\r{self._stage:<13} {self._percent:3} % |{bar}|", end="", file=sys.stderr, flush=True)


@contextmanager
def listening(progress: Progress) -> Iterator[Optional[ProgressFunction]]:
    """The function that the core calls."""
    if progress is True:
        bar = _Bar()
        try:
            yield bar
        finally:
            bar.close()
    elif progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    else:
        raise InvalidInput(
            f"progress = {progress!r} cannot be called; give True or a function of (stage, fraction)"
        )
