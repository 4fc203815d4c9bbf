# SPDX-License-Identifier: Apache-2.0
"""The tables of graphs/README.md are what `isoshade nodes --markdown` and `isoshade schema --markdown` print, the
shipped JSON Schemas are what `isoshade schema` prints, every shipped document and its reflection are valid by them, and
documents and reflections with one fault are not.

schema_test.py ISOSHADE GRAPHS_FOLDER            tests
schema_test.py ISOSHADE GRAPHS_FOLDER --update   writes the tables and the schema instead
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import jsonschema

ISOSHADE, GRAPHS = sys.argv[1], pathlib.Path(sys.argv[2])
MANUAL = GRAPHS / "README.md"
SHIPPED = GRAPHS / "schema" / "isoshade.schema.json"
SHIPPED_REFLECTION = GRAPHS / "schema" / "isoshade.reflection.schema.json"
SHIPPED_STATS = GRAPHS / "schema" / "isoshade.stats.schema.json"


def printed(*arguments):
    return subprocess.run([ISOSHADE, *arguments], check=True, capture_output=True, text=True).stdout


TABLES = ("nodes", "--markdown"), ("schema", "--markdown"), ("schema", "--reflection", "--markdown")


def manual_parts(arguments):
    """The manual before the tables that a command prints, the tables, and what follows."""
    command = f"`isoshade {' '.join(arguments)}`"
    begin, end = f"<!-- begin of {command} -->\n\n", f"\n<!-- end of {command} -->"
    before, rest = MANUAL.read_text().split(begin)
    tables, after = rest.split(end)
    return before + begin, tables, end + after


def update():
    SHIPPED.parent.mkdir(exist_ok=True)
    SHIPPED.write_text(printed("schema"))
    SHIPPED_REFLECTION.write_text(printed("schema", "--reflection"))
    SHIPPED_STATS.write_text(printed("schema", "--stats"))
    for arguments in TABLES:
        before, _, after = manual_parts(arguments)
        MANUAL.write_text(before + printed(*arguments) + after)


FUNCTION = {
    "isoshade": 1,
    "function": "f",
    "inputs": {"x": {"type": "float", "min": 0, "value": 1}, "c": {"type": "any"}},
    "nodes": {
        "a": {"type": "add", "in1": "x", "in2": [1, 2, 3]},
        "s": {"type": "convert", "in": "a", "to": "color3"},
        "k": {"type": "brdf/ggx_d", "alpha": "x", "n_dot_h": 1},
        "e": {"type": "expression", "code": "x * y", "x": "x", "y": 2},
        "m": {"type": "transpose", "in": [1, 2, 3, 4, 5, 6, 7, 8, 9]},
    },
    "outputs": {"out": "s.xyz"},
}
EFFECT = {
    "isoshade": 1,
    "effect": "e",
    "parameters": {"p": {"type": "color3", "value": [1, 1, 1]}},
    "nodes": {"n": {"type": "normal", "space": "view"}},
    "passes": [{"name": "base", "color": {"link": "n"}}],
}
CHANGED_EFFECT = {
    "isoshade": 1,
    "effect": "e",
    "extends": "other.json",
    "parameters": {"p": {"value": 2, "max": None}, "q": None, "r": {"type": "float", "value": 1}},
    "nodes": {"n": {"in1": "p", "in2": None}, "m": None, "k": {"type": "normal", "space": "view"}},
}
SCENE = {
    "isoshade": 1,
    "scene": "s",
    "time": 2,
    "camera": {"position": [0, 0, 1], "target": [0, 0, 0], "fov": 30},
    "lights": {"sun": {"type": "directional", "direction": [0, -1, 0]}},
    "objects": {"o": {"mesh": {"type": "sphere", "radius": 2}, "effect": "e.json", "parameters": {"p": 1},
                      "repeat": [{"count": 2, "step": [1, 0, 0], "parameters": {"q": {"values": [1, 2]}}}]}},
}
EXTENSION = {
    "isoshade": 1,
    "scene": "s",
    "extends": "other.json",
    "camera": {"fov": 30},
    "lights": {"sun": None, "lamp": {"range": 3}},
    "objects": {"o": {"mesh": {"radius": 2}, "parameters": {"p": None, "q": 1}, "repeat": None}, "p": None},
}

# A document, the place of a value in it, and what is put there instead.
BROKEN = [
    (FUNCTION, "isoshade", 2),
    (FUNCTION, "function", "1f"),
    (FUNCTION, "effect", "too"),
    (FUNCTION, "outputs", {}),
    (FUNCTION, "inputs/x/type", "flaot"),
    (FUNCTION, "inputs/x/least", 0),
    (FUNCTION, "inputs/1x", {"type": "float"}),
    (FUNCTION, "nodes/a/in3", 1),
    (FUNCTION, "nodes/a/in1", None),
    (FUNCTION, "nodes/a/in1", [1, 2, 3, 4, 5]),
    (FUNCTION, "nodes/a/in1", "x..y"),
    (FUNCTION, "nodes/a/in1", True),
    (FUNCTION, "nodes/s/to", "colour3"),
    (FUNCTION, "nodes/s/in", ...),
    (FUNCTION, "nodes/a/type", ...),
    (FUNCTION, "nodes/a/type", "ad"),
    (FUNCTION, "nodes/k/type", "brdf/ggx_e"),
    (FUNCTION, "nodes/k/type", "ggx_d"),
    (FUNCTION, "nodes/k/n_dot_k", 1),
    (FUNCTION, "nodes/k/alpha", ...),
    (FUNCTION, "isoshade", ...),
    ({"isoshade": 1, "efect": "e"}, "doc", "a kind that is none"),
    (FUNCTION, "nodes/e/code", ...),
    (FUNCTION, "nodes/m/in", [1, 2, 3]),
    (FUNCTION, "outputs/out", 1),
    (EFFECT, "parameters/p/value", ...),
    (EFFECT, "parameters/p/type", "any"),
    (EFFECT, "nodes/n/space", "wrold"),
    (EFFECT, "passes", []),
    (EFFECT, "passes/0/color", ...),
    (EFFECT, "passes/0/cull", "left"),
    (EFFECT, "passes/0/color", [1, 2]),
    (CHANGED_EFFECT, "extends", ...),
    (CHANGED_EFFECT, "extends", 1),
    (CHANGED_EFFECT, "effect", ...),
    (CHANGED_EFFECT, "parameters/p/maximum", 2),
    (CHANGED_EFFECT, "parameters/p", 2),
    (CHANGED_EFFECT, "parameters/p/type", "flaot"),
    (CHANGED_EFFECT, "nodes/k/space", "wrold"),
    (CHANGED_EFFECT, "nodes/n/in1", {"lonk": "p"}),
    (CHANGED_EFFECT, "passes", []),
    (SCENE, "camera", ...),
    (SCENE, "camera/type", "fisheye"),
    (SCENE, "camera/height", 3),
    (SCENE, "camera/fov", 180),
    (SCENE, "lights/sun/direction", ...),
    (SCENE, "lights/sun/range", 3),
    (SCENE, "objects/o/mesh", "teapot"),
    (SCENE, "objects/o/mesh/rings", 1),
    (SCENE, "objects/o/mesh/caps", True),
    (SCENE, "objects/o/mesh", "lathe"),
    (SCENE, "objects/o/mesh", {"type": "gltf", "path": "x.glb"}),
    (SCENE, "objects/o/mesh", {"type": "lathe", "profile": [[1, 0]]}),
    (SCENE, "objects/o/mesh", {"type": "lathe", "profile": [[1, 0], {"at": [1]}]}),
    (SCENE, "objects/o/effect", ...),
    (SCENE, "objects/o/repeat/0/count", 0),
    (SCENE, "objects/o/repeat/0/parameters/q", {"from": 1}),
    (SCENE, "size", [0, 10]),
    (SCENE, "sizes", [10, 10]),
    (SCENE, "lights/sun", None),
    (EXTENSION, "extends", ...),
    (EXTENSION, "extends", None),
    (EXTENSION, "scene", ...),
    (EXTENSION, "camera", 1),
    (EXTENSION, "lights/lamp", 1),
    (EXTENSION, "objects/o/mash", "sphere"),
    (EXTENSION, "objects/o/repeat", [1, 2, 3, 4]),
]


def changed(document, path, value):
    """A copy with the value at the path, or without the key for `...`."""
    document = copy.deepcopy(document)
    *parents, last = [int(step) if step.isdigit() else step for step in path.split("/")]
    target = document
    for step in parents:
        target = target[step]
    if value is ...:
        del target[last]
    else:
        target[last] = value
    return document


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = printed("schema")
        schema = json.loads(cls.text)
        jsonschema.Draft7Validator.check_schema(schema)
        cls.validator = jsonschema.Draft7Validator(schema)

    def errors(self, document):
        return [f"{'/'.join(map(str, e.absolute_path))}: {e.message}" for e in self.validator.iter_errors(document)]

    def test_the_shipped_schema_is_current(self):
        self.assertTrue(SHIPPED.read_text() == self.text, "update it: schema_test.py ... --update")

    def test_every_shipped_document_is_valid(self):
        self.assertGreater(len(documents()), 10)
        for path in documents():
            self.assertEqual(self.errors(json.loads(path.read_text())), [], path)

    def test_documents_of_every_kind_are_valid(self):
        for document in FUNCTION, EFFECT, CHANGED_EFFECT, SCENE, EXTENSION:
            self.assertEqual(self.errors(document), [])
        self.assertEqual(self.errors(changed(EFFECT, "passes/0/color", [1, 0.5, 0])), [])

    def test_documents_with_one_thing_wrong_are_not(self):
        for document, path, value in BROKEN:
            self.assertNotEqual(self.errors(changed(document, path, value)), [], f"{path} = {value}")


def documents():
    return [p for p in GRAPHS.rglob("*.json") if p.parent.name != "schema"]


class Reflection(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = printed("schema", "--reflection")
        schema = json.loads(cls.text)
        jsonschema.Draft7Validator.check_schema(schema)
        cls.validator = jsonschema.Draft7Validator(schema)
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def reflect(self, path, *arguments):
        """The reflection of a document."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder.name))
        subprocess.run([ISOSHADE, "compile", path, "-o", folder, "--target", "glsl", "-q", *arguments], check=True)
        (reflection,) = folder.glob("*.json")
        return json.loads(reflection.read_text())

    def errors(self, reflection):
        return [f"{'/'.join(map(str, e.absolute_path))}: {e.message}" for e in self.validator.iter_errors(reflection)]

    def test_the_shipped_schema_is_current(self):
        self.assertTrue(SHIPPED_REFLECTION.read_text() == self.text, "update it: schema_test.py ... --update")

    def test_the_reflection_of_every_shipped_document_is_valid(self):
        kinds = set()
        for path in documents():
            if {"scene", "image"} & json.loads(path.read_text()).keys():
                continue
            reflection = self.reflect(path)
            kinds.add(reflection["kind"])
            self.assertEqual(self.errors(reflection), [], path)
        self.assertEqual(kinds, {"function", "effect", "post"})

    def test_reflections_with_one_fault_are_not_valid(self):
        reflection = self.reflect(GRAPHS / "materials" / "textured.json")
        self.assertEqual(self.errors(reflection), [])
        for path, value in [
            ("isoshade_reflection", 2),
            ("kind", "scene"),
            ("bindings", []),
            ("files", ...),
            ("files/0/role", "header"),
            ("structs/0/bytes/scalar", {"size": 4, "alignment": 4}),
            ("structs/0/fields/0/type", "mat3"),
            ("structs/0/fields/0/bytes/std140", ...),
            ("parameters/0/type", "any"),
            ("images/0/samplings/0/filter", "cubic"),
            ("passes/0/states/cull", ...),
            ("passes/0/states/stencil", "none"),
            ("host/0/name", "printf"),
        ]:
            self.assertNotEqual(self.errors(changed(reflection, path, value)), [], f"{path} = {value}")


