#!/usr/bin/env python3
"""Writes the textures of the scenes: scenes/weave.png and scenes/flag.png. Needs only Python."""
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


def flag(x, y):
    """A ring on a field between two stripes, in our own colours."""
    ring = 44 ** 2 < (x - 192) ** 2 + (y - 128) ** 2 < 62 ** 2
    stripe = 24 <= y < 40 or 216 <= y < 232
    return (246, 226, 178) if ring or stripe else (22, 104, 118)


folder = sys.argv[1] if len(sys.argv) > 1 else "scenes"
write(folder + "/weave.png", 32, 32, weave)
write(folder + "/flag.png", 384, 256, flag)
