# SPDX-License-Identifier: LGPL-3.0-or-later
"""The way driven on its map, in characters for a terminal."""

OCCUPIED = 65  # of occupancy_grid/1, 0 to 100


def cores(path):
    """The cores that drove, in their order."""
    return list(dict.fromkeys(core for _, _, core in path))


def text(grid, path, goal, width=96):
    """grid: a value of occupancy_grid/1; path: (x, y, core); goal: (x, y)."""
    per_column = grid["width"] / width  # cells
    height = max(1, round(grid["height"] / (2 * per_column)))  # a character is twice as high as wide
    per_row = grid["height"] / height
    known = cores(path)
    rows = [[" "] * width for _ in range(height)]

    def place(x, y):
        column = (x - grid["origin"]["x"]) / grid["resolution"] / per_column
        row = (y - grid["origin"]["y"]) / grid["resolution"] / per_row
        return (max(0, min(width - 1, int(column))), max(0, min(height - 1, height - 1 - int(row))))

    for index, cell in enumerate(grid["cells"]):
        if cell > OCCUPIED:
            row, column = divmod(index, grid["width"])
            rows[height - 1 - int(row / per_row)][int(column / per_column)] = "#"
    for x, y, core in path:
        column, row = place(x, y)
        rows[row][column] = "123456789"[known.index(core) % 9]
    for mark, point in (("S", path[0][:2] if path else goal), ("G", goal)):
        column, row = place(*point)
        rows[row][column] = mark
    legend = "   ".join(f"{i + 1} {core}" for i, core in enumerate(known))
    return "\n".join([*("".join(row).rstrip() for row in rows), f"S start   G goal   # wall   {legend}"])
