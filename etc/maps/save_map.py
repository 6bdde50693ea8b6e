#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Saves a map of a running system as a YAML file with a PGM image beside it, as navigation/map_server reads them.

Usage: mauvectl --json get map.read | save_map.py FILE.yaml
"""
import json
import pathlib
import sys

FREE, UNKNOWN, OCCUPIED = 254, 205, 0


def level(cell):
    if 0 <= cell < 20:
        return FREE
    return OCCUPIED if cell > 65 else UNKNOWN


def main():
    if len(sys.argv) != 2 or not sys.argv[1].endswith(".yaml"):
        sys.exit(__doc__.strip().splitlines()[-1])
    try:
        grid = json.load(sys.stdin)["value"]
        width, height, cells, origin = (grid[key] for key in ("width", "height", "cells", "origin"))
    except (ValueError, KeyError, TypeError):
        sys.exit("save_map: this is no map (mauvectl --json get RESOURCE.read prints one)")
    if width * height != len(cells) or not cells:
        sys.exit("save_map: the map is empty")
    path = pathlib.Path(sys.argv[1])
    rows = [bytes(level(cell) for cell in cells[i:i + width]) for i in range(0, len(cells), width)]
    path.with_suffix(".pgm").write_bytes(f"P5\n{width} {height}\n255\n".encode() + b"".join(reversed(rows)))
    path.write_text(
        f"image: {path.stem}.pgm\nmode: trinary\nresolution: {grid['resolution']}\n"
        f"origin: [{origin['x']}, {origin['y']}, {origin['heading']}]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")


if __name__ == "__main__":
    main()
