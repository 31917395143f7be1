"""The mutual work v^T K u of two displacement fields of a body, and its change as nodes move.

With the stiffness K of plane stress, the width b, the Lame constants lambda and mu of plane stress,
and the gradients H_cd = d u_c / d x_d of both displacements u and v,

    v^T K u = b Int sigma(u) : H_v dA,   sigma(u) = lambda tr(H_u) I + mu (H_u + H_u^T)

An orthotropic layer has additional stresses along and through the layer
(fem.substructure.elasticity).

If the nodes move by s V while their displacements u and v stay, the gradients change by -s H (grad
V) and the areas by s div V, so that at s = 0

    d/ds v^T K u
        = b Int sigma(u) : H_v div V - sigma(u) : (H_v grad V) - sigma(v) : (H_u grad V) dA.

The directions of a layer change as well. Directions around the drum's centre turn by t . V/r, and
the directions of a straight beam turn with its axis. A turn by phi adds phi gamma to the stretch
along the layer and -phi gamma to the stretch through the layer. Here gamma = t . (H + H^T) n is the
shear between the unit vectors t along and n through the layer.

V is interpolated as displacements are, and both integrals use the quadrature of the stiffness. The
derivatives are therefore exact for the discrete body (Haslinger & Makinen, Introduction to Shape
Optimization, ch. 3).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.elasticity import ElasticLayer, which_elasticity_matrices_are_orthotropic
from drumlin.fem.hp.element import (
    gauss_points_of_elements,
    reference_element_of_degree,
    shape_function_gradients_and_gauss_areas,
)
from drumlin.fem.hp.grid import HpElementGrid
from drumlin.fem.substructure.body import (
    quadrature_points_of_elements,
    shape_function_values_at_quadrature_points,
)
from drumlin.fem.substructure.elasticity import isotropic_and_orthotropic_elastic_constants

NUMBER_OF_ELEMENTS_PER_CHUNK = 500
"""Number of hp elements whose shape-function gradients are in memory at once.

