#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plot of what `scripts/bench peers` has measured.

Usage: plot.py FOLDER    reads peers.csv and writes peers.svg beside it
"""
import csv
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "paper"))
from plot import COLOURS, Picture  # noqa: E402

TITLES = {"exchange": "One write and one read, median", "call": "The longest write or read",
          "step": "Release until written, median", "last": "The longest of these"}
LEFT, RIGHT, ROW = 110, 620, 22


def powers(values):
    """The powers of ten around all values, at least one apart."""
    low = math.floor(math.log10(min(values)))
    return low, max(low + 1, math.ceil(math.log10(max(values))))


def plot_figure(picture, top, title, rows, peers, sizes):
    """A row for each peer and a dot for each size, on a logarithmic axis of the ratio."""
    low, high = powers([ratio for _, _, ratio in rows] + [1.0])
    bottom = top + 10 + ROW * len(peers)

    def x_of(ratio):
        return LEFT + (math.log10(ratio) - low) / (high - low) * (RIGHT - LEFT)

    picture.text(LEFT, top, title, weight="bold")
    for power in range(low, high + 1):
        picture.line(x_of(10**power), top + 8, x_of(10**power), bottom)
        picture.text(x_of(10**power), bottom + 14, f"{10.0**power:g} x", "middle")
    picture.line(x_of(1), top + 8, x_of(1), bottom, "#222", 1.5)
    for i, peer in enumerate(peers):
        picture.text(LEFT - 8, top + 24 + ROW * i, peer, "end", weight="bold" if peer == "mauve" else "normal")
    for peer, size, ratio in rows:
        y = top + 16 + ROW * peers.index(peer) + 3.5 * sizes.index(size)
        picture.dot(x_of(ratio), y, COLOURS[sizes.index(size)])
    return bottom + 44


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/bench/peers")
    with (folder / "peers.csv").open(encoding="utf-8") as file:
        entries = [(row["figure"], row["peer"], row["bytes"], float(row["ratio"])) for row in csv.DictReader(file)]
    peers = list(dict.fromkeys(entry[1] for entry in entries))
    sizes = list(dict.fromkeys(entry[2] for entry in entries))
    picture = Picture(720, 60 + len(TITLES) * (54 + ROW * len(peers)), "Ratios to the raw loop (left is quicker)")
    for i, size in enumerate(sizes):
        picture.dot(LEFT + 110 * i, 38, COLOURS[i])
        picture.text(LEFT + 8 + 110 * i, 42, f"{int(size):,} B")
    top = 70
    for figure, title in TITLES.items():
        rows = [entry[1:] for entry in entries if entry[0] == figure and entry[3] > 0]
        top = plot_figure(picture, top, title, rows, peers, sizes)
    picture.save(folder / "peers.svg")
    return 0


if __name__ == "__main__":
    sys.exit(main())
