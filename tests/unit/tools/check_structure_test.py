"""Each rule of tools/check_structure finds the fault that it is for, and a sound tree has none."""

import pathlib
import subprocess
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[3] / "tools/check_structure"


def findings(files):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        done = subprocess.run([TOOL, "--root", folder], capture_output=True, text=True)
    assert done.returncode == (1 if done.stdout else 0), done
    return done.stdout


class CheckStructure(unittest.TestCase):
    def assert_found(self, name, text, problem):
        self.assertIn(f"{name}:1: {problem}", findings({name: text}))

    def test_a_sound_tree_has_no_finding(self):
        self.assertEqual("", findings({
            "mpi/comm.cpp": "MPI_Barrier(comm);\n",
            "src/solve/a.cpp": '#include <petscksp.h>\n#include "mpi/comm.hpp"\nMPI_Comm group = x;\n',
            "src/io/b.cpp": '#include <hdf5.h>\n',
            "src/video/c.cpp": "#include <opencv2/core.hpp>\n// MPI_Send( is not for here\n",
            "src/sph/CMakeLists.txt": "treacle_library(sph PUBLIC treacle_solve treacle_scene treacle_mpi)\n",
            "tests/unit/io/t.cpp": "#include <hdf5.h>\n",
        }))

    def test_mpi_is_called_in_mpi_only(self):
        self.assert_found("src/solve/a.cpp", "MPI_Send(x);\n", "a call of MPI outside mpi")
        self.assert_found("src/sph/a.cpp", "MPI_Comm c;\n", "a handle of MPI outside mpi")

    def test_petsc_and_hypre_are_in_solve_only(self):
        self.assert_found("src/sph/a.hpp", "#include <petscmat.h>\n", "PETSc outside src/solve")
        self.assert_found("src/io/a.cpp", "#include <HYPRE.h>\n", "HYPRE outside src/solve")
        self.assert_found("src/io/a.cpp", "#include <_hypre_utilities.h>\n", "HYPRE outside src/solve")

    def test_hdf5_is_in_io_only(self):
        self.assert_found("src/app/a.cpp", "#include <hdf5.h>\n", "HDF5 outside src/io")
        self.assert_found("tests/unit/sph/a.cpp", "#include <hdf5.h>\n", "HDF5 outside src/io")

    def test_opencv_is_in_video_only(self):
        self.assert_found("src/app/a.cpp", "#include <opencv2/core.hpp>\n", "OpenCV outside src/video")

    def test_includes_point_down(self):
        self.assert_found("kokkos/a.hpp", '#include "mpi/comm.hpp"\n', "kokkos may not include mpi")
        self.assert_found("src/sph/a.cpp", '#include "grid/step.hpp"\n', "sph may not include grid")

    def test_rooms_include_those_before_them(self):
        cmake = {"src/sph/CMakeLists.txt": "treacle_module(sph HEADERS kokkos\n  ROOMS model pressure viscosity/operator viscosity\n  SOURCES step.cpp)\n"}
        down = {"src/sph/pressure/a.cpp": '#include "sph/model/b.hpp"\n', "src/sph/step.cpp": '#include "sph/viscosity/operator/c.hpp"\n',
                "src/sph/viscosity/d.cpp": '#include "sph/viscosity/operator/c.hpp"\n', "src/sph/model/b.hpp": '#include "sph/model/e.hpp"\n'}
        self.assertEqual("", findings(cmake | down))
        for name, text, problem in (
                ("src/sph/model/a.hpp", '#include "sph/pressure/b.hpp"\n', "model may not include pressure"),
                ("src/sph/viscosity/operator/a.hpp", '#include "sph/viscosity/b.hpp"\n', "viscosity/operator may not include viscosity"),
                ("src/sph/pressure/a.hpp", '#include "sph/step.hpp"\n', "pressure may not include what lies on top of sph"),
                ("src/sph/attic/a.hpp", "\n", "attic is not among the rooms")):
            self.assertIn(f"{name}:1: {problem}", findings(cmake | {name: text}))

    def test_rooms_are_not_crowded(self):
        self.assertEqual("", findings({f"src/io/a{number}.cpp": "\n" for number in range(25)}))
        self.assertIn("src/io:1: 26 sources in a folder", findings({f"src/io/a{number}.cpp": "\n" for number in range(26)}))

    def test_links_point_down(self):
        self.assert_found("src/scene/CMakeLists.txt", "treacle_library(scene PUBLIC treacle_sph)\n",
                          "scene may not link sph")
        self.assert_found("src/other/CMakeLists.txt", "treacle_library(other)\n",
                          "other has no place among the layers")

    def test_long_files_are_found(self):
        self.assertIn("601 lines", findings({"src/io/a.cpp": "\n" * 601}))
        self.assertEqual("", findings({"src/io/a.cpp": "\n" * 600}))

    def test_banned_words_are_found(self):
        word = "TO" + "DO"
        self.assert_found("inputs/a/README.md", f"{word}: later\n", f"{word}: do it or drop it")

    def test_names_that_were_given_up_are_found_in_code(self):
        self.assert_found("src/rigid/a.cpp", "void rub(Ledger& ledger);\n", "rub: write solve_friction")
        self.assertEqual("", findings({"src/rigid/a.cpp": "// rub\nvoid scrub();\n"}))

    def test_words_of_several_meanings_are_found_in_names(self):
        for name, text in (("src/sph/a.cpp", "int halo_place = 0;"), ("kokkos/a.hpp", "struct FaceShares {};"),
                           ("src/grid/body_shares.cpp", "")):
            self.assertIn("one word for each meaning", findings({name: text}), name)
        sound = {"src/sph/a.cpp": "std::holds_alternative<int>(replaced); // held in one place\nconst char* key = \"share\";\n"}
        self.assertEqual("", findings(sound))

    def test_documents_cite_files_that_are_there(self):
        self.assert_found("src/sph/README.md", "See `gone.cpp`.\n", "there is no gone.cpp")
        self.assert_found("src/sph/README.md", "See [it](gone.md#part).\n", "there is no gone.md")
        self.assertEqual("", findings({
            "src/sph/README.md": "`density.cpp`, `sph/density.cpp`, `../grid/mac.hpp`, [grid](../grid/README.md#a), "
                                 "[part](#part), [site](https://x.org/a)\n",
            "src/grid/README.md": "\n",
            "src/grid/mac.hpp": "\n",
            "src/sph/density.cpp": "\n",
        }))

    def test_readme_lists_only_folders_that_are_there(self):
        self.assertIn("README.md:3: there is no folder src/",
                      findings({"README.md": "```\nmpi/  ranks\nsrc/  rest\n```\n", "mpi/a.cpp": ""}))


if __name__ == "__main__":
    unittest.main()
