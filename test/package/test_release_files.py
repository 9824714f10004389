#!/usr/bin/python3
"""The files by which others find and install the project parse, and agree in the version, its date and the tests."""

import json
import pathlib
import re
import unittest
import xml.etree.ElementTree

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]


def found(pattern, path):
    """What the group of a pattern has first in a file."""
    return re.search(pattern, (ROOT / path).read_text(), re.MULTILINE)[1]


class ReleaseFiles(unittest.TestCase):
    def test_files_parse(self):
        paths = [ROOT / "CITATION.cff", ROOT / ".pre-commit-config.yaml", ROOT / "CMakePresets.json"]
        for folder in (".github", "packaging", "src"):
            paths += [path for kind in ("yml", "yaml", "json") for path in (ROOT / folder).rglob(f"*.{kind}")]
        self.assertGreater(len(paths), 9)
        for path in paths:
            with self.subTest(path=str(path.relative_to(ROOT))), path.open() as file:
                self.assertIsInstance(json.load(file) if path.suffix == ".json" else yaml.safe_load(file), dict)

    def test_versions_and_dates_are_those_of_the_build_and_the_changelog(self):
        version = found(r"^project\(.* VERSION ([0-9.]+) ", "CMakeLists.txt")
        citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
        port = json.loads((ROOT / "packaging/vcpkg/pcl-spherical-param/vcpkg.json").read_text())
        package = xml.etree.ElementTree.parse(ROOT / "package.xml")
        self.assertEqual([citation["version"], port["version"], package.findtext("version")], [version] * 3)
        self.assertEqual(citation["date-released"], found(rf"^## \[{re.escape(version)}\] - (\S+)$", "CHANGELOG.md"))

    def test_each_script_of_tests_is_run_by_a_workflow(self):
        runs_all = found(r"run_scripts\.sh\"? ((?:.*\\\n)*.*)", "tools/test_all.sh")
        run = set(re.findall(r"\w+", runs_all.replace("--quick", "")))
        scripts = {path.stem for path in (ROOT / "tools").glob("test*.sh")} - {"test_all"} | {"stress"}
        self.assertEqual(run, scripts)
        for workflow, script in (("weekly", "inputs.script || 'tools/test_all.sh'"), ("ci", "script: .ci/run"),
                                 ("release", "uses: ./.github/workflows/weekly.yml")):  # fmt: skip
            text = (ROOT / f".github/workflows/{workflow}.yml").read_text()
            self.assertIn(script, text)
        self.assertIn("tests", yaml.safe_load(text)["jobs"]["release"]["needs"])


if __name__ == "__main__":
    unittest.main()
