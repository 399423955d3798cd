"""tools/reproduce: its arguments, and the files of an entry."""

import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
sys.path.insert(0, str(TOOLS))

from claims_lib import run, table  # noqa: E402
from reproduce_lib import entries  # noqa: E402


class Reproduce(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def reproduce(self, body):
        context = table.Context(root=self.folder, build=self.folder, scratch=self.folder / "runs")
        out = io.StringIO()
        entries.reproduce(entries.Entry("figure-0", "a title", body, quick=1), context, self.folder / "out", 3, out)
        return out.getvalue()

    def test_every_table_and_figure_is_listed_with_its_title_and_time(self):
        done = subprocess.run([TOOLS / "reproduce", "--list"], capture_output=True, text=True, check=True)
        lines = [[part.strip() for part in line.split(" | ")] for line in done.stdout.splitlines()]
        self.assertEqual([f"table-{number}" for number in ("2.4", "2.5", "2.6", "3.1", "4.1", "5.1", "6.1", "6.2", "D.1", "E.1")]
                         + [f"figure-{number}" for number in ("2.4", "2.5", "2.6", "2.7", "2.8", "2.9", "2.10", "3.4",
                                                              "3.5", "3.6", "3.8", "3.9", "3.12", "4.4", "5.4", "5.6", "5.7",
                                                              "5.8", "6.2", "6.4", "6.5", "6.6", "6.7", "6.8", "6.12", "E.2", "E.3")],
                         [name for name, _, _ in lines])
        for name, title, time in lines:
            self.assertEqual(entries.known()[name].title, title)
            self.assertRegex(time, r"^\d+ (s|min) with --quick(, seconds after another one of [a-z ]+)?$")

    def test_no_entry_says_that_it_takes_more_than_ten_minutes_with_quick(self):
        for one in entries.known().values():
            self.assertLessEqual(one.quick, 600, one.name)

    @unittest.skipUnless("TREACLE_BUILD" in os.environ, "needs a build folder")
    def test_the_cheapest_figure_has_our_numbers_beside_the_dissertations(self):
        out = self.folder / "out"
        subprocess.run([TOOLS / "reproduce", "figure-3.5", "--quick", "--build", os.environ["TREACLE_BUILD"], "--out", out],
                       capture_output=True, check=True)
        columns = run.Columns(out / "figure-3.5.csv")
        self.assertEqual(["particles stand", "best lambda", "difference before", "difference with it",
                          "theirs: particles beside the grid"], columns.header)
        self.assertEqual(["", "larger", "smaller"], columns.text("theirs: particles beside the grid"))
        _, larger, smaller = columns["best lambda"]
        self.assertGreater(larger, 1)
        self.assertLess(smaller, 1)
        self.assertEqual(["particles stand", "x [d]", "y [d]", "particles [Pa]", "grid [Pa]"],
                         run.Columns(out / "pressures.csv").header)
        self.assertEqual(b"\x89PNG", (out / "figure-3.5.png").read_bytes()[:4])

    def test_a_table_is_printed_and_written_with_empty_cells_where_nothing_is_printed(self):
        text = self.reproduce(lambda _, results: results.table("t", ["solver", "seconds [s]", "theirs [s]"],
                                                               [["cg", 0.123456, None]]))
        self.assertIn("cg       0.1235", text)
        columns = run.Columns(self.folder / "out/t.csv")
        self.assertEqual(["cg"], columns.text("solver"))
        self.assertEqual([""], columns.text("theirs"))
        self.assertEqual(0.123456, columns["seconds"][0])

    def test_a_figure_is_a_picture(self):
        def body(_, results):
            with results.figure("f", columns=2) as (left, _):
                left.plot([0, 1], [0, 1])

        self.reproduce(body)
        self.assertEqual(b"\x89PNG", (self.folder / "out/f.png").read_bytes()[:4])

    def test_the_commands_that_were_run_are_kept(self):
        self.reproduce(lambda context, _: run.execute(context, ["echo", "a b"]))
        record = json.loads((self.folder / "out/commands.json").read_text())
        self.assertEqual((["echo 'a b'"], 3), (record["commands"], record["ranks"]))

    def test_two_entries_of_one_name_are_an_error(self):
        entries.known()
        with self.assertRaisesRegex(ValueError, "two entries named 'table-3.1'"):
            entries.entry("table-3.1", "again", quick=1)

    def test_bad_arguments_end_with_exit_code_2(self):
        for arguments in ([], ["figure-0.0"], ["table-3.1", "--build", str(self.folder)],
                          ["table-3.1", "--ranks", "0"]):
            done = subprocess.run([TOOLS / "reproduce", *arguments], capture_output=True, text=True)
            self.assertEqual(2, done.returncode, done.stderr)


if __name__ == "__main__":
    unittest.main()
