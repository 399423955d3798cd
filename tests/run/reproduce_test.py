#!/usr/bin/env python3
"""Every entry of tools/reproduce runs at its smallest size, and leaves a table and the commands behind it.

usage: reproduce_test.py BUILD_FOLDER PART PARTS
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
sys.path.insert(0, str(TOOLS))

from reproduce_lib import entries  # noqa: E402

BUILD, PART, PARTS = "", 0, 1


def part_of(known):
    """Names of this part; those that share studies stand in one part."""
    groups = {}
    for name in sorted(known, key=lambda name: (known[name].quick, name)):
        groups.setdefault(known[name].shares or name, []).append(name)
    return [name for group in list(groups.values())[PART::PARTS] for name in group]


class Entries(unittest.TestCase):
    def test_run_at_their_smallest_size(self):
        names = part_of(entries.known())
        self.assertTrue(names)
        with tempfile.TemporaryDirectory(prefix="treacle_studies_") as studies:
            for name in names:
                with self.subTest(name), tempfile.TemporaryDirectory(prefix="treacle_reproduce_") as folder:
                    self.run_entry(name, pathlib.Path(folder), studies)

    def run_entry(self, name, folder, studies):
        done = subprocess.run([TOOLS / "reproduce", name, "--smallest", "--ranks", "1", "--build", BUILD, "--out", folder, "--studies", studies],
                              capture_output=True, text=True, timeout=240)
        self.assertEqual(done.returncode, 0, f"{done.stdout}\n{done.stderr}")
        record = json.loads((folder / "commands.json").read_text())
        self.assertTrue(record["smallest"] and record["commands"])
        tables = list(folder.glob("*.csv"))
        self.assertTrue(tables)
        for path in tables:
            with open(path, newline="") as file:
                rows = list(csv.reader(file))
            self.assertGreater(len(rows), 1, f"{path.name} has no row")
            self.assertEqual({len(row) for row in rows}, {len(rows[0])}, f"{path.name}: rows of different lengths")
        for path in folder.glob("*.png"):
            self.assertEqual(b"\x89PNG", path.read_bytes()[:4])


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    BUILD, PART, PARTS = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
