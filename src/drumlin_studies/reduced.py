"""Surrogates: coarse models of brakes, with linings on coarse meshes, shoes and ring as formulas.

A surrogate is solved like any other prepared model. The flexibilities of shoe and drum ring are
added to the flexibility of the lining's contact nodes. The difference between the answers of two
surrogates predicts how much the answer changes if a part of the brake is omitted.

The shoe is a bar from the hinge to its far end. Each section carries the contact forces and the
actuation force that act on the shoe between the section and the far end (Timoshenko, Strength of
Materials II). A unit load i causes the bending moment m_i, the normal force n_i and the shear force
v_i in a section. The flexibility, the displacement at load j by load i, is

    F_ij = Int (m_i m_j/EI + n_i n_j/EA + kappa v_i v_j/GA) ds.

The ring is in plane stress. Its displacements are a Fourier series around the drum with the terms
u_r = U(r) cos k theta and u_theta = V(r) sin k theta. U and V are polynomials of degree
DEGREE_THROUGH_RING_THICKNESS through the thickness. The series holds for fixed and free rims and
for thick and thin rings. Under a wave of pressure much shorter than the thickness, the ring deforms
like a half-plane, to 1 % (Johnson, Contact Mechanics, section 13.2).
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import (
    Backing,
    BeamBody,
    DrumRing,
    Lining,
    RectangularCrossSection,
    ShoeBodyOfConstantSection,
    stiffnesses_of_bonded_plates,
)
from drumlin.brake.fields import Material
from drumlin.brake.orthotropic import reason_if_any_part_is_orthotropic
from drumlin.brake.ring_support import reason_if_ring_edge_is_not_fixed_or_free
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.cache import cache_key_of_shoe_shape
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel, reason_against_finite_element_model
from drumlin.fem.substructure.interface import edge_quadrature_points
from drumlin.fem.substructure.ring import RingSubstructure

DEFAULT_ELEMENTS_PER_LINING_OF_SURROGATE = 24
"""Default number of elements along a lining of a surrogate.

With this number the predicted change by an omission is right within a factor of two.
"""
SECTIONS_OF_SURROGATE_BAR = 4 * DEFAULT_ELEMENTS_PER_LINING_OF_SURROGATE
"""Number of sections into which the bar of a shoe is divided.

Each element of the lining has several sections, because a shoe is longer than its lining. Half as
many sections would still pass the tests of the predictions.
"""
RING_WAVES_ALONG_SHORTEST_CONTACT = 8
"""Number of waves of the ring's Fourier series along the shortest contact.

Shorter waves take little part in a contact pressure.
"""
LEAST_RING_MODES = 3 * DEFAULT_ELEMENTS_PER_LINING_OF_SURROGATE
"""Smallest number of modes (waves around the drum) of the ring's Fourier series.

A lining that covers a third of the drum has enough nodes to resolve this number of modes.
"""
MOST_RING_MODES = 4000
"""Largest number of modes of the ring. A brake whose surrogate needs more is refused."""
DEGREE_THROUGH_RING_THICKNESS = 6
"""Degree of the polynomials for the displacement through the thickness of the ring.

