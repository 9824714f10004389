"""Tests of the parts of the suite; they need neither a build nor modules of others."""

import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

from . import __main__ as program
from . import comparison, freshness, machine, readme, stages
from .processes import Failure, in_turn, median_seconds, require, run
from .product import load_clouds
from .report import Figure, Section, write_report
from .tables import Column, Table, parse_markdown


def python(code):
    return [sys.executable, "-c", code]


class InFolder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Processes(unittest.TestCase):
    def test_times_are_those_of_the_one_process(self):
        busy = run(python("import time\nwhile time.process_time() < 0.3: pass"))
        self.assertTrue(busy.good)
        self.assertGreaterEqual(busy.cpu_seconds, 0.3)
        idle = run(python("import time; time.sleep(0.3)"))
        self.assertGreaterEqual(idle.seconds, 0.3)
        self.assertLess(idle.cpu_seconds, 0.3)

    def test_what_takes_too_long_is_ended(self):
        late = run(python("import time; time.sleep(60)"), timeout=0.3)
        self.assertTrue(late.timed_out)
        self.assertFalse(late.good)
        self.assertLess(late.seconds, 30)

    def test_output_and_errors_are_kept_apart(self):
        both = run(python("import sys; print('out'); print('err', file=sys.stderr); sys.exit(3)"))
        self.assertEqual((both.output, both.errors, both.exit_code), ("out\n", "err\n", 3))

    def test_number_of_threads_reaches_the_program(self):
        said = run(python("import os; print(os.environ['OMP_NUM_THREADS'])"), threads=7)
        self.assertEqual(said.output, "7\n")

    def test_a_failure_has_cause_and_remedy(self):
        with self.assertRaises(Failure) as caught:
            require(python("import sys; sys.exit('no such cloud\\nmake one')"))
        self.assertIn("no such cloud", caught.exception.cause)
        self.assertEqual(caught.exception.remedy, "make one")

    def test_commands_run_in_turn_and_failures_once(self):
        with tempfile.NamedTemporaryFile("r") as log:
            commands = [
                python(f"open({log.name!r}, 'a').write({letter!r}); raise SystemExit({code})")
                for letter, code in (("a", 0), ("b", 1), ("c", 0))
            ]
            runs = in_turn(commands, 3)
            self.assertEqual(log.read(), "abcacac")
        self.assertEqual([len(one) for one in runs], [3, 1, 3])
        self.assertEqual(median_seconds(runs[0]), sorted(one.seconds for one in runs[0])[1])


def example(rms=0.0123, seconds=1.5, crossings=0):
    columns = [
        Column("model", "cloud"),
        Column("rms", "RMS [%]", 4),
        Column("crossings", "self-intersections"),
        Column("seconds", "time [s]", 2, exact=False),
        Column("inner", "not quoted", quoted=False),
    ]
    row = {"model": "hand", "rms": rms, "crossings": crossings, "seconds": seconds, "inner": 1}
    return Table("generated", columns, [row, {"model": "head", "rms": None, "seconds": 2.0}])


def results(table):
    return {"sentence": "Measured at commit `0123456789` on a machine.",
            **readme.results_of([table])}  # fmt: skip


class Tables(unittest.TestCase):
    def test_what_is_written_can_be_read(self):
        titles, rows = parse_markdown(example().markdown(quoted=True))
        self.assertEqual(titles, ["cloud", "RMS [%]", "self-intersections", "time [s]"])
        self.assertEqual(rows, [["hand", "0.0123", "0", "1.50"], ["head", "-", "-", "2.00"]])

    def test_csv_has_unrounded_numbers(self):
        lines = example(rms=0.01234567).csv().splitlines()
        self.assertEqual(lines[1], "hand,0.01234567,0,1.5,1")
        self.assertEqual(lines[2], "head,,,2.0,")

    def test_cells(self):
        column = Column("x", "x", 1)
        for value, text in ((1234567, "1,234,567"), (True, "yes"), (False, "no"), (2.25, "2.2"),
                            (float("nan"), "-"), (None, "-"), ("a", "a")):  # fmt: skip
            self.assertEqual(column.cell({"x": value}), text)


