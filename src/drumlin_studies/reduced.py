"""Sketches of brakes: linings on coarse meshes, shoes and ring in closed form.

A sketch is a prepared model like any other. Shoe and ring only add flexibility to the contact nodes
of their lining. The difference of two sketches predicts the change by an omission: see `omission`.

Shoe: a bar in which each section carries the forces of the contact and of the actuation beyond it
(Timoshenko, Strength of Materials II). With bending moment m, normal force n and shear force v of
unit loads the flexibility is

    F_ij = Int (m_i m_j/EI + n_i n_j/EA + kappa v_i v_j/GA) ds.

Ring: plane stress as a Fourier series around the drum, u_r = U(r) cos k theta and u_theta = V(r)
sin k theta, with polynomials of degree RING_DEGREE through the thickness. It holds for both
supports and for thick and thin rings. A wave much shorter than the thickness deforms the ring like
a half-plane, to 1 % (Johnson, Contact Mechanics, section 13.2).
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Backing, Bar, Beam, Lining, Ring, Section, bonded
from drumlin.brake.fields import Material
from drumlin.brake.orthotropic import isotropic_only
from drumlin.brake.ring_support import plain_ring_only
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.cache import shape_key_of_shoe
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel, reason_why_not_modelled
from drumlin.fem.substructure.interface import edge_quadrature_points
from drumlin.fem.substructure.ring import RingSubstructure

SKETCH_ELEMENTS = 24
"""Default number of elements along a lining. The predicted change is then right within a factor of
two.
"""
SKETCH_SECTIONS = 4 * SKETCH_ELEMENTS
"""Sections of a shoe: several for each contact element, as a shoe is longer than its lining.

No test of the predictions notices half of them.
"""
CONTACT_WAVES = 8
"""Waves of the ring along the shortest contact. A contact pressure has few shorter waves."""
LEAST_RING_MODES = 3 * SKETCH_ELEMENTS
"""Smallest number of modes of the ring: the number that the nodes of a lining over a third of the
drum resolve.
"""
MOST_RING_MODES = 4000
"""Number of modes of the ring above which a sketch is refused."""
RING_DEGREE = 6
"""Degree of a ring's displacement through its thickness. A higher degree changes no used digit."""
HALF_PLANE_WAVE = 7.0
"""Thickness of a ring over R/k [rad] above which wave k deforms it like a half-plane, to 1 %."""
RIGID_FACTOR = 1e5
"""Factor on the modulus of a straight beam that is meshed as rigid."""
SECTION_SHEAR_FACTOR = 6 / 5
"""Shear coefficient kappa of a rectangular section."""


def surrogate_maker(elements: int = SKETCH_ELEMENTS) -> Callable[[Brake], PreparedModel]:
    """A function that prepares the sketch of a brake. It meshes equal linings once.

    The function raises BadInput for a brake that finite elements do not cover.
    """
    meshed: dict[Brake, PreparedModel] = {}

    def prepare_surrogate(brake: Brake) -> PreparedModel:
        """The surrogate of a brake; the rigid-shoe model of equal linings is meshed once."""
        reason = (
            reason_why_not_modelled(brake)
            or isotropic_only(brake, "a sketch")
            or plain_ring_only(brake, "a sketch")
        )
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")
        bare = _rigid_brake(brake)
        if bare not in meshed:
            meshed[bare] = prepare(bare, elements=elements, kind=DEFAULT_KIND)
        return _with_closed_forms(
            meshed[bare], brake, min(end - start for start, end in (s.arc for s in brake.shoes))
        )

    return prepare_surrogate


def _with_closed_forms(scene: PreparedModel, brake: Brake, shortest: float) -> PreparedModel:
    """The prepared model of rigid shoes with the flexibilities of the elastic brake added.

    Parameters
    ----------
    scene : PreparedModel
        The prepared model of the brake with rigid shoes on a rigid drum.
    brake : Brake
        The elastic brake.
    shortest : float
        Shortest contact [rad] that the waves of the ring must resolve.

    Raises
    ------
    NoAnswer
        The ring would need too many waves.
    """
    made: dict[tuple[object, ...], ShoeSubstructure] = {}
    bodies = []
    for body, shoe, bare in zip(scene.bodies, brake.shoes, scene.brake.shoes, strict=True):
        key = shape_key_of_shoe(brake, shoe)
        if key not in made:
            made[key] = (
                body if shoe.body == bare.body else _add_shoe_flexibility(body, shoe, brake.size)
            )
        bodies.append(made[key])
    ring = scene.ring
    if ring is None and brake.ring is not None:
        count = max(LEAST_RING_MODES, math.ceil(2 * math.pi * CONTACT_WAVES / max(shortest, 1e-9)))
        if count > MOST_RING_MODES:
            raise NoAnswer(f"a contact of {shortest:.1e} rad is too short for the waves of a ring")
        ring = _ring_flexibility_roots(brake, brake.ring, tuple(bodies), count)
    return replace(scene, brake=brake, bodies=tuple(bodies), ring=ring)


