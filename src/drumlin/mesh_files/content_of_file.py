"""The content of a mesh file of any format: nodes, cells, named groups and the reader's notes."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from drumlin.base.arrays import Floats, Ints

CellNumbersByGroupAndType = Mapping[str, Mapping[str, Ints]]
"""The cells in each group: group name -> meshio's cell type -> indices (m,) of the cells.

The index of a cell is its position among all cells of its type.
"""


@dataclass(frozen=True)
class MeshFileContent:
    """The content of a mesh file, as the reader of its format returns it.

    Parameters
    ----------
    points : (n, 2) or (n, 3) coordinates of the nodes in the file's unit
    cells : nodes (m, k) of the cells of each type, by meshio's name of the type
    cell_groups : cells in each named group
    node_groups : nodes (m,) in each named group
    edge_groups : corner nodes (m, 2) of the edges in each named group
    rounding : (n, 2) largest rounding error of x and y in the file, in the file's unit; None if it
        has to be found from the coordinates
    turned : whether the reader rotated the coordinates, which mixes the rounding errors of x and y
    broken : reasons why a group of the file cannot be read, by the group's name
    notes : lines that tell which parts of the file were ignored
    """

    points: Floats
    cells: Mapping[str, Ints]
    cell_groups: CellNumbersByGroupAndType = field(default_factory=dict)
    node_groups: Mapping[str, Ints] = field(default_factory=dict)
    edge_groups: Mapping[str, Ints] = field(default_factory=dict)
    rounding: Floats | None = None
    turned: bool = False
    broken: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def names_of_all_groups(self) -> list[str]:
        """The names of all groups in the file, each once."""
        groups = (self.cell_groups, self.node_groups, self.edge_groups)
        return list(dict.fromkeys(name for kind in groups for name in kind))


FEWEST_DIGITS_OF_EXACT_COORDINATE = 12
"""Smallest number of digits with which a coordinate in a mesh file counts as exact.

The digits are decimals or significant digits. Double precision has 16 digits. Rounding to 12 digits
moves a node by some billionths of the lining's compression.
"""
ROUND_DECIMAL_COORDINATE_TOLERANCE = 1e-3
"""Largest distance from a round decimal number at which a coordinate counts as this number.

The distance is relative to the step between round numbers, such as 0.01 for two decimals. The
round-off of reading a number is far smaller. The distance of a coordinate that was written with all
its digits is arbitrary.
"""


def largest_rounding_errors_of_coordinates(points: Floats) -> Floats:
    """The largest possible rounding error (n, k) of coordinates (n, k) that were written as text.

    All coordinates are assumed to be written with the same number of decimals, or with the same
    number of significant digits. The smallest number of digits that all coordinates agree with is
    found. The rounding error is half of the last digit.
    """
    # The place of the last digit of a subnormal number (below 2.2e-308) is too small for a double.
    # Such a coordinate counts as zero.
    points = np.where(np.abs(points) < np.finfo(float).tiny, 0.0, points)
    # The coordinates may agree with both assumptions: with a number of decimals, and with a number
    # of significant digits. The larger of the two rounding errors then counts.
    size = np.abs(points)
    exponents = np.floor(np.log10(np.where(size > 0, size, 1.0))) + 1
    found = np.zeros(points.shape)
    for steps in (
        _place_values_of_last_decimal(points),
        _place_values_of_last_significant_digit(points, exponents),
    ):
        if steps is not None:
            found = np.maximum(found, 0.5 * steps)
    return found


def _place_values_of_last_decimal(points: Floats) -> Floats | None:
    """The value of the last decimal of coordinates that all have the same number of decimals.

    For two decimals the value is 0.01. It is repeated for each coordinate (n, k). None is returned
    if the coordinates have more than about FEWEST_DIGITS_OF_EXACT_COORDINATE digits.
    """
    # More and more decimals are tried, beginning with the leading digit of the largest coordinate.
    largest = int(np.floor(np.log10(max(float(np.abs(points).max(initial=0.0)), 1e-300))))
    for decimals in range(-largest, FEWEST_DIGITS_OF_EXACT_COORDINATE - largest):
        step = 10.0**-decimals
        if _is_each_coordinate_multiple_of_step(points, step):
            return np.full(points.shape, step)
    return None


def _place_values_of_last_significant_digit(points: Floats, exponents: Floats) -> Floats | None:
    """The value (n, k) of the last digit of coordinates with the same number of significant digits.

    For 12.34 with four digits the value is 0.01. None is returned if the coordinates have
    FEWEST_DIGITS_OF_EXACT_COORDINATE digits or more. `exponents` (n, k) are the numbers of digits
    before the point.
    """
    for digits in range(1, FEWEST_DIGITS_OF_EXACT_COORDINATE):
        steps = 10.0 ** (exponents - digits)
        if _is_each_coordinate_multiple_of_step(points, steps):
            return np.where(points == 0, 0.0, steps)
    return None


def _is_each_coordinate_multiple_of_step(points: Floats, step: Floats | float) -> bool:
    """Whether all coordinates are whole multiples of the step, up to round-off."""
    multiples = points / step
    return bool(
        np.all(np.abs(multiples - np.round(multiples)) <= ROUND_DECIMAL_COORDINATE_TOLERANCE)
    )
