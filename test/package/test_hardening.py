#!/usr/bin/python3
"""What is installed is hardened as Debian's packages are, read from the files themselves; and each
component brings its software bill of materials, with the checksums of the installed files.

    test_hardening.py <cmake> <build folder> <scratch folder> <ON or OFF> <component>...

OFF: the build is not hardened; only the bills are looked at.
"""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

CMAKE, BUILD_FOLDER = sys.argv[1:3]
PREFIX = pathlib.Path(sys.argv[3])
IS_HARDENED = sys.argv[4].upper() == "ON"
COMPONENTS = sys.argv[5:]
FILES = []


def readelf(*arguments):
    return subprocess.run(["readelf", "-W", *arguments], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True,
                          env={**os.environ, "LC_ALL": "C"}).stdout


def setUpModule():
    shutil.rmtree(PREFIX, ignore_errors=True)
    for component in COMPONENTS:
        subprocess.run([CMAKE, "--install", BUILD_FOLDER, "--prefix", PREFIX, "--component",
                        component], check=True, stdout=subprocess.DEVNULL)
    for path in sorted(PREFIX.rglob("*")):
        if path.is_file() and not path.is_symlink():
            with path.open("rb") as file:
                if file.read(4) == b"\x7fELF":
                    FILES.append(path)


@unittest.skipUnless(IS_HARDENED, "SPHERICAL_PARAM_HARDENING is OFF")
class Hardening(unittest.TestCase):
    def test_there_are_libraries_and_programs(self):
        self.assertGreaterEqual(len(FILES), len(COMPONENTS))

    def each(self):
        for path in FILES:
            yield self.subTest(file=path.name), path

    def test_position_independent(self):
        for sub, path in self.each():
            with sub:
                self.assertRegex(readelf("-h", path), r"Type:\s+DYN ")
                if not re.search(r"\.so(\.|$)", path.name):
                    self.assertRegex(readelf("-d", path), r"\(FLAGS_1\).*\bPIE\b")

    def test_relocations_are_read_only(self):
        for sub, path in self.each():
            with sub:
                self.assertIn("GNU_RELRO", readelf("-l", path))
                dynamic = readelf("-d", path)
                self.assertRegex(dynamic, r"\(FLAGS(_1)?\).*\b(BIND_)?NOW\b")
                self.assertNotIn("(TEXTREL)", dynamic)

    def test_stack_is_not_executable(self):
        for sub, path in self.each():
            with sub:
                segment = re.search(r"GNU_STACK(\s+0x[0-9a-f]+){5} ([RWE ]{3})",
                                    readelf("-l", path))
                self.assertIsNotNone(segment)
                self.assertNotIn("E", segment[2])

    def test_no_segment_is_writable_and_executable(self):
        for sub, path in self.each():
            with sub:
                segments = re.findall(r"^  LOAD(?:\s+0x[0-9a-f]+){5} ([RWE ]{3})",
                                      readelf("-l", path), re.MULTILINE)
                self.assertTrue(segments)
                for segment in segments:
                    self.assertFalse({"W", "E"} <= set(segment), segment)

    def test_stack_is_protected(self):
        for sub, path in self.each():
            with sub:
                self.assertIn("__stack_chk_fail", readelf("--dyn-syms", path))

    def test_library_calls_are_checked(self):
        # Of calls that always have a checked kind no other is left; one file at least has some.
        # Not so vsnprintf, whose address std::to_string() takes.
        always = {"printf", "fprintf", "sprintf", "snprintf", "strcpy", "strcat"}
        checked = False
        for sub, path in self.each():
            with sub:
                symbols = readelf("--dyn-syms", path)
                used = set(re.findall(r" UND (\w+)(?:@|$)", symbols, re.MULTILINE))
                self.assertEqual(used & always, set())
                checked |= any(name.endswith("_chk") for name in used)
        self.assertTrue(checked)

    def test_libraries_are_looked_for_beside_the_file_alone(self):
        for sub, path in self.each():
            with sub:
                dynamic = readelf("-d", path)
                self.assertNotIn("(RPATH)", dynamic)  # which comes before LD_LIBRARY_PATH
                places = re.search(r"\(RUNPATH\).*\[(.*)\]", dynamic)
                for place in places[1].split(":") if places else ():
                    self.assertRegex(place, r"^\$ORIGIN(/\.\./[\w./-]+)?$")


class Bills(unittest.TestCase):
    def test_each_component_has_one_with_the_installed_checksums(self):
        for component in COMPONENTS:
            with self.subTest(component=component):
                bills = list(PREFIX.glob(f"share/doc/*/{component}-*.spdx.json"))
                self.assertEqual(len(bills), 1)
                text = bills[0].read_text(encoding="utf-8")
                self.assertNotIn(BUILD_FOLDER, text)
                self.assertNotIn(str(PREFIX), text)
                files = json.loads(text)["files"]
                self.assertTrue(files)
                for file in files:
                    content = (PREFIX / file["fileName"]).read_bytes()
                    self.assertIn({"algorithm": "SHA256",
                                   "checksumValue": hashlib.sha256(content).hexdigest()},
                                  file["checksums"])

    def test_together_they_tell_of_all_files(self):
        told = {str(PREFIX / file["fileName"])
                for bill in PREFIX.glob("share/doc/*/*.spdx.json")
                for file in json.loads(bill.read_text(encoding="utf-8"))["files"]}
        self.assertEqual(told, {str(path) for path in FILES})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