def _rigid_brake(brake: Brake) -> Brake:
    """The brake without ring and with rigid shoes.

    A straight beam stays, because the block of a post begins at the beam, and becomes stiff.
    """

    def rigid_shoe(shoe: Shoe) -> Shoe:
        """The shoe without an elastic body."""
        if not isinstance(shoe.body, Beam):
            return shoe.model_copy(update={"body": None}) if shoe.mesh is None else shoe
        section = shoe.body.section
        assert section is not None
        stiff = section.material.model_copy(
            update={key: RIGID_FACTOR * E for key, E in section.material.moduli.items()}
        )
        body = shoe.body.model_copy(
            update={"width": section.width, "material": stiff, "bending_stiffness": None}
        )
        return shoe.model_copy(update={"body": body})

    return brake.without_ring().model_copy(
        update={"shoes": tuple(rigid_shoe(shoe) for shoe in brake.shoes)}
    )


def _add_shoe_flexibility(body: ShoeSubstructure, shoe: Shoe, radius: float) -> ShoeSubstructure:
    """The body of a rigid shoe with the flexibility of the shoe added.

    radius : radius of the drum [m].
    """
    bar, coupling = _shoe_as_bar(shoe, radius), body.coupling
    nodal = bar.half(body.line.xy)
    pressed, dragged = -nodal @ coupling.N.T, nodal @ coupling.T.T
    load = bar.half(body.load_centre[:, None], beyond=np.ones((len(bar.along), 1)))
    couple = np.concatenate([bar.bending, np.zeros(2 * len(bar.along))])[:, None]
    loaded = np.hstack([load, couple])
    return replace(
        body,
        closure_by_pressure=body.closure_by_pressure - pressed.T @ pressed,
        closure_by_friction=None
        if body.closure_by_friction is None
        else body.closure_by_friction - pressed.T @ dragged,
        closure_by_load=body.closure_by_load - pressed.T @ loaded,
    )


class _Bar(NamedTuple):
    """The sections of a shoe along its axis, in the frame of the shoe.

    Attributes
    ----------
    at : array (m, 2)
        Points of the axis [m].
    tangent : array (m, 2)
        Unit tangents, away from the hinge.
    along : array (m,)
        Distance of each section from the hinged end: an angle [rad] on an arc, a length [m] on a
        beam.
    foot : array
        Where the distance is zero: an angle (1,) on an arc, a point (2,) on a beam.
    bending, stretching, shearing : array (m,)
        Square roots of ds/EI, ds/EA and kappa ds/GA.
    round : bool
        Whether the axis is an arc.
    """

    at: Floats
    tangent: Floats
    along: Floats
    foot: Floats
    bending: Floats
    stretching: Floats
    shearing: Floats
    round: bool

    def half(self, xy: Floats, beyond: Floats | None = None) -> Floats:
        """Square root S (3 m, 2 n) of the flexibility S^T S of forces along x and y at n points.

        Parameters
        ----------
        xy : array (2, n)
            The points [m].
        beyond : array (m, n), optional
            1 where a point lies beyond a section, so that the section carries its force.
        """
        if beyond is None:
            if self.round:  # place: angle from the shoe's hinged end
                turn = np.abs(np.arctan2(xy[1], xy[0]) - self.foot[0])
            else:
                turn = (xy.T - self.foot) @ self.tangent[0]
            beyond = (turn > self.along[:, None]).astype(float)
        arm = xy.T - self.at[:, None]  # (m, n, 2)
        # The moments of unit forces along x and y.
        moment = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        normal = np.broadcast_to(self.tangent[:, None], arm.shape)
        shear = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)

        def weighted_rows(part: Floats, root: Floats) -> Floats:
            """A part of the square root of the flexibility, times a root of its compliance."""
            # Only the sections between a force and the hinge carry the force.
            scaled = part * (beyond * root[:, None])[..., None]
            return np.asarray(scaled.reshape(len(root), -1))

        bending = weighted_rows(moment, self.bending)
        stretching = weighted_rows(normal, self.stretching)
        return np.concatenate([bending, stretching, weighted_rows(shear, self.shearing)])


