#!/usr/bin/python3
"""The files by which others find and install the project parse, and agree in the version, its date and the tests."""

import json
import os
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
        for path in ("pyproject.toml", "setup.py", "packaging/conan/conanfile.py"):  # they read CMakeLists.txt
            self.assertFalse(version in (ROOT / path).read_text(), path)
        for library in ("spherical-param-core", "pcl-spherical-param"):
            self.assertEqual(found(rf"`lib{library}([0-9.]+)`", "doc/guide.md"), version.rpartition(".")[0])
        self.assertEqual(citation["date-released"], found(rf"^## \[{re.escape(version)}\] - (\S+)$", "CHANGELOG.md"))

    def test_each_script_of_tests_is_run_by_a_workflow(self):
        runs_all = found(r"run_scripts\.sh\"? ((?:.*\\\n)*.*)", "tools/test_all.sh")
        run = set(re.findall(r"\w+", runs_all.replace("--quick", "")))
        scripts = {path.stem for path in (ROOT / "tools").glob("test*.sh")} - {"test_all"} | {"stress"}
        self.assertEqual(run, scripts)
        jobs = {name: self.workflow(name)["jobs"] for name in ("ci", "release", "weekly")}
        weekly = {"uses": "./.github/workflows/weekly.yml"}
        self.assertEqual(jobs["ci"]["debian"], {**weekly, "with": {"script": ".ci/run"}})
        self.assertEqual(jobs["release"]["tests"], weekly)
        self.assertIn("tests", jobs["release"]["release"]["needs"])
        test = next(step["run"] for step in jobs["weekly"]["debian"]["steps"] if step.get("name") == "Test")
        self.assertEqual(test.splitlines()[1:], ["${{ inputs.script || 'tools/test_all.sh' }}"])
        others = [job for name, job in jobs["ci"].items() if name != "debian"]
        self.assertFalse([job for job in others if "debian" in str(job.get("container"))])

    def test_workflows_run_scripts_that_exist_and_the_commands_of_the_guide(self):
        for path in (ROOT / ".github/workflows").glob("*.yml"):
            scripts = set(re.findall(r"(?:tools|\.ci)/[\w./]*\w", path.read_text()))
            for script in scripts - {"tools/all"}:  # a target of CMake
                self.assertTrue(os.access(ROOT / script, os.X_OK), f"{path.name}: {script}")
        steps = self.workflow("release")["jobs"]["debian"]["steps"]
        made = next(step["run"] for step in steps if step.get("name") == "Packages").splitlines()
        commands = "\n".join(made[1:])
        self.assertTrue(f"```sh\n{commands}\n```" in (ROOT / "doc/guide.md").read_text(), commands)
        steps = self.workflow("ci")["jobs"]["ros2"]["steps"]
        build = next(step["run"] for step in steps if "guide" in step.get("name", "")).splitlines()[1]
        self.assertIn(f"\n{build}\n", (ROOT / "doc/guide.md").read_text())

    @staticmethod
    def workflow(name):
        return yaml.safe_load((ROOT / f".github/workflows/{name}.yml").read_text())


if __name__ == "__main__":
    unittest.main()
