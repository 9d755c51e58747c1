#!/usr/bin/env python3
"""Writes the textures of the scenes: scenes/weave.png and scenes/flag.png. Needs only Python."""
import math
import struct
import sys
import zlib


def write(path, width, height, pixel):
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y))
                    for y in range(height))
    chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data
                                + struct.pack(">I", zlib.crc32(kind + data)))
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n"
                  + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                  + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def weave(x, y):
    """Two threads over two: brightest in the middle of a thread, dark where it dives under."""
    across, along = (x, y) if (x // 16 + y // 16) % 2 else (y, x)
    round_off = 1 - ((across % 16 - 7.5) / 8) ** 2 * 0.45
    dive = 1 - ((along % 16 - 7.5) / 8) ** 4 * 0.30
    return (min(255, int(255 * round_off * dive)),) * 3


def light(byte):
    c = byte / 255
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def byte(light):
    c = 12.92 * light if light <= 0.0031308 else 1.055 * light ** (1 / 2.4) - 0.055
    return int(255 * c + 0.5)


def flag(x, y):
    """A ring on a field between two stripes, in our own colours: at the edges of the ring a
    pixel has as much of both in linear light as it covers."""
    away = math.hypot(x - 191.5, y - 127.5)
    ring = min(max(away - 43.5, 0), max(62.5 - away, 0), 1)
    share = 1 if 24 <= y < 40 or 216 <= y < 232 else ring
    return tuple(byte(share * light(a) + (1 - share) * light(b))
                 for a, b in zip((246, 226, 178), (22, 104, 118)))


folder = sys.argv[1] if len(sys.argv) > 1 else "scenes"
write(folder + "/weave.png", 32, 32, weave)
write(folder + "/flag.png", 384, 256, flag)