class Readme(InFolder):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "README.md"
        self.path.write_text(f"before\n{readme.BEGIN}\nold\n{readme.END}\nafter\n")
        readme.update(self.path, results(example()))

    def test_agrees_with_the_report_it_was_written_from(self):
        differences, compared = readme.check(self.path, results(example()))
        self.assertEqual((differences, compared), ([], 8))
        text = self.path.read_text()
        self.assertTrue(text.startswith("before\n") and text.endswith("\nafter\n"))
        self.assertNotIn("old", text)
        self.assertEqual(readme.quoted_commit(self.path), "0123456789")

    def test_tables_that_were_not_measured_again_are_told(self):
        empty = {"sentence": "Measured at commit `0123456789` on a machine.", "tables": []}
        self.assertEqual(readme.update(self.path, empty), ["generated"])
        self.assertEqual(readme.quoted_tables(self.path), {})

    def test_a_number_that_was_changed_is_found(self):
        self.path.write_text(self.path.read_text().replace("0.0123", "0.0103"))
        differences, _ = readme.check(self.path, results(example()))
        self.assertEqual(len(differences), 1)
        self.assertIn("the README says 0.0103, measured is 0.0123", differences[0])

    def test_numbers_that_no_longer_hold_are_found(self):
        for table, wrong in (
            (example(rms=0.0131), 1),
            (example(crossings=1), 1),
            (example(seconds=4.0), 1),
            (example(rms=None), 1),
            (example(rms=0.0124, seconds=2.5), 0),  # another processor, a busier machine
        ):
            with self.subTest(row=table.rows[0]):
                self.assertEqual(len(readme.check(self.path, results(table))[0]), wrong)

    def test_times_are_left_out_on_request(self):
        differences, compared = readme.check(self.path, results(example(seconds=9.0)), times=False)
        self.assertEqual((differences, compared), ([], 6))

    def test_rows_that_were_not_measured_are_not_compared(self):
        table = example()
        del table.rows[0]
        self.assertEqual(readme.check(self.path, results(table)), ([], 4))

    def test_other_columns_are_stale(self):
        table = example()
        table.columns[1] = Column("rms", "RMS [mm]", 4)
        self.assertEqual(len(readme.check(self.path, results(table))[0]), 1)

    def test_a_readme_without_the_part_is_refused(self):
        self.path.write_text("nothing here\n")
        with self.assertRaises(Failure):
            readme.check(self.path, results(example()))

    def test_a_commit_that_did_not_lead_here_is_told(self):
        self.path.write_text(self.path.read_text().replace("0123456789", "none"))
        self.assertIn("does not say", freshness.commit_problem(self.path))


class Report(InFolder):
    def test_has_commit_and_machine_tables_and_figures(self):
        provenance = machine.describe(self.folder, self.folder)
        figure = Figure(None, "Figure 9", "A tail.", "no display")
        section = Section("The paper", ["Words.\n", example(), figure])
        write_report(self.folder, provenance, [section], 90.0)
        text = (self.folder / "report.md").read_text()
        for part in (provenance.sentence(), "1.5 minutes", "## The paper", "Words.",
                     example().markdown(), "(not drawn: no display)", "A tail."):  # fmt: skip
            self.assertIn(part, text)
        self.assertEqual((self.folder / "generated.csv").read_text(), example().csv())
        written = json.loads((self.folder / "results.json").read_text())
        self.assertEqual(readme.tables_of(written)["generated"].cells(), example().cells())
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()),
                         ["generated.csv", "report.md", "results.json"])  # fmt: skip


class Comparison(unittest.TestCase):
    def test_summary_counts_spheres_through_all_points(self):
        table = Table("models", comparison.QUALITY, keys=2)
        for model, method, sphere, used, crossings, rms in (
            ("a", "ours", True, 100.0, 0, 1.0),
            ("b", "ours", True, 100.0, 2, 1.0),
            ("a", "peer", True, 99.9, 0, 3.0),
            ("b", "peer", False, 100.0, 0, 5.0),
        ):
            table.rows.append({"model": model, "method": method, "sphere": sphere, "used": used,
                               "intersections": crossings, "rms": rms, "hausdorff": rms,
                               "seconds": rms, "megabytes": 1.0})  # fmt: skip
        table.rows.append({"model": "b", "method": "late", "failure": "not done after 120 s"})
        ours, peer, late = comparison._summary(table).rows
        self.assertEqual((ours["clouds"], ours["spheres"], ours["clean"]), (2, 2, 1))
        self.assertEqual((peer["spheres"], peer["clean"], peer["rms"]), (0, 0, 4.0))
        self.assertEqual((late["clouds"], late["spheres"], late["rms"]), (1, 0, None))


