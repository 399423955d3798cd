#!/usr/bin/env python3
"""Runs the program as a user does: bad scenes get a message, commands do what is documented.

usage: cli_test.py PROGRAM MPIEXEC GROUP RANKS
"""
import csv
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from harness import environment_for

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "scenes")
BAD = os.path.join(SCENES, "bad")
COLUMN = os.path.join(SCENES, "column.yaml")
PROGRAM, MPIEXEC, RANKS = "", "", 1

# File in scenes/bad: what its message must name besides file and line.
BAD_SCENES = {
    "unknown_key": ["liquids.water.viscosty", "did you mean viscosity"],
    "duplicate_key": ["density", "twice"],
    "wrong_unit": ["liquids.water.density", "must be a density", "kg/m3"],
    "out_of_range": ["liquids.water.viscosity = -3 Pa s", "must be >= 0"],
    "missing_file": ["no_such_rabbit.ply", "--data"],
    "mesh_with_holes": ["open_box.obj", "not closed", "1 hole"],
    "liquid_in_solid": ["liquids.water", "bodies.post", "15 of its 80"],
    "outside_the_domain": ["liquids.water", "outside of the domain"],
    "no_particles": ["no liquid particle", "domain.spacing"],
    "too_much_memory": ["memory", "domain.spacing"],
    "not_yaml": ["is not YAML"],
    "several_problems": ["domain.spacing", "liquids.water.viscosity", "liquids.water.colour"],
    "massless_body": ["bodies.raft.density", "unless its mass is given"],
    "dfsph_raft": ["bodies.raft", "dfsph"],
    "balanced_iisph": ["method.pressure.wall_force", "solver: isph only"],
    "bounded_iisph": ["method.pressure.dirichlet", "solver: isph only"],
    "bounded_gamg": ["method.pressure.preconditioner", "complementarity"],
    "relaxed_cholesky": ["method.pressure.relaxation", "sor_jacobi"],
    "dfsph_liquids": ["differ in density or viscosity", "solver: dfsph"],
    "unknown_liquid": ["measurements", "wine"],
    "thin_body": ["bodies.raft", "thinner than domain.spacing"],
    "grid_thin_sheet": ["bodies.sheet", "thinner than domain.spacing", "pass through it"],
    "body_in_body": ["bodies.post overlaps bodies.raft", "0.02 m"],
    "body_in_wall": ["bodies.raft", "wall x_max"],
    "moving_plane": ["bodies.slope", "no end"],
    "keyframe_times": ["bodies.piston.keyframes", "increasing times"],
    "reserved_name": ["output.name = solid"],
    "unknown_field": ["presure", "velocity, pressure, liquid, density", "did you mean pressure"],
    "surface_tension": ["liquids.water.surface_tension", "not modelled"],
    "unlike_surface_tensions": ["liquids.oil.surface_tension differs from that of liquids.water", "none between liquids"],
    "no_surface_tension": ["liquids.water.surface_tension = 0", "must be > 0"],
    "capillary_step": ["time.step = ", "is above the limit of the surface tension, 0.00297"],
    "slip_length": ["domain.boundaries.y_min.slip", "needs a viscosity", "free_slip or no_slip"],
    "no_slip_length": ["domain.boundaries.y_min.slip_length", "has no effect", "slip is not slip_length"],
    "slip_of_the_laplacian": ["domain.boundaries.y_min.slip", "form: corrected"],
    "negative_region": ["liquids.honey.viscosity_regions", "must be >= 0", "honey is about 10 Pa s"],
    "missing_viscosity": ["liquids.paint.viscosity", "must be > 0 with a rheology"],
    "yield_of_carreau": ["liquids.paint.rheology.yield_stress", "belongs to herschel_bulkley"],
    "rheology_and_region": ["liquids.paint.viscosity_regions", "cannot go with a rheology"],
    "unsorted_profile": ["liquids.honey.viscosity_profile.points", "increasing coordinates"],
    "explicit_regions": ["liquids.honey", "needs the implicit viscosity"],
    "rheology_by_pairs": ["liquids.paint.rheology", "corrected or adjoint"],
    "inlet_in_solid": ["inlets.spout is inside bodies.block", "behind the opening"],
    "inlet_outside": ["inlets.spout reaches outside of the domain", "behind the opening"],
    "inlet_in_liquid": ["inlets.spout is where liquids.honey is at the start"],
    "grid_inlet_in_solid": ["inlets.spout is inside bodies.block", "a plug", "behind the opening"],
    "grid_inlet_outside": ["inlets.spout reaches outside of the domain", "a plug"],
    "grid_unlike_liquids": ["liquids.oil: another density", "cannot go with method.kind: grid"],
    "grid_skin_friction": ["domain.boundaries.y_min.skin_friction", "cannot go with method.kind: grid", "choose a slip"],
    "plane_spin_about_y": ["bodies.drum.angular_velocity = [0, 12, 0]", "about z alone", "the scene is plane", "write a number"],
    "plane_turn_about_x": ["rotation_axis = [1, 0]", "must be z", "the scene is plane"],
    "plane_motion_along_z": ["bodies.drum.velocity = [0, 0, 1]", "the scene is plane"],
    "plane_liquid_along_z": ["liquids.oil.velocity = [0, 0, 2]", "the scene is plane"],
    "plane_inlet_along_z": ["inlets.spout.disc.direction = [0, 0, -1]", "the scene is plane"],
    "tab": ["a tab stands in the indentation", "write blanks"],
    "sliding_free_slip_wall": ["boundaries.y_max.velocity = [1, 0]", "a free-slip wall takes nothing along", "no_slip"],
    "outward_wall": ["boundaries.y_max.velocity = [1, 0.5]", "must be 0 along y", "kinematic body"],
    "moving_open_side": ["boundaries.y_max.velocity", "the side is open and no wall"],
    "moving_periodic_side": ["boundaries.x_min.velocity", "the side is periodic and no wall"],
    "short_period": ["the period of 0.05 m in x is not above two support radii, 0.05 m", "lengthen the domain"],
    "lid_beyond_period": ["bodies.lid moves and is 0.200001 m long in x, more than the period of 0.2 m", "as long as the period"],
    "turning_lid": ["bodies.lid may turn", "locked"],
    "inlet_without_flow": ["inlets.spout.flow_rate", "must be > 0"],
    "inlet_backwards": ["inlets.spout.flow_rate = -1 l/s", "turn `direction` round"],
    "inlet_unknown_liquid": ["the liquid hony of spout is not among `liquids`"],
    "unknown_partner": ["the body wheal of axle is not among `bodies`", "`to` may be left out"],
    "self_joint": ["axle links wheel to itself"],
    "static_joint": ["the body post of axle is not dynamic"],
    "ball_axis": ["joints.axle.axis", "has no effect"],
    "tilted_hinge": ["joints.axle.axis", "must be z"],
    "slider_without_axis": ["joints.rail.axis", "must be given"],
    "held_body": ["bodies.wheel cannot move", "hold all six", "kind: static"],
    "locked_body": ["bodies.wheel cannot move", "locked", "kind: static"],
    "same_names": ["joints: the name axle stands twice"],
    "same_bodies": ["bodies: the name wheel stands twice"],
    "unreachable_residual": ["method.pressure.residual = 1e-16", "rounding"],
    "unreachable_density_error": ["method.pressure.density_error = 1e-20", "rounding"],
    "long_step": ["time.step", "viscosity"],
    "as_published_without_matrix": ["method.viscosity.form", "assembled: true"],
    "multigrid_without_matrix": ["method.viscosity.preconditioner", "assembled: true"],
    "bicgstab_without_matrix": ["method.viscosity.solver", "assembled: true"],
}

