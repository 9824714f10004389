#!/usr/bin/python3
"""doc/guarantees.md names tests that exist, and every suite of them."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
PAGE = (ROOT / "doc" / "guarantees.md").read_text()
TESTS = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+), (\w+)\)", re.MULTILINE)


class Page(unittest.TestCase):
    def setUp(self):
        self.tests = set()
        for source in (ROOT / "test").rglob("*.cpp"):
            self.tests.update(TESTS.findall(source.read_text()))
        self.suites = {suite for suite, _ in self.tests}

    def test_names_tests_that_exist(self):
        for suite, name in re.findall(r"\b([A-Z]\w+)\.([A-Z]\w+|\*)", PAGE):
            with self.subTest(suite=suite, name=name):
                self.assertIn(suite, self.suites)
                self.assertTrue(name == "*" or any(
                    test.startswith(name) for of, test in self.tests if of == suite))
        for name in re.findall(r"\b(test_\w+\.py)\b", PAGE):
            self.assertTrue(list((ROOT / "test").rglob(name)), name)

    def test_names_every_suite(self):
        named = set(re.findall(r"\w+", PAGE))
        self.assertEqual(sorted(self.suites - named), [])


unittest.main()
