#!/usr/bin/env python3
"""Runs that others do: requested as folders, by job arrays or by Dakota's files, and taken in again.

usage: file_driven_test.py PROGRAM MPIEXEC
"""
import json
import os
import shutil
import subprocess
import sys

import harness
from harness import Program
from sweep_test import Study

JOBS = os.path.join(os.path.dirname(os.path.dirname(harness.HERE)), "jobs")


class Folders(Study):
    def setUp(self):
        super().setUp()
        self.change("points: 4", "points: 2")

    def ask(self, count, *more):
        return self.sweep("--ask", count, "--to", "asked", *more).stdout

    def tell(self, code=0):
        return self.sweep("--tell", "asked", code=code)

    def test_the_table_is_that_of_a_sweep(self):
        self.sweep(out="good")
        self.assertIn("3 runs in asked: 1,2,3", self.ask(3))
        self.assertIn("1 runs in asked: 4", self.ask(3))
        for number in (3, 1):  # in any order
            self.treacle("forward", f"asked/000{number}")
        told = self.tell(code=5).stdout
        self.assertIn("2 runs done, 0 failed, 0 known before, 2 still out, 0 folders left alone", told)
        for number in (2, 4):
            subprocess.run([Program.path, "forward", self.path("asked"), "--array-task"], check=True, cwd=self.folder,
                           env={**os.environ, "SLURM_ARRAY_TASK_ID": str(number)}, capture_output=True, timeout=240)
        self.assertIn("2 runs done, 0 failed, 2 known before, 0 still out", self.tell().stdout)
        self.assertEqual(self.figures(), self.figures("good"))
        self.assertIn("no run is left", self.ask(3))

    def test_late_double_foreign_and_half_written_folders(self):
        self.ask(4)
        self.treacle("forward", "asked/0001")
        for name in ("params.yaml", "params.in"):
            os.makedirs(self.path("asked", "other"), exist_ok=True)
            shutil.copy(self.path("asked", "0002", name), self.path("asked", "other"))  # a double: no result yet
        os.makedirs(self.path("asked", "notes"))
        with open(self.path("asked", "0003", "result.json"), "w") as file:
            file.write('{"number": 3, "key": "')
        with open(self.path("asked", "0004", "params.yaml")) as file:
            text = file.read()
        with open(self.path("asked", "0004", "params.yaml"), "w") as file:
            file.write(text.replace("key: \"", "key: \"a"))
        with open(self.path("asked", "0002", "FAIL"), "w") as file:
            file.write("node down\n")
        done = self.tell(code=5)
        self.assertIn("1 runs done, 1 failed", done.stdout)
        for words in ("notes: has no params.yaml", "0003/result.json: cannot be read", "0004: asks for no run of this study"):
            self.assertIn(words, done.stderr + done.stdout)
        self.treacle("forward", "asked/0002")  # late, after it counted as failed
        self.tell(code=5)
        self.assertEqual(self.rows()[1]["status"], "done")
        with open(self.path("asked", "0002", "FAIL"), "w") as file:
            file.write("again\n")
        self.tell(code=5)
        self.assertEqual(self.rows()[1]["status"], "done")
        with open(self.path("asked", "0001", "result.json")) as file:
            result = json.load(file)
        result["figures"]["front [m]"] += 1
        with open(self.path("asked", "0001", "result.json"), "w") as file:
            json.dump(result, file)
        told = self.tell(code=5)
        self.assertIn("0001: has other figures than the run had before", told.stderr + told.stdout)

    def test_a_study_that_has_changed_is_refused(self):
        self.ask(1)
        self.change("viscosity: 10 Pa.s", "viscosity: 10 Pa.s\n    surface_tension: 0.03 N/m", "block.yaml")
        self.assertIn("asks for another run than its scene gives now", self.treacle("forward", "asked/0001", code=2).stderr)
        with open(self.path("asked", "0001", "FAIL")) as file:
            self.assertIn("ask for the runs again", file.read())


class Dakota(Study):
    """Does what Dakota does with the example's driver: writes parameters files, starts it, reads results files."""

    def evaluate(self, number, text):
        with open(self.path(f"params.in.{number}"), "w") as file:
            file.write(text)
        subprocess.run([os.path.join(JOBS, "dakota", "driver.sh"), f"params.in.{number}", f"results.out.{number}"], check=True, cwd=self.folder,
                       env={**os.environ, "STUDY": "study.yaml", "TREACLE": Program.path}, timeout=240)
        with open(self.path(f"results.out.{number}")) as file:
            return file.read().split("\n")

    def test_standard_and_aprepro_formats(self):
        standard = "                    2 variables\n 10.0 viscosity\n 1400 density\n 1 functions\n 1 ASV_1:front\n 2 derivative_variables\n 1 DVV_1:viscosity\n 2 DVV_2:density\n 0 analysis_components\n 1 eval_id\n"
        aprepro = "{ DAKOTA_VARS = 2 }\n{ viscosity = 1.0e+01 }\n{ density = 1.4e+03 }\n{ DAKOTA_FNS = 1 }\n{ DAKOTA_EVAL_ID = 2 }\n"
        first, second = self.evaluate(1, standard), self.evaluate(2, aprepro)
        self.assertEqual(first, second)
        value, label = first[0].split()
        self.assertEqual(label, "front")
        self.assertGreater(float(value), 0.06)

    def test_a_failure_is_told_as_dakota_captures_it(self):
        self.assertEqual(self.evaluate(1, "2 variables\n-10.0 viscosity\n1400 density\n")[0], "FAIL")
        with open(self.path("results.out.1.log")) as file:
            self.assertIn("must be >= 0", file.read())
        self.assertEqual(self.evaluate(2, "2 variables\n10.0 viscosity\n")[0], "FAIL")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