class References(InFolder):
    def table(self, factor=1.0, same=True):
        report = {
            "data": "generated scans of a hand",
            "threads": 2,
            "repetitions": 3,
            "stages": [
                {"stage": "topology", "points": points, "reference": "map of edges",
                 "reference_seconds": 0.3 * factor, "one_thread_seconds": 0.02 * factor,
                 "all_threads_seconds": 0.01 * factor, "reference_over_all_threads": 30.0,
                 "same_output": same}
                for points in (10000, 100000)
            ],
        }  # fmt: skip
        heading, words, table = stages.references_table(report)
        self.assertIn("references", heading)
        self.assertIn("2 threads", words)
        return table

    def test_both_paths_are_side_by_side_in_the_readme(self):
        path = self.folder / "README.md"
        path.write_text(f"{readme.BEGIN}\n{readme.END}\n")
        readme.update(path, results(self.table()))
        titles, rows = readme.quoted_tables(path)["references"]
        self.assertEqual(len(titles), 8)
        self.assertEqual(rows[1], ["topology", "100,000", "map of edges", "300.00", "20.00",
                                   "10.00", "30.0", "yes"])  # fmt: skip
        for table, wrong in (
            (self.table(factor=1.5), 0),
            (self.table(factor=3.0), 6),  # times that no longer hold
            (self.table(same=False), 2),
        ):
            self.assertEqual(len(readme.check(path, results(table))[0]), wrong)
        # Whatever the times, the output has to be the same.
        differences, _ = readme.check(path, results(self.table(3.0, same=False)), times=False)
        self.assertEqual(len(differences), 2)
        self.assertIn("the README says yes, measured is no", differences[0])


class CommandLine(InFolder):
    def main(self, *words):
        readme_file = self.folder / "README.md"
        program.main([*words, "--build", str(self.folder), "--readme", str(readme_file)])

    def test_wrong_lines_are_refused_before_anything_is_done(self):
        for words in ((), ("out", "models", "more"), ("out", "--unknown"), ("out", "--only", "x"),
                      ("out", "--quick", "--update-readme")):  # fmt: skip
            with self.subTest(words=words), contextlib.redirect_stderr(io.StringIO()) as errors:
                with self.assertRaises(SystemExit) as caught:
                    self.main(*words)
                self.assertEqual(caught.exception.code, 2)
                self.assertEqual(len(errors.getvalue().splitlines()), 2)

    def test_a_folder_with_other_things_is_left_alone(self):
        (self.folder / "thesis.tex").write_text("x")
        with self.assertRaises(Failure):
            self.main(str(self.folder), "--check-only")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["thesis.tex"])

    def test_models_that_are_not_there_are_told(self):
        for models in ("missing", "."):
            with self.subTest(models=models), self.assertRaises(Failure):
                self.main(str(self.folder / "out"), str(self.folder / models), "--check-only")

    def test_models_with_and_without_truth(self):
        for name in ("points/a.ply", "points/b.ply", "truth/a.ply"):
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).touch()
        first, second = load_clouds(self.folder)
        self.assertEqual((first.name, second.name), ("a", "b"))
        self.assertEqual(first.truth, self.folder / "truth" / "a.ply")
        self.assertIsNone(second.truth)


class Machine(InFolder):
    def test_the_report_says_where_it_was_made(self):
        sentence = machine.describe(self.folder, self.folder).sentence()
        self.assertIn("commit `unknown`", sentence)
        self.assertRegex(sentence, r"\d{4}-\d\d-\d\d: .+, \d+ cores, \d+ GiB, .+")


if __name__ == "__main__":
    unittest.main()