A higher degree changes no significant digit of a prediction.
"""
HALF_PLANE_LIMIT_OF_RING_WAVE_NUMBER = 7.0
"""Limit of k h/R for the mode of order k of a ring of radius R and thickness h. Above the limit the
ring deforms like a half-plane, to 1 %.
"""
MODULUS_FACTOR_OF_RIGID_BEAM = 1e5
"""Factor that multiplies the modulus of a straight beam, so that the beam counts as rigid."""
SHEAR_COEFFICIENT_OF_RECTANGULAR_SECTION = 6 / 5
"""Shear coefficient kappa of a rectangular section."""


def make_function_that_prepares_surrogates(
    elements: int = DEFAULT_ELEMENTS_PER_LINING_OF_SURROGATE,
) -> Callable[[Brake], PreparedModel]:
    """A function that returns the surrogate of a brake: a coarse model that is solved quickly.

    The function keeps its meshes: brakes that differ only in shoes and ring share one mesh of the
    linings. It raises BadInput for a brake that finite elements do not cover.

    elements : number of elements along each lining.
    """
    meshed: dict[Brake, PreparedModel] = {}

    def prepare_surrogate_of_brake(brake: Brake) -> PreparedModel:
        """The surrogate of a brake: a coarse prepared model with shoes and ring as formulas.

        The linings are meshed once for all brakes with the same linings.
        """
        reason = (
            reason_against_finite_element_model(brake)
            or reason_if_any_part_is_orthotropic(brake, "a sketch")
            or reason_if_ring_edge_is_not_fixed_or_free(brake, "a sketch")
        )
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")
        bare = _brake_with_rigid_shoes_and_drum(brake)
        if bare not in meshed:
            meshed[bare] = make_prepared_model(bare, elements=elements, kind=DEFAULT_MESH_KIND)
        shortest_arc = min(shoe.arc[1] - shoe.arc[0] for shoe in brake.shoes)
        return _model_with_shoe_and_ring_flexibility(meshed[bare], brake, shortest_arc)

    return prepare_surrogate_of_brake


def _model_with_shoe_and_ring_flexibility(
    scene: PreparedModel, brake: Brake, shortest: float
) -> PreparedModel:
    """The prepared model of rigid shoes, to which the flexibilities of shoes and ring are added.

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
        key = cache_key_of_shoe_shape(brake, shoe)
        if key not in made:
            made[key] = (
                body
                if shoe.body == bare.body
                else _add_elastic_shoe_flexibility_to_rigid_body(body, shoe, brake.size)
            )
        bodies.append(made[key])
    ring = scene.ring
    if ring is None and brake.ring is not None:
        count = max(
            LEAST_RING_MODES,
            math.ceil(2 * math.pi * RING_WAVES_ALONG_SHORTEST_CONTACT / max(shortest, 1e-9)),
        )
        if count > MOST_RING_MODES:
            raise NoAnswer(f"a contact of {shortest:.1e} rad is too short for the waves of a ring")
        ring = _ring_with_closed_form_flexibility(brake, brake.ring, tuple(bodies), count)
    return replace(scene, brake=brake, bodies=tuple(bodies), ring=ring)


def _brake_with_rigid_shoes_and_drum(brake: Brake) -> Brake:
    """The brake with a rigid drum and rigid shoes.

    A straight beam stays, because the block of a post begins at the beam. Its modulus is multiplied
    by MODULUS_FACTOR_OF_RIGID_BEAM.
    """

    def shoe_with_rigid_body(shoe: Shoe) -> Shoe:
        """The shoe with a rigid body.

        A straight beam becomes MODULUS_FACTOR_OF_RIGID_BEAM times as stiff; any other elastic body
        is left out. A shoe with a mesh file is not changed.
        """
        if not isinstance(shoe.body, BeamBody):
            return shoe.model_copy(update={"body": None}) if shoe.mesh is None else shoe
        section = shoe.body.section
        assert section is not None
        stiff = section.material.model_copy(
            update={
                key: MODULUS_FACTOR_OF_RIGID_BEAM * E for key, E in section.material.moduli.items()
            }
        )
        body = shoe.body.model_copy(
            update={"width": section.width, "material": stiff, "bending_stiffness": None}
        )
        return shoe.model_copy(update={"body": body})

    return brake.brake_without_ring().model_copy(
        update={"shoes": tuple(shoe_with_rigid_body(shoe) for shoe in brake.shoes)}
    )


def _add_elastic_shoe_flexibility_to_rigid_body(
    body: ShoeSubstructure, shoe: Shoe, radius: float
) -> ShoeSubstructure:
    """The condensed body of a rigid shoe, to which the flexibility of the elastic shoe is added.

    body : condensed lining on the rigid shoe; shoe : the elastic shoe; radius : radius of the drum
        [m].
    """
    bar, coupling = _bar_that_replaces_shoe(shoe, radius), body.coupling
    nodal = bar.square_root_of_bar_flexibility(body.line.xy)
    pressed, dragged = -nodal @ coupling.N.T, nodal @ coupling.T.T
    load = bar.square_root_of_bar_flexibility(
        body.application_point_of_actuation_loads[:, None], beyond=np.ones((len(bar.along), 1))
    )
    couple = np.concatenate([bar.bending, np.zeros(2 * len(bar.along))])[:, None]
    loaded = np.hstack([load, couple])
    flexibility = body.flexibility
    by_friction = flexibility.gap_closure_by_friction
    changed = flexibility._replace(
        gap_closure_by_pressure=flexibility.gap_closure_by_pressure - pressed.T @ pressed,
        gap_closure_by_friction=None if by_friction is None else by_friction - pressed.T @ dragged,
        gap_closure_by_load=flexibility.gap_closure_by_load - pressed.T @ loaded,
    )
    return replace(body, flexibility=changed)


