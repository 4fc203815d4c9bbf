#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Installs isoshade and builds programs against the copy, as a user does.

    install_test.py BUILD SOURCE [Installed.TEST]      of a build tree in which everything that is installed is built

ISOSHADE_KEEP=FOLDER keeps the files of the test there.
"""

import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

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


def pixels_of_png(path):
    """Width, height, and the bytes of red, green, blue and alpha of a PNG file of 8 bits."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert (depth, color) == (8, 6), "not 8 bits of RGBA"
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    rows, stride, above, pixels = zlib.decompress(packed), 4 * width, bytes(4 * width), b""
    for y in range(height):
        kind, row = rows[y * (stride + 1)], bytearray(rows[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = (row[i - 4], above[i], above[i - 4]) if i >= 4 else (0, above[i], 0)
            guess = left + up - corner
            nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            row[i] = row[i] + (0, left, up, (left + up) // 2, nearest)[kind] & 255
        above = row
        pixels += row
    return width, height, pixels


def has_vulkan():
    return not re.search(r"^ISOSHADE_VULKAN:BOOL=(OFF|0|FALSE)$", (BUILD / "CMakeCache.txt").read_text(), re.MULTILINE)


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

    # The scene that bound_by_reflection draws.
    BOX = """{"isoshade": 1, "scene": "box", "size": [480, 360], "background": [0.02, 0.025, 0.035, 0],
      "camera": {"position": [1.2, 1.1, 1.9], "target": [0, 0, 0], "fov": 36},
      "lights": {"a": {"type": "directional", "direction": [-0.5, -0.8, -0.6], "color": [0.9, 0.8, 0.7]},
                 "b": {"type": "directional", "direction": [0.7, -0.2, -0.7], "color": [0.2, 0.3, 0.5]}},
      "objects": {"box": {"mesh": "box", "effect": "EFFECT", "transform": {"rotate": [0, -10, 0]}}}}"""

    @unittest.skipUnless(has_vulkan(), "isoshade is built without Vulkan")
    def test_what_is_bound_by_reflection_is_close_to_the_picture_of_the_contract(self):
        build = self.folder / "programs"
        configure(HERE / "programs", build, f"-Disoshade_ROOT={self.prefix}")
        run("cmake", "--build", build, "--target", "bound_by_reflection")
        scene, drawn, expected = (self.folder / name for name in ("box.json", "drawn.ppm", "expected.png"))
        materials = self.prefix / "share/isoshade/materials"
        # The share of pixels that may differ by more than 1/255, and how much they may: colours of mip levels are rounded to
        # 8 bits, and a step of every_type may lie at the middle of a pixel.
        for effect, settings, far, most in (
                (materials / "textured.json", {"tiles": "2,2"}, 0.02, 3),
                (materials / "textured.json", {"color": "0.2,0.9,0.4"}, 0.02, 3),
                (materials / "cook_torrance.json", {"metallic": "0.5", "roughness": "0.2"}, 1e-4, 2),
                (HERE / "programs/every_type.json", {}, 1e-4, 32),
                (HERE / "programs/every_type.json", {"shell": "false", "choice": "0", "steps": "3"}, 1e-4, 32)):
            with self.subTest(effect=effect.stem, settings=settings):
                scene.write_text(self.BOX.replace("EFFECT", str(effect)))
                run(self.command, "--allow-outside", "render", scene, "-o", expected, env=self.environment,
                    *[word for name, value in settings.items() for word in ("--set", f"{name}={value}")])
                said = run(build / "bound_by_reflection", effect.stem, drawn, env=self.environment,
                           *[f"{name}=[{value}]" if "," in value else f"{name}={value}" for name, value in settings.items()])
                width, height, wanted = pixels_of_png(expected)
                head, seen = f"P6\n{width} {height}\n255\n".encode(), drawn.read_bytes()
                self.assertTrue(seen.startswith(head))
                seen = seen[len(head):]
                differences = [max(abs(seen[3 * i + c] - wanted[4 * i + c]) for c in range(3)) for i in range(width * height)]
                mean, largest = sum(differences) / len(differences), max(differences)
                distant = sum(difference > 1 for difference in differences)
                print(f"{effect.stem} {settings}: mean difference {mean:.3f} / 255, largest {largest} / 255, {distant} pixels "
                      f"differ by more than 1 / 255; {said.strip()}")
                covered = sum(alpha != 0 for alpha in wanted[3::4])
                self.assertEqual(said, f"{effect.stem} covers {covered} of {width * height} pixels\n")
                self.assertGreater(covered, width * height // 4)
                self.assertLess(mean, 0.5)
                self.assertLessEqual(largest, most)
                self.assertLessEqual(distant, far * width * height)

    def test_cmake_names_every_file_that_compile_writes(self):
        source, build = self.folder / "names", self.folder / "names/build"
        source.mkdir()
        documents = [self.prefix / "share/isoshade" / name for name in
                     ("materials/cook_torrance.json", "effects/cartoon.json", "effects/leaves.json", "effects/height_fog.json", "library/brdf/ggx_d.json")]
        lines, expected = "", {}
        for wrapper, languages in (("none", "glsl cpp glsl-es"), ("forward", "glsl glsl-es spirv"), ("isoshade", "glsl cpp spirv")):
            lines += f"add_library({wrapper} INTERFACE)\n"
            for document in documents[:4] if wrapper == "forward" else documents:
                lines += f"isoshade_add_graph({wrapper} {document} WRAPPER {wrapper} TARGETS {languages})\n"
            folder = build / f"{wrapper}.isoshade" / (wrapper if wrapper != "none" else "")
            lines += (f"get_target_property(files {wrapper} ISOSHADE_FILES)\n"
                      f'file(WRITE ${{CMAKE_BINARY_DIR}}/{wrapper}.txt "${{files}}")\n')
            expected[wrapper] = folder
        (source / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(names LANGUAGES NONE)\n"
                                               "find_package(isoshade CONFIG REQUIRED)\n" + lines)
        configure(source, build, f"-Disoshade_ROOT={self.prefix}")
        run("cmake", "--build", build, "--target", *expected)
        for wrapper, folder in expected.items():
            named = {pathlib.Path(file) for file in (build / f"{wrapper}.txt").read_text().split(";")}
            written = {file for file in folder.iterdir() if file.is_file() and file.suffix != ".d"}
            self.assertEqual(named, written, wrapper)

    def test_cmake_says_what_is_wrong_with_a_graph(self):
        source = self.folder / "wrong"
        source.mkdir()
        effect = self.prefix / "share/isoshade/materials/textured.json"
        function = self.prefix / "share/isoshade/library/brdf/ggx_d.json"
        texts = {"text.json": "no JSON",
                 "scene.json": '{"isoshade": 1, "scene": "s"}',
                 "unnamed.json": '{"isoshade": 1, "effect": 3}',
                 "without_passes.json": '{"isoshade": 1, "effect": "e"}',
                 "based.json": '{"isoshade": 1, "effect": "e", "extends": "nowhere.json"}',
                 "unnamed_pass.json": '{"isoshade": 1, "effect": "e", "passes": [{}]}',
                 "long.json": '{"isoshade": 1, "effect": "e", "passes": [{"name": "' + 200 * "p" + '"}]}'}
        for name, text in texts.items():
            (source / name).write_text(text)
        for arguments, message in (
                (f"{effect} TARGETS spirv", "there is no spirv with WRAPPER none; there are glsl, cpp, glsl-es"),
                (f"{effect} WRAPPER forward TARGETS cpp", "there is no cpp with WRAPPER forward; there are glsl, glsl-es, spirv"),
                (f"{effect} WRAPPER isoshade TARGETS glsl-es", "there is no glsl-es with WRAPPER isoshade"),
                (f"{effect} WRAPPER deferred", "there is no wrapper deferred; there are none, forward and isoshade"),
                (f"{effect} WRAPPER", "unknown or incomplete arguments WRAPPER"),
                (f"{effect} TARGET spirv", "unknown or incomplete arguments TARGET;spirv"),
                (f"{function} WRAPPER forward", "is a function, which has no vertices and pixels for WRAPPER forward"),
                ("missing.json", "missing.json"),
                ("text.json", "is not a document of isoshade"),
                ("scene.json", "is not an effect, a post or a function"),
                ("unnamed.json", '"effect" in'),
                ("without_passes.json WRAPPER forward", "has no passes"),
                ("based.json WRAPPER forward", "which does not exist"),
                ("unnamed_pass.json WRAPPER forward", '"passes.0.name" in'),
                ("long.json WRAPPER isoshade", "are too long for names of files")):
            with self.subTest(arguments):
                (source / "CMakeLists.txt").write_text(
                    "cmake_minimum_required(VERSION 3.25)\nproject(wrong LANGUAGES NONE)\nfind_package(isoshade CONFIG REQUIRED)\n"
                    f"add_library(wrong INTERFACE)\nisoshade_add_graph(wrong {arguments})\n")
                said = run("cmake", "-S", source, "-B", source / "build", f"-Disoshade_ROOT={self.prefix}", ok=False)
                self.assertIn(message, " ".join(said.split()))

    def test_cmake_compiles_for_fixed_values(self):
        source, build = self.folder / "fixed", self.folder / "fixed/build"
        source.mkdir()
        (source / "glow.json").write_text(
            '{"isoshade": 1, "effect": "glow", "parameters": {"power": {"type": "float", "value": 1}, '
            '"tint": {"type": "color3", "value": [1, 1, 1]}}, '
            '"nodes": {"c": {"type": "multiply", "in1": "tint", "in2": "power"}}, "passes": [{"name": "base", "color": "c"}]}')
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(fixed LANGUAGES NONE)\nfind_package(isoshade CONFIG REQUIRED)\n"
            "add_library(dim INTERFACE)\n"
            "isoshade_add_graph(dim glow.json TARGETS glsl PREFIX dim SET power=0.5 tint=0.25,0.5,1)\n")
        configure(source, build, f"-Disoshade_ROOT={self.prefix}")
        run("cmake", "--build", build, "--target", "dim")
        parameters = json.loads((build / "dim.isoshade/glow.json").read_text())["parameters"]
        self.assertEqual([parameter["fixed"] for parameter in parameters], [0.5, [0.25, 0.5, 1]])

    def test_an_edited_function_makes_the_spirv_of_a_wrapper_again(self):
        source, build = self.folder / "spirv", self.folder / "spirv/build"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(spirv LANGUAGES NONE)\nfind_package(isoshade CONFIG REQUIRED)\n"
            "add_library(glow INTERFACE)\nisoshade_add_graph(glow glow.json WRAPPER forward TARGETS glsl spirv)\n"
            "foreach(kind GLSL SPIRV)\n  get_target_property(files glow ISOSHADE_${kind})\n"
            '  file(WRITE ${CMAKE_BINARY_DIR}/${kind}.txt "${files}")\nendforeach()\n')
        function = source / "half.json"
        function.write_text('{"isoshade": 1, "function": "half", "inputs": {"in": {"type": "float"}}, '
                            '"nodes": {"y": {"type": "multiply", "in1": "in", "in2": 0.5}}, "outputs": {"out": "y"}}')
        graph = ('{"isoshade": 1, "effect": "glow", "parameters": {"power": {"type": "float", "value": 1}}, '
                 '"nodes": {"y": {"type": "half.json", "in": "power"}, "c": {"type": "convert", "in": "y", "to": "color3"}}, '
                 '"passes": [{"name": "base", "color": "c"}]}')
        (source / "glow.json").write_text(graph)
        configure(source, build, f"-Disoshade_ROOT={self.prefix}")

        def files(kind):
            return [pathlib.Path(file) for file in (build / f"{kind}.txt").read_text().split(";")]

        def build_all():
            return run("cmake", "--build", build, "--target", "glow")

        build_all()
        self.assertEqual([file.name for file in files("GLSL")], ["glow.vert", "glow.frag"])
        self.assertEqual([file.name for file in files("SPIRV")], ["glow.vert.spv", "glow.frag.spv"])
        vertex, fragment = (file.read_bytes() for file in files("SPIRV"))
        self.assertEqual(fragment[:4], struct.pack("<I", 0x07230203))
        self.assertIn("no work to do", build_all())
        function.write_text(function.read_text().replace("0.5", "0.25"))
        self.assertIn("Compiling glow to glsl,spirv", build_all())
        self.assertEqual(files("SPIRV")[0].read_bytes(), vertex)
        self.assertNotEqual(files("SPIRV")[1].read_bytes(), fragment)
        self.assertIn("no work to do", build_all())
        # Another pass: the names of the files follow.
        (source / "glow.json").write_text(graph.replace('"passes": [', '"passes": [{"name": "first", "color": "c"}, '))
        build_all()
        self.assertEqual([file.name for file in files("SPIRV")], ["glow.first.vert.spv", "glow.first.frag.spv",
                                                                  "glow.base.vert.spv", "glow.base.frag.spv"])
        self.assertTrue(all(file.is_file() for file in files("SPIRV")))
        (source / "CMakeLists.txt").write_text((source / "CMakeLists.txt").read_text().replace("TARGETS glsl spirv", "TARGETS spirv"))
        build_all()
        self.assertIn("no work to do", build_all())

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
