"""The content of a mesh file of any format: nodes, cells, named groups and notes of the reader."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from drumlin.base.arrays import Floats, Ints

CellGroups = Mapping[str, Mapping[str, Ints]]
"""Rows of the cells in a group: group name -> meshio's cell type -> rows (m,)."""


@dataclass(frozen=True)
class FileContent:
    """The content of a mesh file, as the reader of its format hands it on.

    Parameters
    ----------
    points : (n, 2) or (n, 3), coordinates in the file's unit
    cells : nodes (m, k) of the cells of each type, as numbers of points; types as meshio names them
    cell_groups : cells in each named group
    node_groups : numbers of the points (m,) in each named group
    edge_groups : corner points (m, 2) of the edges in each named group
    outer_groups : as edge_groups; those edges count only that lie on the outline
    rounding : (n, 2), how far the writer of the file may have rounded x and y, in the file's unit;
        None where this is to be found from the coordinates
    turned : whether the reader turned the coordinates, so that roundings of x and y mix
    broken : reasons why a group of the file cannot be read, by its name
    notes : lines about what was passed over
    """

    points: Floats
    cells: Mapping[str, Ints]
    cell_groups: CellGroups = field(default_factory=dict)
    node_groups: Mapping[str, Ints] = field(default_factory=dict)
    edge_groups: Mapping[str, Ints] = field(default_factory=dict)
    outer_groups: Mapping[str, Ints] = field(default_factory=dict)
    rounding: Floats | None = None
    turned: bool = False
    broken: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def group_names(self) -> list[str]:
        """The names of all groups, each once, in the order of the file."""
        groups = (self.cell_groups, self.node_groups, self.edge_groups, self.outer_groups)
        return list(dict.fromkeys(name for kind in groups for name in kind))


MOST_DECIMALS = 12
"""Number of decimals, or of significant digits, from which on a coordinate counts as exact.

Double precision has 16 digits. The rounding of 12 digits is a billionth of the lining's
compression.
"""
DIGIT_SLACK = 1e-3
"""Distance of a coordinate from a decimal grid, in steps, up to which it counts as rounded to it.

The round-off of reading is far smaller. Coordinates with all digits lie anywhere in a step.
"""


def rounding_errors_of_coordinates(points: Floats) -> Floats:
    """The largest rounding error (n, k) of coordinates (n, k) that were written as text.

    The rounding error is half a step of the coarsest decimal grid that all coordinates lie on. The
    grid has one number of decimals, or one number of significant digits.
    """
    size = np.abs(points)
    exponents = np.floor(np.log10(np.where(size > 0, size, 1.0))) + 1
    found = np.zeros(points.shape)
    for steps in (_find_decimal_steps(points), _find_digit_steps(points, exponents)):
        if steps is not None:
            found = np.maximum(found, 0.5 * steps)
    return found


def _find_decimal_steps(points: Floats) -> Floats | None:
    """The step of the coarsest grid of decimals that all coordinates lie on; None without a grid.

    The step is repeated for each coordinate (n, k).
    """
    largest = int(np.floor(np.log10(max(float(np.abs(points).max(initial=0.0)), 1e-300))))
    for decimals in range(-largest, MOST_DECIMALS - largest):
        step = 10.0**-decimals
        if _lie_on_grid(points, step):
            return np.full(points.shape, step)
    return None


def _find_digit_steps(points: Floats, exponents: Floats) -> Floats | None:
    """The steps (n, k) of the coarsest grid of significant digits that all coordinates lie on.

    None without a grid.
    """
    for digits in range(1, MOST_DECIMALS):
        steps = 10.0 ** (exponents - digits)
        if _lie_on_grid(points, steps):
            return np.where(points == 0, 0.0, steps)
    return None


def _lie_on_grid(points: Floats, step: Floats | float) -> bool:
    """Whether all coordinates are whole multiples of the step, but for round-off."""
    multiples = points / step
    return bool(np.all(np.abs(multiples - np.round(multiples)) <= DIGIT_SLACK))
