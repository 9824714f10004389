#!/usr/bin/python3
"""Checks that every block of commands or code in README.md and doc is run by a test as printed.

Before each there is a comment: "test", see run_examples.py, or "run by SCRIPT", which has a call
"doc_block PAGE N" for the N-th of its blocks, or is .ci/run and calls the script by run_scripts.sh.
"""

import collections
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"(?:^<!-- (?P<mark>test|run by (?P<script>\S+))[^\n]*-->\n+)?^```(?P<language>sh|cpp|python)\n"
                   r"(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)  # fmt: skip


class Commands(unittest.TestCase):
    def test_each_block_is_run_by_a_test(self):
        for page in [ROOT / "README.md", *sorted((ROOT / "doc").rglob("*.md"))]:
            name = page.relative_to(ROOT)
            numbers = collections.Counter()
            for block in BLOCK.finditer(page.read_text()):
                numbers[block["script"]] += 1
                with self.subTest(page=str(name), block=block["text"].splitlines()[0]):
                    self.assertIsNotNone(block["mark"], "no comment says what runs it")
                    if block["script"] == ".ci/run":
                        tool = re.match(r"tools/(\w+)\.sh", block["text"])
                        self.assertRegex((ROOT / ".ci/run").read_text(), rf"run_scripts\.sh.*[ \"]{tool[1]}\b")
                    elif block["script"]:
                        self.assertRegex((ROOT / block["script"]).read_text(), rf'doc_block "?\S*{name}"? {numbers[block["script"]]}\b')


if __name__ == "__main__":
    unittest.main()
