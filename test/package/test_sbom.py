#!/usr/bin/python3
"""The software bill of materials has what SPDX 2.3 requires, tells of all files and of what they
need, and is the same when it is made again.

    test_sbom.py <make_sbom.py> <description of the build> <bill> <source folder> <build folder>
"""

import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SCRIPT, BUILD, BILL, SOURCE_FOLDER, BUILD_FOLDER = (pathlib.Path(path) for path in sys.argv[1:6])
# Clauses 7 to 11 of the specification: https://spdx.github.io/spdx-spec/v2.3/
ID = re.compile(r"SPDXRef-[A-Za-z0-9.-]+$")
URI = re.compile(r"[a-z][a-z0-9+.-]*://[^\s#]+$")
TIME = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
PARTY = re.compile(r"(Person|Organization): \S.*$|NOASSERTION$")
LICENCE = re.compile(r"([A-Za-z0-9.-]+( WITH [A-Za-z0-9.-]+)?|NOASSERTION|NONE)$")
PURL = re.compile(r"pkg:(deb/[a-z]+|npm)/[A-Za-z0-9%.~-]+@[A-Za-z0-9%.~-]+"
                  r"(\?[a-z]+=[^\s&]+(&[a-z]+=[^\s&]+)*)?$")
RELATIONSHIPS = {"DESCRIBES", "CONTAINS", "DEPENDS_ON", "DYNAMIC_LINK", "BUILD_TOOL_OF"}
DIGITS = {"SHA1": 40, "SHA256": 64}
SONAME = re.compile(r"\(NEEDED\).*\[(.+)\]")


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


