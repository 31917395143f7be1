"""The elastic layers of shoes and rings, and the constants from which their stiffness is computed.

The elasticity matrix D of a layer (brake.elasticity) is split into an isotropic part, which is
integrated for all layers at once, and the additional stiffness along and through the layer,

    sigma = lambda tr(eps) 1 + 2 mu eps + a eps_along t t^T + b eps_through n n^T

with the stress sigma, the strain eps, the unit vectors t along and n through the layer, lambda =
D_12, mu = D_33, a = D_11 - lambda - 2 mu and b = D_22 - lambda - 2 mu. Isotropic layers have a = b
= 0, and the terms with a and b are skipped.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody, RectangularCrossSection
from drumlin.brake.elasticity import ElasticLayer, normal_stiffness_in_excess_of_isotropic


def elastic_layers_of_shoe(shoe: Shoe) -> dict[str, ElasticLayer]:
    """The elastic layers of a shoe by name of subdomain, with their directions in the shoe's frame.

    On a drum the directions of a layer follow the arc. The layers of a pad on a plane have one
    direction, along x. A straight beam and the block between it and its lining have the direction
    of the beam.
    """
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    around: Floats | None = None
    behind: Floats | None = None
    if shoe.is_on_plane:
        around = behind = np.array([1.0, 0.0])
    elif isinstance(body, BeamBody):
        behind = shoe.frame.convert_vectors_to_shoe_frame(
            make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy).along
        )
    layers = {
        "lining": ElasticLayer.make_layer_in_plane_stress(lining.material, lining.width, around)
    }
    if backing is not None:
        layers["backing"] = ElasticLayer.make_layer_in_plane_stress(
            backing.material, lining.width, behind
        )
    if body is not None:
        for name, plate in body.plates.items():
            layers[name] = ElasticLayer.make_layer_in_plane_stress(
                plate.material, plate.width, behind
            )
    return layers


def elastic_layers_of_ring(section: RectangularCrossSection) -> dict[str, ElasticLayer]:
    """The elastic layer of a drum ring, under the name "drum" of the ring's only subdomain."""
    return {"drum": ElasticLayer.make_layer_in_plane_stress(section.material, section.width)}


def isotropic_and_orthotropic_elastic_constants(elasticity: Any) -> Any:
    """The constants lambda, mu, a, b (..., 4) of elasticity matrices D (..., 3, 3).

    The constants have the unit of the matrices. lambda = D_12 and mu = D_33 belong to the isotropic
    part; a and b are the additional stiffness along and through the layer.
    """
    isotropic = np.stack([elasticity[..., 0, 1], elasticity[..., 2, 2]], axis=-1)
    return np.concatenate([isotropic, normal_stiffness_in_excess_of_isotropic(elasticity)], axis=-1)


def elasticity_times_width_of_layers(
    layers: Mapping[str, ElasticLayer], part: Sequence[str]
) -> Floats:
    """Elasticity matrices times width (l, 3, 3) [N/m] of the l layers whose names are `part`."""
    return np.array([layers[name].elasticity_times_width for name in part])


def unit_vectors_through_thickness_of_layers(along: Any) -> Any:
    """Unit vectors (2, ...) through layers, from the unit vectors `along` the layers (2, ...)."""
    return np.stack([-along[1], along[0]])


def stresses_from_displacement_gradients(
    gradient: Floats, elasticity: Floats, along: Floats | None
) -> Floats:
    """Stresses (2, 2, ...) of displacement gradients, in the unit of `elasticity`.

    Parameters
    ----------
    gradient : (2, 2, ...) derivatives d u_i / d x_j
    elasticity : (..., 3, 3) elasticity matrix of each point, or one matrix of all points
    along : (2, ...) unit vectors along the layers; None if all layers are isotropic
    """
    lam, mu, a, b = np.moveaxis(isotropic_and_orthotropic_elastic_constants(elasticity), -1, 0)
    strain = 0.5 * (gradient + gradient.swapaxes(0, 1))
    stresses = 2 * mu * strain
    # The lambda of plane stress multiplies the sum of the two strains in the plane alone.
    for i in range(2):
        stresses[i, i] += lam * (gradient[0, 0] + gradient[1, 1])
    if along is not None:
        for stiffer, direction in (
            (a, along),
            (b, unit_vectors_through_thickness_of_layers(along)),
        ):
            stretch = np.einsum("i...,ij...,j...->...", direction, strain, direction)
            stresses += stiffer * stretch * direction[:, None] * direction
    return stresses
