# SPDX-License-Identifier: MIT
"""What model.py needs of a scene: points, triangles and springs of sheets and meshes."""
from pathlib import Path

import numpy as np


class Surface:
    """Triangles of a body or a mesh collider; `first` is the number of its first point."""

    def __init__(self, triangles, first, n):
        self.triangles, self.points = triangles + first, np.arange(first, first + n)
        sides = np.sort(np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        self.edges, index, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        # (t, 3) of side k of a triangle: whether another triangle has it, and that one's third vertex
        index = index.reshape(3, -1).T
        self.inner = count[index] == 2
        third = np.roll(self.triangles, -2, axis=1)
        total = np.zeros(len(self.edges), int)
        np.add.at(total, index, third)
        self.across = np.where(self.inner, total[index] - third, -1)
        fans = np.bincount(self.triangles.ravel(), minlength=first + n)
        self.share = np.where(np.isin(self.triangles, self.edges[count == 1]), 0, 1 / fans[self.triangles])
        self.joined = {tuple(edge) for edge in self.edges} | {tuple(edge[::-1]) for edge in self.edges}


def read_obj(path):
    rows = [line.split() for line in Path(path).read_text().splitlines()]
    return (np.array([r[1:4] for r in rows if r[:1] == ["v"]], float),
            np.array([[word.split("/")[0] for word in r[1:4]] for r in rows if r[:1] == ["f"]], int) - 1)


def read_grid(body, _):
    """Positions at rest, which are those at the start, triangles, ends of springs."""
    cloth, (columns, rows) = body["cloth"], body["cloth"]["grid"]
    number = np.arange(rows * columns).reshape(rows, columns)
    a = (np.arange(columns) / (columns - 1) - 0.5) * cloth["size"][0]
    b = (np.arange(rows) / (rows - 1) - 0.5) * cloth["size"][1]
    across, down = (grid.ravel() for grid in np.meshgrid(a, b))
    flat = cloth.get("start", "hanging") == "flat"
    own = np.stack([across, 0 * down if flat else -down, down if flat else 0 * down], axis=1)
    kinds = []
    for kind, steps in (("stretch", ((0, 1), (1, 0))), ("shear", ((1, 1), (1, -1))), ("bend", ((0, 2), (2, 0)))):
        for i, j in steps:
            low, high = max(0, -j), columns - max(0, j)
            kinds.append((kind, np.stack([number[:rows - i, low:high].ravel(),
                                          number[i:, low + j:high + j].ravel()], axis=1)))
    corner = number[:-1, :-1].ravel()  # a cell's triangles share the diagonal from top right to bottom left
    below = corner + columns
    cells = np.stack([corner, below, corner + 1, corner + 1, below, below + 1], 1).reshape(-1, 3)
    return own, cells, kinds


def read_mesh(body, folder):
    """The same of a mesh: springs along edges, and across them between the third vertices."""
    own, triangles = read_obj(folder / body["mesh"]["file"])
    surface = Surface(triangles, 0, len(own))
    third = np.roll(triangles, -2, axis=1)
    across = np.stack([third, surface.across], -1)[surface.inner]
    bends = np.unique(across[across[:, 0] < across[:, 1]], axis=0)
    return own, triangles, [("stretch", surface.edges), ("bend", bends)]
