"""Thermal strain and swelling: the nodal forces by which free strains load a body.

A free strain eps_0, by heat or swelling, causes no stress by itself: sigma = D (eps - eps_0). The
nodal forces

    f_ai = b Int sigma^0_ij psi_a,j dA,   sigma^0 = D eps_0

with the elasticity matrix D, the width b and the shape functions psi_a deform the body as the free
strain does (Duhamel's analogy: Timoshenko & Goodier, Theory of Elasticity, ch. 13). These forces
are in equilibrium. The stress in the body is the stress D eps of its strain eps minus sigma^0.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.elasticity import ElasticLayer
from drumlin.fem.substructure.body import quadrature_points_of_elements
from drumlin.fem.substructure.elasticity import (
    stresses_from_displacement_gradients,
    unit_vectors_through_thickness_of_layers,
)

FreeStrainFunctionByLayer = Mapping[str, Callable[[Floats], Floats]]
"""For each layer that expands, by its name, a function that returns its free strains.

The function takes points (2, ...) [m] and returns the free strains (2, ...) along and through the
layer. Both strains of a heated isotropic layer are its coefficient of expansion times its
temperature rise.
"""


def stress_times_width_of_free_strain(
    layer: ElasticLayer, strain: Floats, points: Floats
) -> Floats:
    """The stress D eps_0 of a layer's free strain eps_0, times the layer's width [N/m].

    The result is (2, 2, ...) at points (2, ...) [m]. `strain` (2, ...) are the free strains along
    and through the layer at these points.
    """
    along = layer.unit_vectors_along_layer(points)
    through = unit_vectors_through_thickness_of_layers(along)
    free_strain = strain[0] * along[:, None] * along + strain[1] * through[:, None] * through
    return stresses_from_displacement_gradients(free_strain, layer.elasticity_times_width, along)


def nodal_forces_of_thermal_expansion(
    basis: Any, layers: Mapping[str, ElasticLayer], strains: FreeStrainFunctionByLayer
) -> Floats:
    """Nodal forces (2 nodes,) [N] that deform a body as the free strains of its layers do.

    Parameters
    ----------
    basis : scalar basis of a mesh, or a grid of hp elements, which computes its own forces
    layers : elastic layers by subdomain
    strains : free strains of the subdomains that expand
    """
    if hasattr(basis, "nodal_forces_of_layer_expansion"):
        return np.asarray(basis.nodal_forces_of_layer_expansion(layers, strains))
    gradients = np.array([psi[0].grad for psi in basis.basis])
    points = quadrature_points_of_elements(basis)
    forces = np.zeros((basis.N, 2))
    for name, strain in strains.items():
        members = basis.mesh.subdomains[name]
        at = points[:, members]
        held = stress_times_width_of_free_strain(layers[name], strain(at), at)
        own = np.einsum("ijeq,ajeq,eq->aei", held, gradients[:, :, members], basis.dx[members])
        np.add.at(forces, basis.element_dofs[:, members], own)
    return forces.ravel()
