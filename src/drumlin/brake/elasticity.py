"""The elasticity of materials and layers: one matrix, in directions of the layer's own.

All that computes strains and stresses takes this matrix: elements and columns, meshes, mutual
works, fields, the second solver and the peers. The directions are the one along the layer, which
runs around the drum's centre or straight on, and the one through its thickness. With the strains
eps along and through the layer and the shear gamma between both,

    sigma = D eps,   eps = (eps_along, eps_through, gamma),   D_13 = D_23 = 0.

An isotropic material has no directions: its D is the same in all, D_11 = D_22 = D_12 + 2 D_33.
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.fields import AnyMaterial, Material

ISOTROPIC_WITHIN = 1e-14
"""Part of D_12 + 2 D_33 below which the difference of D_11 or D_22 to it is round-off. The
differences of isotropic materials are some 1e-16 of it."""


def elasticity_matrix(material: AnyMaterial) -> Floats:
    """Elasticity matrix (3, 3) [Pa] of a material in plane stress, in the layer's own directions.

    It takes strains along the layer and through its thickness and the shear between both to
    stresses. It is the inverse of the compliances

        1/E_along, 1/E_through, -nu_along_through/E_along and 1/G_along_through.
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
    """Elasticity matrix (6, 6) [Pa] of an isotropic solid: strains xx, yy, zz and shears yz, zx, xy
    to stresses."""
    E, nu = material.E, material.nu
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    found = np.diag([2 * mu] * 3 + [mu] * 3)
    found[:3, :3] += lam
    return found


class ElasticLayer(NamedTuple):
    """What kernels need to know of a layer.

    `elasticity` (3, 3) [Pa]: its `elasticity_matrix`; of a solid (6, 6). `width` [m]: across the
    plane; of a solid a plain factor. `along` (2,): the direction of a straight layer; None of a
    layer around the origin, which is the drum's centre.
    """

    elasticity: Floats
    width: float
    along: Floats | None = None

    @classmethod
    def of(cls, material: AnyMaterial, width: float, along: Floats | None = None) -> "ElasticLayer":
        """The layer of a material in plane stress."""
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
    """D_11 and D_22 (..., 2) of elasticity matrices (..., 3, 3), less D_12 + 2 D_33; zero of
    isotropic ones."""
    isotropic = elasticity[..., 0, 1] + 2 * elasticity[..., 2, 2]
    found = np.stack(
        [elasticity[..., 0, 0] - isotropic, elasticity[..., 1, 1] - isotropic], axis=-1
    )
    return np.where(np.abs(found) > ISOTROPIC_WITHIN * np.abs(isotropic)[..., None], found, 0.0)


def has_directions(elasticity: Floats) -> Bools:
    """Which of the elasticity matrices (..., 3, 3) differ from an isotropic one, (...)."""
    return np.asarray(stiffer_along_and_through(elasticity).any(axis=-1))
