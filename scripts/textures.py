#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the images in graphs/textures that are not rendered from graphs, and a glTF file with boards that show one of
them. Needs only Python.

    scripts/textures.py graphs/textures
"""
import base64
import json
import math
import os
import random
import struct
import sys
import zlib


def png(path, width, height, pixel, channels):
    """pixel(x, y) returns one byte for each channel: 1 grey, 3 RGB, 4 RGBA."""
    rows = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y)) for y in range(height))
    kind = {1: 0, 3: 2, 4: 6}[channels]

    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def srgb(linear):
    encoded = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return int(255 * encoded + 0.5)


def toon_ramp(x, y):
    """Three bands of light: shadow, half shadow, light."""
    return [srgb(0.22 if x < 26 else 0.56 if x < 38 else 1.0)]


def uv_grid(x, y):
    """8 x 8 squares; red grows with u, green with v; the upper left square has a frame."""
    light = (x // 16 + y // 16) % 2 == 0
    line = x % 16 == 0 or y % 16 == 0
    if x < 16 and y < 16 and (x < 3 or y < 3 or x > 12 or y > 12):
        return [255, 255, 255]
    if line:
        return [40, 40, 48]
    base = 235 if light else 120
    return [base * (64 + x) // 192, base * (64 + y) // 192, base * 3 // 4]


def leaf(x, y):
    """A disc with a soft edge: alpha 1 inside, 0 outside."""
    across, down = (x + 0.5) / 33 - 0.5, (y + 0.5) / 17 - 0.5
    distance = (across * across + down * down) ** 0.5
    return [90, 170 - 3 * y, 60, max(0, min(255, int(255 * (0.45 - distance) * 8 + 0.5)))]


REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
NEAREST, LINEAR, LEVELS = 9728, 9729, 9987


def boards(path):
    """Eight boards, 1 wide, in two rows, each with a material that reads uv_grid.png in another way. Their first texture
    coordinates run from -0.5 to 1.5, their second from 0 to 1, upside down."""
    textures, samplers = [], []

    def texture(wrap_u=REPEAT, wrap_v=REPEAT, larger=LINEAR, smaller=LEVELS, set=0, **transform):
        samplers.append({"wrapS": wrap_u, "wrapT": wrap_v, "magFilter": larger, "minFilter": smaller})
        textures.append({"source": 0, "sampler": len(samplers) - 1})
        info = {"index": len(textures) - 1, "texCoord": set}
        if transform:
            info["extensions"] = {"KHR_texture_transform": transform}
        return info

    def material(name, info, **more):
        return {"name": name, "pbrMetallicRoughness": {"baseColorTexture": info, "metallicFactor": 0}, **more}

    glow = {
        "name": "emissive strength",
        "pbrMetallicRoughness": {"baseColorFactor": [0.02, 0.02, 0.02, 1], "metallicFactor": 0},
        "emissiveFactor": [1, 0.5, 0.2],
        "emissiveTexture": texture(offset=[0.25, 0.25], scale=[0.5, 0.5]),
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2.5}},
    }
    materials = [
        material("repeated", texture()),
        material("clamped", texture(CLAMP, CLAMP)),
        material("mirrored and clamped", texture(MIRROR, CLAMP)),
        material("nearest texels", texture(larger=NEAREST, offset=[0.02, 0.02], scale=[0.12, 0.12])),
        material("turned", texture(CLAMP, MIRROR, rotation=0.5, offset=[-0.1, 0.4], scale=[1.2, 0.8])),
        material("second texture coordinates", texture(set=1)),
        material("unlit", texture(smaller=LINEAR, set=1), extensions={"KHR_materials_unlit": {}}),
        glow,
    ]
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    columns = [
        ("VEC3", [(x, y, 0) for x, y in corners]),
        ("VEC3", [(0, 0, 1)] * 4),
        ("VEC2", [(2 * x - 0.5, 1.5 - 2 * y) for x, y in corners]),
        ("VEC2", [(x, y) for x, y in corners]),
    ]
    data, views, accessors = b"", [], []
    for kind, values in columns:
        packed = b"".join(struct.pack("<%df" % len(value), *value) for value in values)
        accessors.append({"bufferView": len(views), "componentType": 5126, "count": 4, "type": kind})
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        data += packed
    accessors[0].update({"min": [0, 0, 0], "max": [1, 1, 0]})
    accessors.append({"bufferView": len(views), "componentType": 5123, "count": 6, "type": "SCALAR"})
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 12})
    data += struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    attributes = {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "TEXCOORD_1": 3}
    count = len(materials)
    used = ["KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_texture_transform"]
    gltf = {
        "asset": {"version": "2.0"},
        "extensionsUsed": used,
        "extensionsRequired": used,
        "scene": 0,
        "scenes": [{"nodes": list(range(count))}],
        "nodes": [{"mesh": i, "translation": [1.15 * (i % 4), -1.15 * (i // 4), 0]} for i in range(count)],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 4, "material": i}]} for i in range(count)],
        "materials": materials,
        "textures": textures,
        "samplers": samplers,
        "images": [{"uri": "uv_grid.png"}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }
    with open(path, "w") as file:
        json.dump(gltf, file, indent=1)
        file.write("\n")


TONES = 6
LEVELS_OF_STROKES = [256, 128, 64, 32]


class Sheet:
    """A square of paper that repeats: 1 white, 0 black. Lines are as many pixels wide on every size of sheet."""

    def __init__(self, size, strokes):
        self.size = size
        self.values = [1.0] * (size * size)
        for stroke in strokes:
            self.draw(stroke)

    def pixels(self, stroke, reach):
        """The pixels around a stroke: their places, and how much of the ink each takes."""
        upright, x, y, length, bend, ink = stroke
        size = self.size
        count = max(2, round(length * size))
        for i in range(count):
            along = (i + 0.5) / count
            middle = (y + bend * math.sin(2.2 * along + 9 * bend)) * size
            pressure = ink * min(1, 7 * along, 7 * (1 - along) + 0.1)
            for row in range(math.floor(middle - reach), math.ceil(middle + reach) + 1):
                cover = min(1, max(0, 0.65 + 0.5 - abs(row + 0.5 - middle)))
                a, b = (round(x * size) + i) % size, row % size
                yield (a * size + b if upright else b * size + a), cover * pressure

    def draw(self, stroke):
        """The darker of the paper and the stroke: more strokes never lighten a pixel."""
        for place, ink in self.pixels(stroke, 1.2):
            self.values[place] = min(self.values[place], 1 - ink)

    def crowd(self, stroke):
        """How much ink lies around a stroke that is not drawn yet."""
        found = [1 - self.values[place] for place, _ in self.pixels(stroke, 2.5)]
        return sum(found) / len(found)

    def darkness(self):
        return 1 - sum(self.values) / len(self.values)


def hatching(folder):
    """Tonal art maps after Praun, Hoppe, Webb and Finkelstein 2001, "Real-Time Hatching": six tones of strokes, one
    below the other, in one file for each mip level. Each tone has the strokes of the lighter one, and each level those
    of the smaller one. The darker three tones are hatched across, too."""
    chance = random.Random(1)
    tones = []
    for tone in range(TONES):
        wanted = 0.87 * (tone + 1) / TONES
        levels = {}
        smaller = []
        for size in reversed(LEVELS_OF_STROKES):
            strokes = list(tones[-1][size]) if tones else []
            strokes += [stroke for stroke in smaller if stroke not in strokes]
            sheet = Sheet(size, strokes)
            while sheet.darkness() < wanted:
                upright = tone >= TONES // 2 and chance.random() < 0.75
                made = [
                    (upright, chance.random(), chance.random(), 0.3 + 0.6 * chance.random(),
                     0.03 * (chance.random() - 0.5), 0.8 + 0.2 * chance.random())
                    for _ in range(10)
                ]
                best = min(made, key=lambda stroke: sheet.crowd(stroke) - 0.1 * stroke[3])
                strokes.append(best)
                sheet.draw(best)
            levels[size] = smaller = strokes
        tones.append(levels)
    for size in LEVELS_OF_STROKES:
        sheets = [Sheet(size, levels[size]) for levels in tones]
        png(os.path.join(folder, "hatching_%d.png" % size), size, TONES * size,
            lambda x, y: [round(255 * sheets[y // size].values[y % size * size + x])], 1)


folder = sys.argv[1]
png(os.path.join(folder, "toon_ramp.png"), 64, 4, toon_ramp, 1)
png(os.path.join(folder, "uv_grid.png"), 128, 128, uv_grid, 3)
png(os.path.join(folder, "leaf.png"), 33, 17, leaf, 4)
boards(os.path.join(folder, "boards.gltf"))
hatching(folder)
