"""Elasticity matrices of materials and layers, in directions of the layer.

All kernels that compute strains and stresses take this matrix. Its directions are along the layer,
around the drum's centre or straight on, and through its thickness. With the strains along and
through the layer and the shear gamma between both,

    sigma = D eps,   eps = (eps_along, eps_through, gamma),   D_13 = D_23 = 0.

The matrix of an isotropic material is the same in all directions: D_11 = D_22 = D_12 + 2 D_33.
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.fields import AnyMaterial, Material

ISOTROPIC_WITHIN = 1e-14
"""Relative difference between D_11 or D_22 and D_12 + 2 D_33 up to which a material is isotropic.

Round-off makes differences of some 1e-16 in isotropic materials.
"""


def elasticity_matrix(material: AnyMaterial) -> Floats:
    """Elasticity matrix (3, 3) [Pa] of a material in plane stress, in directions of the layer.

    It is the inverse of the matrix of compliances, whose entries are 1/E_along, 1/E_through,
    -nu_along_through/E_along and 1/G_along_through.
    """
    if isinstance(material, Material):
        E, nu = material.E, material.nu
        lam, mu = E * nu / (1 - nu**2), E / (2 * (1 + nu))
        stiff = lam + 2 * mu
        return np.array([[stiff, lam, 0.0], [lam, stiff, 0.0], [0.0, 0.0, mu]])
    along, through, nu = material.E_along, material.E_through, material.nu_along_through
    share = 1 - nu**2 * through / along
    coupled = nu * through / share
    return np.array(
        [
            [along / share, coupled, 0.0],
            [coupled, through / share, 0.0],
            [0.0, 0.0, material.G_along_through],
        ]
    )


def solid_elasticity_matrix(material: Material) -> Floats:
    """Elasticity matrix (6, 6) [Pa] of an isotropic solid.

    Its rows and columns are the strains xx, yy, zz and the shears yz, zx, xy.
    """
    E, nu = material.E, material.nu
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    found = np.diag([2 * mu] * 3 + [mu] * 3)
    found[:3, :3] += lam
    return found


class ElasticLayer(NamedTuple):
    """Stiffness and directions of a layer, as kernels need them.

    Attributes
    ----------
    elasticity : (3, 3), the `elasticity_matrix` [Pa]; of a solid (6, 6)
    width : across the plane [m]; of a solid a plain factor
    along : (2,), direction of a straight layer; None of a layer around the drum's centre, which is
        the origin
    """

    elasticity: Floats
    width: float
    along: Floats | None = None

    @classmethod
    def of(cls, material: AnyMaterial, width: float, along: Floats | None = None) -> "ElasticLayer":
        """Make the layer of a material in plane stress."""
        return cls(elasticity_matrix(material), width, along)

    @property
    def stiffness(self) -> Floats:
        """The elasticity matrix times the width [N/m]."""
        return self.elasticity * self.width

    def directions(self, points: Any) -> Any:
        """Unit vectors along the layer (2, ...) at points (2, ...) [m], in their precision."""
        if self.along is None:
            x, y = points
            return np.stack([-y, x]) / np.hypot(x, y)
        straight = self.along.reshape(2, *(1,) * (points.ndim - 1))
        return np.broadcast_to(straight.astype(points.dtype), points.shape)


def stiffer_along_and_through(elasticity: Any) -> Any:
    """Excess (..., 2) of D_11 and D_22 over D_12 + 2 D_33, of elasticity matrices (..., 3, 3).

    It is zero for isotropic matrices.
    """
    isotropic = elasticity[..., 0, 1] + 2 * elasticity[..., 2, 2]
    along, through = elasticity[..., 0, 0] - isotropic, elasticity[..., 1, 1] - isotropic
    found = np.stack([along, through], axis=-1)
    round_off = ISOTROPIC_WITHIN * np.abs(isotropic)[..., None]
    return np.where(np.abs(found) > round_off, found, 0.0)


def has_directions(elasticity: Floats) -> Bools:
    """Whether each of the elasticity matrices (..., 3, 3) is not isotropic, (...)."""
    return np.asarray(stiffer_along_and_through(elasticity).any(axis=-1))
