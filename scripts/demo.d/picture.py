# SPDX-License-Identifier: LGPL-3.0-or-later
"""The path driven as a picture: SVG for a file, characters for a terminal."""

COLOURS = ["#1f6feb", "#d1242f", "#1a7f37", "#9a6700", "#8250df"]
MARGIN = 1.0  # m around everything
SCALE = 60  # pixels a metre


def bounds(path, obstacles, goal):
    xs = [x for x, _, _ in path] + [goal[0]] + [x + s * r for x, _, r in obstacles for s in (-1, 1)]
    ys = [y for _, y, _ in path] + [goal[1]] + [y + s * r for _, y, r in obstacles for s in (-1, 1)]
    return min(xs) - MARGIN, min(ys) - MARGIN, max(xs) + MARGIN, max(ys) + MARGIN


def pieces(path):
    """The path cut where the core changed: (core, points); neighbours share a point."""
    result = []
    for x, y, core in path:
        if not result or result[-1][0] != core:
            last = result[-1][1][-1:] if result else []
            result.append((core, list(last)))
        result[-1][1].append((x, y))
    return result


def cores(path):
    return list(dict.fromkeys(core for _, _, core in path))


def svg(path, obstacles, goal):
    left, bottom, right, top = bounds(path, obstacles, goal)
    known = cores(path)

    def at(x, y):
        return f"{(x - left) * SCALE:.1f}", f"{(top - y) * SCALE:.1f}"

    width, height = (right - left) * SCALE, (top - bottom) * SCALE + 24 * len(known)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
             'font-family="sans-serif" font-size="14">',
             '<rect width="100%" height="100%" fill="white"/>']
    for x, y, radius in obstacles:
        cx, cy = at(x, y)
        lines.append(f'<circle cx="{cx}" cy="{cy}" r="{radius * SCALE:.1f}" fill="#8c959f"/>')
    for core, points in pieces(path):
        places = " ".join(",".join(at(x, y)) for x, y in points)
        colour = COLOURS[known.index(core) % len(COLOURS)]
        lines.append(f'<polyline points="{places}" fill="none" stroke="{colour}" stroke-width="4" '
                     'stroke-linecap="round" stroke-linejoin="round"/>')
    if path:
        x, y = at(*path[0][:2])
        lines.append(f'<circle cx="{x}" cy="{y}" r="7" fill="black"><title>start</title></circle>')
    x, y = at(*goal)
    lines.append(f'<circle cx="{x}" cy="{y}" r="9" fill="none" stroke="black" stroke-width="3">'
                 '<title>goal</title></circle>')
    for i, core in enumerate(known):
        y = (top - bottom) * SCALE + 24 * i + 12
        lines.append(f'<rect x="12" y="{y - 6:.0f}" width="28" height="5" '
                     f'fill="{COLOURS[i % len(COLOURS)]}"/>')
        lines.append(f'<text x="48" y="{y + 2:.0f}">{core}</text>')
    return "\n".join([*lines, "</svg>", ""])


def text(path, obstacles, goal, width=72):
    left, bottom, right, top = bounds(path, obstacles, goal)
    step = (right - left) / width
    height = max(1, round((top - bottom) / (2 * step)))  # a character is twice as high as wide
    known = cores(path)

    def place(x, y):
        return (min(width - 1, int((x - left) / step)),
                min(height - 1, int((top - y) / (2 * step))))

    rows = [[" "] * width for _ in range(height)]
    for row in range(height):
        for column in range(width):
            x, y = left + (column + 0.5) * step, top - (row + 0.5) * 2 * step
            if any((x - ox) ** 2 + (y - oy) ** 2 < radius ** 2 for ox, oy, radius in obstacles):
                rows[row][column] = "#"
    for x, y, core in path:
        column, row = place(x, y)
        rows[row][column] = "123456789"[known.index(core) % 9]
    for mark, point in (("S", path[0][:2] if path else goal), ("G", goal)):
        column, row = place(*point)
        rows[row][column] = mark
    legend = "   ".join(f"{i + 1} {core}" for i, core in enumerate(known))
    frame = "+" + "-" * width + "+"
    return "\n".join([frame, *("|" + "".join(row) + "|" for row in rows), frame,
                      f"S start   G goal   # obstacle   {legend}"])
