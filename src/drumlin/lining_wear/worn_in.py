"""Compute the clearance of worn-in linings, with which an elastic brake has the final pressure.

Wear ends when every point of the lining wears as fast as the motion of the shoe brings it nearer to
the drum. On a hinged shoe the pressure p is then proportional to sin(phi). On a mesh, p is the
pressure of steady wear, by `archard.solve_steady_wear`. With the rigid-body motions y' of the shoe
per sliding distance, the opening w' of the gap and the loads h it satisfies

    w' = M p + B y' >= 0,   p >= 0,   p w' = 0,   C p = h

The matrix M turns nodal gaps into gaps weighted by the shape functions of the elements
(`drumlin.fem.substructure.interface`). Friction at the abutments opposes y'. This module seeks the
gap g between the unloaded linings and the drum with which the brake has the same pressure p under
its load. The gap g must satisfy, for some motions y of the shoe,

    w = M g + q + A p + B y >= 0,   p w = 0

The actuation opens the weighted gap q, and the pressure opens the weighted gap A p. Let
c = M^-1 (q + A p) be both openings together. For any motions y0 of the shoe and any a >= 0 the
choice

    g = a p - c - M^-1 B y0,   y = y0 + a y'   gives   w = a (M p + B y') = a w'

This w is 0 where the lining is in contact, and not negative elsewhere, so that the pressure is p.
The factor a and the motions y0 can be chosen. The code calls a `depth_per_pressure`, c `opened` and
y0 `rest`, and follows these rules:

- a > 0 is the depth of even wear per pressure. A negative a would push the part of the lining that
  is not in contact into the drum. A small depth is enough, see
  LARGEST_ADDED_STEADY_WEAR_OVER_ELASTIC_GAP.
- y0 is the position in which the unloaded shoe rests. It does not move a foot on a rough abutment.
  The foot then slides by a y' alone, and friction acts on it as in steady wear. y0 is the sum of
  two motions. The first opens the gap nearest to c. The second closes the gap most evenly, and it
  is just large enough that -c - M^-1 B y0 is nowhere negative: the unloaded lining does not lie in
  the drum. The motion y' cannot take the place of the second motion. Where the contact ends, y'
  moves the lining along the drum, and no amount of y' keeps the lining out of the drum there.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import groupby
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import InterpolationTable, table_rows_from_coordinates_and_values
from drumlin.brake.further_loads import require_springs_with_constant_pull
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.foundation.model import (
    DEFAULT_DIVISIONS_OF_SHOE_BEAM,
    contact_problem_of_shoe_group,
    validated_names_of_effects_to_include,
)
from drumlin.foundation.post import brake_angles_from_beam_angles
from drumlin.laws import solve_brake_by_sine_law
from drumlin.lining_wear.archard import WearContactProblem, WearLaw, solve_steady_wear
from drumlin.lining_wear.linings import (
    WornLining,
    brake_with_given_lining_clearances,
    wear_setup_by_finite_elements,
)
from drumlin.response import Response
from drumlin.response.merit import response_with_figures_of_merit

LEAST_RELATIVE_GAP_CHANGE_OF_CONSIDERED_NODE = 0.01
"""Gap change by a motion of the shoe below which a node is ignored.

It is relative to the lining's largest gap change by this motion. An unloaded worn-in lining must
not penetrate the drum. The shoe is moved away from the drum until no node penetrates it, except for
the ignored nodes. These lie near the line through the hinge and the drum's centre, where even a
large motion hardly changes the gap. A judgement; the pressure does not depend on it."""

LARGEST_ADDED_STEADY_WEAR_OVER_ELASTIC_GAP = 1e-3
"""Largest depth of the steady wear that is added to a worn-in lining, relative to the elastic gap.

