"""tools/claims: what counts as ok, short and not measured, and how results are read."""

import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
sys.path.insert(0, str(TOOLS))

from claims_lib import device, device_solves, device_sources, device_steps, gtest, run, table  # noqa: E402
from structure_lib import loops  # noqa: E402


def context(folder, **given):
    folder = pathlib.Path(folder)
    return table.Context(root=folder, build=folder / "build", scratch=folder / "runs", **given)


def sample():
    rows = table.Table("sample")

    @rows.row("good", claim="one", asked="= 1")
    def good(_):
        return table.Figure("1", True)

    @rows.row("bad", claim="two", asked="= 2")
    def bad(here):
        run.execute(here, ["echo", "a b"])
        return table.Figure("1", False)

    @rows.row("broken", claim="three", asked="= 3")
    def broken(here):
        run.execute(here, ["false"])

    @rows.row("peer", claim="four", asked="= 4")
    def peer(here):
        return table.Figure(str(here.peer("splish")), True)

    return rows


class Claims(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def run_table(self, rows, **given):
        out, report = io.StringIO(), self.folder / "claims.json"
        passed = table.run(rows, rows.rows, context(self.folder, **given), report, out)
        return passed, out.getvalue().splitlines(), json.loads(report.read_text())

    def test_a_row_says_what_was_claimed_asked_measured_and_run(self):
        passed, lines, report = self.run_table(sample())
        self.assertFalse(passed)
        self.assertEqual("good | one | = 1 | 1 | ok | ", lines[0])
        self.assertEqual("bad | two | = 2 | 1 | short | echo 'a b'", lines[1])
        self.assertEqual(["ok", "short", "short", "not measured"], [row["status"] for row in report["rows"]])

    def test_a_failing_command_is_a_row_that_falls_short(self):
        _, lines, _ = self.run_table(sample())
        self.assertIn("exit code 1 instead of 0", lines[2])

    def test_a_row_without_its_peer_is_not_measured(self):
        _, lines, _ = self.run_table(sample())
        self.assertIn("needs --peer splish=PATH | not measured", lines[3])
        _, lines, _ = self.run_table(sample(), peers={"splish": "/x"})
        self.assertIn("/x | ok", lines[3])

    def test_the_last_line_counts(self):
        _, lines, _ = self.run_table(sample())
        self.assertEqual(["1 not measured", "1 passed, 2 failed"], lines[-2:])

    def test_columns_are_found_by_name_without_the_unit(self):
        path = self.folder / "steps.csv"
        path.write_text("step,time [s],mass [kg]\n0,0,1\n1,0.5,3\n")
        columns = run.Columns(path)
        self.assertEqual([0, 0.5], list(columns["time"]))
        self.assertEqual(2, columns.at("mass", 0.25))
        with self.assertRaisesRegex(table.CommandFailed, "no column 'speed', but step, time, mass"):
            columns["speed"]

    def test_frames_are_read_in_the_order_of_ids(self):
        import h5py

        with h5py.File(self.folder / "a.hdf", "w") as file:
            file["VTKHDF/Points"] = [[2.0, 0, 0], [1.0, 0, 0]]
            file["VTKHDF/PointData/id"] = [8, 3]
        (self.folder / "a.hdf.series").write_text(json.dumps(
            {"file-series-version": "1.0", "files": [{"name": "a.hdf", "time": 0.5}]}))
        folder = run.RunFolder(self.folder)
        self.assertEqual([(0.5, self.folder / "a.hdf")], folder.frames())
        with self.assertRaisesRegex(table.CommandFailed, "no index of frames"):
            folder.frames(solids=True)
        self.assertEqual([1.0, 2.0], list(folder.frame()["position"][:, 0]))

    def test_a_gtest_report_without_tests_does_not_pass(self):
        self.assertFalse(gtest.parse({"testsuites": []}).ok)

    def test_a_gtest_report_counts_failures_and_keeps_properties(self):
        report = gtest.parse({"testsuites": [{"name": "A", "testsuite": [
            {"name": "b", "status": "RUN", "result": "COMPLETED", "worst": "1e-5"},
            {"name": "c", "status": "RUN", "result": "COMPLETED", "failures": [{"failure": "x"}]},
            {"name": "d", "status": "NOTRUN"}]}]})
        self.assertEqual((2, ("A.c",), {"worst": "1e-5"}), (report.ran, report.failed, report.properties))
        self.assertFalse(report.ok)

    def test_loops_of_the_host_are_those_beyond_the_list_and_entries_without_a_loop_are_told(self):
        entries = device_sources.allowed("# A list\n\nsrc/a.cpp | A::write 2, seed | output\nsrc/b.cpp | gone | contacts\n")
        found = [loops.Loop("src/a.cpp", 1, name, "") for name in ("A::write", "A::write", "A::solve", "seed", "seed")]
        left, stale = device_sources.judged(found, entries)
        self.assertEqual(["A::solve", "seed", "seed"], [one.function for one in left])
        self.assertEqual([("src/b.cpp", "gone", 1, "contacts")], [(one.path, one.function, one.loops, one.why) for one in stale])

    def test_iterations_are_the_same_within_one_of_those_on_one_rank(self):
        self.assertTrue(device_solves.same({1: 8, 2: 9, 4: 7}))
        self.assertFalse(device_solves.same({1: 8, 2: 8, 3: 10}))
        reports = {ranks: gtest.TestReport(1, (), {"iterations_24": "9", "iterations_chebyshev_24": str(8 + ranks)}) for ranks in (1, 2)}
        self.assertEqual({"24": {1: 9, 2: 9}}, device_solves.by_size(reports, "iterations_"))
        self.assertEqual({"24": {1: 9, 2: 10}}, device_solves.by_size(reports, "iterations_chebyshev_"))

    def test_the_hosts_share_is_that_between_the_marks_of_steps(self):
        import numpy

        marks = numpy.array([[90, 0.1, 7], [100, 1, 10], [110, 1.5, 11], [120, 2, 12]])
        share, kernels = device_steps.share_of_marks(marks, 1)
        self.assertAlmostEqual(0.5, share)
        self.assertEqual(10, kernels)

    def test_of_runs_in_turn_the_least_time_of_each_step_counts(self):
        import numpy

        runs = [{"solve": numpy.array([1.0, 5.0])}, {"solve": numpy.array([3.0, 2.0])}]
        self.assertEqual(device_steps.Timed({"solve": 1.5}, 2), device_steps.fastest(runs))

    def test_phases_that_take_no_time_are_not_judged(self):
        before, now = device_steps.Timed({"solve": 1.0, "sort": 1e-3}, 5), device_steps.Timed({"solve": 0.5, "sort": 5e-3}, 5)
        found = device_steps.ratios(before, now)
        self.assertEqual({"solve", "step"}, set(found))
        self.assertAlmostEqual(0.5, found["solve"])
        self.assertAlmostEqual(0.505 / 1.001, found["step"])

    def test_rows_that_need_what_is_not_there_are_not_measured(self):
        names = ("ranks and threads", "phases", "same answers, threads", "lines")
        rows = table.Table("device")
        rows.rows = [row for row in device.TABLE.rows if row.name in names]
        with unittest.mock.patch.dict("os.environ"):
            os.environ.pop("KOKKOS_SOURCE", None)
            _, _, report = self.run_table(rows)
        self.assertEqual(["not measured"] * len(names), [row["status"] for row in report["rows"]])

    def test_bad_arguments_end_with_exit_code_2(self):
        for arguments in (["nothing"], ["ground", "--row", "no such row"], ["ground", "--peer", "x"],
                          ["ground", "--build", str(self.folder)]):
            done = subprocess.run([TOOLS / "claims", *arguments], capture_output=True, text=True)
            self.assertEqual(2, done.returncode, done.stderr)


if __name__ == "__main__":
    unittest.main()