class _ShoeAsBar(NamedTuple):
    """A shoe as a bar of m sections along its axis, in the coordinates of the shoe.

    Attributes
    ----------
    at : array (m, 2)
        Points of the axis in the middle of the sections [m].
    tangent : array (m, 2)
        Unit tangents of the axis, away from the hinge.
    along : array (m,)
        Distance of each section from the hinged end of the bar: an angle [rad] on an arc, a length
        [m] on a straight beam.
    foot : array
        The hinged end of the bar, from which `along` is measured: an angle (1,) [rad] on an arc, a
        point (2,) [m] on a straight beam.
    bending, stretching, shearing : array (m,)
        Square roots of ds/EI, ds/EA and kappa ds/GA for sections of length ds.
    is_arc : bool
        Whether the axis is an arc.
    """

    at: Floats
    tangent: Floats
    along: Floats
    foot: Floats
    bending: Floats
    stretching: Floats
    shearing: Floats
    is_arc: bool

    def square_root_of_bar_flexibility(self, xy: Floats, beyond: Floats | None = None) -> Floats:
        """The square root S of the bar's flexibility S^T S under forces at n points.

        S has the shape (3 m, 2 n): for each of the m sections bending, stretching and shearing, for
        each point forces along x and along y.

        Parameters
        ----------
        xy : array (2, n)
            The points [m].
        beyond : array (m, n), optional
            1 where a point lies beyond a section, seen from the hinge, so that the section carries
            the force at the point; 0 elsewhere. By default these numbers follow from the points.
        """
        if beyond is None:
            if self.is_arc:  # place: angle from the shoe's hinged end
                turn = np.abs(np.arctan2(xy[1], xy[0]) - self.foot[0])
            else:
                turn = (xy.T - self.foot) @ self.tangent[0]
            beyond = (turn > self.along[:, None]).astype(float)
        arm = xy.T - self.at[:, None]  # (m, n, 2)
        # The moments of unit forces along x and y.
        moment = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        normal = np.broadcast_to(self.tangent[:, None], arm.shape)
        shear = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)

        def flexibility_root_of_section_forces(part: Floats, root: Floats) -> Floats:
            """Rows (m, 2 n) of S for moments or forces in the sections: `part` times `root`.

            part : (m, n, 2), moment, normal or shear force in each section by unit loads at the
            points; root : (m,), square root of each section's compliance.
            """
            # Only the sections between the hinge and the point of a force carry the force.
            scaled = part * (beyond * root[:, None])[..., None]
            return np.asarray(scaled.reshape(len(root), -1))

        bending = flexibility_root_of_section_forces(moment, self.bending)
        stretching = flexibility_root_of_section_forces(normal, self.stretching)
        return np.concatenate(
            [bending, stretching, flexibility_root_of_section_forces(shear, self.shearing)]
        )


def _bar_that_replaces_shoe(shoe: Shoe, radius: float) -> _ShoeAsBar:
    """The bar that stands for the elastic body of a shoe.

    Where a body along an arc carries a lining and a backing, the three are one bonded section of
    the bar.

    radius : radius of the drum [m].
    """
    body = shoe.body
    assert body is not None
    if isinstance(body, ShoeBodyOfConstantSection):
        axis = _arc_axis_of_bar(shoe, body, radius)
    else:
        axis = _straight_axis_of_bar(shoe)
    EI, EA, GA = axis.stiffnesses
    return _ShoeAsBar(
        at=axis.at,
        tangent=axis.tangent,
        along=axis.along,
        foot=axis.foot,
        bending=np.sqrt(axis.ds / EI),
        stretching=np.sqrt(axis.ds / EA),
        shearing=np.sqrt(SHEAR_COEFFICIENT_OF_RECTANGULAR_SECTION * axis.ds / GA),
        is_arc=isinstance(body, ShoeBodyOfConstantSection),
    )


class _AxisAndSectionStiffnessOfBar(NamedTuple):
    """The axis of a bar of m sections, and the stiffness of its sections.

    Attributes
    ----------
    at, tangent, along, foot : array
        The axis as in the attributes of `_ShoeAsBar`: points, tangents, distances from the hinged
        end, and hinged end.
    ds : array (m,)
        Length of each section [m].
    stiffnesses : array (3, m) or (3, 1)
        Bending stiffness EI [N m^2], axial stiffness EA [N] and shear stiffness GA [N].
    """

    at: Floats
    tangent: Floats
    along: Floats
    foot: Floats
    ds: Floats
    stiffnesses: Floats


