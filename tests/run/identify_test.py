#!/usr/bin/env python3
"""treacle identify finds the viscosity of a film that treacle film has made, and goes on after a kill.

usage: identify_test.py PROGRAM MPIEXEC
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import harness
from harness import Workplace

SCENE = """schema_version: 1
title: A plane block of syrup slumps
domain: {dimensions: 2, max: [0.2, 0.1], spacing: 1 cm, boundaries: {y_min: {slip: no_slip}, y_max: open}}
liquids:
  - {name: syrup, density: 1400, viscosity: 10 Pa.s, shapes: [{box: {min: [0, 0], max: [0.06, 0.08]}}]}
method: grid
time: {end: 0.24 s}
output: {interval: 40 ms}
cameras:
  - {name: front, position: [0.1, 0.05, 0.6], target: [0.1, 0.05, 0], up: [0, 1, 0], width: 240, height: 160, field_of_view: 24 deg}
measurements:
  - {name: front, kind: front, axis: x}
"""
STUDY = """schema_version: 1
title: Viscosity of a slumping block
scenes:
  - {name: slump, file: scene.yaml}
parameters:
  - {name: viscosity, key: liquids.syrup.viscosity, range: [0.5 Pa.s, 200 Pa.s], scale: log}
experiments:
  - {name: block, masks: film, camera: front, from: 40 ms}
measured:
  - {name: density, key: liquids.syrup.density, value: 1400, plus_minus: 20}
search: {tolerance: 0.03, evaluations: 10}
"""


ROD = """schema_version: 1
title: A rod falls in oil
domain:
  dimensions: 2
  max: [0.04, 0.06]
  spacing: 2.5 mm
  boundaries: {x_min: {slip: no_slip}, x_max: {slip: no_slip}, y_min: {slip: no_slip}, y_max: {slip: no_slip}}
liquids:
  - {name: oil, density: 970, viscosity: 1 Pa.s, subtract_bodies: true, shapes: [{box: {min: [0, 0], max: [0.04, 0.06]}}]}
bodies:
  - {name: rod, kind: dynamic, density: 1555, slip: no_slip, shape: {sphere: {centre: [0.02, 0.045], radius: 0.006}}}
method: {kind: grid}
time: {end: 0.25 s}
"""
FIELDS = """schema_version: 1
title: Oil around a falling rod
scenes: [{name: fall, file: rod.yaml}]
parameters:
  - {name: viscosity, key: liquids.oil.viscosity, range: [0.2 Pa.s, 8 Pa.s], scale: log}
experiments:
  - name: rod
    from: 0.04 s
    piv: {files: ["fields/field_*.csv"], times: fields/times.csv, origin: [4 mm, 4 mm, 0], right: [1, 0, 0], up: [0, 1, 0], y: up, window: 4 mm, noise: 0.3 mm/s}
search: {tolerance: 0.03, evaluations: 8}
"""

OTHER = """schema_version: 1
title: Honey and whatever else
domain: {dimensions: 2, max: [0.2, 0.1], spacing: 1 cm}
liquids:
  - {name: honey, material: honey, shapes: [{box: {min: [0, 0], max: [0.06, 0.08]}}]}
method: grid
time: {end: 40 ms}
"""
RESULT = """schema_version: 1
trials: 12
materials:
  - {name: lotion, density: 990, viscosity: 31, rheology: {law: herschel_bulkley, exponent: 0.4, yield_stress: 20}, temperature: 22 C +- 1 C, found: [consistency = 31 Pa.s]}
  - {name: milk, density: 1010, viscosity: 12, found: ["viscosity = 12 Pa.s, a lower limit alone"], well_determined: false}
