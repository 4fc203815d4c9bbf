#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Installs isoshade and builds programs against the copy, as a user does.

    install_test.py BUILD SOURCE [Installed.TEST]      of a build tree in which everything that is installed is built

ISOSHADE_KEEP=FOLDER keeps the files of the test there.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
HERE = pathlib.Path(__file__).resolve().parent
LAUNCHER = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []


def run(*command, ok=True, **options):
    """The output of a command, which must succeed, or with ok=False must fail."""
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          **options)
    if (done.returncode == 0) != ok:
        raise AssertionError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def configure(source, build, *definitions):
    return run("cmake", "-G", "Ninja", "-S", source, "-B", build, "-DCMAKE_BUILD_TYPE=Release", *LAUNCHER, *definitions)


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keep = os.environ.get("ISOSHADE_KEEP")
        cls.folder = pathlib.Path(keep or tempfile.mkdtemp(prefix="isoshade-install-"))
        if keep:
            shutil.rmtree(keep, ignore_errors=True)
        cls.prefix = cls.folder / "prefix"
        run("cmake", "--install", BUILD, "--prefix", cls.folder / "first")
        # Moved, so that nothing can depend on where it was installed.
        (cls.folder / "first").rename(cls.prefix)
        cls.libraries = next(cls.prefix.glob("lib*/**/isoshadeConfig.cmake")).parents[2]
        cls.command = cls.prefix / "bin/isoshade"
        # Without the source tree's paths, and with a cache of its own.
        cls.environment = {**os.environ, "LD_LIBRARY_PATH": str(cls.libraries), "XDG_CACHE_HOME": str(cls.folder / "cache")}

    @classmethod
    def tearDownClass(cls):
        if "ISOSHADE_KEEP" not in os.environ:
            shutil.rmtree(cls.folder)

    def test_libraries_export_only_their_interface(self):
        for name in "compiler", "runtime":
            [library] = self.libraries.glob(f"libisoshade_{name}.so.*.*.*")
            symbols = run("nm", "-D", "-C", "--defined-only", library).splitlines()
            exported = {line.split(" ", 2)[2] for line in symbols}
            # Instances of the standard library's templates are weak, and the same in every program.
            ours = {s for s in exported if not re.match(r"(vtable|typeinfo|typeinfo name|guard variable) for |.*\bstd::|operator ", s)}
            self.assertTrue(ours, name)
            inner = {s for s in ours if not re.match(r"isoshade::\w+(\[abi:cxx11\])?(\(|::(load|load_file|open|is_open|description|render|render_file|evaluate)(\[abi:cxx11\])?\()", s)}
            self.assertEqual(inner, set(), f"{name} exports what no header declares")

    def test_libraries_load_no_build_tree(self):
        for file in [*self.libraries.glob("libisoshade_*.so"), self.command]:
            dynamic = run("readelf", "-d", file)
            self.assertNotRegex(dynamic, "RPATH|RUNPATH", file)

    def test_command_finds_the_installed_library(self):
        added = self.prefix / "share/isoshade/library/only_here.json"
        added.write_text('{"isoshade": 1, "function": "only_here", "inputs": {"in": {"type": "float"}}, '
                         '"nodes": {"y": {"type": "add", "in1": "in", "in2": 1}}, "outputs": {"out": "y"}}')
        user = self.folder / "user.json"
        user.write_text('{"isoshade": 1, "function": "user", "inputs": {"in": {"type": "float"}}, '
                        '"nodes": {"y": {"type": "only_here", "in": "in"}}, "outputs": {"out": "y"}}')
        try:
            run(self.command, "compile", user, "-o", self.folder / "user", env=self.environment)
        finally:
            added.unlink()

    def test_manual_is_installed(self):
        manual = self.prefix / "share/doc/isoshade"
        for page in "README.md", "graphs/README.md", "docs/diagnostics.md":
            self.assertTrue((manual / page).is_file(), page)

    def test_programs_with_generated_code_and_with_the_libraries(self):
        build = self.folder / "programs"
        configure(HERE / "programs", build, f"-Disoshade_ROOT={self.prefix}")
        run("cmake", "--build", build)
        print(run(build / "two_effects", self.prefix / "share/isoshade", env=self.environment))
        output = run(build / "in_process", self.prefix / "share/isoshade/effects/cartoon.json", env=self.environment)
        self.assertIn("wrong.json:1:", output)
        self.assertIn(f"read {self.prefix}/share/isoshade/library/toon/", output)
        with_pkg_config = self.folder / "with_pkg_config"
        found = run("pkg-config", "--cflags", "--libs", "isoshade_compiler",
                    env={**os.environ, "PKG_CONFIG_PATH": str(self.libraries / "pkgconfig")}).split()
        run("c++", "-std=c++20", HERE / "programs/in_process.cpp", "-o", with_pkg_config, *found)
        self.assertEqual(run(with_pkg_config, env=self.environment), run(build / "in_process", env=self.environment))

    def test_an_edited_function_rebuilds_what_uses_it_and_nothing_else(self):
        source, build = self.folder / "rebuild", self.folder / "rebuild/build"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(rebuild LANGUAGES CXX)\n"
            f"find_package(isoshade CONFIG REQUIRED)\nadd_executable(rebuild main.cpp uses.cpp)\n"
            "target_link_libraries(rebuild m)\n"  # without keywords, as old projects do
            "isoshade_add_graph(rebuild uses.json)\nisoshade_add_graph(rebuild alone.json)\n")
        graph = ('{"isoshade": 1, "function": "NAME", "inputs": {"in": {"type": "float"}}, '
                 '"nodes": {"y": {NODE}}, "outputs": {"out": "y"}}')

        def write(name, node):
            (source / f"{name}.json").write_text(graph.replace("NAME", name).replace("NODE", node))

        write("helper", '"type": "multiply", "in1": "in", "in2": 2')
        write("uses", '"type": "helper.json", "in": "in"')
        write("alone", '"type": "add", "in1": "in", "in2": 1')
        (source / "main.cpp").write_text('#include "alone.h"\n#include <cstdio>\nfloat uses_at(float x);\n'
                                         'int main() { std::printf("%g %g\\n", isoshade::shaders::alone::alone(1.0f), uses_at(1)); }\n')
        (source / "uses.cpp").write_text('#include "uses.h"\nfloat uses_at(float x) { return isoshade::shaders::uses::uses(x); }\n')
        configure(source, build, f"-Disoshade_ROOT={self.prefix}")

        def steps():
            """What a build runs, one line each, without the progress."""
            lines = run("cmake", "--build", build).splitlines()
            return [re.sub(r"^\[\d+/\d+\] ", "", line) for line in lines if line.startswith("[")]

        self.assertEqual(len(steps()), 5)
        self.assertEqual(run(build / "rebuild"), "2 2\n")
        self.assertEqual(steps(), [])
        write("helper", '"type": "multiply", "in1": "in", "in2": 3')
        made = steps()
        self.assertEqual(run(build / "rebuild"), "2 3\n")
        self.assertEqual(len(made), 3, made)
        self.assertRegex(made[0], "Compiling uses to glsl,cpp")
        self.assertRegex(made[1], "uses.cpp.o")
        self.assertRegex(made[2], "Linking")
        # Another text, the same function: what includes the header is not compiled again.
        (source / "helper.json").write_text((source / "helper.json").read_text() + "\n")
        made = steps()
        self.assertLessEqual(len(made), 3, made)
        self.assertRegex(made[0], "Compiling uses to glsl,cpp")
        self.assertEqual(steps(), [])

    def test_added_as_a_folder_it_leaves_the_host_alone(self):
        build = self.folder / "host"
        configure(HERE / "host", build, f"-DISOSHADE={SOURCE}")
        # Some of isoshade's files and the host's own, all with the host's warnings as errors.
        objects = "isoshade/compiler/support/CMakeFiles/isoshade_support.dir"
        run("ninja", "-C", build, f"{objects}/visible.cpp.o", f"{objects}/leftovers.cpp.o",
            "CMakeFiles/host.dir/main.cpp.o")
        commands = (build / "compile_commands.json").read_text()
        [own] = re.findall(r'"command": "([^"]*) -c [^"]*host/main.cpp"', commands)
        flags = [word for word in own.split() if word.startswith("-") and word[:2] not in ("-I", "-D", "-o", "-c")]
        self.assertEqual(sorted(flags), sorted("-Wall -Wextra -Wconversion -Wshadow -Wold-style-cast -Wundef -Werror -O3 "
                                               "-std=gnu++23".split()))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