def _shoe_as_bar(shoe: Shoe, radius: float) -> _Bar:
    """The bar of a shoe. An arc bends as one section with the backing and the lining on it."""
    body = shoe.body
    assert body is not None
    plates = list(body.plates.values())[::-1]
    middle = (np.arange(SKETCH_SECTIONS) + 0.5) / SKETCH_SECTIONS
    if isinstance(body, Bar):
        near, far = sorted(shoe.frame.phis((body.start, body.end)), key=abs)
        phi = near + (far - near) * middle
        start, end = shoe.arc
        over = [
            _layer_of_bar(shoe, layer) for layer in (shoe.backing, shoe.lining) if layer is not None
        ]
        alone, together = bonded(plates), bonded([*plates, *over])
        lined = (phi > start) & (phi < end)
        depth, EI, EA, GA = np.where(lined, np.array(together)[:, None], np.array(alone)[:, None])
        axis = radius - shoe.sign * (shoe.depth - depth)
        along, foot = np.abs(phi - near), np.array([near])
        at = (axis * np.array([np.cos(phi), np.sin(phi)])).T
        tangent = math.copysign(1.0, far - near) * np.column_stack([-np.sin(phi), np.cos(phi)])
        ds = axis * abs(far - near) / SKETCH_SECTIONS
    else:
        hinge, end_ = shoe.frame.to_shoe(shoe.pin.xy), shoe.frame.to_shoe(shoe.actuation.point.xy)
        line = axis_of(hinge, end_)
        along, foot = line.length * middle, hinge
        at, tangent = hinge + along[:, None] * line.along, np.tile(line.along, (SKETCH_SECTIONS, 1))
        ds = np.full(SKETCH_SECTIONS, line.length / SKETCH_SECTIONS)
        _, EI, EA, GA = np.array(bonded(plates))[:, None]
    return _Bar(
        at=at,
        tangent=tangent,
        along=along,
        foot=foot,
        bending=np.sqrt(ds / EI),
        stretching=np.sqrt(ds / EA),
        shearing=np.sqrt(SECTION_SHEAR_FACTOR * ds / GA),
        round=isinstance(body, Bar),
    )


def _layer_of_bar(shoe: Shoe, layer: Lining | Backing) -> Section:
    """A layer of the shoe's body as a section of the bar, as wide as the lining."""
    return Section(layer.thickness, shoe.lining.width, layer.material)


def _ring_flexibility_roots(
    brake: Brake, ring: Ring, bodies: tuple[ShoeSubstructure, ...], count: int
) -> RingSubstructure:
    """The ring under the linings of all shoes, as square roots (2 count + 2, n) of its flexibility.

    Parameters
    ----------
    brake, ring : Brake, Ring
        The brake and its ring.
    bodies : tuple of body
        The body of each shoe, with its contact line.
    count : int
        Number of modes of the ring.
    """
    sign, radius, section = brake.shoes[0].sign, brake.size, ring.section
    assert section is not None
    k = np.arange(count + 1)
    radial, shear = ring_mode_compliances(ring, radius, sign, k)
    # Fourier coefficients of a traction on a ring of this width, for each mode.
    share = np.where(k == 0, 0.5, 1.0) / (math.pi * radius * section.width)
    root = np.sqrt(share * radial)
    turned = np.where(k == 0, 0.0, sign * share * shear / root)
    pressed, dragged = [], []
    for body, shoe in zip(bodies, brake.shoes, strict=True):
        c, s = _wave_integrals(body, shoe, k)
        pressed.append(np.vstack([root[:, None] * c, root[:, None] * s]))
        dragged.append(np.vstack([-turned[:, None] * s, turned[:, None] * c]))
    return RingSubstructure(
        mesh=None,
        basis=None,
        line=bodies[0].line,
        condensed=None,  # type: ignore[arg-type]
        normal_half_flexibilities=tuple(pressed),
        friction_half_flexibilities=tuple(dragged),
        coupling_matrices=(),
        held=k,
        rim_balance=None,
    )


def _wave_integrals(body: ShoeSubstructure, shoe: Shoe, k: Ints) -> tuple[Floats, Floats]:
    """Integrals b Int psi_i cos k theta ds and b Int psi_i sin k theta ds: arrays (modes, n) [m^2].

    psi_i are the shape functions of the contact nodes, theta is the angle of the brake.
    """
    line = body.line
    psi, x, ds = edge_quadrature_points(line.xy[:, line.pieces])
    wave = np.exp(1j * k[:, None, None] * shoe.frame.theta(shoe.phi_of(x, 1.0)))
    found = np.zeros((len(k), len(line.nodes)), dtype=complex)
    # No node occurs twice in one row of the pieces, so that += adds each contribution.
    for value, nodes in zip(psi, line.pieces, strict=True):
        found[:, nodes] += shoe.lining.width * (wave * (value * ds)).sum(axis=2)
    return found.real, found.imag


