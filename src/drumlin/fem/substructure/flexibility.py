"""The flexibility of a body under pressures and friction on its contact nodes.

All unknowns of the body are eliminated except its frame, contact nodes included. With the Cholesky
factorisation L L^T of the stiffness K, loads G and H do the work G^T K^-1 H = (L^-1 G)^T L^-1 H on
each other's displacements. The forward substitution L^-1 G goes front by front, and so does the sum
of these products.

A nodal pressure loads a few neighbouring contact nodes. Its forward substitution changes only the
fronts of the regions around these nodes, from the smallest region to the whole body. In the front
of a small region only its own few pressures count, and a shoe is slender, so that the fronts of
large regions have few unknowns. The work thus grows with the square of the number of contact nodes,
as the flexibility itself does. A condensation to all contact nodes would have a dense stiffness,
whose factorisation and solutions grow with the cube of this number.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.lapack import dtrsm
from drumlin.fem.substructure.elimination import CholeskyFactorOfFront


class ContactFlexibility(NamedTuple):
    """How a body moves at its n contact nodes and l load points, and what its frame takes up.

    The frame does not move. The matrices N and T and the unit loads are those of
    `preparation.bodies.ShoeSubstructure`. Without friction the three matrices of friction are None.

    Attributes
    ----------
    gap_closure_by_pressure, gap_closure_by_friction : (n, n) weighted gap closure N u due to unit
        nodal pressures, and due to unit nodal friction
    gap_closure_by_load : (n, l) weighted gap closure N u due to the unit loads
    load_point_motion_by_friction : (l, n) work of each unit load on the displacements due to unit
        nodal friction; for a unit force it is the displacement of its point along the force
    load_point_motion_by_load : (l, l) work of each unit load on the displacements due to each unit
        load
    reaction_to_pressure, reaction_to_friction : (3, n) support reaction on the frame (force x,
        force y, moment about the pin) to unit nodal pressures, and to unit nodal friction
    reaction_to_load : (3, l) support reaction on the frame to the unit loads
    """

    gap_closure_by_pressure: Floats
    gap_closure_by_friction: Floats | None
    gap_closure_by_load: Floats
    load_point_motion_by_friction: Floats | None
    load_point_motion_by_load: Floats
    reaction_to_pressure: Floats
    reaction_to_friction: Floats | None
    reaction_to_load: Floats

    def motion_of_load_points(self, p: Floats, friction: Floats, load: Floats) -> Floats:
        """The work (l,) of each unit load on the displacements due to pressure, friction and loads.

        The arguments are those of `support_reaction`.
        """
        motion = self.load_point_motion_by_load @ load - self.gap_closure_by_load.T @ p
        if self.load_point_motion_by_friction is None:
            return motion
        return motion + self.load_point_motion_by_friction @ friction

    def support_reaction(self, p: Floats, friction: Floats, load: Floats) -> Floats:
        """The support reaction (3,): force x [N], force y [N] and moment about the pin [N m].

        Parameters
        ----------
        p : (n,) pressure at the contact nodes [Pa], or (n, k) for k pressures
        friction : friction stress at the contact nodes [Pa], in the form of `p`; its sign is that
            of the tangents of the coupling matrix T
        load : (l,) factors of the unit loads, or (l, 1) for all k pressures
        """
        reaction = self.reaction_to_pressure @ p + self.reaction_to_load @ load
        if self.reaction_to_friction is None:
            return reaction
        return reaction + self.reaction_to_friction @ friction


class ContactForces(NamedTuple):
    """The nodal forces of unit nodal pressures, and of unit nodal friction, on the contact nodes.

    Attributes
    ----------
    by_type : one or two arrays (n, 2n): the forces of each unit nodal pressure on the displacements
        of the contact nodes, and those of each unit nodal friction; x and y of a node are side by
        side
    first, last : (2n,) for each displacement the range of nodal pressures with forces on it, from
        `first` to `last` - 1
    """

    by_type: tuple[Floats, ...]
    first: Ints
    last: Ints

    @classmethod
    def contact_forces_of_coupling_matrices(cls, N: Floats, T: Floats | None) -> "ContactForces":
        """The contact forces of the coupling matrices N and T (n, 2n); T is None without friction.

        The pressure p has the nodal forces -N^T p, and the friction T^T p.
        """
        by_type = (-N,) if T is None else (-N, T)
        is_loaded = N != 0 if T is None else (N != 0) | (T != 0)
        first = is_loaded.argmax(axis=0)
        last = len(N) - is_loaded[::-1].argmax(axis=0)
        return cls(by_type, first, np.where(is_loaded.any(axis=0), last, first))


class EliminatedUnknownsInOrder(NamedTuple):
    """The unknowns of a body in the order of elimination, with the unit loads on them.

    Attributes
    ----------
    region : (m,) number of the region of each eliminated unknown, not decreasing
    contact : (u,) for each unknown the number of its displacement among those of the contact nodes;
        -1 for other unknowns. The last unknowns are those of the frame
    loads : (u, l) unit loads on all unknowns
    """

    region: Ints
    contact: Ints
    loads: Floats


class _LoadsOnLaterUnknowns(NamedTuple):
    """The condensed loads of one front on the later unknowns that are coupled with it.

    Attributes
    ----------
    unknowns : (m,) numbers of the later unknowns
    first, last : the range of nodal pressures whose loads are in `values`
    values : (m, l + k (last - first)) condensed unit loads, then condensed loads of the nodal
        pressures of the range, then those of the nodal friction if there is friction (k = 2)
    """

    unknowns: Ints
    first: int
    last: int
    values: Floats


class _SumsOverFronts(NamedTuple):
    """Sums over fronts from which the flexibility follows; the arrays grow in place.

    Attributes
    ----------
    closure_by_load, motion_by_load : (n, l), (l, l) gap closure and load travel due to unit loads
    closure_by_type, motion_by_type : for each type of contact forces, (n, n) gap closure and (l, n)
        load travel due to them
    on_frame_by_load : (3, l) unit loads, condensed to the frame
    on_frame_by_type : for each type of contact forces, these forces (3, n) condensed to the frame
    """

    closure_by_load: Floats
    motion_by_load: Floats
    closure_by_type: tuple[Floats, ...]
    motion_by_type: tuple[Floats, ...]
    on_frame_by_load: Floats
    on_frame_by_type: tuple[Floats, ...]

    @classmethod
    def sums_before_first_front(
        cls, unknowns: EliminatedUnknownsInOrder, forces: ContactForces
    ) -> "_SumsOverFronts":
        """The sums before the first front."""
        on_frame = unknowns.loads[len(unknowns.region) :].copy()
        count = unknowns.loads.shape[1]
        n = len(forces.by_type[0])
        return cls(
            np.zeros((n, count)),
            np.zeros((count, count)),
            tuple(np.zeros((n, n)) for _ in forces.by_type),
            tuple(np.zeros((count, n)) for _ in forces.by_type),
            on_frame,
            tuple(np.zeros((len(on_frame), n)) for _ in forces.by_type),
        )

    def add_products_of_front(self, y: Floats, first: int, last: int) -> None:
        """Add the products of the loads y = L^-1 G on the own unknowns of a front.

        The rows of y are the own unknowns, and its columns those of `_LoadsOnLaterUnknowns` for the
        range of nodal pressures from `first` to `last` - 1.
        """
        count, width = len(self.motion_by_load), last - first
        loaded, pressed = y[:, :count], y[:, count : count + width]
        self.motion_by_load[:] += loaded.T @ loaded
        if not width:
            return
        # The pressure presses the lining away from the drum, so that gap closures have a minus.
        self.closure_by_load[first:last] -= pressed.T @ loaded
        for k in range(len(self.closure_by_type)):
            of_type = y[:, _columns_of_type(k, count, width)]
            self.closure_by_type[k][first:last, first:last] -= pressed.T @ of_type
            self.motion_by_type[k][:, first:last] += loaded.T @ of_type

    def add_loads_on_frame(self, rest: _LoadsOnLaterUnknowns, inner: int) -> None:
        """Add the loads of a front that are condensed to the frame, after `inner` unknowns."""
        rows, count = rest.unknowns - inner, len(self.motion_by_load)
        width = rest.last - rest.first
        self.on_frame_by_load[rows] += rest.values[:, :count]
        for k, on_frame in enumerate(self.on_frame_by_type):
            columns = _columns_of_type(k, count, width)
            on_frame[rows, rest.first : rest.last] += rest.values[:, columns]

    def flexibility_of_whole_body(self) -> ContactFlexibility:
        """The flexibility, after all fronts were added."""
        has_friction = len(self.closure_by_type) > 1
        return ContactFlexibility(
            gap_closure_by_pressure=self.closure_by_type[0],
            gap_closure_by_friction=self.closure_by_type[1] if has_friction else None,
            gap_closure_by_load=self.closure_by_load,
            load_point_motion_by_friction=self.motion_by_type[1] if has_friction else None,
            load_point_motion_by_load=self.motion_by_load,
            # The frame keeps its place if its support balances the condensed loads.
            reaction_to_pressure=-self.on_frame_by_type[0],
            reaction_to_friction=-self.on_frame_by_type[1] if has_friction else None,
            reaction_to_load=-self.on_frame_by_load,
        )


def _columns_of_type(k: int, count: int, width: int) -> slice:
    """The columns of type k (0 pressure, 1 friction) after `count` unit loads.

    Each type has `width` columns.
    """
    return slice(count + k * width, count + (k + 1) * width)


def flexibility_under_contact_forces(
    fronts: Iterable[CholeskyFactorOfFront],
    unknowns: EliminatedUnknownsInOrder,
    forces: ContactForces,
) -> ContactFlexibility:
    """The flexibility of a body under its unit loads and its contact forces.

    Parameters
    ----------
    fronts : factorised fronts of all unknowns except the frame, in the order of elimination
    unknowns : the unknowns in this order, with the unit loads
    forces : contact forces
    """
    region, inner = unknowns.region, len(unknowns.region)
    frame_region = int(region[-1]) + 1
    pending: list[list[_LoadsOnLaterUnknowns]] = [[] for _ in range(frame_region + 1)]
    position = np.empty(len(unknowns.loads), dtype=np.int64)
    sums = _SumsOverFronts.sums_before_first_front(unknowns, forces)
    for front in fronts:
        own = front.own.stop - front.own.start
        position[front.own] = np.arange(own)
        position[front.later] = own + np.arange(len(front.later))
        r = int(region[front.own.start])
        first, last, right = _loads_on_front(front, position, unknowns, forces, pending[r])
        pending[r] = []
        y = dtrsm(1.0, front.L, right[:own], lower=1)
        sums.add_products_of_front(y, first, last)
        if len(front.later):
            rest = right[own:] - front.rows_of_later_unknowns @ y
            next_region = frame_region if front.later[0] >= inner else int(region[front.later[0]])
            pending[next_region].append(_LoadsOnLaterUnknowns(front.later, first, last, rest))
    for on_frame in pending[frame_region]:
        sums.add_loads_on_frame(on_frame, inner)
    return sums.flexibility_of_whole_body()


def _loads_on_front(
    front: CholeskyFactorOfFront,
    position: Ints,
    unknowns: EliminatedUnknownsInOrder,
    forces: ContactForces,
    pending: list[_LoadsOnLaterUnknowns],
) -> tuple[int, int, Floats]:
    """The loads on the unknowns of a front, and the range of nodal pressures that they belong to.

    Returns the begin and the end of this range, and the loads (own + later unknowns, columns) with
    the columns of `_LoadsOnLaterUnknowns`.

    Parameters
    ----------
    front : the front
    position : (u,) position in the front of each of its unknowns
    unknowns, forces : see `flexibility_under_contact_forces`
    pending : condensed loads of earlier fronts that are to be added
    """
    on_contact = unknowns.contact[front.own]
    rows = np.flatnonzero(on_contact >= 0)
    on_contact = on_contact[rows]
    ranges = [(each.first, each.last) for each in pending if each.last > each.first]
    if len(rows):
        ranges.append((int(forces.first[on_contact].min()), int(forces.last[on_contact].max())))
    first = min((begin for begin, _ in ranges), default=0)
    last = max((end for _, end in ranges), default=0)

    count, width = unknowns.loads.shape[1], last - first
    own = front.own.stop - front.own.start
    shape = (own + len(front.later), count + len(forces.by_type) * width)
    right = np.zeros(shape, order="F")
    right[:own, :count] = unknowns.loads[front.own]
    if len(rows):
        for k, matrix in enumerate(forces.by_type):
            right[rows, _columns_of_type(k, count, width)] = matrix[first:last, on_contact].T
    for each in pending:
        at, part = position[each.unknowns], each.last - each.first
        right[at, :count] += each.values[:, :count]
        for k in range(len(forces.by_type)):
            start = count + k * width + each.first - first
            values = each.values[:, _columns_of_type(k, count, part)]
            right[at, start : start + part] += values
    return first, last, right
