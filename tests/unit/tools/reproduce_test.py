"""tools/reproduce: what can be asked for, and what an entry leaves behind."""

import io
import json
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
        entries.reproduce(entries.Entry("figure-0", "a title", body), context, self.folder / "out", 3, out)
        return out.getvalue()

    def test_every_table_and_figure_is_listed_with_its_title(self):
        done = subprocess.run([TOOLS / "reproduce", "--list"], capture_output=True, text=True, check=True)
        names = [line.split(" | ")[0] for line in done.stdout.splitlines()]
        self.assertEqual(sorted(names), names)
        self.assertEqual(set(entries.known()), set(names))
        for name in ("table-2.6", "table-3.1", "figure-2.10"):
            self.assertIn(name, names)

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
            entries.entry("table-3.1", "again")

    def test_bad_arguments_end_with_exit_code_2(self):
        for arguments in ([], ["figure-0.0"], ["table-3.1", "--build", str(self.folder)],
                          ["table-3.1", "--ranks", "0"]):
            done = subprocess.run([TOOLS / "reproduce", *arguments], capture_output=True, text=True)
            self.assertEqual(2, done.returncode, done.stderr)


if __name__ == "__main__":
    unittest.main()