"""


class Materials(Workplace):
    """What was identified goes into a liquid of another scene."""

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("report"))
        for name, text in (("scene.yaml", OTHER), ("report/result.yaml", RESULT)):
            with open(self.path(name), "w") as file:
                file.write(text)

    def test_the_whole_rheology_goes_into_the_liquid_and_set_counts_more(self):
        self.treacle("run", "scene.yaml", "--material", ".:lotion", "--set", "liquids.honey.rheology.exponent=0.5", "--out", "out")
        with open(self.path("out", "effective.yaml")) as file:
            text = file.read()
        for line in ("density: 990 kg/m3", "viscosity: 31 Pa s", "law: herschel_bulkley", "exponent: 0.5", "yield_stress: 20 Pa"):
            self.assertRegex(text, rf"(?m)^ +{line}$")
        told = self.treacle("check", "scene.yaml", "--material", "honey=report/result.yaml:milk", "--set", "liquids.0.density=1000").stdout
        for sentence in ("milk of ", "does not tell it well", "is not as ", "temperature not stated"):
            self.assertIn(sentence, told)

    def test_what_does_not_fit_is_told_before_anything_is_run(self):
        two = OTHER.replace("method: grid", "  - {name: water, viscosity_profile: {points: [{at: 0, viscosity: 1}]}, shapes: [{box: {min: [0.1, 0], max: [0.2, 0.05]}}]}\nmethod: grid")
        with open(self.path("two.yaml"), "w") as file:
            file.write(two)
        for scene, arguments, text in (("scene.yaml", ["."], "result.yaml:5: it is not said which of its liquids is meant; it has lotion, milk; write --material .:lotion"),
                                       ("scene.yaml", [".:lution"], "result.yaml:4: there is no material lution; did you mean lotion?"),
                                       ("scene.yaml", ["hony=.:milk"], "scene.yaml:5: there is no liquid hony; did you mean honey?"),
                                       ("scene.yaml", [".:milk", ".:lotion"], "has a material already"),
                                       ("scene.yaml", ["nothing:milk"], "there is no file nothing"),
                                       ("scene.yaml", ["scene.yaml"], "scene.yaml: has no materials"),
                                       ("two.yaml", [".:milk"], "two.yaml:6: it is not said into which liquid the material goes"),
                                       ("two.yaml", ["water=.:milk"], "two.yaml:6: liquids.water.viscosity_profile would count")):
            words = [word for one in arguments for word in ("--material", one)]
            self.assertIn(text, self.treacle("run", scene, *words, "--out", "out", code=2).stderr)
            self.assertFalse(os.path.exists(self.path("out")))


TWO = """schema_version: 1
title: A power law of a slumping block
scenes: [{name: slump, file: scene.yaml, set: ["liquids.syrup.rheology={law: power_law, exponent: 0.7}"]}]
parameters:
  - {name: consistency, key: liquids.syrup.viscosity, range: [2 Pa.s, 50 Pa.s], scale: log}
  - {name: exponent, key: liquids.syrup.rheology.exponent, range: [0.3, 1]}
experiments:
  - {name: block, masks: film, camera: front, from: 40 ms}
candidates:
  - {name: same}
  - {name: low, set: ["liquids.syrup.shapes.0.box.max=[0.03, 0.04]"]}