class Stats(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = printed("schema", "--stats")
        schema = json.loads(cls.text)
        jsonschema.Draft7Validator.check_schema(schema)
        cls.validator = jsonschema.Draft7Validator(schema)

    def errors(self, stats):
        return [f"{'/'.join(map(str, e.absolute_path))}: {e.message}" for e in self.validator.iter_errors(stats)]

    def measure(self, *options):
        scene = GRAPHS / "scenes" / "borders.json"
        return json.loads(printed("render", scene, "--backend", "interpreter", "--size", "16x16", "--stats-json", "-", *options))

    def test_the_shipped_schema_is_current(self):
        self.assertTrue(SHIPPED_STATS.read_text() == self.text, "update it: schema_test.py ... --update")

    def test_the_times_of_one_frame_and_of_many_are_valid(self):
        for count in 1, 4:
            stats = self.measure("--frames", str(count), "--turntable")
            self.assertEqual(self.errors(stats), [])
            self.assertEqual(stats["frames"], count)
            for step, times in stats["milliseconds"].items():
                self.assertEqual(len(times["frames"]), count, step)
                self.assertEqual(times["frames"][0], times["first"], step)
                self.assertEqual("median" in times, count > 1, step)
                others = sorted(times["frames"][1:])
                if others:
                    self.assertEqual(times["median"], others[1], step)
                    self.assertLessEqual(times["lower_quartile"], times["median"], step)
                    self.assertLessEqual(times["median"], times["upper_quartile"], step)

    def test_times_with_one_fault_are_not_valid(self):
        stats = self.measure("--frames", "2")
        for path, value in [
            ("isoshade_frame_times", 2),
            ("backend", ...),
            ("threads", 0),
            ("frames", "2"),
            ("milliseconds/plan", ...),
            ("milliseconds/idle", {"first": 1, "frames": [1]}),
            ("milliseconds/draw/first", -1),
            ("milliseconds/draw/mean", 1),
            ("milliseconds/draw/frames", []),
        ]:
            self.assertNotEqual(self.errors(changed(stats, path, value)), [], f"{path} = {value}")


class Manual(unittest.TestCase):
    def test_the_tables_are_current(self):
        for arguments in TABLES:
            self.assertTrue(manual_parts(arguments)[1] == printed(*arguments), "update them: schema_test.py ... --update")


if __name__ == "__main__":
    if "--update" in sys.argv:
        update()
    else:
        unittest.main(argv=sys.argv[:1])
