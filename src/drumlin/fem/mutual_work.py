"""The mutual work of two displacements of a body, v^T K u, by its parts, and its change as the
nodes of the body move.

Of the stiffness K of plane stress, with the gradients H_cd = d u_c / d x_d of both displacements,

    v^T K u = b Int sigma(u) : H_v dA,   sigma(u) = lambda tr(H_u) I + mu (H_u + H_u^T).

Nodes that move by s V, with the displacements of the nodes kept, change the gradients by -s H (grad
V) and areas by s div V, so that at s = 0

    d/ds v^T K u = b Int sigma(u) : H_v div V - sigma(u) : (H_v grad V) - sigma(v) : (H_u grad V) dA.

V is interpolated as displacements are, and both integrals use the quadrature of the stiffness: they
are exact for the discrete body (Haslinger & Makinen, Introduction to Shape Optimization, ch. 3).
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Floats, Ints
from drumlin.brake.fields import Material
from drumlin.fem.hp.element import gradients
from drumlin.fem.hp.grid import Grid
from drumlin.fem.shapes import plane_stress

CHUNK = 500
"""Elements of a grid whose gradients are held at once: a few megabytes of degree 8. Fewer elements
take more turns of a Python loop, more elements take memory in proportion."""


class _Sample(NamedTuple):
    """The `elements` (e,) of a body, their nodes `dofs` (e, a), the gradients `slopes` (e, 2, a, q)
    [1/m] of the shape functions at the points of quadrature and the `area` (e, q) [m^2] of each
    point."""

    elements: Ints
    dofs: Ints
    slopes: Floats
    area: Floats

    def gradient(self, u: Floats) -> Floats:
        """H (e, q, 2, 2) of displacements u (2 nodes,), H_cd = d u_c / d x_d."""
        return np.asarray(np.einsum("eac,edaq->eqcd", u.reshape(-1, 2)[self.dofs], self.slopes))


def work_by_part(basis: Any, materials: Mapping[str, tuple[Material, float]], u: Floats, v: Floats) -> dict[str, float]:
    """v^T K u [N m] of the displacements u and v (2 nodes,) [m], of each part of a body.

    materials: material and width [m] of each part.
    """
    lame = _lame(basis, materials)
    work = np.zeros(len(lame))
    for sample in _samples(basis):
        stress, strain = _stress(sample.gradient(u), lame[sample.elements]), sample.gradient(v)
        work[sample.elements] = np.einsum("eqcd,eqcd,eq->e", stress, strain, sample.area)
    return {name: float(work[elements].sum()) for name, elements in _mesh(basis).subdomains.items()}


def change_by_nodes(
    basis: Any, materials: Mapping[str, tuple[Material, float]], u: Floats, v: Floats, moves: Floats
) -> Floats:
    """d/ds v^T K u [N] as the nodes move by s times each of `moves` (k, 2 nodes): (k,)."""
    lame = _lame(basis, materials)
    found = np.zeros(len(moves))
    for sample in _samples(basis):
        own = lame[sample.elements]
        of_u, of_v = sample.gradient(u), sample.gradient(v)
        pressed, tested = _stress(of_u, own), _stress(of_v, own)
        work = np.einsum("eqcd,eqcd->eq", pressed, of_v)
        bent = np.einsum("eqcj,eqcd->eqdj", pressed, of_v) + np.einsum("eqcj,eqcd->eqdj", tested, of_u)
        for k, move in enumerate(moves):
            moved = sample.gradient(move)
            wider = work * np.trace(moved, axis1=2, axis2=3) - np.einsum("eqdj,eqdj->eq", bent, moved)
            found[k] += float((wider * sample.area).sum())
    return found


def _stress(H: Floats, lame: Floats) -> Floats:
    """Stress times width (e, q, 2, 2) [N/m] of gradients H (e, q, 2, 2); lame (e, 2) [N/m]."""
    lam, mu = lame.T[:, :, None, None, None]
    return np.asarray(lam * np.trace(H, axis1=2, axis2=3)[..., None, None] * np.eye(2) + mu * (H + H.swapaxes(2, 3)))


def _lame(basis: Any, materials: Mapping[str, tuple[Material, float]]) -> Floats:
    """lambda and mu of plane stress times the width of each element (elements, 2) [N/m]."""
    lame = np.zeros((basis.element_dofs.shape[1], 2))
    for name, elements in _mesh(basis).subdomains.items():
        material, width = materials[name]
        lame[elements] = width * np.array(plane_stress(material.E, material.nu))
    return lame


def _mesh(basis: Any) -> Any:
    """What has the subdomains of a basis: a grid itself, or the basis's mesh."""
    return basis if isinstance(basis, Grid) else basis.mesh


def _samples(basis: Any) -> Iterator[_Sample]:
    """All elements of a body, a few at a time."""
    if isinstance(basis, Grid):
        count = len(basis.ordered_dofs)
        for first in range(0, count, CHUNK):
            own = slice(first, first + CHUNK)
            slopes, area = gradients(basis.element_nodes[own], basis.degree)
            yield _Sample(np.arange(count)[own], basis.ordered_dofs[own], slopes, area)
        return
    slopes = np.array([psi[0].grad for psi in basis.basis]).transpose(2, 1, 0, 3)
    yield _Sample(np.arange(basis.mesh.nelements), basis.element_dofs.T, slopes, basis.dx)
