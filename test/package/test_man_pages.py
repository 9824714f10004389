#!/usr/bin/python3
"""The manual pages tell what the tools tell: test_man_pages.py BINARIES PAGES MAKE_MAN_PAGE"""

import gzip
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

BINARIES, PAGES, MAKER = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
# The one that makes scans comes first: its examples make the files of the others.
TOOLS = sorted((page.name[:-len(".1.gz")] for page in PAGES.glob("*.1.gz")),
               key=lambda name: (not name.endswith("_scan"), name))


def help_of(tool):
    return subprocess.run([BINARIES / tool, "-h"], check=True, capture_output=True,
                          encoding="utf-8").stdout


def plain(roff):
    """The words of a page, without its fonts and escapes."""
    text = re.sub(r"\\f[BIPR]", "", roff)
    for escape, character in (("\\(aq", "'"), ("\\(ga", "`"), ("\\(ha", "^"), ("\\(ti", "~"),
                              ("\\(dq", '"'), ("\\-", "-"), ("\\&", ""), ("\\e", "\\")):
        text = text.replace(escape, character)
    return text


class ManPages(unittest.TestCase):
    def setUp(self):
        self.assertGreaterEqual(len(TOOLS), 5)
        self.pages = {tool: gzip.decompress((PAGES / f"{tool}.1.gz").read_bytes()).decode("utf-8")
                      for tool in TOOLS}

    def test_every_page_has_the_usual_sections(self):
        for tool, page in self.pages.items():
            titles = re.findall(r"^\.SH (.*)$", page, re.MULTILINE)
            for title in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES",
                          "SEE ALSO"):
                self.assertEqual(titles.count(title), 1, f"{title} of {tool}")

    def test_every_option_of_the_help_is_on_the_page_with_its_text(self):
        for tool, page in self.pages.items():
            options = re.findall(r"^  (-[\w-]+)((?: \S+)?) {2,}(.*)$", help_of(tool), re.MULTILINE)
            self.assertGreaterEqual(len(options), 7)
            entries = re.findall(r"^\.TP\n(.*)\n((?:[^.].*\n)*)", page, re.MULTILINE)
            told = {plain(tag): " ".join(plain(text).split()) for tag, text in entries}
            for name, argument, text in options:
                self.assertIn(text.strip(), told.get(name + argument, ""), f"{name} of {tool}")

    def test_every_word_of_the_help_is_on_the_page(self):
        for tool, page in self.pages.items():
            words = set(re.findall(r"[\w.]{3,}", plain(page).lower()))
            missing = set(re.findall(r"[\w.]{3,}", help_of(tool).lower())) - words - {"usage:"}
            # The titles of these two sections differ.
            missing = {word.strip(".") for word in missing} - {"usage", "code"}
            missing = {word for word in missing if word not in {w.strip(".") for w in words}}
            self.assertEqual(missing, set(), tool)

    def test_examples_of_the_help_do_what_they_say(self):
        with tempfile.TemporaryDirectory() as folder:
            count = 0
            for tool in TOOLS:
                for line in re.findall(rf"^    {tool} .*$", help_of(tool), re.MULTILINE):
                    words = shlex.split(line)
                    run = subprocess.run([BINARIES / words[0], *words[1:]], cwd=folder,
                                         capture_output=True, encoding="utf-8", check=False)
                    self.assertEqual(run.returncode, 0, f"{line}: {run.stderr}")
                    count += 1
            self.assertGreaterEqual(count, 2 * len(TOOLS) - 1)

    def test_same_bytes_again_and_the_date_that_was_given(self):
        with tempfile.TemporaryDirectory() as folder:
            pages = []
            for name in ("first.1.gz", "second.1.gz"):
                pages.append(pathlib.Path(folder) / name)
                subprocess.run([sys.executable, MAKER, BINARIES / TOOLS[0], pages[-1],
                                "--date", "1000000000"], check=True)
            self.assertEqual(pages[0].read_bytes(), pages[1].read_bytes())
            self.assertIn(b" 2001-09-09 ", gzip.decompress(pages[0].read_bytes()))

    def test_help_without_options_is_refused_and_leaves_no_page(self):
        with tempfile.TemporaryDirectory() as folder:
            tool = pathlib.Path(folder) / "tool"
            tool.write_text("#!/bin/sh\necho 'Usage: tool x'\n", encoding="utf-8")
            tool.chmod(0o755)
            run = subprocess.run([sys.executable, MAKER, tool, tool.with_suffix(".1"),
                                  "--date", "0"], check=False, capture_output=True)
            self.assertNotEqual(run.returncode, 0)
            self.assertEqual(os.listdir(folder), ["tool"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
