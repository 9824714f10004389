"""How a finding is printed."""

from __future__ import annotations

import json


class FindingText:
    """Text of a finding, and the option to try as it is pasted into a call."""

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
