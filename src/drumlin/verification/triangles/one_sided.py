"""One-sided supports in the contact equations: anchors, abutments and struts that only push.

A support with the force s opens by v = v_0 + D f + E s + V y under nodal contact forces f and in
rigid-body motions y. A support that bears has the opening v = 0, and an open support the force s =
0. Each support that bears adds an unknown, its force, and an equation, v = 0, to the contact
equations.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.one_sided import (
    LARGEST_ROUND_OFF_PULL_OF_SUPPORT,
    BearingFlagsOfOneSidedSupports,
    OneSidedSupport,
    divide_motions_into_held_and_free,
    do_linings_resist_free_motions,
    one_sided_supports_of_brake,
    work_of_support_push_in_rigid_body_modes,
)
from drumlin.verification.triangles.equations import ContactEquations
from drumlin.verification.triangles.face import ShoeCondensedToLiningFace


class EquationsOfOneSidedSupportOpenings(NamedTuple):
    """The openings v = v_0 + D f + E s + V y of m one-sided supports of some shoes.

    Attributes
    ----------
    supports : the supports; they name shoes by positions in the list of the given shoes
    opening : (m,) v_0, openings due to clearances, loads and heat [m]
    opening_by_contact_force : (m, n) D, openings of the supports per nodal contact force [m/N]
    opening_by_support_force : (m, m) E, openings of the supports per force of a support [m/N]
    opening_by_rigid_mode : (m, k) V, openings of the supports per unit of a rigid-body mode
    gap : (n, m) openings of the gaps at the nodes per force of a support [m/N]
    sizes : (k,) amount of each mode that displaces points of the brake by about 1 m
    """

    supports: tuple[OneSidedSupport, ...]
    opening: Floats
    opening_by_contact_force: Floats
    opening_by_support_force: Floats
    opening_by_rigid_mode: Floats
    gap: Floats
    sizes: Floats


def one_sided_supports_of_shoes(brake: Brake, shoes: list[Shoe]) -> tuple[OneSidedSupport, ...]:
    """The one-sided supports of some of a brake's shoes; they name shoes by position in `shoes`."""
    names, found = [shoe.name for shoe in shoes], []
    for support in one_sided_supports_of_brake(brake):
        ends = [brake.shoes[side.shoe].name for side in support.sides]
        if ends[0] in names:
            sides = [
                side._replace(shoe=names.index(end))
                for side, end in zip(support.sides, ends, strict=True)
            ]
            found.append(support._replace(sides=tuple(sides)))
    return tuple(found)


class ShoeAndItsPlacesInContactEquations(NamedTuple):
    """A shoe with its condensed face and its places in the contact equations.

    Attributes
    ----------
    shoe, face : the shoe, and the shoe condensed to the face of its lining
    normal : (n, 2n) matrix that gives the normal components of the displacements of the n nodes
    nodal_forces_per_normal_force : (2n, n) matrix that turns normal forces into nodal forces on the
        lining, with friction
    nodes, modes : positions of its nodes and of its rigid-body modes in the equations of all shoes
    """

    shoe: Shoe
    face: ShoeCondensedToLiningFace
    normal: Floats
    nodal_forces_per_normal_force: Floats
    nodes: slice
    modes: slice


