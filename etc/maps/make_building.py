#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Draws building.pgm and building.yaml beside itself: a fenced yard of 12 x 12 m and the two wings of a
building round it, 24 x 16 m in all. Metres, x east, y north; the robot starts at (0, 0) in the yard.

Usage: make_building.py
"""
import math
import pathlib

RESOLUTION = 0.05
LEFT, BOTTOM, RIGHT, TOP = -4.0, -5.0, 20.0, 11.0
FREE, UNKNOWN, OCCUPIED = 254, 205, 0
WIDTH = round((RIGHT - LEFT) / RESOLUTION)
HEIGHT = round((TOP - BOTTOM) / RESOLUTION)

# Rectangles (x0, y0, x1, y1), painted in this order.
WALLS = [
    (LEFT, BOTTOM, RIGHT, -4.8), (LEFT, 10.8, RIGHT, TOP),    # fence and outer walls
    (LEFT, BOTTOM, -3.8, TOP), (19.8, BOTTOM, RIGHT, TOP),
    (8.0, BOTTOM, 8.2, TOP), (LEFT, 6.8, 8.0, 7.0),           # between yard and wings
    (8.2, 4.0, 19.8, 4.2), (8.2, 6.0, 19.8, 6.2),             # along the corridor
    (12.0, -4.8, 12.2, 4.0), (16.0, -4.8, 16.2, 4.0),         # between the south rooms
    (14.0, 6.2, 14.2, 10.8),                                  # between the north rooms
    (18.2, -3.4, 19.8, -3.3), (18.2, -4.8, 18.3, -3.3),       # a locked store
]
DOORS = [
    (7.9, 4.3, 8.3, 5.9),                                     # yard to corridor
    (7.9, -3.5, 8.3, -2.2), (7.9, 8.3, 8.3, 9.6),             # yard to office, laboratory to hall
    (1.0, 6.7, 2.4, 7.1),                                     # yard to laboratory
    (9.3, 3.9, 10.6, 4.3), (13.4, 3.9, 14.7, 4.3), (17.2, 3.9, 18.5, 4.3),
    (10.9, 5.9, 12.2, 6.3), (16.0, 5.9, 17.3, 6.3),
    (11.9, -1.6, 12.3, -0.3),                                 # office to meeting room
]
FURNITURE = [
    (10.9, 0.6, 11.6, 2.2), (8.2, 0.4, 8.6, 2.8), (9.4, -4.8, 11.4, -4.3),      # office
    (13.4, -2.8, 14.8, -0.6),                                                   # meeting table
    (19.2, 0.0, 19.8, 2.6), (16.2, -4.8, 16.7, -2.6),                           # workshop
    (8.2, 10.3, 10.6, 10.8), (12.6, 8.4, 13.2, 8.7),                            # hall
    (15.8, 9.2, 18.2, 9.8), (14.2, 6.9, 14.6, 8.3), (19.3, 6.8, 19.8, 9.0),     # library
    (-2.2, 8.6, 0.2, 9.3), (3.4, 8.6, 5.8, 9.3), (-3.8, 10.2, 7.0, 10.8),       # laboratory
    (15.2, 5.75, 15.8, 6.0),                                                    # corridor
]
PILLARS = [(-2.6, 5.4, 0.25), (6.6, -3.4, 0.25), (-2.8, -3.6, 0.3), (11.2, 8.4, 0.15), (18.0, 1.2, 0.35)]
STORE = (18.3, -4.8, 19.8, -3.4)  # nobody has been in there


def cells(low, high, origin, count):
    return range(max(0, round((low - origin) / RESOLUTION)), min(count, round((high - origin) / RESOLUTION)))


def paint(grid, rectangle, level):
    x0, y0, x1, y1 = rectangle
    for row in cells(y0, y1, BOTTOM, HEIGHT):
        for column in cells(x0, x1, LEFT, WIDTH):
            grid[row][column] = level


def main():
    grid = [bytearray([FREE] * WIDTH) for _ in range(HEIGHT)]
    paint(grid, STORE, UNKNOWN)
    for rectangle in WALLS:
        paint(grid, rectangle, OCCUPIED)
    for rectangle in DOORS:
        paint(grid, rectangle, FREE)
    for rectangle in FURNITURE:
        paint(grid, rectangle, OCCUPIED)
    for x, y, radius in PILLARS:
        for row in cells(y - radius, y + radius, BOTTOM, HEIGHT):
            for column in cells(x - radius, x + radius, LEFT, WIDTH):
                centre = (LEFT + (column + 0.5) * RESOLUTION, BOTTOM + (row + 0.5) * RESOLUTION)
                if math.dist(centre, (x, y)) <= radius:
                    grid[row][column] = OCCUPIED
    folder = pathlib.Path(__file__).resolve().parent
    header = f"P5\n{WIDTH} {HEIGHT}\n255\n".encode()
    (folder / "building.pgm").write_bytes(header + b"".join(reversed(grid)))
    (folder / "building.yaml").write_text(
        f"image: building.pgm\nmode: trinary\nresolution: {RESOLUTION}\n"
        f"origin: [{LEFT}, {BOTTOM}, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")


if __name__ == "__main__":
    main()
