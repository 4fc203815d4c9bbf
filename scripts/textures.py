#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the images in graphs/textures that are not rendered from graphs. Needs only Python.

    scripts/textures.py graphs/textures
"""
import os
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


folder = sys.argv[1]
png(os.path.join(folder, "toon_ramp.png"), 64, 4, toon_ramp, 1)
png(os.path.join(folder, "uv_grid.png"), 128, 128, uv_grid, 3)
png(os.path.join(folder, "leaf.png"), 33, 17, leaf, 4)
