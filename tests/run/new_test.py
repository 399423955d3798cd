#!/usr/bin/env python3
"""treacle new writes studies that treacle check takes, and the tutorial of inputs/templates finds a viscosity as it is printed.

usage: new_test.py PROGRAM MPIEXEC
"""
import os
import re
import shlex
import sys

import harness
from harness import INPUTS, Workplace

TEMPLATES = sorted(name for name in os.listdir(os.path.join(INPUTS, "templates")) if os.path.isdir(os.path.join(INPUTS, "templates", name)))


class New(Workplace):
    def read(self, *names):
        with open(self.path(*names)) as file:
            return file.read()

    def test_every_template_is_listed_written_and_good(self):
        listed = self.treacle("new").stdout
        for name in TEMPLATES:
            with self.subTest(template=name):
                self.assertIn(f"  {name} ", listed)
                self.treacle("new", name, name)
                self.assertEqual(sorted(os.listdir(self.path(name))), ["FILMING.md", "scene.yaml", "study.yaml"])
                self.assertIn("time_zero", self.read(name, "FILMING.md"))
                told = self.treacle("check", f"{name}/study.yaml").stdout
                for text in ("not there yet", "capillary length", "% of viscosity", "Bond number", "cells across", "90 % interval"):
                    self.assertIn(text, told)

    def test_a_first_guess_centres_the_search_and_the_form_is_filled_in(self):
        # Huppert 1982: 1200 9.81 (0.06 0.038)^3 2 / 3 (1.411 / 0.15)^5 Pa s
        told = self.treacle("new", "bostwick", "one", "--front", "15cm", "--at", "2s", "--set", "length=60 mm +- 0.3 mm").stdout
        guess = 1200 * 9.81 * (0.06 * 0.038) ** 3 * 2 / 3 * (1.411 / 0.15) ** 5
        self.assertIn(f"first guess: {guess:.3g} Pa.s", told)
        study = self.read("one", "study.yaml")
        low, high = map(float, re.search(r"range: \[(\S+) Pa.s, (\S+) Pa.s\]", study).groups())
        self.assertAlmostEqual((low * high) ** 0.5 / guess, 1, delta=0.01)
        self.assertIn("value: 60 mm, plus_minus: 0.3 mm", study)
        self.assertIn("end: 2 s", self.read("one", "scene.yaml"))
        told = self.treacle("check", "one/study.yaml").stdout
        self.assertRegex(told, r"length +60 mm \+- 0.3 mm: 1.5 % of viscosity")

    def test_what_cannot_be_is_told_and_nothing_is_written(self):
        self.treacle("new", "bostwick", "there")
        before = self.read("there", "study.yaml")
        for words, text in ((["bostwick", "there"], "nothing is overwritten"), (["bostwik", "new"], "did you mean bostwick?"), (["bostwick"], "needs a folder"),
                            (["bostwick", "new", "--front", "9cm"], "--front --at"), (["bostwick", "new", "--front", "9 kg", "--at", "1s"], "must be a length"),
                            (["bostwick", "new", "--speed", "9cm/s"], "gives no first guess"), (["bostwick", "new", "--set", "lenght=5 cm"], "did you mean length?"),
                            (["bostwick", "new", "--set", "length=50 mm"], "write both, in one unit"), (["bostwick", "new", "--set", "density=5 cm"], "must be a density"),
                            (["nozzle_cup", "new", "--cup", "ford4", "--efflux", "3s"], "takes off"), (["nozzle_cup", "new", "--cup", "ford9", "--efflux", "30s"], "is no cup")):
            self.assertIn(text, self.treacle("new", *words, code=2).stderr)
            self.assertEqual(os.listdir(self.folder), ["there"])
        self.assertEqual(self.read("there", "study.yaml"), before)

    def test_the_tutorial_finds_the_viscosity_as_printed(self):
        with open(os.path.join(INPUTS, "templates", "README.md")) as file:
            commands = re.search(r"```sh\n(.*?)```", file.read(), re.S).group(1)
        for line in commands.splitlines():
            words = shlex.split(line, comments=True)
            if words:
                self.assertEqual(words[0], "treacle")
                told = self.treacle(*words[1:]).stdout
        value = float(re.search(r"viscosity = (\S+) Pa.s, 90 % interval", told).group(1))
        # Minimal results of each template's commands.
        self.assertLess(abs(value / 9 - 1), 0.05, told)
        self.assertIn("index.html", told)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