At degree 8 they take a few megabytes. Fewer elements need more passes of a Python loop, and more
elements need more memory. The number changes no result.
"""


class _ShapeFunctionsAtQuadraturePoints(NamedTuple):
    """The shape functions of e elements of a body at q quadrature points of each element.

    Attributes
    ----------
    elements : numbers (e,) of the elements
    dofs : nodes (e, a) of the elements
    slopes : gradients (e, 2, a, q) [1/m] of the shape functions
    values : values (a, q) of the shape functions
    area : area (e, q) [m^2] that each quadrature point stands for
    """

    elements: Ints
    dofs: Ints
    slopes: Floats
    values: Floats
    area: Floats

    def displacement_gradients_at_points(self, u: Floats) -> Floats:
        """The displacement gradients d u_c / d x_d (e, q, 2, 2) at the quadrature points.

        `u` (2 nodes,) are the displacements of the nodes.
        """
        return np.asarray(np.einsum("eac,edaq->eqcd", u.reshape(-1, 2)[self.dofs], self.slopes))

    def displacements_at_quadrature_points(self, u: Floats) -> Floats:
        """The displacements (e, q, 2) at the quadrature points, interpolated from the nodes.

        `u` (2 nodes,) are the displacements of the nodes.
        """
        return np.asarray(np.einsum("eac,aq->eqc", u.reshape(-1, 2)[self.dofs], self.values))


class _LayerDirectionsAtQuadraturePoints(NamedTuple):
    """The directions of the layers of a body at its quadrature points.

    Attributes
    ----------
    along : unit vectors (elements, q, 2) along the layers
    curvature : turn (elements, q) of the direction per motion of a point along its layer [rad/m]
    straight : whether an element (elements,) is in a straight layer, whose curvature is 0
    """

    along: Floats
    curvature: Floats
    straight: Bools

    def turns_of_layer_directions_at_moved_points(
        self, elements: Ints, moved: Floats, axis: float
    ) -> Floats:
        """The turn (e, q) [rad] of the layer directions at quadrature points that move.

        Parameters
        ----------
        elements : numbers (e,) of the elements that contain the points
        moved : motion (e, q, 2) [m] of the quadrature points
        axis : turn [rad] of the axis of a straight beam
        """
        around = np.einsum("eqc,eqc->eq", self.along[elements], moved) * self.curvature[elements]
        return np.asarray(np.where(self.straight[elements, None], axis, around))


def mutual_elastic_work_in_each_part_of_body(
    basis: Any, layers: Mapping[str, ElasticLayer], u: Floats, v: Floats
) -> dict[str, float]:
    """The mutual work v^T K u [N m] of displacements u and v in each part of a body.

    The keys are the names of the parts.

    Parameters
    ----------
    basis : finite-element basis of the body
    layers : materials of the parts by their names
    u, v : displacements (2 nodes,) [m]
    """
    constants = _elastic_constants_of_elements(basis, layers)
    directions = _layer_directions_at_quadrature_points(basis, layers)
    work = np.zeros(len(constants))
    for sample in _shape_functions_in_element_chunks(basis):
        along = None if directions is None else directions.along[sample.elements]
        stress = _stress_times_width_of_displacement_gradients(
            sample.displacement_gradients_at_points(u), constants[sample.elements], along
        )
        strain = sample.displacement_gradients_at_points(v)
        work[sample.elements] = np.einsum("eqcd,eqcd,eq->e", stress, strain, sample.area)
    return {
        name: float(work[elements].sum())
        for name, elements in _mesh_of_finite_element_basis(basis).subdomains.items()
    }


def mutual_work_derivatives_by_node_motions(
    basis: Any,
    layers: Mapping[str, ElasticLayer],
    u: Floats,
    v: Floats,
    moves: Floats,
    axes: Sequence[float],
) -> Floats:
    """The derivatives (k,) [N] of the mutual work v^T K u by k motions of a body's nodes.

    K is the stiffness of the body. The nodal displacements u and v stay as the nodes move.

    Parameters
    ----------
    basis : finite-element basis of the body
    layers : materials of the parts by their names
    u, v : displacements (2 nodes,) [m]
    moves : motions (k, 2 nodes) of the nodes per unit motion of a point of the shoe
    axes : turns (k,) [rad/m] of the axis of a straight beam per unit motion of a point of the shoe
    """
    constants = _elastic_constants_of_elements(basis, layers)
    directions = _layer_directions_at_quadrature_points(basis, layers)
    changes = np.zeros(len(moves))
    for sample in _shape_functions_in_element_chunks(basis):
        own = constants[sample.elements]
        along = None if directions is None else directions.along[sample.elements]
        of_u, of_v = (
            sample.displacement_gradients_at_points(u),
            sample.displacement_gradients_at_points(v),
        )
        stress_u = _stress_times_width_of_displacement_gradients(of_u, own, along)
        stress_v = _stress_times_width_of_displacement_gradients(of_v, own, along)
        by_turn = (
            None
            if along is None
            else _work_change_per_turn_of_layer_directions(of_u, of_v, own, along)
        )
        # This density of work is multiplied by div V, the growth of area by the motion V.
        work = np.einsum("eqcd,eqcd->eq", stress_u, of_v)
        by_gradient = _work_density_change_per_motion_gradient(stress_u, of_v)
        by_gradient = by_gradient + _work_density_change_per_motion_gradient(stress_v, of_u)
        for k, move in enumerate(moves):
            V = sample.displacement_gradients_at_points(move)
            wider = work * np.trace(V, axis1=2, axis2=3)
            change = wider - np.einsum("eqdj,eqdj->eq", by_gradient, V)
            if directions is not None and by_turn is not None:
                turn = directions.turns_of_layer_directions_at_moved_points(
                    sample.elements, sample.displacements_at_quadrature_points(move), axes[k]
                )
                change += by_turn * turn
            changes[k] += float((change * sample.area).sum())
    return changes


def _work_density_change_per_motion_gradient(stress: Floats, H: Floats) -> Floats:
    """The derivative (e, q, 2, 2) of the work density by -grad V, for a motion V of the nodes.

    The gradient H (e, q, 2, 2) of the displacements changes by -H (grad V) as the nodes move, and
    `stress` does work on this change.
    """
    return np.einsum("eqcj,eqcd->eqdj", stress, H)


def _stress_times_width_of_displacement_gradients(
    H: Floats, constants: Floats, along: Floats | None
) -> Floats:
    """The stress times width (e, q, 2, 2) [N/m] of displacement gradients.

    Parameters
    ----------
    H : displacement gradients (e, q, 2, 2)
    constants : elastic constants (e, 4) [N/m] of
        `elasticity.isotropic_and_orthotropic_elastic_constants`
    along : unit vectors (e, q, 2) along the layers; None if all layers are isotropic
    """
    lam, mu, a, b = constants.T[:, :, None, None, None]
    volumetric = lam * np.trace(H, axis1=2, axis2=3)[..., None, None] * np.eye(2)
    stress = volumetric + mu * (H + H.swapaxes(2, 3))
    if along is not None:
        for stiffer, d in ((a, along), (b, _unit_vectors_through_layers(along))):
            stretch = np.einsum("eqc,eqcd,eqd->eq", d, H, d)[..., None, None]
            stress = stress + stiffer * stretch * d[..., None] * d[..., None, :]
    return np.asarray(stress)


def _unit_vectors_through_layers(along: Floats) -> Floats:
    """The unit vectors (..., 2) in the thickness direction of layers.

    `along` (..., 2) are the unit vectors along the layers.
    """
    return np.stack([-along[..., 1], along[..., 0]], axis=-1)


def _work_change_per_turn_of_layer_directions(
    of_u: Floats, of_v: Floats, constants: Floats, along: Floats
) -> Floats:
    """The change (e, q) of the work density b sigma(u) : H_v per turn of the layers [N/m per rad].

    Parameters
    ----------
    of_u, of_v : displacement gradients (e, q, 2, 2)
    constants : elastic constants (e, 4) [N/m] of
        `elasticity.isotropic_and_orthotropic_elastic_constants`
    along : unit vectors (e, q, 2) along the layers
    """
    of_first = _strains_in_layer_directions(of_u, constants, along)
    of_second = _strains_in_layer_directions(of_v, constants, along)
    return (
        of_first.shear * of_second.stretch_times_stiffness
        + of_second.shear * of_first.stretch_times_stiffness
    )


class _StrainsInLayerDirections(NamedTuple):
    """Shear and stretch (e, q) in the directions along and through a layer.

    Attributes
    ----------
    shear : shear strain gamma between both directions
    stretch_times_stiffness : a eps_along - b eps_through [N/m], with the stiffnesses a and b that
        the layer's directions add to its isotropic stiffness
    """

    shear: Floats
    stretch_times_stiffness: Floats


def _strains_in_layer_directions(
    H: Floats, constants: Floats, along: Floats
) -> _StrainsInLayerDirections:
    """The shear and stretch of displacement gradients H (e, q, 2, 2) in the layers' directions.

    `constants` (e, 4) [N/m] are the elastic constants of the elements, as
    `elasticity.isotropic_and_orthotropic_elastic_constants` returns them, and `along` (e, q, 2) the
    unit vectors along the layers.
    """
    a, b = constants[:, 2:3], constants[:, 3:4]
    through = _unit_vectors_through_layers(along)
    eps_along = np.einsum("eqc,eqcd,eqd->eq", along, H, along)
    eps_through = np.einsum("eqc,eqcd,eqd->eq", through, H, through)
    shear = np.einsum("eqc,eqcd,eqd->eq", along, H + H.swapaxes(2, 3), through)
    return _StrainsInLayerDirections(shear, a * eps_along - b * eps_through)


def _elastic_constants_of_elements(basis: Any, layers: Mapping[str, ElasticLayer]) -> Floats:
    """The constants lambda, mu, a, b (elements, 4) [N/m] of each element.

    See `isotropic_and_orthotropic_elastic_constants`.
    """
    constants = np.zeros((basis.element_dofs.shape[1], 4))
    for name, elements in _mesh_of_finite_element_basis(basis).subdomains.items():
        constants[elements] = isotropic_and_orthotropic_elastic_constants(
            layers[name].elasticity_times_width
        )
    return constants


def _layer_directions_at_quadrature_points(
    basis: Any, layers: Mapping[str, ElasticLayer]
) -> _LayerDirectionsAtQuadraturePoints | None:
    """The directions of a body's layers at its quadrature points; None if all are isotropic."""
    subdomains = _mesh_of_finite_element_basis(basis).subdomains
    if not any(
        which_elasticity_matrices_are_orthotropic(layers[name].elasticity) for name in subdomains
    ):
        return None
    if isinstance(basis, HpElementGrid):
        points = np.moveaxis(
            gauss_points_of_elements(basis.node_coordinates_of_each_element, basis.degree), 1, 0
        )
    else:
        points = quadrature_points_of_elements(basis)
    along, straight = np.empty(points.shape), np.zeros(points.shape[1], dtype=bool)
    # A layer with one fixed direction is straight; all other layers run around the drum's centre.
    for name, elements in subdomains.items():
        along[:, elements] = layers[name].unit_vectors_along_layer(points[:, elements])
        straight[elements] = layers[name].along is not None
    curvature = np.where(straight[:, None], 0.0, 1 / np.hypot(*points))
    return _LayerDirectionsAtQuadraturePoints(np.moveaxis(along, 0, 2), curvature, straight)