def ring_mode_compliances(
    ring: Ring, radius: float, sign: int, modes: Ints
) -> tuple[Floats, Floats]:
    """Radial displacement [m/Pa] of the friction surface under two tractions, for each mode.

    The first (m,) is for the radial traction cos k theta, the second (m,) for the traction
    sin k theta around the drum. A free rim is held by a force that is spread over it like its
    rigid-body motion, so that its mean motion is zero.

    Parameters
    ----------
    ring : Ring
        The ring, isotropic.
    radius : float
        Radius of the drum [m].
    sign : int
        1 where the ring lies outside the friction surface, -1 inside.
    modes : array of int (m,)
        Growing orders k.
    """
    section = ring.section
    assert section is not None
    assert isinstance(section.material, Material)
    E, nu = section.material.E, section.material.nu
    long = modes * section.thickness <= HALF_PLANE_WAVE * radius
    if not long.all():
        over = radius / (E * modes[~long])
        found = ring_mode_compliances(ring, radius, sign, modes[long])
        return np.append(found[0], 2 * over), np.append(found[1], (1 - nu) * over)
    # Lagrange polynomials on Chebyshev points, as sums of Legendre polynomials.
    x = -np.cos(math.pi * np.arange(RING_DEGREE + 1) / RING_DEGREE)
    V = np.linalg.inv(np.polynomial.legendre.legvander(x, RING_DEGREE))
    xi, w = np.polynomial.legendre.leggauss(RING_DEGREE + 2)
    psi = np.polynomial.legendre.legvander(xi, RING_DEGREE) @ V
    derivative = np.array(
        [np.polynomial.legendre.legval(xi, np.polynomial.legendre.legder(c)) for c in V.T]
    ).T
    half = sign * section.thickness / 2
    r = radius + half * (1 + xi)
    d, over = derivative / half, psi / r[:, None]
    zero = np.zeros_like(psi)
    n = modes[:, None, None]
    # Strains (m, q, 2 nodes) of unit displacements: radial, around the drum, and shear.
    e_r = np.broadcast_to(np.hstack([d, zero]), (len(modes), len(xi), 2 * (RING_DEGREE + 1)))
    e_t = np.concatenate([over + 0 * n, n * over], axis=2)
    g = np.concatenate([-n * over, d - over + 0 * n], axis=2)
    weight = (w * abs(half) * r)[:, None] * E / (1 - nu**2)

    def weighted_product(a: Floats, b: Floats) -> Floats:
        """Integrals over the section of the products of two fields, for each mode."""
        return np.asarray(a.transpose(0, 2, 1) @ (weight * b))

    K = (
        weighted_product(e_r, e_r + nu * e_t)
        + weighted_product(e_t, e_t + nu * e_r)
        + (1 - nu) / 2 * weighted_product(g, g)
    )
    size, rim = RING_DEGREE + 1, RING_DEGREE
    hold = np.zeros((len(modes), 2 * size, 2))
    if ring.support == "fixed":
        hold[:, rim, 0] = hold[:, size + rim, 1] = 1.0
    else:
        hold[modes == 0, size + rim, 0] = 1.0
        hold[modes == 1, rim, 0], hold[modes == 1, size + rim, 0] = 1.0, -1.0
    # The constraints are appended to the equations, scaled to the size of the stiffness.
    scale = np.abs(K).max()
    bordered = np.zeros((len(modes), 2 * size + 2, 2 * size + 2))
    bordered[:, : 2 * size, : 2 * size] = K
    bordered[:, : 2 * size, 2 * size :] = scale * hold
    bordered[:, 2 * size :, : 2 * size] = scale * hold.transpose(0, 2, 1)
    # A constraint that a mode does not have gets a unit equation of its own.
    for j in range(2):
        bordered[:, 2 * size + j, 2 * size + j] = np.where(hold[:, :, j].any(axis=1), 0.0, scale)
    load = np.zeros((len(modes), 2 * size + 2, 2))
    load[:, 0, 0] = load[:, size, 1] = radius
    u = np.linalg.solve(bordered, load)
    return np.asarray(u[:, 0, 0]), np.asarray(u[:, 0, 1])