The elastic gap is the largest opening of the gap under load that no motion of the shoe closes. The
added wear lifts the part of the lining that is not in contact off the drum, and lets feet on rough
abutments slide as in steady wear. For both purposes the value must be far above the round-off of
1e-12. A value of 1 would make soft shoes turn more than they need to. A judgement; the pressure
does not depend on it."""


def solve_worn_in_brake(
    brake: Brake, *, penalty: float = DEFAULT_PENALTY_FACTOR, **options: Any
) -> Response:
    """Solve a brake by finite elements as if its linings were worn in.

    Parameters
    ----------
    brake : the brake, whose clearances and misfit are replaced
    penalty : factor alpha of the contact stiffness alpha E/t per area
    options : options of `prepared_model_with_finest_elements`
    """
    scene = prepared_model_with_finest_elements(brake, **options)
    worn = brake_with_worn_in_clearances(scene, brake)
    return response_with_figures_of_merit(brake, solve_prepared_model(scene, worn, penalty=penalty))


def brake_with_worn_in_clearances(scene: PreparedModel, brake: Brake) -> Brake:
    """The brake with the clearances of worn-in linings in place of its own clearances and misfit.

    The clearances are computed for a round drum. An out-of-round drum stays out of round in the
    result: as it turns, it wears the lining evenly if the whole lining stays in contact. `scene`
    holds the prepared finite elements of the brake. Raises NoAnswer for a self-locking shoe, and
    BadInput for springs with a rate.
    """
    require_springs_with_constant_pull(brake, "the worn-in brake")
    setup = wear_setup_by_finite_elements(
        scene, brake_without_misfit_and_clearance(brake, drum=True)
    )
    gaps: dict[tuple[int, int], InterpolationTable] = {}
    for number, interface in enumerate(setup.interfaces):
        surfaces = [surface for surface in setup.surfaces if surface.interface == number]
        # Shoes under a cam or behind a strut move together, so that their linings count as one.
        linings = [slice(None)]
        if brake.reason_why_cam_or_strut_sets_forces is None:
            linings = _contact_unknowns_of_each_shoe(surfaces)
        gap = _gap_of_unloaded_worn_in_linings(interface, linings)
        for surface in surfaces:
            along = gap[surface.slice_in_interface][surface.forward]
            gaps[surface.shoe, surface.lining] = table_rows_from_coordinates_and_values(
                surface.contact_angles_in_growing_order, along
            )
    return brake_with_given_lining_clearances(brake_without_misfit_and_clearance(brake), gaps)


def _contact_unknowns_of_each_shoe(surfaces: Sequence[WornLining]) -> list[slice]:
    """For each shoe, the slice of its contact unknowns among the unknowns of a contact problem.

    A slice spans all linings of a shoe, which move together. `surfaces` are the linings of the
    contact problem, ordered by shoe.
    """
    slices = []
    for _, own in groupby(surfaces, attrgetter("shoe")):
        first, *others = own
        slices.append(
            slice(first.slice_in_interface.start, (others or [first])[-1].slice_in_interface.stop)
        )
    return slices


def _gap_of_unloaded_worn_in_linings(interface: WearContactProblem, linings: list[slice]) -> Floats:
    """The gap (n,) [m] between the drum and the unloaded, worn-in linings of one contact problem.

    The docstring of the module explains the symbols M, p, A, q, B and y.

    Parameters
    ----------
    interface : contact problem of the linings
    linings : slices of the contact unknowns, one for each shoe that moves independently; a single
        slice if all shoes move together

    Raises
    ------
    NoAnswer
        if there is no steady wear, or if friction at an abutment may act in more than one way
    """
    end = solve_steady_wear(interface, WearLaw(1.0))
    footing, M, p = (
        interface.abutment_friction_cases[end.footing],
        interface.weight,
        end.contact.p,
    )
    # At the pressures p the tangent of the friction stress is the friction stress itself, so that
    # q + A p is the gap also if friction depends on the pressure.
    A, q, B, *_ = interface.contact_problem_at_pressures(footing, p)
    # While the unloaded shoe rests, each foot on a rough abutment sticks. Of all friction cases,
    # the case in which all feet stick has the fewest rigid-body motions.
    resting = min(
        map(attrgetter("problem.B"), interface.abutment_friction_cases),
        key=lambda B: B.shape[1],
    )
    solved = scipy.linalg.solve(M, np.column_stack([q + A @ p, resting]), assume_a="pos")
    # `opened` (n,) [m] is the opening c of the gap by the load. Motions y close the gap by
    # approach @ y.
    opened, approach = solved[:, 0], -solved[:, 1:]
    motions = _motions_that_close_gap_best_and_most_evenly(interface, opened, approach)
    rest, bent = motions.nearest, opened - approach @ motions.nearest
    closing = approach @ motions.evenly
    for part in linings:
        # The motion `evenly` is added, just large enough to keep the lining out of the drum. Nodes
        # where this motion hardly changes the gap (LEAST_RELATIVE_GAP_CHANGE_OF_CONSIDERED_NODE) do
        # not count.
        moves = closing[part] >= LEAST_RELATIVE_GAP_CHANGE_OF_CONSIDERED_NODE * closing[part].max()
        amount = float((bent[part][moves] / closing[part][moves]).max())
        own_motions = np.any(resting[part] != 0, axis=0)
        rest[own_motions] += amount * motions.evenly[own_motions]
    depth_per_pressure = LARGEST_ADDED_STEADY_WEAR_OVER_ELASTIC_GAP * np.abs(bent).max() / p.max()
    # In steady wear the shoes move by `rest_among_all` plus `depth_per_pressure` times the steady
    # motion. The directions of friction at the abutments must fit this motion, too.
    rest_among_all = np.linalg.lstsq(B, resting @ rest, rcond=None)[0]
    y = rest_among_all + depth_per_pressure * end.contact.y
    if not footing.is_consistent_with_solution(replace(end.contact, y=y)):
        raise NoAnswer("worn in, a foot hardly slides: friction may act on it in more than one way")
    return depth_per_pressure * p - opened + approach @ rest


class _GapClosingMotions(NamedTuple):
    """Two motions of the shoes, each as m factors of the rigid-body modes.

    Attributes
    ----------
    nearest : (m,), the motion that comes nearest to closing the gap that the load opens
    evenly : (m,), the motion that comes nearest to closing the gap by 1 m everywhere
    """

    nearest: Floats
    evenly: Floats


def _motions_that_close_gap_best_and_most_evenly(
    interface: WearContactProblem, opened: Floats, approach: Floats
) -> _GapClosingMotions:
    """Two motions of the shoes: one closes the gap `opened` best, one closes the gap most evenly.

    Both are least-squares fits, in which each node is weighted by its area.

    Parameters
    ----------
    interface : contact problem of the linings
    opened : (n,) [m], opening of the gap by the load
    approach : (n, m), closing of the gap by each rigid-body mode
    """
    weight = np.sqrt(np.abs(interface.area))[:, None]
    wanted = np.column_stack([opened, np.ones(len(opened))])
    nearest, evenly = np.linalg.lstsq(approach * weight, wanted * weight, rcond=None)[0].T
    return _GapClosingMotions(nearest, evenly)


def brake_without_misfit_and_clearance(brake: Brake, *, drum: bool = False) -> Brake:
    """The brake with linings that fit the drum exactly: without misfit and without clearance.

    If `drum` is true, an out-of-round drum is also made round.
    """

    def shoe_without_misfit_and_clearance(shoe: Shoe) -> Shoe:
        """The shoe with linings without misfit and clearance."""
        no_misfit = type(shoe.lining.linings[0].misfit)()
        lining = shoe.lining.copy_of_lining_with_changed_fields(
            {"clearance": 0.0, "misfit": no_misfit}
        )
        return shoe.model_copy(update={"lining": lining})

    shoes = tuple(map(shoe_without_misfit_and_clearance, brake.shoes))
    return (brake.brake_with_perfectly_round_drum() if drum else brake).model_copy(
        update={"shoes": shoes}
    )


def post_brake_with_worn_in_clearances(
    brake: Brake, *, sections: int = DEFAULT_DIVISIONS_OF_SHOE_BEAM, lift: Iterable[str] = ()
) -> Brake:
    """The brake with clearances for which the foundation model gives the pressure of the sine law.

    This is the pressure of worn-in linings. The clearances replace all clearances and the misfit of
    the brake.

    Parameters
    ----------
    brake : the brake, a post brake
    sections : number of divisions of each shoe's beam
    lift : names in `foundation.INCLUDABLE_EFFECTS` of the effects that the model includes

    Raises
    ------
    NoAnswer
        for a self-locking shoe
    """
    names, law = validated_names_of_effects_to_include(brake, lift), solve_brake_by_sine_law(brake)
    fitting = brake_without_misfit_and_clearance(brake, drum=True)
    shoes = list(range(len(brake.shoes)))
    gaps: dict[tuple[int, int], InterpolationTable] = {}
    # Shoes influence each other only if the model includes how each shoe's own pressure bends the
    # drum's ring.
    groups = [shoes] if "own-pressure" in names else [[i] for i in shoes]
    for group in groups:
        model = contact_problem_of_shoe_group(fitting, group, sections, names)
        # The pressure of the sine law is converted into normal forces on the sectors of the
        # linings.
        forces, angles = [], []
        for i, post in zip(group, model.posts, strict=True):
            theta = brake_angles_from_beam_angles(post.axis, brake.shoes[i], post.theta)
            angles.append(theta)
            width = brake.shoes[i].lining.width
            forces.append(law.shoes[i].pressure_at(theta) * width * brake.size * post.sector)
        # Actuation and pressure open the gap. The clearance and a turn of the shoe must close it.
        opened = model.problem.q + model.problem.A @ np.concatenate(forces)
        parts = np.split(opened, np.cumsum(list(map(len, angles)))[:-1])
        for k, post in enumerate(model.posts):
            own, theta = parts[k], angles[k]
            # The shoe is turned by the smallest angle for which no clearance is negative. The
            # clearance is then 0 at one sector.
            gap = post.closing[0] * np.max(own / post.closing[0]) - own
            of_linings = zip(
                post.values_of_each_lining_by_growing_angle(theta),
                post.values_of_each_lining_by_growing_angle(gap),
                strict=True,
            )
            for number, (places, own_gap) in enumerate(of_linings):
                gaps[group[k], number] = table_rows_from_coordinates_and_values(places, own_gap)
    return brake_with_given_lining_clearances(fitting, gaps)