# Problems in one scene, where it is more than one.
PROBLEMS = {"several_problems": 3}

# The error of a bad scene comes before anything large is allocated: an empty program takes about 100 MB a rank.
MOST_MEMORY_KB = 300_000


def launch(arguments, ranks, **options):
    command = [PROGRAM, *map(str, arguments)]
    if ranks > 1:
        command = [MPIEXEC, "-n", str(ranks), *command]
    return subprocess.run(command, capture_output=True, text=True, timeout=240, **options)


def without_mpi(text):
    """Messages of the launcher, between rules of dashes, are not the program's; a group may stand open."""
    kept, inside = [], False
    for line in text.splitlines():
        if re.fullmatch(r"-{20,}", line):
            inside = not inside
        elif not inside and line.strip():
            kept.append(line)
    return kept


def marked_lines(path):
    with open(path) as file:
        return {number for number, line in enumerate(file, 1) if "# here" in line}


class Workplace(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="treacle_cli_")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def treacle(self, *arguments, ranks=None, code=0):
        done = launch(arguments, RANKS if ranks is None else ranks, cwd=self.folder, env=environment_for(code))
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}\n{done.stderr}")
        return done

    def refusal(self, *arguments, ranks=None):
        """Output of a command that must end with exit code 2 and print a message once, on rank 0, to stderr only."""
        done = self.treacle(*arguments, ranks=ranks, code=2)
        self.assertEqual(done.stdout, "")
        lines = without_mpi(done.stderr)
        self.assertTrue(lines, "no message")
        self.assertEqual(len(lines), len(set(lines)), f"said more than once: {lines}")
        return "\n".join(lines)