def equations_of_one_sided_support_openings(
    supports: tuple[OneSidedSupport, ...],
    shoes: list[ShoeAndItsPlacesInContactEquations],
    brake: Brake,
) -> EquationsOfOneSidedSupportOpenings:
    """The equations for the openings of the one-sided supports of a brake's shoes."""
    m, n, k = len(supports), shoes[-1].nodes.stop, shoes[-1].modes.stop
    opening = np.array([support.clearance for support in supports])
    opening_by_contact_force, gap = np.zeros((m, n)), np.zeros((n, m))
    opening_by_support_force, opening_by_rigid_mode = np.zeros((m, m)), np.zeros((m, k))
    for i, one in enumerate(shoes):
        face = one.face
        # The columns of `face.displacements_under_unit_pushes` belong to the supports that push
        # this shoe, in the order of `own`.
        own = [
            (j, side.push_of_one_newton)
            for j, support in enumerate(supports)
            for side in support.sides
            if side.shoe == i
        ]
        for column, (j, push) in enumerate(own):
            opening[j] += face.push_travel[column]
            opening_by_contact_force[j, one.nodes] = (
                face.displacements_under_unit_pushes[:, column] @ one.nodal_forces_per_normal_force
            )
            opening_by_rigid_mode[j, one.modes] = work_of_support_push_in_rigid_body_modes(
                one.shoe, push
            )
            gap[one.nodes, j] = -one.normal @ face.displacements_under_unit_pushes[:, column]
        at = [j for j, _ in own]
        opening_by_support_force[np.ix_(at, at)] += face.push_compliance
    sizes = np.concatenate(
        [
            np.where(
                np.isin(one.shoe.rigid_body_modes_of_support().names, ["turn", "tilt"]),
                1 / brake.size,
                1.0,
            )
            for one in shoes
        ]
    )
    return EquationsOfOneSidedSupportOpenings(
        supports,
        opening,
        opening_by_contact_force,
        opening_by_support_force,
        opening_by_rigid_mode,
        gap,
        sizes,
    )


def contact_equations_on_supports_that_bear(
    equations: ContactEquations,
    supports: EquationsOfOneSidedSupportOpenings,
    bearing: BearingFlagsOfOneSidedSupports,
) -> ContactEquations | None:
    """The contact equations with the forces of the supports that bear as further unknowns.

    The result is None if the supports that bear are statically redundant, or if they leave a motion
    free that the linings do not resist.
    """
    A, q, B, C, _, h, weight, is_force = equations
    on = np.flatnonzero(bearing)
    motions = divide_motions_into_held_and_free(supports.opening_by_rigid_mode[on], supports.sizes)
    if motions is None:
        return None
    scale = float(np.linalg.norm(B * supports.sizes, axis=0).max())
    if not do_linings_resist_free_motions(B @ motions.free, scale):
        return None
    V, E = supports.opening_by_rigid_mode[on], supports.opening_by_support_force[np.ix_(on, on)]
    return ContactEquations(
        A,
        q,
        np.column_stack([B, supports.gap[:, on]]),
        np.concatenate([C, supports.opening_by_contact_force[on]]),
        np.block([[np.zeros((len(h), len(h))), V.T], [V, E]]),
        np.concatenate([h, -supports.opening[on]]),
        weight,
        np.concatenate([is_force, np.ones(len(on), dtype=bool)]),
    )


def do_supports_bear_as_assumed_in_triangle_solution(
    supports: EquationsOfOneSidedSupportOpenings,
    bearing: BearingFlagsOfOneSidedSupports,
    f: Floats,
    s: Floats,
    y: Floats,
) -> bool:
    """Whether no bearing support pulls its shoe, and no open support overlaps its shoe.

    Parameters
    ----------
    supports : the openings of the m supports
    bearing : whether each support bears
    f, s, y : nodal contact forces (n,) [N], forces (m,) of the supports [N], and motions (k,)
    """
    parts = [
        supports.opening,
        supports.opening_by_contact_force @ f,
        supports.opening_by_support_force @ s,
        supports.opening_by_rigid_mode @ y,
    ]
    opening, on = np.sum(parts, axis=0), np.array(bearing)
    largest = max(float(np.abs(s).max()), float(f.sum()))
    pulls = s[on] < -LARGEST_ROUND_OFF_PULL_OF_SUPPORT * largest
    overlaps = opening[~on] < -LARGEST_ROUND_OFF_PULL_OF_SUPPORT * float(np.abs(parts).max())
    return not (pulls.any() or overlaps.any())