class Sbom(unittest.TestCase):
    def setUp(self):
        self.bill = read(BILL)
        self.build = read(BUILD)
        self.elements = [self.bill] + self.bill["packages"] + self.bill["files"]

    def test_document_has_required_fields(self):
        bill = self.bill
        self.assertEqual(bill["spdxVersion"], "SPDX-2.3")
        self.assertEqual(bill["dataLicense"], "CC0-1.0")
        self.assertEqual(bill["SPDXID"], "SPDXRef-DOCUMENT")
        self.assertRegex(bill["name"], r"^\S+$")
        self.assertRegex(bill["documentNamespace"], URI)
        self.assertRegex(bill["creationInfo"]["created"], TIME)
        self.assertTrue(bill["creationInfo"]["creators"])
        for creator in bill["creationInfo"]["creators"]:
            self.assertRegex(creator, r"^(Tool|Person|Organization): \S")

    def test_identifiers_are_unique_and_well_formed(self):
        identifiers = [element["SPDXID"] for element in self.elements]
        self.assertEqual(len(identifiers), len(set(identifiers)))
        for identifier in identifiers:
            self.assertRegex(identifier, ID)

    def test_packages_have_required_fields(self):
        for package in self.bill["packages"]:
            self.assertTrue(package["name"])
            location = package["downloadLocation"]
            self.assertTrue(location == "NOASSERTION" or URI.match(location), location)
            self.assertRegex(package["supplier"], PARTY)
            self.assertRegex(package["licenseDeclared"], LICENCE)
            self.assertRegex(package["licenseConcluded"], LICENCE)
            self.assertTrue(package["copyrightText"])
            self.assertIsInstance(package["filesAnalyzed"], bool)
            self.assertEqual(package["filesAnalyzed"], "packageVerificationCode" in package)
            for reference in package.get("externalRefs", []):
                self.assertEqual(reference["referenceCategory"], "PACKAGE-MANAGER")
                self.assertEqual(reference["referenceType"], "purl")
                self.assertRegex(reference["referenceLocator"], PURL)

    def test_files_have_required_fields(self):
        for file in self.bill["files"]:
            self.assertRegex(file["fileName"], r"^\./\S+$")
            self.assertRegex(file["licenseConcluded"], LICENCE)
            sums = {entry["algorithm"]: entry["checksumValue"] for entry in file["checksums"]}
            self.assertEqual(set(sums), set(DIGITS))  # SHA1 is what the specification demands
            for algorithm, value in sums.items():
                self.assertRegex(value, r"^[0-9a-f]{%d}$" % DIGITS[algorithm])

    def test_relationships_are_among_elements(self):
        identifiers = {element["SPDXID"] for element in self.elements}
        for entry in self.bill["relationships"]:
            self.assertIn(entry["relationshipType"], RELATIONSHIPS)
            self.assertIn(entry["spdxElementId"], identifiers)
            self.assertIn(entry["relatedSpdxElement"], identifiers)
        self.assertEqual([entry["spdxElementId"] for entry in self.bill["relationships"]
                          if entry["relationshipType"] == "DESCRIBES"], ["SPDXRef-DOCUMENT"])
        # Nothing is there without a reason.
        told = {entry["spdxElementId"] for entry in self.bill["relationships"]}
        told |= {entry["relatedSpdxElement"] for entry in self.bill["relationships"]}
        self.assertEqual(identifiers - told, set())

    def test_every_file_of_the_build_is_told_with_its_checksum(self):
        expected = {pathlib.Path(entry["file"]).name: entry["file"]
                    for entries in self.build["components"].values() for entry in entries}
        files = {file["fileName"][2:]: file for file in self.bill["files"]}
        self.assertEqual(set(files), set(expected))
        sums = []
        for name, path in expected.items():
            content = pathlib.Path(path).read_bytes()
            listed = {entry["algorithm"]: entry["checksumValue"]
                      for entry in files[name]["checksums"]}
            self.assertEqual(listed["SHA256"], hashlib.sha256(content).hexdigest())
            self.assertEqual(listed["SHA1"], hashlib.sha1(content).hexdigest())
            sums.append(listed["SHA1"])
        code = hashlib.sha1("".join(sorted(sums)).encode("ascii")).hexdigest()
        ours = [package["packageVerificationCode"]["packageVerificationCodeValue"]
                for package in self.bill["packages"] if package["filesAnalyzed"]]
        self.assertEqual(ours, [code])

    def test_everything_linked_is_told_with_version_and_licence(self):
        packages = {package["SPDXID"]: package for package in self.bill["packages"]}
        linked = {}
        for entry in self.bill["relationships"]:
            if entry["relationshipType"] == "DYNAMIC_LINK":
                linked.setdefault(entry["spdxElementId"], set()).add(entry["relatedSpdxElement"])
        for entries in self.build["components"].values():
            for entry in entries:
                path = pathlib.Path(entry["file"])
                needed = SONAME.findall(subprocess.run(
                    ["readelf", "-d", "-W", path], check=True, stdout=subprocess.PIPE, text=True,
                    env={**os.environ, "LC_ALL": "C"}).stdout)
                file = next(file for file in self.bill["files"]
                            if file["fileName"] == "./" + path.name)
                self.assertEqual(bool(needed), file["SPDXID"] in linked, path)
                for other in linked.get(file["SPDXID"], ()):
                    if other in packages:
                        self.assertNotEqual(packages[other]["licenseDeclared"], "NOASSERTION",
                                            f"{packages[other]['name']}: unknown to {SCRIPT.name}")
                        self.assertIn("versionInfo", packages[other])

    def test_dependencies_that_are_headers_are_told(self):
        names = {package["name"] for package in self.bill["packages"]}
        self.assertIn("Eigen", names)
        self.assertIn("qhull", names)
        if "tools" in self.build["components"]:
            self.assertLessEqual({"JSON for Modern C++", "FLANN", "VTK", "Boost", "zlib"}, names)

    def test_no_path_of_this_machine(self):
        text = BILL.read_text(encoding="utf-8")
        for folder in (SOURCE_FOLDER, BUILD_FOLDER, "/usr/", "/home/", "/tmp/"):
            self.assertNotIn(str(folder), text)

    def test_same_bytes_again(self):
        with tempfile.TemporaryDirectory() as folder:
            again = pathlib.Path(folder, "again.json")
            subprocess.run([SCRIPT, BUILD, again], check=True)
            self.assertEqual(again.read_bytes(), BILL.read_bytes())

    def test_missing_file_is_no_silent_gap(self):
        with tempfile.TemporaryDirectory() as folder:
            result = subprocess.run(
                [SCRIPT, BUILD, pathlib.Path(folder, "bill"), "--component", "core",
                 "--prefix", folder], check=False, stderr=subprocess.PIPE, text=True)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn("there is no", result.stderr)
            self.assertFalse(pathlib.Path(folder, "bill").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
