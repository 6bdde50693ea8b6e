#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plots of what `scripts/bench paper` has measured.

Usage: plot.py FOLDER    reads its CSV files and writes an SVG file beside each that has a plot
"""
import csv
import math
import pathlib
import sys
from xml.sax.saxutils import escape

COLOURS = ("#c0392b", "#2471a3", "#1e8449", "#7d3c98", "#b9770e", "#566573", "#117a65", "#884ea0")
FONT = 'font-family="sans-serif" font-size="12"'


class Picture:
    def __init__(self, width, height, title):
        self.width, self.height = width, height
        self.parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" {FONT}>',
                      f'<rect width="{width}" height="{height}" fill="white"/>']
        self.text(width / 2, 18, title, "middle", weight="bold")

    def text(self, x, y, text, anchor="start", colour="#222", weight="normal"):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}" '
                          f'font-weight="{weight}">{escape(text)}</text>')

    def line(self, x1, y1, x2, y2, colour="#ccc", width=1.0, dash=""):
        self.parts.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" '
                          f'stroke-width="{width}"' + (f' stroke-dasharray="{dash}"' if dash else "") + "/>")

    def box(self, x, y, width, height, colour, opacity=1.0):
        self.parts.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" '
                          f'fill="{colour}" fill-opacity="{opacity}" stroke="#333" stroke-width="0.5"/>')

    def dot(self, x, y, colour, radius=3.0, opacity=1.0):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}" '
                          f'fill-opacity="{opacity}"/>')

    def save(self, path):
        path.write_text("\n".join([*self.parts, "</svg>\n"]), encoding="utf-8")
        print(f"plot: {path}")


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.reader(file))


def wanted(label):
    """Of the many rows of Tables 5 and 6, those that a picture can show."""
    return any(label.endswith(end) for end in ("full rate", "contended", "sparse, median", "paper, sparse, mean"))


def plot_sizes(path, title):
    """Lines over the size of the value, both axes logarithmic."""
    head, *rows = rows_of(path)
    count = len(head) - 1
    named = [(name, cells) for name, *cells in rows if wanted(name)]
    picture = Picture(900, 480, title)
    left, right, top, bottom = 60, 600, 40, 430
    x_of = [left + i * (right - left) / (count - 1) for i in range(count)]

    def y_of(value):
        return bottom - math.log10(max(value, 1.0)) / 6 * (bottom - top)

    for power in range(7):
        picture.line(left, y_of(10**power), right, y_of(10**power))
        picture.text(left - 6, y_of(10**power) + 4, f"{10**power:,} ns" if power < 4 else f"{10**(power - 3):,} us", "end")
    for x, size in zip(x_of, head[1:]):
        picture.text(x, bottom + 18, size, "middle")
    for i, (name, cells) in enumerate(named):
        colour = COLOURS[i % len(COLOURS)]
        dash = "6 3" if "sparse" in name else "2 3" if "contended" in name else ""
        points = [(x, y_of(float(cell))) for x, cell in zip(x_of, cells) if cell]
        for (x1, y1), (x2, y2) in zip(points, points[1:]):
            picture.line(x1, y1, x2, y2, colour, 2.5 if name.startswith("mauve") else 1.2, dash)
        for x, y in points:
            picture.dot(x, y, colour)
        picture.line(right + 20, top + 20 * i, right + 50, top + 20 * i, colour, 2, dash)
        picture.text(right + 56, top + 20 * i + 4, name)
    picture.save(path.with_suffix(".svg"))


def plot_executions(path):
    """A dot for each cycle: A above, B below."""
    rows = rows_of(path)[1:]
    platforms = list(dict.fromkeys(row[0] for row in rows))
    picture = Picture(900, 60 + 60 * len(platforms), "Executions of A (red, 20 ms) and B (blue, 10 ms)")
    left, right, most = 130, 880, max([40.0, *(float(row[2]) for row in rows)])

    def x_of(value):
        return left + value / most * (right - left)

    for step in range(0, int(most) + 1, 10):
        picture.line(x_of(step), 30, x_of(step), 40 + 60 * len(platforms))
        picture.text(x_of(step), 54 + 60 * len(platforms), f"{step} ms", "middle")
    for i, platform in enumerate(platforms):
        picture.text(8, 70 + 60 * i, platform)
        for j, row in enumerate(row for row in rows if row[0] == platform):
            first = row[1] == "a"
            y = (50 if first else 72) + 60 * i + (j * 7 % 16)
            picture.dot(x_of(float(row[2])), y, COLOURS[0 if first else 1], 1.8, 0.5)
    picture.save(path.with_suffix(".svg"))


def plot_timeline(path, title):
    """Tasks as rows, releases as arrows, jobs as boxes; from three periods before the change."""
    jobs = [(row[0], row[1], float(row[2]), float(row[3])) for row in rows_of(path)[1:]]
    configure = next(job for job in jobs if job[0] == "configure")
    begin = max(0.0, (configure[2] // 100 - 2) * 100)
    end = max(job[3] for job in jobs) + 20
    picture = Picture(980, 230, title)
    left, right = 60, 960

    def x_of(instant):
        return left + (instant - begin) / (end - begin) * (right - left)

    picture.box(x_of(configure[2]), 40, x_of(configure[3]) - x_of(configure[2]), 150, "#f9e79f", 0.6)
    picture.text(x_of(configure[2]) + 4, 54, "A's next core is configured")
    for name, y, colours in (("b", 110, {"1": "#5dade2"}), ("a", 180, {"1": "#ec7063", "2": "#58d68d"})):
        picture.text(20, y - 6, name.upper(), weight="bold")
        picture.line(left, y, right, y, "#333")
        for release in range(int(begin), int(end), 100):
            picture.line(x_of(release), y, x_of(release), y - 42, "#333", 1.2)
            picture.line(x_of(release), y - 42, x_of(release) - 3, y - 36, "#333", 1.2)
            picture.line(x_of(release), y - 42, x_of(release) + 3, y - 36, "#333", 1.2)
        for row, core, start, stop in jobs:
            if row == name and stop > begin:
                picture.box(x_of(start), y - 28, x_of(stop) - x_of(start), 28, colours[core])
    for release in range(int(begin), int(end), 100):
        picture.text(x_of(release), 200, f"{release / 1000:.1f} s", "middle")
    picture.text(left, 220, "blue: B; red: A with its first core, green: with its second one (preemption by B inside)")
    picture.save(path.with_suffix(".svg"))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/bench/paper")
    plots = {
        "table5": lambda path: plot_sizes(path, "Table 5: one write"),
        "table6": lambda path: plot_sizes(path, "Table 6: one read"),
        "executions": plot_executions,
        "figure9": lambda path: plot_timeline(path, "Fig. 9: a long reconfiguration of A, asked for by B"),
        "figure9_in_place": lambda path: plot_timeline(path, "Fig. 9: the same, A stands still meanwhile"),
    }
    for name, plot in plots.items():
        path = folder / f"{name}.csv"
        if path.is_file():
            plot(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
