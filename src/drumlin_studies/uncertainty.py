"""The uncertainty of a value due to its mesh, and of the comparison of a simulation with data.

The measure of the uncertainty due to the mesh is Roache's grid convergence index. The uncertainty
of a comparison is the validation uncertainty of ASME V&V 20.
"""

import math
from typing import NamedTuple

from drumlin.comparison import richardson_limit_from_three_meshes

CONVERGENCE_INDEX_SAFETY_FACTOR = 1.25
"""Factor of safety of the grid convergence index, by which the extrapolated error is multiplied.

The value applies if three meshes show the order of convergence (Roache 1994). With two meshes
Roache uses the value 3.
"""


class GridConvergenceIndex(NamedTuple):
    """Richardson extrapolation and grid convergence index from three meshes.

    Attributes
    ----------
    order : float
        Observed order of convergence.
    extrapolated : float
        The value for a mesh size of zero.
    fine, coarse : float
        Grid convergence index, a relative uncertainty, of the finer and of the coarser pair of
        meshes. It is relative to the value on the finer mesh of the pair.
    asymptotic : float
        Index of the coarser pair, divided by r^p times the index of the finer pair, with the ratio
        r of the mesh sizes and the order p. Near 1 the errors on these meshes fall with the order
        p.
    """

    order: float
    extrapolated: float
    fine: float
    coarse: float
    asymptotic: float


def grid_convergence_index_of_three_values(
    fine: float,
    medium: float,
    coarse: float,
    ratio: float = 2.0,
    safety: float = CONVERGENCE_INDEX_SAFETY_FACTOR,
) -> GridConvergenceIndex:
    """Order of convergence, extrapolated value and grid convergence index from three meshes.

    The values on the fine, medium and coarse mesh are f1, f2 and f3:

        p = ln((f3 - f2)/(f2 - f1))/ln r
        f = f1 + (f1 - f2)/(r^p - 1)
        GCI = F |(f1 - f2)/f1|/(r^p - 1)

    (Roache 1994, J. Fluids Eng. 116, 405.)

    Parameters
    ----------
    fine, medium, coarse : float
        The value on each mesh.
    ratio : float
        Ratio r of the mesh sizes of two neighbouring meshes.
    safety : float
        Factor of safety F.

    Raises
    ------
    ValueError
        The two differences have opposite signs, or the finer difference is not the smaller one.
        The values then show no order of convergence.
    """
    near, far = fine - medium, medium - coarse
    if near * far <= 0 or abs(far) <= abs(near):
        raise ValueError(
            f"no order: the differences {far:g} and {near:g} do not shrink with one sign"
        )
    # Richardson extrapolation gives the order and the limit. The indices follow from the distance
    # of the fine value from this limit.
    limit = richardson_limit_from_three_meshes(coarse, medium, fine, ratio)
    growth = ratio**limit.order
    fine_index = safety * limit.uncertainty / abs(fine)
    coarse_index = safety * limit.uncertainty * growth / abs(medium)
    asymptotic = coarse_index / (growth * fine_index)
    return GridConvergenceIndex(limit.order, limit.value, fine_index, coarse_index, asymptotic)


class ComparisonOfSimulationWithData(NamedTuple):
    """The comparison of a simulation S with data D (ASME V&V 20-2009, section 1-5).

    Attributes
    ----------
    error : float
        Comparison error E = S - D.
    uncertainty : float
        Validation uncertainty u_val of E: due to mesh, inputs and data, but not due to the model.
        The error of the model lies between E - u_val and E + u_val.
    """

    error: float
    uncertainty: float

    @property
    def model_error_interval(self) -> tuple[float, float]:
        """The two ends E - u_val and E + u_val of the interval in which the model's error lies."""
        return self.error - self.uncertainty, self.error + self.uncertainty

    @property
    def is_model_error_detected(self) -> bool:
        """Whether |E| > u_val, so that the comparison shows an error of the model."""
        return abs(self.error) > self.uncertainty


def compare_simulated_value_with_reference_value(
    simulation: float, data: float, *, numerical: float, inputs: float = 0.0, of_data: float
) -> ComparisonOfSimulationWithData:
    """The comparison error E = S - D with its validation uncertainty u_val.

    u_val^2 = u_num^2 + u_input^2 + u_D^2. All uncertainties have the unit of S and D and the same
    coverage factor.

    Parameters
    ----------
    simulation, data : float
        The value S of the simulation and the value D of the data.
    numerical : float
        Uncertainty u_num by the mesh and the solver.
    inputs : float
        Uncertainty u_input by the inputs of the simulation.
    of_data : float
        Uncertainty u_D of the data, or of the reference in their place.
    """
    return ComparisonOfSimulationWithData(
        simulation - data, math.sqrt(numerical**2 + inputs**2 + of_data**2)
    )
