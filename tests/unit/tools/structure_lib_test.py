"""What tools/structure_lib finds in small trees: comments, tags, names, declarations, functions, places, loops."""

import pathlib
import shutil
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
sys.path.insert(0, str(TOOLS))

from structure_lib import declarations, functions, loops, places, sources, tags, vocabulary, words  # noqa: E402


class StructureLib(unittest.TestCase):
    def tree(self, files):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        root = pathlib.Path(temporary.name)
        for name, text in {"src/a/a.cpp": "", "kokkos/k.hpp": "", "mpi/m.hpp": "", **files}.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return root

    def test_neighbouring_lines_are_one_comment_and_strings_are_none(self):
        text = '// One\n// comment.\nint a; // behind\nauto s = "// none";\n  // Two.\n'
        self.assertEqual([(1, "One comment."), (5, "Two.")], [(one.line, one.text) for one in sources.comments(text)])
        self.assertEqual([1, 2, 3, 5], [number for number, _ in sources.comment_text(text)])

    def test_code_has_no_comments_and_keeps_its_lines(self):
        self.assertEqual("int a;  \n\nb = 1'000;", sources.code("int a; /* c */ // d\n// e\nb = 1'000;"))
        self.assertEqual("f();", sources.code('f("a // b");', strings=False))

    def test_openings_without_a_noun_are_found(self):
        root = self.tree({"src/a/b.hpp": "// What is left.\nint a;\n// The rest.\nint b;\n\n// Whatever it is.\n"})
        count, found = words.without_a_noun(root)
        self.assertEqual((3, ["src/a/b.hpp:1: What is left."]), (count, found))

    def test_tags_have_a_row_and_a_source(self):
        table = "| tag | formula |\n|---|---|\n| S1 | x |\n| S2, S3 | y |\n| (S4t) | z |\n\n| S9 | no tag |\n"
        found = tags.check(self.tree({"src/a/README.md": table, "src/a/b.cpp": "// (S1)-(S3)\nf(S4); // (S5) and (S)\n"}))
        self.assertEqual(4, found.rows)
        self.assertEqual(["(S4t) of src/a/README.md:5"], found.without_source)
        self.assertEqual(["(a.S5), 1 times, first src/a/b.cpp:2"], found.without_row)

    def test_tags_of_two_modules_are_found_unless_they_name_theirs(self):
        table = "| tag | formula |\n|---|---|\n| {} | x |\n"
        same = tags.check(self.tree({"src/a/README.md": table.format("R1"), "src/b/README.md": table.format("R1")}))
        self.assertEqual(1, len(same.twice))
        named = tags.check(self.tree({"src/a/README.md": table.format("(a.R1)"), "src/b/README.md": table.format("(b.R1)"),
                                      "src/a/x.cpp": "// (R1)\n", "src/b/x.cpp": "// (b.R1)\n"}))
        self.assertEqual([], named.lines())

    def test_names_are_whole_words_of_code_in_their_folder(self):
        text = "// Quad\nQuad a; Quadric b;\nint slack;\n"
        self.assertEqual([(2, "Quad")], vocabulary.names_in(text, "src/sph/a.hpp", {"Quad", "slack"}))
        self.assertEqual([(2, "Quad"), (3, "slack")], vocabulary.names_in(text, "src/grid/a.hpp", {"Quad", "slack"}))

    def test_parameters_are_counted(self):
        for signature, count in (("()", 0), ("(void)", 0), ("(int a)", 1), ("(std::pair<int, int> a, const double b[3] = {1, 2})", 2),
                                 ("(const std::function<double(int, int)>& f, int b) const", 2)):
            self.assertEqual(count, functions.count_parameters(signature), signature)

    @unittest.skipUnless(shutil.which("ctags"), "needs universal-ctags")
    def test_declarations_without_a_comment_are_found(self):
        text = ("// A scene.\nstruct Scene {\n    int count;\n    double spacing;\n\n    int bare;\n    int told; // [kg]\n\n    // Local.\n"
                "    void f();\n    void g();\n\nprivate:\n    int hidden_;\n};\n\nvoid bare_too(int a);\n")
        count = declarations.count(self.tree({"src/a/b.hpp": text}))
        names = [line.split(": ")[1] for line in count.bare]
        self.assertEqual((["bare_too", "spacing", "bare"], 8), (names, count.all))
        self.assertEqual(["src/a/b.hpp:4: spacing"], count.numbers)

    @unittest.skipUnless(shutil.which("ctags"), "needs universal-ctags")
    def test_functions_are_measured(self):
        sizes = functions.sizes(self.tree({"src/a/b.cpp": "int f() { return 1; }\n\nint g(int a) {\n    return a;\n}\n"}))
        self.assertEqual([("g", 3, 1), ("f", 1, 0)], [(one.name, one.lines, one.parameters) for one in sizes.functions])

    def test_places_name_files_and_what_is_in_them(self):
        document = "## Where things are\n\n| question | path |\n|---|---|\n| where | `a.cpp`: `{}` → `{}` |\n"
        for symbol, file, faults in (("run", "k.hpp", []), ("walk", "k.hpp", ["no walk in a.cpp"]), ("run", "gone.hpp", ["no file gone.hpp"])):
            root = self.tree({"CONTRIBUTING.md": document.format(symbol, file), "src/a/a.cpp": "void run();\n"})
            entry, = places.entries(root)
            self.assertEqual([f"CONTRIBUTING.md:5: {fault}" for fault in faults], places.faults(root, entry))

    def test_loops_of_kernels_and_over_few_things_are_none_of_the_host(self):
        few = ("int k = 0; k < 3; ++k", "int a = 0; a < grid.dimensions; ++a", "std::size_t b = 0; b < bodies.size(); ++b",
               "Index k = offsets[i]; k < offsets[i + 1]; ++k", "auto* array : {&one, &other}", "const auto& inlet : setup.inlets", ";;")
        many = ("int i = 0; i < particles.store.owned(); ++i", "Index i = 0; i < rows; ++i", "std::size_t i = 0; i < z.size(); ++i",
                "double& value : z", "std::size_t i = rows; i-- > 0;",
                "int r = 0; r < rows() && bodies > 0; ++r", "int i = 0; i < 3 * n; ++i", "const Index column : halo.columns()", "Index k = 0; k < offsets[rows_]; ++k")
        for head in few + many:
            text = f"void f() {{ for ({head}) g(); }}"
            self.assertEqual([head] if head in many else [], [found for _, found in loops.host_loops(text)], head)
            for kernel in (f"KOKKOS_INLINE_FUNCTION {text}", f"void f() {{ run(KOKKOS_LAMBDA(int r) {{ {text} }}); }}"):
                self.assertEqual([], loops.host_loops(kernel), head)

    def test_a_nest_of_loops_is_one_and_what_stands_behind_a_kernel_is_seen(self):
        nest = "for (int i = 0; i < rows; ++i) { for (int j = 0; j < rows; ++j) g(i, j); }"
        self.assertEqual(1, len(loops.host_loops(f"void f() {{ {nest} }}")))
        self.assertEqual(2, len(loops.host_loops(f"void f() {{ for (int k = 0; k < 3; ++k) {{ {nest} {nest} }} }}")))
        kernel = "Kokkos::parallel_for(n, KOKKOS_LAMBDA(int i) { for (int k = 0; k < rows; ++k) g(i, k); });"
        self.assertEqual(1, len(loops.host_loops(f"void f() {{ {kernel} for (int i = 0; i < rows; ++i) h(i); }}")))

    @unittest.skipUnless(shutil.which("ctags"), "needs universal-ctags")
    def test_loops_have_the_name_of_the_function_around_them(self):
        root = self.tree({"src/sph/a.cpp": "// for (one)\nvoid A::f() {\n    g([&](int n) {\n        for (int i = 0; i < n; ++i) h(i);\n    });\n}\n"})
        self.assertEqual([("src/sph/a.cpp", 4, "A::f", "int i = 0; i < n; ++i")],
                         [(one.path, one.line, one.function, one.head) for one in loops.find(root)])


if __name__ == "__main__":
    unittest.main()
