"""Elasticity matrices of materials and layers, in the axes of the layer.

The finite elements take the material of a layer as this matrix D. Its axes are the direction along
the layer (a circle around the drum's centre, or a straight line) and the direction through its
thickness. With the strains in these two directions and the shear strain gamma,

    sigma = D eps,   eps = (eps_along, eps_through, gamma),   D_13 = D_23 = 0.

The matrix of an isotropic material is the same in all axes: D_11 = D_22 = D_12 + 2 D_33.
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.fields import IsotropicOrOrthotropicMaterial, Material

RELATIVE_TOLERANCE_OF_ISOTROPY = 1e-14
"""Largest difference of D_11 and D_22 from D_12 + 2 D_33, relative to this sum, that is round-off.

A material with a larger difference counts as orthotropic. In isotropic materials round-off causes
differences of some 1e-16.
"""


def plane_stress_elasticity_matrix(material: IsotropicOrOrthotropicMaterial) -> Floats:
    """Elasticity matrix (3, 3) [Pa] of a material in plane stress, in the axes of its layer.

    It is the inverse of the compliance matrix, with the entries 1/E_along, 1/E_through and
    1/G_along_through on the diagonal and -nu_along_through/E_along beside it.
    """
    if isinstance(material, Material):
        E, nu = material.E, material.nu
        lam, mu = E * nu / (1 - nu**2), E / (2 * (1 + nu))
        stiff = lam + 2 * mu
        return np.array([[stiff, lam, 0.0], [lam, stiff, 0.0], [0.0, 0.0, mu]])
    along, through, nu = material.E_along, material.E_through, material.nu_along_through
    # `share` is the determinant of the compliances of the two normal strains, times both Young's
    # moduli.
    share = 1 - nu**2 * through / along
    coupled = nu * through / share
    return np.array(
        [
            [along / share, coupled, 0.0],
            [coupled, through / share, 0.0],
            [0.0, 0.0, material.G_along_through],
        ]
    )


class ElasticLayer(NamedTuple):
    """The elasticity matrix, width and direction of a layer, for its finite elements.

    Attributes
    ----------
    elasticity : (3, 3), the `plane_stress_elasticity_matrix` [Pa]
    width : width across the plane of the brake [m]
    along : (2,), direction of a straight layer; None for a layer that is an arc about the drum's
        centre, which is the origin
    """

    elasticity: Floats
    width: float
    along: Floats | None = None

    @classmethod
    def make_layer_in_plane_stress(
        cls, material: IsotropicOrOrthotropicMaterial, width: float, along: Floats | None = None
    ) -> "ElasticLayer":
        """Make a layer in plane stress: `width` [m] and `along` are the attributes of the layer."""
        return cls(plane_stress_elasticity_matrix(material), width, along)

    @property
    def elasticity_times_width(self) -> Floats:
        """The elasticity matrix times the width of the layer [N/m]."""
        return self.elasticity * self.width

    def unit_vectors_along_layer(self, points: Any) -> Any:
        """Unit vectors (2, ...) along the layer at points (2, ...) [m].

        Their floating-point type, such as double precision, is that of the points.
        """
        if self.along is None:
            x, y = points
            return np.stack([-y, x]) / np.hypot(x, y)
        straight = self.along.reshape(2, *(1,) * (points.ndim - 1))
        return np.broadcast_to(straight.astype(points.dtype), points.shape)


def normal_stiffness_in_excess_of_isotropic(elasticity: Any) -> Any:
    """How much D_11 and D_22 of elasticity matrices D (..., 3, 3) exceed D_12 + 2 D_33.

    The result (..., 2) [Pa] has both differences. They are 0 for isotropic matrices.
    """
    isotropic = elasticity[..., 0, 1] + 2 * elasticity[..., 2, 2]
    along, through = elasticity[..., 0, 0] - isotropic, elasticity[..., 1, 1] - isotropic
    found = np.stack([along, through], axis=-1)
    round_off = RELATIVE_TOLERANCE_OF_ISOTROPY * np.abs(isotropic)[..., None]
    return np.where(np.abs(found) > round_off, found, 0.0)


def which_elasticity_matrices_are_orthotropic(elasticity: Floats) -> Bools:
    """Whether each elasticity matrix of an array (..., 3, 3) is not isotropic; shape (...)."""
    return np.asarray(normal_stiffness_in_excess_of_isotropic(elasticity).any(axis=-1))