def _middles_of_bar_sections() -> Floats:
    """Places (m,) of the middles of a bar's sections, from 0 at the hinge to 1 at the far end."""
    return (np.arange(SECTIONS_OF_SURROGATE_BAR) + 0.5) / SECTIONS_OF_SURROGATE_BAR


def _arc_axis_of_bar(
    shoe: Shoe, body: ShoeBodyOfConstantSection, radius: float
) -> _AxisAndSectionStiffnessOfBar:
    """The axis and the stiffness of a shoe along an arc, with lining and backing where it has them.

    radius : radius of the drum [m].
    """
    near, far = sorted(shoe.frame.phi_coordinates_as_list((body.start, body.end)), key=abs)
    phi = near + (far - near) * _middles_of_bar_sections()
    start, end = shoe.arc
    plates = list(body.plates.values())[::-1]
    over = [
        _lining_or_backing_as_bar_layer(shoe, layer)
        for layer in (shoe.backing, shoe.lining)
        if layer is not None
    ]
    alone = np.array(stiffnesses_of_bonded_plates(plates))
    together = np.array(stiffnesses_of_bonded_plates([*plates, *over]))
    lined = (phi > start) & (phi < end)
    depth, *stiffnesses = np.where(lined, together[:, None], alone[:, None])
    axis = radius - shoe.sign_internal_plus_external_minus * (shoe.total_thickness - depth)
    return _AxisAndSectionStiffnessOfBar(
        at=(axis * np.array([np.cos(phi), np.sin(phi)])).T,
        tangent=math.copysign(1.0, far - near) * np.column_stack([-np.sin(phi), np.cos(phi)]),
        along=np.abs(phi - near),
        foot=np.array([near]),
        ds=axis * abs(far - near) / SECTIONS_OF_SURROGATE_BAR,
        stiffnesses=np.array(stiffnesses),
    )


def _straight_axis_of_bar(shoe: Shoe) -> _AxisAndSectionStiffnessOfBar:
    """The axis and the stiffness of a straight beam, from the hinge to the actuation force."""
    assert shoe.body is not None
    hinge, end = (
        shoe.frame.convert_vectors_to_shoe_frame(shoe.pin.xy),
        shoe.frame.convert_vectors_to_shoe_frame(shoe.actuation.point.xy),
    )
    line = make_beam_axis(hinge, end)
    along = line.length * _middles_of_bar_sections()
    plates = list(shoe.body.plates.values())[::-1]
    return _AxisAndSectionStiffnessOfBar(
        at=hinge + along[:, None] * line.along,
        tangent=np.tile(line.along, (SECTIONS_OF_SURROGATE_BAR, 1)),
        along=along,
        foot=hinge,
        ds=np.full(SECTIONS_OF_SURROGATE_BAR, line.length / SECTIONS_OF_SURROGATE_BAR),
        stiffnesses=np.array(stiffnesses_of_bonded_plates(plates)[1:])[:, None],
    )


def _lining_or_backing_as_bar_layer(shoe: Shoe, layer: Lining | Backing) -> RectangularCrossSection:
    """The lining or backing of a shoe as a layer of the bar's section, with the lining's width."""
    return RectangularCrossSection(layer.thickness, shoe.lining.width, layer.material)


def _ring_with_closed_form_flexibility(
    brake: Brake, ring: DrumRing, bodies: tuple[ShoeSubstructure, ...], count: int
) -> RingSubstructure:
    """The elastic drum ring of a surrogate, with the square roots of its flexibility.

    Each lining has two square roots, for pressure and for friction, of the shape (2 count + 2, n)
    for the n contact nodes of the lining.

    Parameters
    ----------
    brake, ring : Brake, DrumRing
        The brake and its drum ring.
    bodies : tuple of ShoeSubstructure
        The condensed body of each shoe, with its contact line.
    count : int
        Largest order k of the modes cos k theta and sin k theta of the ring.
    """
    sign, radius, section = (
        brake.shoes[0].sign_internal_plus_external_minus,
        brake.size,
        ring.section,
    )
    assert section is not None
    k = np.arange(count + 1)
    radial, shear = radial_ring_compliances_under_two_tractions_by_mode(ring, radius, sign, k)
    # Factors that turn integrals of pressure times cos k theta into Fourier coefficients.
    share = np.where(k == 0, 0.5, 1.0) / (math.pi * radius * section.width)
    root = np.sqrt(share * radial)
    turned = np.where(k == 0, 0.0, sign * share * shear / root)
    pressed, dragged = [], []
    for body, shoe in zip(bodies, brake.shoes, strict=True):
        c, s = _cosine_and_sine_integrals_over_lining(body, shoe, k)
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