class Serial(Workplace):
    """Commands that need no run."""

    def test_every_bad_scene_has_a_case(self):
        files = {name[:-5] for name in os.listdir(BAD) if name.endswith(".yaml")}
        self.assertEqual(files, set(BAD_SCENES))

    def check_bad(self, command):
        for name, words in BAD_SCENES.items():
            with self.subTest(scene=name, command=command):
                path = os.path.join(BAD, name + ".yaml")
                extra = ["--out", self.path("result")] if command == "run" else []
                message = self.refusal(command, path, *extra)
                for word in words:
                    self.assertIn(word, message)
                places = [re.match(r".*" + name + r"\.yaml:(\d+): ", line) for line in message.splitlines()]
                self.assertNotIn(None, places, f"no file:line in {message}")
                self.assertEqual(len(places), PROBLEMS.get(name, 1), message)
                self.assertLessEqual({int(place[1]) for place in places}, marked_lines(path), message)
                # What memory is free changes from one moment to the next, and the ranks are named.
                if command == "check" and RANKS > 1 and name != "too_much_memory":
                    self.assertEqual(self.refusal(command, path, ranks=1), message)
                self.assertEqual(os.listdir(self.folder), [], "something was written")

    def test_check_refuses_every_bad_scene(self):
        if RANKS == 1:
            self.skipTest("on two ranks each scene is checked on one rank as well, and says the same")
        self.check_bad("check")

    def test_run_refuses_every_bad_scene_and_writes_nothing(self):
        self.check_bad("run")

    def test_a_scene_too_large_is_refused_at_once(self):
        start = time.monotonic()
        self.refusal("check", os.path.join(BAD, "too_much_memory.yaml"))
        self.assertLess(time.monotonic() - start, 60)  # about 1 s; making a billion particles takes minutes
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, MOST_MEMORY_KB)

    def test_an_override_is_checked_and_named(self):
        message = self.refusal("check", COLUMN, "--set", "liquids.water.viscosity=-1")
        self.assertIn("--set liquids.water.viscosity=-1", message)
        self.assertIn("must be >= 0", message)

    def test_a_missing_scene_is_named(self):
        self.assertIn("no_such.yaml", self.refusal("check", "no_such.yaml"))
        self.assertIn("no_such.yaml", self.refusal("run", "no_such.yaml"))

    def test_check_tells_counts_steps_and_numbers(self):
        out = self.treacle("check", COLUMN).stdout
        # 8 x 10 particles; sqrt(9.81 x 0.2) = 1.401 m/s; 1000 x 1.401 x 0.2 / 0.001 = 2.801e5
        for pattern in [r"liquid +80\n", r"1\.401 m/s", r"Reynolds number +2\.801e\+05", r"no warnings"]:
            self.assertRegex(out, pattern)
        self.assertEqual(os.listdir(self.folder), [])

    def test_check_tells_particles_and_mass_of_each_liquid(self):
        out = self.treacle("check", os.path.join(SCENES, "layers.yaml")).stdout
        # 6 x 6 x 4 and 10 x 6 x 6 particles of nearly 8 cm3.
        for pattern in [r"144 particles, 0\.11\d+ kg\n", r"360 particles, 2\.8\d+ kg\n", r"Atwood number +0\.8182"]:
            self.assertRegex(out, pattern)

    def test_check_warns_of_thin_liquid(self):
        out = self.treacle("check", COLUMN, "--set", "domain.spacing=8 cm").stdout
        self.assertRegex(out, r"warning: liquids\.water: 100 % of it is thinner than three spacings")

    def test_the_surface_tension_of_a_material_is_told(self):
        for command in [["check"], ["run", "--out", "told"]]:
            done = self.treacle(*command, COLUMN, "--set", "liquids.water.material=water")
            self.assertIn("does not model the surface tension of water", done.stdout + done.stderr)

    def test_a_risky_density_is_told_with_its_number(self):
        raft = os.path.join(SCENES, "raft.yaml")
        self.assertIn("no warnings", self.treacle("check", raft).stdout)
        light = self.treacle("check", raft, "--set", "bodies.raft.density=10").stdout
        self.assertIn("warning: bodies.raft has 0.01 times the density of water", light)
        layers = os.path.join(SCENES, "layers.yaml")
        self.assertIn("no warnings", self.treacle("check", layers).stdout)
        heavy = self.treacle("check", layers, "--set", "liquids.heavy.density=5000").stdout
        self.assertIn("warning: liquids: heavy has 50 times the density of light", heavy)

    def test_thin_bodies_are_told(self):
        thin = ["--set", "bodies.post.shape.box.max=[0.281, 0.1]"]
        for command in [["check"], ["run", "--out", "told"]]:
            done = self.treacle(*command, COLUMN, *thin)
            self.assertIn("too thin for a layer on each side", done.stdout + done.stderr)

    def test_check_takes_a_folder_and_draws_a_picture(self):
        os.mkdir(self.path("scene"))
        shutil.copy(COLUMN, self.path("scene", "scene.yaml"))
        self.treacle("check", "scene", "--picture", "start.png")
        with open(self.path("start.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_schema_knows_every_key_and_suggests(self):
        self.assertIn("domain.spacing", self.treacle("schema", "domain.spacing").stdout)
        schema = json.loads(self.treacle("schema", "--json").stdout)
        self.assertIn("liquids", schema["properties"])
        self.assertIn("did you mean domain.spacing", self.refusal("schema", "domain.spacin"))

    def test_materials_have_sources(self):
        out = self.treacle("materials").stdout
        self.assertRegex(out, r"(?m)^honey.* \d")

    def test_version_names_libraries(self):
        out = self.treacle("--version").stdout
        for word in ["treacle ", "sources", "Kokkos", "HDF5", "PETSc", "HYPRE", "MPI"]:
            self.assertIn(word, out)

    def test_help_of_every_command(self):
        for command in ["run", "resume", "check", "schema", "materials", "info", "export", "render"]:
            out = self.treacle(command, "--help").stdout
            self.assertIn("treacle " + command, out)
            self.assertNotIn("kokkos", out.lower())
        self.assertIn("Exit codes", self.treacle("--help").stdout)

    def test_command_line_errors_suggest(self):
        self.assertIn("did you mean render?", self.refusal("rendr"))
        self.assertIn("did you mean --overwrite?", self.refusal("run", COLUMN, "--overwrit"))
        self.assertIn("--wall-limit 3 kg", self.refusal("run", COLUMN, "--wall-limit", "3 kg"))
        self.assertIn("required", self.refusal("run"))
        self.assertIn("too many arguments: more", self.refusal("resume", "some", "more"))

    def test_what_is_no_run_is_refused(self):
        os.mkdir(self.path("empty"))
        for command in [["info"], ["render"], ["export", "--to", "ply"], ["resume"]]:
            self.assertIn("no effective.yaml", self.refusal(command[0], "empty", *command[1:]))
            self.assertRegex(self.refusal(command[0], "nowhere", *command[1:]), "no such")


class WithRun(Workplace):
    """What needs the results of a run; one is made and copied for each test."""

    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.mkdtemp(prefix="treacle_run_")
        done = launch(["run", COLUMN, "--out", os.path.join(cls.made, "column")], RANKS)
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.made)

    def setUp(self):
        super().setUp()
        shutil.copytree(os.path.join(self.made, "column"), self.path("column"))

    def listing(self):
        return sorted(os.path.relpath(os.path.join(folder, name), self.folder)
                      for folder, _, names in os.walk(self.folder) for name in names)

    def test_a_run_leaves_its_files(self):
        files = self.listing()
        for name in ["effective.yaml", "manifest.json", "steps.csv", "bodies.csv", "measurements.csv", "summary.json",
                     "frames/frame.hdf.series", "frames/solid_000000.hdf"]:
            self.assertIn(os.path.join("column", name), files)
        self.assertEqual(len([name for name in files if re.search(r"frame_\d+\.hdf$", name)]), 5)
        self.assertFalse([name for name in files if name.endswith(".tmp")])

    def test_measurements_start_with_what_the_scene_says(self):
        with open(self.path("column", "measurements.csv")) as file:
            first = next(csv.DictReader(file))
        # The column is 0.16 x 0.2 m; particles fill a per mille less than their cubes, as the kernel sums have it.
        self.assertAlmostEqual(float(first["front [m]"]), 0.16, delta=1e-9)
        self.assertAlmostEqual(float(first["height [m]"]), 0.2, delta=5e-4)
        self.assertEqual(float(first["dry [m]"]), 0)

    def test_an_existing_folder_is_refused_and_untouched(self):
        before = {name: os.stat(self.path(name)).st_mtime_ns for name in self.listing()}
        self.assertIn("--overwrite", self.refusal("run", COLUMN, "--out", "column"))
        self.assertEqual(before, {name: os.stat(self.path(name)).st_mtime_ns for name in self.listing()})
        self.treacle("run", COLUMN, "--out", "column", "--overwrite")

    def test_a_checkpoint_of_another_scene_is_refused(self):
        text = open(self.path("column", "effective.yaml")).read()
        with open(self.path("column", "effective.yaml"), "w") as file:
            file.write(text.replace("Small column", "Other column"))
        self.assertIn("another scene", self.refusal("resume", "column"))

    def test_a_run_stopped_by_the_clock_goes_on(self):
        self.treacle("run", COLUMN, "--out", "short", "--wall-limit", "1 us", code=5)
        self.assertRegex(self.treacle("info", "short").stdout, r"ended +stopped")
        self.treacle("resume", "short")
        self.assertRegex(self.treacle("info", "short").stdout, r"ended +finished")

    def test_info_tells_what_files_hold(self):
        out = self.treacle("info", "column").stdout
        for pattern in ["Small column", "frames: 5, from 0 to 0.04 s", "velocity \\[m/s\\]", r"ended +finished"]:
            self.assertRegex(out, pattern)
        out = self.treacle("info", "column/frames/frame_000000.hdf").stdout
        self.assertRegex(out, r"particles +80\n")
        self.assertRegex(out, r"x \[m\] +0\.01 to 0\.15\n")
        self.assertRegex(out, r"velocity \[m/s\] +0 ")
        checkpoint = sorted(os.listdir(self.path("column", "checkpoints")))[-1]
        out = self.treacle("info", "column/checkpoints/" + checkpoint).stdout
        self.assertRegex(out, r"liquid/position +80 rows")
        self.assertRegex(out, r"checksums +right")

    def test_info_shows_a_broken_checkpoint(self):
        folder = self.path("column", "checkpoints")
        path = os.path.join(folder, sorted(os.listdir(folder))[-1])
        os.truncate(path, os.path.getsize(path) // 2)
        self.assertRegex(self.treacle("info", "column").stdout, os.path.basename(path) + " broken")

    def test_export_writes_every_particle(self):
        self.treacle("export", "column", "--to", "csv", "--frames", "0:-1:2")
        self.assertEqual(sorted(os.listdir(self.path("column", "exports"))),
                         self.expected_names(range(0, 5, 2), "csv"))
        first = self.path("column", "exports", self.expected_names([0], "csv")[0])
        lines = open(first).read().splitlines()
        self.assertEqual(len(lines), 81)
        self.assertIn("velocity_x [m/s]", lines[0])
        self.treacle("export", "column/frames/solid_000000.hdf", "--to", "ply", "--out", "elsewhere")
        self.assertEqual(os.listdir(self.path("elsewhere")), ["solid_000000.ply"])

    def expected_names(self, places, ending):
        with open(self.path("column", "frames", "frame.hdf.series")) as file:
            names = [entry["name"] for entry in json.load(file)["files"]]
        return sorted(names[place][:-3] + ending for place in places)

    def test_export_of_the_surface_writes_a_file_a_frame_and_an_index(self):
        said = self.treacle("export", "column", "--to", "surface", "--frames", "0:1", "--out", "meshes").stdout
        files = sorted(os.listdir(self.path("meshes")))
        self.assertEqual(len(files), 3, files)
        self.assertTrue(files[0].endswith("_surface.ply.series"), files)
        with open(self.path("meshes", files[1]), "rb") as file:
            head = file.read(2000)
        self.assertIn(b"property float velocity_x", head)
        pieces = int(re.search(r"pieces (\d+)", said).group(1))
        self.assertEqual(pieces, 1)
        for form, count in (("vtp", 4), ("obj", 3)):
            self.treacle("export", "column", "--to", "surface", "--format", form, "--frames", "0:1", "--out", form)
            self.assertEqual(len(os.listdir(self.path(form))), count)

    def test_export_of_the_surface_refuses_what_it_cannot_do(self):
        self.assertIn("ply, obj and vtp", self.refusal("export", "column", "--to", "surface", "--format", "stl"))
        self.assertIn("--to surface", self.refusal("export", "column", "--to", "ply", "--format", "obj"))
        self.assertIn("single frame", self.refusal("export", "column/frames/solid_000000.hdf", "--to", "surface"))

    def test_export_refuses_what_is_not_there(self):
        self.assertIn("ply, vtp and csv", self.refusal("export", "column", "--to", "obj"))
        self.assertIn("no frame 9", self.refusal("export", "column", "--to", "csv", "--frames", "9"))
        self.assertIn("no range", self.refusal("export", "column", "--to", "csv", "--frames", "a:b"))
        self.assertFalse(os.path.exists(self.path("column", "exports")))

    def test_render_draws_pictures_and_a_movie(self):
        self.treacle("render", "column")
        names = sorted(os.listdir(self.path("column", "pictures")))
        self.assertEqual(len([name for name in names if name.endswith(".png")]), 5)
        self.assertEqual(len([name for name in names if name.startswith("side_speed.")]), 1)

    def test_pictures_do_not_depend_on_the_number_of_ranks(self):
        for ranks in [1, RANKS + 1]:
            self.treacle("render", "column", "--out", f"by_{ranks}", "--no-movie", "--frames", "2:", ranks=ranks)
        for name in os.listdir(self.path("by_1")):
            with open(self.path("by_1", name), "rb") as one, open(self.path(f"by_{RANKS + 1}", name), "rb") as other:
                self.assertEqual(one.read(), other.read(), name)
        self.assertEqual(len(os.listdir(self.path("by_1"))), 3)

    def test_render_refuses_what_is_not_there(self):
        self.assertIn("did you mean pressure?", self.refusal("render", "column", "--field", "presure"))
        self.assertIn("there are side, automatic", self.refusal("render", "column", "--camera", "top"))
        self.assertIn("--size", self.refusal("render", "column", "--size", "10by10"))
        self.assertIn("--range", self.refusal("render", "column", "--range", "3:1"))
        self.assertFalse(os.path.exists(self.path("column", "pictures")))

    def test_a_run_without_frames_has_nothing_to_draw(self):
        self.treacle("run", COLUMN, "--out", "none", "--set", "output.interval=0")
        self.assertIn("output.interval", self.refusal("render", "none"))
        self.assertIn("frames: none", self.treacle("info", "none").stdout)

    def test_frames_come_at_the_times_that_are_listed(self):
        self.treacle("run", COLUMN, "--out", "listed", "--set", "output.interval=0", "--set", "output.times=[7 ms, 2.5 ms]", "--set", "time.end=10 ms")
        with open(self.path("listed", "frames", "frame.hdf.series")) as series:
            times = [entry["time"] for entry in json.load(series)["files"]]
        self.assertEqual(len(times), 4)
        for time, expected in zip(times, (0, 2.5e-3, 7e-3, 10e-3)):
            self.assertAlmostEqual(time, expected, delta=1e-12)
        self.assertIn("output.times", self.refusal("check", COLUMN, "--set", "output.times=[-1 ms]"))

    def test_an_unused_petsc_option_is_told(self):
        done = self.treacle("run", COLUMN, "--out", "options", "--petsc", "-presure_ksp_rtol 1e-9")
        self.assertIn("-presure_ksp_rtol", done.stderr)


class Alone(unittest.TestCase):
    """The program given is lonely_error: rank 1 throws while rank 0 blocks."""

    def test_an_error_on_one_rank_ends_all(self):
        done = launch([], 2)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("rank 1 alone: here: something; because.", done.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    PROGRAM, MPIEXEC, group, RANKS = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
    unittest.main(argv=[sys.argv[0], group, *sys.argv[5:]])
