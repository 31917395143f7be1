"""The mutual work v^T K u of two displacements of a body, and its change as the nodes move.

With the stiffness K of plane stress and the gradients H_cd = d u_c / d x_d of both displacements,

    v^T K u = b Int sigma(u) : H_v dA,   sigma(u) = lambda tr(H_u) I + mu (H_u + H_u^T)

and the further stiffness of a layer in directions of its own (fem.substructure.elasticity).

Nodes that move by s V, while their displacements stay, change the gradients by -s H (grad V) and
areas by s div V, so that at s = 0

    d/ds v^T K u
        = b Int sigma(u) : H_v div V - sigma(u) : (H_v grad V) - sigma(v) : (H_u grad V) dA.

The directions of a layer change as well. Around the drum's centre they turn by t . V/r, and those
of a straight beam turn with its axis. A turn by phi adds phi gamma to the stretch along the layer
and -phi gamma to the stretch through it, with the shear gamma = t . (H + H^T) n between both.

V is interpolated as displacements are, and both integrals use the quadrature of the stiffness: they
are exact for the discrete body (Haslinger & Makinen, Introduction to Shape Optimization, ch. 3).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.elasticity import ElasticLayer, has_directions
from drumlin.fem.hp.element import gauss_points, gradients, reference_element
from drumlin.fem.hp.grid import ColumnGrid
from drumlin.fem.substructure.body import quadrature_points, shape_values
from drumlin.fem.substructure.elasticity import split_elasticity

SAMPLE_CHUNK = 500
"""Elements of a grid whose gradients are held at once: a few megabytes at degree 8. Fewer elements
take more turns of a Python loop, and more elements take memory in proportion.
"""


class _Sample(NamedTuple):
    """Some elements of a body at their q points of quadrature.

    Attributes
    ----------
    elements : the elements (e,)
    dofs : their nodes (e, a)
    slopes : gradients (e, 2, a, q) [1/m] of the shape functions
    values : shape functions (a, q)
    area : of each point (e, q) [m^2]
    """

    elements: Ints
    dofs: Ints
    slopes: Floats
    values: Floats
    area: Floats

    def gradient(self, u: Floats) -> Floats:
        """H (e, q, 2, 2) of displacements u (2 nodes,), H_cd = d u_c / d x_d."""
        return np.asarray(np.einsum("eac,edaq->eqcd", u.reshape(-1, 2)[self.dofs], self.slopes))

    def value(self, u: Floats) -> Floats:
        """Displacements u (2 nodes,) at the points, (e, q, 2)."""
        return np.asarray(np.einsum("eac,aq->eqc", u.reshape(-1, 2)[self.dofs], self.values))


class _Directions(NamedTuple):
    """The directions of the layers of a body at its points of quadrature.

    Attributes
    ----------
    along : unit vectors (elements, q, 2) along the layers
    curvature : turn of the directions as a point moves along (elements, q) [rad/m]
    straight : whether an element is in a straight layer (elements,); its curvature is 0
    """

    along: Floats
    curvature: Floats
    straight: Bools

    def turn(self, elements: Ints, moved: Floats, axis: float) -> Floats:
        """The turn (e, q) [rad] of the directions in some elements.

        Their points move by `moved` (e, q, 2) [m], and the axis of a straight beam turns by `axis`
        [rad].
        """
        around = np.einsum("eqc,eqc->eq", self.along[elements], moved) * self.curvature[elements]
        return np.asarray(np.where(self.straight[elements, None], axis, around))


def work_by_part(
    basis: Any, layers: Mapping[str, ElasticLayer], u: Floats, v: Floats
) -> dict[str, float]:
    """v^T K u [N m] of displacements u and v, for each part of a body by its name.

    Parameters
    ----------
    basis : of the body
    layers : those of its parts
    u, v : displacements (2 nodes,) [m]
    """
    constants, directions = _constants(basis, layers), _directions(basis, layers)
    work = np.zeros(len(constants))
    for sample in _samples(basis):
        along = None if directions is None else directions.along[sample.elements]
        stress = _stress(sample.gradient(u), constants[sample.elements], along)
        strain = sample.gradient(v)
        work[sample.elements] = np.einsum("eqcd,eqcd,eq->e", stress, strain, sample.area)
    return {name: float(work[elements].sum()) for name, elements in _mesh(basis).subdomains.items()}


def change_by_nodes(
    basis: Any,
    layers: Mapping[str, ElasticLayer],
    u: Floats,
    v: Floats,
    moves: Floats,
    axes: Sequence[float],
) -> Floats:
    """d/ds v^T K u (k,) [N] as the nodes of a body move in k ways.

    Parameters
    ----------
    basis : of the body
    layers : those of its parts
    u, v : displacements (2 nodes,) [m]
    moves : motions (k, 2 nodes); the nodes move by s times them [m]
    axes : turns (k,) of the axis of a straight beam; it turns by s times them [rad]
    """
    constants, directions = _constants(basis, layers), _directions(basis, layers)
    changes = np.zeros(len(moves))
    for sample in _samples(basis):
        own = constants[sample.elements]
        along = None if directions is None else directions.along[sample.elements]
        of_u, of_v = sample.gradient(u), sample.gradient(v)
        stress_u, stress_v = _stress(of_u, own, along), _stress(of_v, own, along)
        by_turn = None if along is None else _work_by_turn(of_u, of_v, own, along)
        work = np.einsum("eqcd,eqcd->eq", stress_u, of_v)
        # The gradients change by -H (grad V), which enters both displacements.
        by_gradient = np.einsum("eqcj,eqcd->eqdj", stress_u, of_v)
        by_gradient = by_gradient + np.einsum("eqcj,eqcd->eqdj", stress_v, of_u)
        for k, move in enumerate(moves):
            V = sample.gradient(move)
            wider = work * np.trace(V, axis1=2, axis2=3)
            change = wider - np.einsum("eqdj,eqdj->eq", by_gradient, V)
            if directions is not None and by_turn is not None:
                turn = directions.turn(sample.elements, sample.value(move), axes[k])
                change += by_turn * turn
            changes[k] += float((change * sample.area).sum())
    return changes


def _stress(H: Floats, constants: Floats, along: Floats | None) -> Floats:
    """Stress times width (e, q, 2, 2) [N/m] of gradients H (e, q, 2, 2).

    Parameters
    ----------
    H : the gradients
    constants : (e, 4) of `elasticity.split_elasticity` [N/m]
    along : unit vectors (e, q, 2) along the layers; None where all layers are isotropic
    """
    lam, mu, a, b = constants.T[:, :, None, None, None]
    volumetric = lam * np.trace(H, axis1=2, axis2=3)[..., None, None] * np.eye(2)
    stress = volumetric + mu * (H + H.swapaxes(2, 3))
    if along is not None:
        for stiffer, d in ((a, along), (b, _through(along))):
            stretch = np.einsum("eqc,eqcd,eqd->eq", d, H, d)[..., None, None]
            stress = stress + stiffer * stretch * d[..., None] * d[..., None, :]
    return np.asarray(stress)


def _through(along: Floats) -> Floats:
    """Unit vectors through layers (..., 2) by those along them."""
    return np.stack([-along[..., 1], along[..., 0]], axis=-1)


def _work_by_turn(of_u: Floats, of_v: Floats, constants: Floats, along: Floats) -> Floats:
    """The change of sigma(u) : H_v times the width (e, q) [N/m] per turn of the layers' directions.

    Parameters
    ----------
    of_u, of_v : gradients (e, q, 2, 2)
    constants : (e, 4) of `elasticity.split_elasticity` [N/m]
    along : unit vectors (e, q, 2)
    """
    of_first = _direction_strains(of_u, constants, along)
    of_second = _direction_strains(of_v, constants, along)
    return of_first.shear * of_second.stretched + of_second.shear * of_first.stretched


class _DirectionStrains(NamedTuple):
    """Strains in the directions of a layer (e, q): the shear gamma between along and through the
    layer, and `stretched`, a eps_along - b eps_through [N/m].
    """

    shear: Floats
    stretched: Floats


def _direction_strains(H: Floats, constants: Floats, along: Floats) -> _DirectionStrains:
    """The strains of gradients H (e, q, 2, 2) in the directions of the layers."""
    a, b, through = constants[:, 2:3], constants[:, 3:4], _through(along)
    eps_along = np.einsum("eqc,eqcd,eqd->eq", along, H, along)
    eps_through = np.einsum("eqc,eqcd,eqd->eq", through, H, through)
    shear = np.einsum("eqc,eqcd,eqd->eq", along, H + H.swapaxes(2, 3), through)
    return _DirectionStrains(shear, a * eps_along - b * eps_through)


def _constants(basis: Any, layers: Mapping[str, ElasticLayer]) -> Floats:
    """The constants of `elasticity.split_elasticity` times the width of each element (elements, 4) [N/m]."""
    constants = np.zeros((basis.element_dofs.shape[1], 4))
    for name, elements in _mesh(basis).subdomains.items():
        constants[elements] = split_elasticity(layers[name].stiffness)
    return constants


def _directions(basis: Any, layers: Mapping[str, ElasticLayer]) -> _Directions | None:
    """The directions of the layers of a body; None where all of them are isotropic."""
    subdomains = _mesh(basis).subdomains
    if not any(has_directions(layers[name].elasticity) for name in subdomains):
        return None
    if isinstance(basis, ColumnGrid):
        points = np.moveaxis(gauss_points(basis.element_nodes, basis.degree), 1, 0)
    else:
        points = quadrature_points(basis)
    along, straight = np.empty(points.shape), np.zeros(points.shape[1], dtype=bool)
    for name, elements in subdomains.items():
        along[:, elements] = layers[name].directions(points[:, elements])
        straight[elements] = layers[name].along is not None
    curvature = np.where(straight[:, None], 0.0, 1 / np.hypot(*points))
    return _Directions(np.moveaxis(along, 0, 2), curvature, straight)


def _mesh(basis: Any) -> Any:
    """The mesh of a basis, which has its subdomains; a grid is its own mesh."""
    return basis if isinstance(basis, ColumnGrid) else basis.mesh


def _samples(basis: Any) -> Iterator[_Sample]:
    """All elements of a body, a few at a time."""
    if isinstance(basis, ColumnGrid):
        count = len(basis.ordered_dofs)
        for first in range(0, count, SAMPLE_CHUNK):
            own = slice(first, first + SAMPLE_CHUNK)
            slopes, area = gradients(basis.element_nodes[own], basis.degree)
            elements, dofs = np.arange(count)[own], basis.ordered_dofs[own]
            yield _Sample(elements, dofs, slopes, reference_element(basis.degree).values, area)
        return
    slopes = np.array([psi[0].grad for psi in basis.basis]).transpose(2, 1, 0, 3)
    elements = np.arange(basis.mesh.nelements)
    yield _Sample(elements, basis.element_dofs.T, slopes, shape_values(basis), basis.dx)