def _cosine_and_sine_integrals_over_lining(
    body: ShoeSubstructure, shoe: Shoe, k: Ints
) -> tuple[Floats, Floats]:
    """Integrals b Int psi_i cos k theta ds and b Int psi_i sin k theta ds over a lining [m^2].

    Both results are arrays (modes, n). b is the width of the lining, psi_i is the shape function of
    contact node i of n, theta is the angle around the brake, and k is the order of a mode.
    """
    line = body.line
    psi, x, ds = edge_quadrature_points(line.xy[:, line.pieces])
    wave = np.exp(
        1j
        * k[:, None, None]
        * shoe.frame.surface_coordinates_of_phi(
            shoe.surface_coordinates_of_points_in_shoe_frame(x, 1.0)
        )
    )
    found = np.zeros((len(k), len(line.nodes)), dtype=complex)
    # `+=` with an index array is right, because a node occurs at most once in each row of
    # `line.pieces`. For a repeated node it would add only the last value.
    for value, nodes in zip(psi, line.pieces, strict=True):
        found[:, nodes] += shoe.lining.width * (wave * (value * ds)).sum(axis=2)
    return found.real, found.imag


def radial_ring_compliances_under_two_tractions_by_mode(
    ring: DrumRing, radius: float, sign: int, modes: Ints
) -> tuple[Floats, Floats]:
    """Radial displacements of a ring's friction surface under two tractions, for each mode.

    Both results are arrays (m,) [m/Pa]. The first is for the radial traction cos k theta, the
    second for the traction sin k theta around the drum. With a free rim the rigid-body motion of
    the rim is set to zero on average. The necessary force is distributed over the rim like this
    motion.

    Parameters
    ----------
    ring : DrumRing
        The ring, isotropic.
    radius : float
        Radius of the drum [m].
    sign : int
        1 if the ring lies outside the friction surface, -1 if it lies inside.
    modes : array of int (m,)
        Orders k of the modes, in growing order.
    """
    section = ring.section
    assert section is not None
    assert isinstance(section.material, Material)
    # For modes with waves much shorter than the thickness the formulas of a half-plane hold.
    long = modes * section.thickness <= HALF_PLANE_LIMIT_OF_RING_WAVE_NUMBER * radius
    if not long.all():
        E, nu = section.material.E, section.material.nu
        over = radius / (E * modes[~long])
        found = radial_ring_compliances_under_two_tractions_by_mode(ring, radius, sign, modes[long])
        return np.append(found[0], 2 * over), np.append(found[1], (1 - nu) * over)
    K = _ring_stiffness_of_each_mode(section.material, section.thickness, radius, sign, modes)
    load = np.zeros((*K.shape[:2], 2))
    load[:, 0, 0] = load[:, DEGREE_THROUGH_RING_THICKNESS + 1, 1] = radius
    u = _displacements_under_linear_constraints(
        K, _displacement_constraints_at_ring_rim_by_mode(ring, modes), load
    )
    return np.asarray(u[:, 0, 0]), np.asarray(u[:, 0, 1])


class _ShapeFunctionsThroughRingThickness(NamedTuple):
    """The shape functions of a ring through its thickness, at the q points of a Gauss rule.

    Attributes
    ----------
    xi, weights : array (q,)
        Points of [-1, 1] from the friction surface to the rim, and their weights.
    psi, slope : array (q, DEGREE_THROUGH_RING_THICKNESS + 1)
        Values of the shape functions at the points, and their derivatives by xi.
    """

    xi: Floats
    weights: Floats
    psi: Floats
    slope: Floats


def _shape_functions_through_ring() -> _ShapeFunctionsThroughRingThickness:
    """The shape functions of a ring through its thickness: Lagrange polynomials.

    Their nodes are Chebyshev points. The polynomials are written as sums of Legendre polynomials.
    """
    x = -np.cos(
        math.pi * np.arange(DEGREE_THROUGH_RING_THICKNESS + 1) / DEGREE_THROUGH_RING_THICKNESS
    )
    V = np.linalg.inv(np.polynomial.legendre.legvander(x, DEGREE_THROUGH_RING_THICKNESS))
    xi, w = np.polynomial.legendre.leggauss(DEGREE_THROUGH_RING_THICKNESS + 2)
    psi = np.polynomial.legendre.legvander(xi, DEGREE_THROUGH_RING_THICKNESS) @ V
    slope = np.array(
        [np.polynomial.legendre.legval(xi, np.polynomial.legendre.legder(c)) for c in V.T]
    ).T
    return _ShapeFunctionsThroughRingThickness(xi, w, psi, slope)


