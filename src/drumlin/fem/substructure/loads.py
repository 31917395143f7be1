"""The load columns of a body: which columns of its load matrices belong to which unit load.

A body is condensed once for all unit loads that its model needs. Each load has a name and one
column for each of its components. The actuation has three components: unit force x, unit force y
and unit couple on the loaded end, or on the frame of a body whose back is held. All other forces,
the forces on the mass and the thermal strain have names of their own. A caller gives the factors of
the acting loads by name, and receives the factors of all columns.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drumlin.base.arrays import Floats, slices_from_lengths_of_consecutive_parts

ACTUATION_LOAD_NAME = "actuation"
"""Name of the unit loads of a shoe's actuation force on its body: force x, force y and couple."""
HEAT_LOAD_NAME = "heat"
"""Name of the load of a heated shoe: the nodal forces of its free strains, in one column."""
CHANGED_SHAPE_LOAD_NAME = "changed shape"
"""Name of the load of a slightly changed mesh.

Its only column has nodal forces that act, to first order, like small moves of the mesh's nodes.
"""
FURTHER_FORCE_LOAD_NAME = "further forces"
"""Name of the unit loads at the points of springs and other forces: force x, y at each point."""
MASS_LOAD_NAME = "forces on mass"
"""Name of the unit loads on a shoe's mass of 1 kg: unit acceleration x, y, and centrifugal force at
the angular speed 1 rad/s.
"""


@dataclass(frozen=True)
class ColumnsOfUnitLoads:
    """The load columns of a body: which columns belong to which unit load.

    `sizes` are the name of each load and the number of its columns, in the order of the columns.
    """

    sizes: tuple[tuple[str, int], ...] = ()

    @classmethod
    def columns_of_named_unit_loads(cls, loads: Mapping[str, Floats]) -> "ColumnsOfUnitLoads":
        """Make the load columns of unit loads, given by name as arrays (unknowns, k)."""
        return cls(tuple((name, forces.shape[1]) for name, forces in loads.items()))

    @cached_property
    def column_slice_of_each_load(self) -> dict[str, slice]:
        """For each load, by its name, the slice of its columns among all load columns."""
        names = [name for name, _ in self.sizes]
        return dict(
            zip(
                names,
                slices_from_lengths_of_consecutive_parts(size for _, size in self.sizes),
                strict=True,
            )
        )

    @property
    def number_of_load_columns(self) -> int:
        """Number of columns of all unit loads of the body together."""
        return sum(size for _, size in self.sizes)

    def column_factors_of_all_loads(self, acting: Mapping[str, Floats]) -> Floats:
        """Factors (l,) of all load columns, zero for loads that do not act.

        Parameters
        ----------
        acting : factors (k,) of each load that acts, by the name of the load

        Raises
        ------
        KeyError
            for an unknown name
        """
        factors = np.zeros(self.number_of_load_columns)
        for name, own in acting.items():
            factors[self.column_slice_of_each_load[name]] = own
        return factors

    def column_factors_of_one_named_load(self, name: str, factors: Floats) -> Floats:
        """The factors (k, ...) of the load `name`, out of the factors (l, ...) of all columns."""
        return factors[self.column_slice_of_each_load[name]]


def stack_nodal_loads_as_matrix_columns(loads: Mapping[str, Floats], unknowns: int) -> Floats:
    """The columns (unknowns, l) of all loads side by side, in the order of the loads."""
    return np.concatenate([np.zeros((unknowns, 0)), *loads.values()], axis=1)
