"""Uncertainty of a mesh and of a comparison: Roache's grid convergence index, and the validation of
ASME V&V 20.
"""

import math
from typing import NamedTuple

from drumlin.comparison import extrapolate

SAFETY = 1.25
"""Factor of safety of the index where three meshes show the order (Roache 1994; 3 where only two
are there).
"""


class Index(NamedTuple):
    """What three meshes say of a value: observed `order`, the value `extrapolated` to no mesh size,
    and the grid convergence index of the `fine` and of the `coarse` pair of meshes, relative to the
    finer value of each.

    `asymptotic`: coarse over r^p fine; near 1 the meshes show the leading term of the error.
    """

    order: float
    extrapolated: float
    fine: float
    coarse: float
    asymptotic: float


def grid_convergence(
    fine: float, medium: float, coarse: float, ratio: float = 2.0, safety: float = SAFETY
) -> Index:
    """The grid convergence index of values on three meshes, each `ratio` times as coarse as the one
    before.

        p = ln((f3 - f2)/(f2 - f1))/ln r,   f = f1 + (f1 - f2)/(r^p - 1),   GCI = F |(f1 - f2)/f1|/(r^p - 1)

    (Roache 1994, J. Fluids Eng. 116, 405.) Raises ValueError where the differences do not shrink
    with one sign: there is no order then.
    """
    near, far = fine - medium, medium - coarse
    if near * far <= 0 or abs(far) <= abs(near):
        raise ValueError(
            f"no order: the differences {far:g} and {near:g} do not shrink with one sign"
        )
    found = extrapolate(coarse, medium, fine, ratio)
    growth = ratio**found.order
    first = safety * found.uncertainty / abs(fine)
    second = safety * found.uncertainty * growth / abs(medium)
    return Index(found.order, found.value, first, second, second / (growth * first))


class Validation(NamedTuple):
    """A simulation against data (ASME V&V 20-2009, section 1-5): comparison error E = S - D, and
    its uncertainty.

    `uncertainty`: u_val, of all that is not the model; the model's own error lies within E -+
    u_val.
    """

    error: float
    uncertainty: float

    @property
    def model_error(self) -> tuple[float, float]:
        """The interval (two ends) in which the model's error lies."""
        return self.error - self.uncertainty, self.error + self.uncertainty

    @property
    def resolved(self) -> bool:
        """Whether the error of the model is seen: |E| > u_val. Else it is lost in what is not
        known.
        """
        return abs(self.error) > self.uncertainty


def validate(
    simulation: float, data: float, *, numerical: float, inputs: float = 0.0, of_data: float
) -> Validation:
    """E = S - D with u_val^2 = u_num^2 + u_input^2 + u_D^2, all in the unit of the value and of one
    coverage.

    `numerical`: of the simulation's mesh and solver; `inputs`: what its inputs' uncertainty does;
    `of_data`: of the data, or of the reference that stands for it.
    """
    return Validation(simulation - data, math.sqrt(numerical**2 + inputs**2 + of_data**2))