def _ring_stiffness_of_each_mode(
    material: Material, thickness: float, radius: float, sign: int, modes: Ints
) -> Floats:
    """The stiffness (m, 2 n, 2 n) of a ring of width 1 for each of m modes.

    The unknowns are the radial displacements U at n nodes through the thickness, then the
    displacements V around the drum at the same nodes.

    Parameters
    ----------
    material : Material
        Material of the ring.
    thickness : float
        Thickness of the ring [m].
    radius, sign, modes : float, int, array
        As in `radial_ring_compliances_under_two_tractions_by_mode`.
    """
    E, nu = material.E, material.nu
    through = _shape_functions_through_ring()
    half = sign * thickness / 2
    r = radius + half * (1 + through.xi)
    d, over = through.slope / half, through.psi / r[:, None]
    zero = np.zeros_like(through.psi)
    n = modes[:, None, None]
    # Strains (m, q, 2 nodes) at q Gauss points under unit nodal displacements: radial strain,
    # strain around the drum, and shear strain.
    e_r = np.broadcast_to(
        np.hstack([d, zero]), (len(modes), len(r), 2 * (DEGREE_THROUGH_RING_THICKNESS + 1))
    )
    e_t = np.concatenate([over + 0 * n, n * over], axis=2)
    g = np.concatenate([-n * over, d - over + 0 * n], axis=2)
    weight = (through.weights * abs(half) * r)[:, None] * E / (1 - nu**2)

    def integrate_strain_products(a: Floats, b: Floats) -> Floats:
        """Integrals (m, 2 n, 2 n) of a b E/(1 - nu^2) r dr through the ring's thickness.

        There is one integral for each of the m modes around the ring. `a` and `b` (m, q, 2 n) are
        strains at q points of the thickness under unit displacements of the n nodes.
        """
        return np.asarray(a.transpose(0, 2, 1) @ (weight * b))

    return (
        integrate_strain_products(e_r, e_r + nu * e_t)
        + integrate_strain_products(e_t, e_t + nu * e_r)
        + (1 - nu) / 2 * integrate_strain_products(g, g)
    )


def _displacement_constraints_at_ring_rim_by_mode(ring: DrumRing, modes: Ints) -> Floats:
    """The constraints (m, 2 n, 2) on the displacements U and V of n nodes, for each of m modes.

    A fixed rim does not move. For a free rim the constraints suppress the rigid-body motions: the
    rotation in mode k = 0 and the translation in mode k = 1. A constraint whose coefficients are
    all zero is inactive.
    """
    size, rim = DEGREE_THROUGH_RING_THICKNESS + 1, DEGREE_THROUGH_RING_THICKNESS
    hold = np.zeros((len(modes), 2 * size, 2))
    if ring.support == "fixed":
        hold[:, rim, 0] = hold[:, size + rim, 1] = 1.0
    else:
        hold[modes == 0, size + rim, 0] = 1.0
        hold[modes == 1, rim, 0], hold[modes == 1, size + rim, 0] = 1.0, -1.0
    return hold


def _displacements_under_linear_constraints(K: Floats, hold: Floats, load: Floats) -> Floats:
    """The displacements (m, n, l) of m bodies under l loads and two linear constraints.

    The constraints become further equations, scaled to the size of the stiffness matrix.

    Parameters
    ----------
    K : array (m, n, n)
        Stiffness of the bodies.
    hold : array (m, n, 2)
        Coefficients of the displacements in the constraints; a constraint whose coefficients are
        all zero is inactive.
    load : array (m, n, l)
        Loads on the bodies.
    """
    m, n, _ = K.shape
    scale = np.abs(K).max()
    bordered = np.zeros((m, n + 2, n + 2))
    bordered[:, :n, :n] = K
    bordered[:, :n, n:] = scale * hold
    bordered[:, n:, :n] = scale * hold.transpose(0, 2, 1)
    # An inactive constraint has a row of zeros. A number on the diagonal of this row keeps the
    # system regular.
    for j in range(2):
        bordered[:, n + j, n + j] = np.where(hold[:, :, j].any(axis=1), 0.0, scale)
    right = np.zeros((m, n + 2, load.shape[2]))
    right[:, :n] = load
    return np.linalg.solve(bordered, right)[:, :n]
