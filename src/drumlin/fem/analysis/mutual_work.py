"""The mutual work of two displacements of a body, v^T K u, by its parts, and its change as the
nodes of the body move.

Of the stiffness K of plane stress, with the gradients H_cd = d u_c / d x_d of both displacements,

    v^T K u = b Int sigma(u) : H_v dA,   sigma(u) = lambda tr(H_u) I + mu (H_u + H_u^T)

and what the layer is stiffer in directions of its own (fem.substructure.elasticity).

Nodes that move by s V, with the displacements of the nodes kept, change the gradients by -s H (grad
V) and areas by s div V, so that at s = 0

    d/ds v^T K u = b Int sigma(u) : H_v div V - sigma(u) : (H_v grad V) - sigma(v) : (H_u grad V)
    dA.

Directions of a layer change as well. Around the drum's centre they turn by t . V/r, those of a
straight beam turn with its axis. By a turn phi the stretch along the layer grows by phi gamma and
that through it by -phi gamma, with the shear gamma = t . (H + H^T) n between both.

V is interpolated as displacements are, and both integrals use the quadrature of the stiffness: they
are exact for the discrete body (Haslinger & Makinen, Introduction to Shape Optimization, ch. 3).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.elasticity import ElasticLayer, has_directions
from drumlin.fem.hp.element import element, gauss_points, gradients
from drumlin.fem.hp.grid import ColumnGrid
from drumlin.fem.substructure.body import points_of, values_of
from drumlin.fem.substructure.elasticity import split

CHUNK = 500
"""Elements of a grid whose gradients are held at once: a few megabytes of degree 8. Fewer elements
take more turns of a Python loop, more elements take memory in proportion."""


class _Sample(NamedTuple):
    """The `elements` (e,) of a body, their nodes `dofs` (e, a), the gradients `slopes` (e, 2, a, q)
    [1/m] of the shape functions at the points of quadrature, the `values` (a, q) of these functions
    there and the `area` (e, q) [m^2] of each point."""

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
    """The directions of the layers at the points of quadrature: unit vectors `along` them
    (elements, q, 2), and how these turn as a point moves along, `curvature` (elements, q) [rad/m],
    0 in `straight` (elements,) layers."""

    along: Floats
    curvature: Floats
    straight: Bools

    def turn(self, elements: Ints, moved: Floats, axis: float) -> Floats:
        """The turn (e, q) of the directions [rad] in some elements whose points move by `moved` (e,
        q, 2) [m], as the axis of a straight beam turns by `axis` [rad]."""
        around = np.einsum("eqc,eqc->eq", self.along[elements], moved) * self.curvature[elements]
        return np.asarray(np.where(self.straight[elements, None], axis, around))


def work_by_part(
    basis: Any, layers: Mapping[str, ElasticLayer], u: Floats, v: Floats
) -> dict[str, float]:
    """v^T K u [N m] of the displacements u and v (2 nodes,) [m], of each part of a body; layers:
    those of the parts."""
    constants, directions = _constants(basis, layers), _directions(basis, layers)
    work = np.zeros(len(constants))
    for sample in _samples(basis):
        along = None if directions is None else directions.along[sample.elements]
        stress, strain = (
            _stress(sample.gradient(u), constants[sample.elements], along),
            sample.gradient(v),
        )
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
    """d/ds v^T K u [N] as the nodes of a body move, (k,).

    Parameters
    ----------
    basis : of the body
    layers : those of its parts
    u, v : (2 nodes,) displacements [m]
    moves : (k, 2 nodes) by s times which the nodes move [m]
    axes : (k,) by s times which the axis of a straight beam turns [rad]
    """
    constants, directions = _constants(basis, layers), _directions(basis, layers)
    found = np.zeros(len(moves))
    for sample in _samples(basis):
        own = constants[sample.elements]
        along = None if directions is None else directions.along[sample.elements]
        of_u, of_v = sample.gradient(u), sample.gradient(v)
        pressed, tested = _stress(of_u, own, along), _stress(of_v, own, along)
        by_turn = None if along is None else _work_by_turn(of_u, of_v, own, along)
        work = np.einsum("eqcd,eqcd->eq", pressed, of_v)
        bent = np.einsum("eqcj,eqcd->eqdj", pressed, of_v) + np.einsum(
            "eqcj,eqcd->eqdj", tested, of_u
        )
        for k, move in enumerate(moves):
            moved = sample.gradient(move)
            wider = work * np.trace(moved, axis1=2, axis2=3) - np.einsum(
                "eqdj,eqdj->eq", bent, moved
            )
            if directions is not None and by_turn is not None:
                wider += by_turn * directions.turn(sample.elements, sample.value(move), axes[k])
            found[k] += float((wider * sample.area).sum())
    return found


def _stress(H: Floats, constants: Floats, along: Floats | None) -> Floats:
    """Stress times width (e, q, 2, 2) [N/m] of gradients H (e, q, 2, 2).

    constants (e, 4): of `elasticity.split` [N/m]; along (e, q, 2): unit vectors, None where all
    layers are isotropic.
    """
    lam, mu, a, b = constants.T[:, :, None, None, None]
    found = lam * np.trace(H, axis1=2, axis2=3)[..., None, None] * np.eye(2) + mu * (
        H + H.swapaxes(2, 3)
    )
    if along is not None:
        for stiffer, d in ((a, along), (b, _through(along))):
            stretch = np.einsum("eqc,eqcd,eqd->eq", d, H, d)[..., None, None]
            found = found + stiffer * stretch * d[..., None] * d[..., None, :]
    return np.asarray(found)


def _through(along: Floats) -> Floats:
    """Unit vectors through layers (..., 2) by those along them."""
    return np.stack([-along[..., 1], along[..., 0]], axis=-1)


def _work_by_turn(of_u: Floats, of_v: Floats, constants: Floats, along: Floats) -> Floats:
    """How sigma(u) : H_v times the width (e, q) [N/m] changes per radian by which the layers'
    directions turn.

    Parameters
    ----------
    of_u, of_v : (e, q, 2, 2) gradients
    constants : (e, 4) of `elasticity.split` [N/m]
    along : (e, q, 2) unit vectors
    """
    a, b, through = constants[:, 2:3], constants[:, 3:4], _through(along)

    def strains(H: Floats) -> tuple[Floats, Floats]:
        """The shear between both directions, and a eps_along - b eps_through."""
        eps_along, eps_through = (np.einsum("eqc,eqcd,eqd->eq", d, H, d) for d in (along, through))
        gamma = np.einsum("eqc,eqcd,eqd->eq", along, H + H.swapaxes(2, 3), through)
        return gamma, a * eps_along - b * eps_through

    (gamma_u, stretched_u), (gamma_v, stretched_v) = strains(of_u), strains(of_v)
    return gamma_u * stretched_v + gamma_v * stretched_u


def _constants(basis: Any, layers: Mapping[str, ElasticLayer]) -> Floats:
    """The constants of `elasticity.split` times the width of each element (elements, 4) [N/m]."""
    found = np.zeros((basis.element_dofs.shape[1], 4))
    for name, elements in _mesh(basis).subdomains.items():
        found[elements] = split(layers[name].stiffness)
    return found


def _directions(basis: Any, layers: Mapping[str, ElasticLayer]) -> _Directions | None:
    """The directions of the layers of a body; None where all of them are isotropic."""
    subdomains = _mesh(basis).subdomains
    if not any(has_directions(layers[name].elasticity) for name in subdomains):
        return None
    if isinstance(basis, ColumnGrid):
        points = np.moveaxis(gauss_points(basis.element_nodes, basis.degree), 1, 0)
    else:
        points = points_of(basis)
    along, straight = np.empty(points.shape), np.zeros(points.shape[1], dtype=bool)
    for name, elements in subdomains.items():
        along[:, elements] = layers[name].directions(points[:, elements])
        straight[elements] = layers[name].along is not None
    curvature = np.where(straight[:, None], 0.0, 1 / np.hypot(*points))
    return _Directions(np.moveaxis(along, 0, 2), curvature, straight)


def _mesh(basis: Any) -> Any:
    """What has the subdomains of a basis: a grid itself, or the basis's mesh."""
    return basis if isinstance(basis, ColumnGrid) else basis.mesh


def _samples(basis: Any) -> Iterator[_Sample]:
    """All elements of a body, a few at a time."""
    if isinstance(basis, ColumnGrid):
        count = len(basis.ordered_dofs)
        for first in range(0, count, CHUNK):
            own = slice(first, first + CHUNK)
            slopes, area = gradients(basis.element_nodes[own], basis.degree)
            yield _Sample(
                np.arange(count)[own],
                basis.ordered_dofs[own],
                slopes,
                element(basis.degree).values,
                area,
            )
        return
    slopes = np.array([psi[0].grad for psi in basis.basis]).transpose(2, 1, 0, 3)
    yield _Sample(
        np.arange(basis.mesh.nelements), basis.element_dofs.T, slopes, values_of(basis), basis.dx
    )