search: {evaluations: 8}
"""


class Next(Workplace):
    """Candidates of a study of two parameters."""

    def setUp(self):
        super().setUp()
        for name, text in (("scene.yaml", SCENE), ("study.yaml", TWO)):
            with open(self.path(name), "w") as file:
                file.write(text)
        self.treacle("run", "scene.yaml", "--set", "liquids.syrup.rheology={law: power_law, exponent: 0.6}", "--set", "output.interval=10 ms", "--out", "truth")
        self.treacle("film", "truth", "--out", "film", "--lead", 0, "--noise", 0)

    def test_candidates_are_ranked_by_the_band_and_any_film_narrows_it(self):
        done = self.treacle("next", "study.yaml", "--out", "out", "--rates", 1, 30)
        now = float(re.search(r"now ([0-9.]+) %", done.stdout).group(1))
        rows = [(name, float(width)) for name, width in re.findall(r"with (\S+) +([0-9.]+) %", done.stdout)]
        self.assertEqual({name for name, _ in rows}, {"same", "low"}, done.stdout)
        self.assertLess(rows[0][1], now)
        self.assertLessEqual(rows[0][1], rows[1][1])
        self.assertIn(f"film next: {rows[0][0]}", done.stdout)
        # All runs are there already: the same answer, and at once.
        again = self.treacle("next", "study.yaml", "--out", "out", "--rates", 1, 30)
        self.assertEqual(re.findall(r"with .*", again.stdout), re.findall(r"with .*", done.stdout))

        # A rheometer's curve takes the place of both parameters, and of the law of the scene.
        self.treacle("identify", "study.yaml", "--out", "out")
        with open(self.path("curve.csv"), "w") as file:
            file.write("shear rate [1/s],viscosity [Pa.s]\n" + "".join(f"{rate},{2 / rate + 9 * rate ** -0.4}\n" for rate in (0.1, 1, 3, 10, 30, 100, 300)))
        told = self.treacle("identify", "study.yaml", "--out", "out", "--compare-curve", "curve.csv").stdout
        self.assertRegex(told, r"\(measured curve\)  K 9\.?0* Pa s at 1/s, n 0\.6, yield stress 2 Pa  objective [0-9.]+")
        with open(self.path("out", "journal.jsonl")) as file:
            last = [line for line in map(json.loads, file) if "asked" in line][-1]
        with open(self.path("out", "runs", f"{last['asked']:04d}", "run", "effective.yaml")) as file:
            text = file.read()
        for line in ("viscosity: 9(.0+[0-9]*)? Pa s", "law: herschel_bulkley", "exponent: 0.6(0+[0-9]*)?", "yield_stress: (2(.0+[0-9]*)?|1.99+[0-9]*) Pa"):
            self.assertRegex(text, rf"(?m)^ +{line}$")

    def test_a_study_without_candidates_is_told_how_to_list_them(self):
        with open(self.path("study.yaml"), "w") as file:
            file.write(TWO.replace(TWO[TWO.index("candidates:"):TWO.index("search:")], ""))
        self.assertIn("candidates: [{name:", self.treacle("next", "study.yaml", "--out", "out", code=2).stderr)


class Fields(Workplace):
    """Velocity fields of PIV, of a rod that falls in a plane."""

    def setUp(self):
        super().setUp()
        self.write("rod.yaml", ROD)
        self.write("study.yaml", FIELDS)
        self.treacle("run", "rod.yaml", "--set", "domain.spacing=2 mm", "--set", "liquids.oil.viscosity=1.3", "--set", "output.interval=20 ms", "--out", "truth")
        self.treacle("piv", "truth", "--out", "fields", "--origin", 0.004, 0.004, 0, "--up", 0, 1, 0, "--size", 0.032, 0.052, "--step", 0.002, "--window", 0.004,
                     "--from", 0.03, "--to", 0.25, "--interval", 0.02, "--noise", 0.02, "--outliers", 0.05, "--track", "rod", "--track-noise", 5e-5)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def identified(self, out):
        with open(self.path(out, "report", "result.yaml")) as file:
            text = file.read()
        return float(re.search(r"value: ([0-9.e+-]+)", text).group(1)), text

    def test_a_free_rods_fields_tell_the_viscosity(self):
        self.assertRegex(self.treacle("check", "study.yaml").stdout, r"11 fields, 5049 vectors, \d+ compared, \d+ not measured, \d+ outliers dropped")
        done = self.treacle("identify", "study.yaml", "--out", "out")
        value, text = self.identified("out")
        # Five cells across the rod, where the fields have six: some 10 % of its drag.
        self.assertLess(abs(value / 1.3 - 1), 0.15, text)
        self.assertIn("proportional to its density", done.stdout)
        self.assertIn("well determined", text)
        self.assertEqual(sum(name.endswith(".svg") for name in os.listdir(self.path("out", "report"))), 4)

    def test_on_a_prescribed_path_a_slow_flow_does_not_tell_it(self):
        self.write("study.yaml", FIELDS.replace("noise: 0.3 mm/s}", "noise: 0.3 mm/s, ball: fields/track.csv}"))
        self.assertIn("needs search.rungs", self.treacle("identify", "study.yaml", "--out", "out", code=2).stderr)
        self.treacle("identify", "study.yaml", "--out", "out", "--set", "search.evaluations=4", "--set", "search.noise_runs=2", "--set",
                     "search.rungs=[2.5 mm, 2.2 mm]")
        self.assertIn("not identifiable", self.identified("out")[1])

    def test_bad_fields_are_told_before_anything_is_run(self):
        for old, new, text in (("origin: [4 mm", "origin: [40 mm", "outside of the scene's domain"),
                               ("noise: 0.3 mm/s}", "noise: 0.3 mm/s, ball: {track: fields/track.csv, body: rood}}", "did you mean rod?"),
                               ("noise: 0.3 mm/s}", "noise: 0.3 mm/s, ball: fields/track.csv}\n    time_zero: 0.1 s", "ball.track is at"),
                               ("fields/field_*", "fields/feld_*", "is not there"),
                               ("from: 0.04 s", "from: 0.3 s", "no field is between")):
            self.write("study.yaml", FIELDS.replace(old, new))
            self.assertNotEqual(FIELDS.replace(old, new), FIELDS)
            done = self.treacle("identify", "study.yaml", "--out", "out", code=2)
            self.assertIn(text, done.stderr)
            self.assertIn("study.yaml:", done.stderr)


class Identify(Workplace):
    def setUp(self):
        super().setUp()
        self.write("scene.yaml", SCENE)
        self.write("study.yaml", STUDY)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def film(self, viscosity):
        self.treacle("run", "scene.yaml", "--set", f"liquids.syrup.viscosity={viscosity}", "--set", "domain.spacing=8 mm", "--out", "truth")
        self.treacle("film", "truth", "--out", "film", "--rate", 25, "--lead", 0, "--codec", "lossless")

    def result(self, out):
        with open(self.path(out, "report", "result.yaml")) as file:
            text = file.read()
        value = float(re.search(r"value: ([0-9.e+-]+)", text).group(1))
        low, high = map(float, re.search(r"interval_90: \[([0-9.e+-]+) Pa.s, ([0-9.e+-]+)", text).groups())
        with open(self.path(out, "report", "index.html")) as file:
            page = file.read()
        return value, low, high, text, page[page.index("<h2>Trials"):]

    def opens_from_disk(self, report):
        """All that the page shows is beside it; a browser, where there is one, finds nothing missing."""
        with open(os.path.join(report, "index.html")) as file:
            page = file.read()
        self.assertNotIn("http", re.sub(r'xmlns="[^"]*"', "", page))
        shown = re.findall(r'(?:src|href)="([^"#]+)"', page)
        self.assertIn("block_rows.png", shown)
        for name in shown:
            self.assertTrue(os.path.exists(os.path.join(report, name)), name)
        browser = shutil.which("chromium")
        if browser:
            picture = self.path("report.png")
            told = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--window-size=1000,3000",
                                   f"--user-data-dir={self.path('browser')}", f"--screenshot={picture}", f"file://{report}/index.html"],
                                  capture_output=True, text=True, timeout=120).stderr
            self.assertNotIn("ERR_FILE_NOT_FOUND", told)
            self.assertGreater(os.path.getsize(picture), 50000, told)

    def ended(self, journal):
        """Numbers of the runs that have an outcome."""
        if not os.path.exists(journal):
            return []
        with open(journal) as file:
            return re.findall(r'"ended":(\d+)', file.read())

    def test_a_viscosity_is_found_and_the_same_on_other_lanes_and_after_a_kill(self):
        self.film("10 Pa.s")
        self.treacle("identify", "study.yaml", "--out", "one", "--set", "runs.lanes=1")
        value, low, high, text, trials = self.result("one")
        # The film has another spacing: a part in ten of the viscosity at six cells of height.
        self.assertLess(abs(value / 10 - 1), 0.15, text)
        self.assertTrue(low < value < high)
        report = os.listdir(self.path("one", "report"))
        self.assertIn("index.html", report)
        self.assertEqual(sum(name.endswith(".png") for name in report), 7)
        self.assertIn("block_contours.mp4", report)
        self.assertIn("block_rows.png", report)
        self.opens_from_disk(self.path("one", "report"))
        # Its result makes another scene's liquid the same.
        self.write("other.yaml", OTHER)
        self.treacle("run", "other.yaml", "--material", "one/report/result.yaml:syrup", "--set", "time.end=20 ms", "--out", "other")
        with open(self.path("other", "effective.yaml")) as file:
            self.assertEqual(re.search(r"^    viscosity: ([0-9.e+-]+) Pa s", file.read(), re.M).group(1), re.search(r"value: ([0-9.e+-]+)", text).group(1))
        with open(self.path("other", "manifest.json")) as file:
            told = json.load(file)["materials"][0]
        self.assertEqual((told["liquid"], told["material"], told["density [kg/m3]"]), ("honey", "syrup", 1400))
        self.assertIn("90 % interval", told["found"][0])
        self.compares_with_a_curve("one", text)
        # Killed when some runs are done, on four lanes, one of which speculates; the rest on two.
        process = self.start("identify", "study.yaml", "--out", "two", "--set", "runs.lanes=4")
        journal = self.path("two", "journal.jsonl")
        end = time.monotonic() + 120
        while time.monotonic() < end and process.poll() is None and len(self.ended(journal)) < 3:
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        done = len(self.ended(journal))
        self.treacle("identify", "study.yaml", "--out", "two", "--set", "runs.lanes=2")
        self.assertEqual(self.result("two")[3:], (text, trials))
        ended = self.ended(journal)
        self.assertGreaterEqual(done, 1)
        self.assertEqual(len(ended), len(set(ended)), "no finished run is repeated")

    def write_curve(self, law):
        self.write("curve.csv", "shear rate [1/s],viscosity [Pa.s]\n" + "".join(f"{rate},{law(rate)}\n" for rate in (0.1, 0.3, 1, 3, 10, 30, 100, 300)))

    def compares_with_a_curve(self, out, before):
        """A study that is done has one more run at a measured curve, which leaves the answer as it is."""
        def compared(*words):
            done = self.treacle("identify", "study.yaml", "--out", out, "--compare-curve", "curve.csv", *words)
            text = self.result(out)[3]
            for block in ("identified", "misfits", "trials", "materials"):
                self.assertEqual(*(re.search(rf"(?m)^{block}:.*(\n .*)*", one).group() for one in (before, text)))
            block = re.search(r"(?m)^compared_curve:(\n .*)*", text).group()
            return done.stdout, block, len(self.ended(self.path(out, "journal.jsonl")))

        def rows():
            with open(self.path(out, "report", "block_rows.png"), "rb") as file:
                return int.from_bytes(file.read(24)[20:], "big")

        def misfits(block):
            return map(float, re.search(r"name: block, unit: px, curve: ([0-9.e+-]+), answer: ([0-9.e+-]+)", block).groups())

        runs, height = len(self.ended(self.path(out, "journal.jsonl"))), rows()
        self.write_curve(lambda rate: 30)
        said, block, count = compared()
        self.assertEqual(count, runs + 1)
        law = dict(re.findall(r"(\w+): ([0-9.e+-]+)", re.search(r"fit: {(.*)}", block).group(1)))
        self.assertAlmostEqual(float(law["consistency"]), 30, 3)
        self.assertAlmostEqual(float(law["exponent"]), 1, 4)
        at_curve, at_answer = misfits(block)
        self.assertGreater(at_curve, 2 * at_answer) # three times the film's viscosity
        self.assertGreater(rows(), 1.3 * height)
        self.assertIn("(measured curve)", said)
        self.assertIn("did you mean syrup?", self.treacle("identify", "study.yaml", "--out", out, "--compare-curve", "sirup=curve.csv", code=2).stderr)
        self.assertIn("the run at the measured curve is", said)
        self.assertEqual(compared()[1:], (block, count), "done once")
        with open(self.path(out, "table.csv")) as file:
            self.assertNotIn("herschel", file.read())
        # Near to the film's: as well as the answer does, or nearly.
        self.write_curve(lambda rate: 10)
        at_curve, at_answer = misfits(compared()[1])
        self.assertLess(at_curve, 1.5 * at_answer + 0.1)
        # One that takes too long is reported, and so is a curve that no such law is near to.
        self.write_curve(lambda rate: 20)
        self.assertIn("timed out", compared("--set", "runs.time_limit=1 ms")[1])
        self.write_curve(lambda rate: 10 if rate < 5 else 1)
        said, block, last = compared()
        self.assertIn("no law of Herschel and Bulkley", block)
        self.assertEqual(last, count + 2)
        self.assertEqual(rows(), height)

    def test_bad_input_is_told_before_anything_is_run(self):
        self.film("10 Pa.s")
        listed = sorted(os.listdir(self.folder))
        for old, new, text in (("masks: film", "masks: flim", "neither silhouettes.csv nor film.csv"),
                               ("from: 40 ms", "from: 9 s", "no mask is between"),
                               ("camera: front", "camera: font", "neither a file nor a camera of the scene"),
                               ("key: liquids.syrup.viscosity", "key: liquids.syrup.viscositi", "viscositi"),
                               (STUDY[STUDY.index("  - {name: viscosity"):STUDY.index("search")],
                                "  - {key: liquids.syrup.density, range: [900, 1500]}\n" + STUDY[STUDY.index("experiments"):STUDY.index("measured")],
                                "silhouettes know the ratio"),
                               (STUDY[STUDY.index("experiments"):STUDY.index("measured")], "", "has no experiments"),
                               (STUDY[STUDY.index("parameters"):STUDY.index("experiments")], "", "has no parameters"),
                               ("range: [0.5 Pa.s, 200 Pa.s]", "range: [0.5 Pa.s, 200 Pa.s], start: 300 Pa.s", "must lie in the range")):
            self.write("study.yaml", STUDY.replace(old, new))
            self.assertNotEqual(STUDY.replace(old, new), STUDY)
            done = self.treacle("identify", "study.yaml", "--out", "out", code=2)
            self.assertIn(text, done.stderr)
            self.assertIn("study.yaml", done.stderr)
            self.assertEqual(sorted(os.listdir(self.folder)), listed, text)
        self.write("study.yaml", STUDY)
        self.treacle("identify", "study.yaml", "--set", "search.method=bracketin", code=2)
        words = ["--set", "search.objective=mismatch", "--set", "search.method=gauss_newton"]
        self.assertIn("search.objective = mismatch: must be displacements", self.treacle("identify", "study.yaml", *words, "--out", "out", code=2).stderr)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