def _mesh_of_finite_element_basis(basis: Any) -> Any:
    """The mesh of a basis, which names the subdomains. A grid of hp elements is its own mesh."""
    return basis if isinstance(basis, HpElementGrid) else basis.mesh


def _shape_functions_in_element_chunks(basis: Any) -> Iterator[_ShapeFunctionsAtQuadraturePoints]:
    """Yield the shape functions of all elements of a body, in chunks that fit in memory."""
    if isinstance(basis, HpElementGrid):
        count = len(basis.element_nodes_boundary_nodes_first)
        for first in range(0, count, NUMBER_OF_ELEMENTS_PER_CHUNK):
            own = slice(first, first + NUMBER_OF_ELEMENTS_PER_CHUNK)
            slopes, area = shape_function_gradients_and_gauss_areas(
                basis.node_coordinates_of_each_element[own], basis.degree
            )
            elements, dofs = np.arange(count)[own], basis.element_nodes_boundary_nodes_first[own]
            yield _ShapeFunctionsAtQuadraturePoints(
                elements, dofs, slopes, reference_element_of_degree(basis.degree).values, area
            )
        return
    slopes = np.array([psi[0].grad for psi in basis.basis]).transpose(2, 1, 0, 3)
    elements = np.arange(basis.mesh.nelements)
    yield _ShapeFunctionsAtQuadraturePoints(
        elements,
        basis.element_dofs.T,
        slopes,
        shape_function_values_at_quadrature_points(basis),
        basis.dx,
    )
