"""The prepared model of a brake whose shoes have a finite width (hierarchic model of the width)."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Material
from drumlin.brake.friction import reason_if_friction_depends_on_pressure
from drumlin.brake.heat import reason_if_any_shoe_is_heated
from drumlin.brake.orthotropic import reason_if_any_part_is_orthotropic
from drumlin.fem.hp.body import (
    condensed_body_with_cholesky_factor,
    contact_line_of_lining_face_nodes,
)
from drumlin.fem.hp.columns import matrix_entries_while_columns_are_joined
from drumlin.fem.hp.division import (
    RefinementLevel,
    ShoeElementDivision,
    divide_shoe_into_hp_elements,
)
from drumlin.fem.preparation.bodies import (
    ShoeBodyElements,
    ShoeSubstructure,
    make_shoe_substructure,
)
from drumlin.fem.preparation.cache import (
    CacheOfCondensedBodies,
    indices_of_first_shoes_of_equal_shape,
    shoe_without_loads_and_clearances,
)
from drumlin.fem.preparation.scene import (
    PreparedModel,
    SecondsOfEachPhase,
    SingularPointsByShoeShape,
    add_elapsed_time_of_block_to_phase,
    messages_on_rigid_parts,
    messages_on_shoes_of_equal_shape,
)
from drumlin.fem.preparation.scene import reason_against_finite_element_model as plane_why_not
from drumlin.fem.substructure.body import CondensedBody
from drumlin.fem.width.columns import ConditionAtEdgeFarthestFromContact
from drumlin.fem.width.face import ContactFaceWithWidth
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    functions_across_width_of_shoe,
    half_widths_of_parts,
)
from drumlin.fem.width.open_columns import divisions_with_open_columns
from drumlin.fem.width.recovery import EliminatedUnknownsOfShoeWithWidth
from drumlin.fem.width.shoe import condense_shoe_with_width, layers_with_width_functions
from drumlin.response.response import Response

LARGEST_POISSON_RATIO_OF_WIDTH_MODEL = 0.499
"""Largest Poisson's ratio for which the model of the width can be used.

For nearly incompressible materials, pressures would have to be unknowns as well as displacements.
"""
LARGEST_WIDTH_DEGREE = 9
"""Largest degree of the polynomials across the width.

The Gauss rule over the width is exact for products of two polynomials up to degree 11.
"""
MOST_BYTES_OF_KEPT_CHOLESKY_FACTOR = 10_000_000
"""Largest memory [bytes] of a shoe's Cholesky factor that is kept after the shoe is coupled.

A larger factor is computed again when it is needed.
"""
MOST_NODES_OF_CONTACT_FACE = 3500
"""Largest number of nodes of a contact face; a shoe with more is refused unless more are allowed.

The limit is one of memory. By the two constants below a shoe with so many nodes takes 0.79 GB, and
0.89 GB with friction.
"""
MATRICES_OF_CONTACT_NODES_WITHOUT_FRICTION = 8.1
"""Memory of a shoe with n contact nodes, divided by the memory of a matrix (n, n).

While the shoe is condensed, its contact stiffness and the Cholesky factor make up four such
matrices each. On "built" 510128 of `drumlin_studies.solid_error` with 1111 to 2060 nodes the peak
of the memory was 8.1 matrices.
"""
MATRICES_OF_CONTACT_NODES_WITH_FRICTION = 9.1
"""The same with friction, while the contact is solved or the shoe is condensed.

The contact problem then has two compliances, for two friction coefficients, beside the matrices of
the shoe, the scaled equations and their factors. On "built" 510123 with 1067 to 1940 nodes, of
which two thirds are in contact, the peak was 8.9 to 9.1 matrices.
"""
NO_INTERIOR_RESULTS_MESSAGE = "interior fields: recovered only for a file or a picture"
"""Message which says that a prepared model of solid shoes has no stresses inside the bodies."""
ONLY_HALF_OF_SOLID_SHOES_MESSAGE = "the other half of each shoe: symmetric"
"""Message which says that a prepared model has only half of each shoe, beside the mid-plane."""

MakeWidthFunctionsOfShoe = Callable[[Shoe], FunctionsAcrossWidth]
"""The type of a function that returns the functions of z across the width of a given shoe."""


class NumberOfUnknownsOfBodyWithWidth(NamedTuple):
    """The number of displacements of a body with functions across its width, `unknowns`.

    The number takes the place of the basis that a body in plane stress has on its mesh: callers ask
    a body with widths for this number only.
    """

    unknowns: int


class ShoeSubstructureWithWidth(ShoeSubstructure):
    """The condensed body of a shoe with displacements that are polynomials across its width."""

    @property
    def unknowns(self) -> int:
        """Number of displacements of the body, for all its nodes and all functions of z."""
        return int(self.basis.unknowns)


def reason_why_width_model_does_not_apply(brake: Brake) -> str | None:
    """The reason why the model of the width does not apply to a brake; None where it applies."""
    if brake.reason_why_shoes_cannot_be_meshed() is not None:
        return brake.reason_why_shoes_cannot_be_meshed()
    if brake.ring is not None:
        return "its drum is an elastic ring, whose own width is not modelled"
    for shoe in brake.shoes:
        reason = _reason_against_modelling_width_of_shoe(shoe)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    model = "the model of the width"
    return (
        brake.reason_if_several_linings_are_not_allowed(model)
        or reason_if_any_part_is_orthotropic(brake, model)
        or reason_if_any_shoe_is_heated(brake, model)
        or plane_why_not(brake)
    )


def reason_why_effect_of_widths_is_not_estimated(brake: Brake) -> str | None:
    """The reason why the effect of the widths on an answer of plane stress is not estimated.

    It is None where the effect is estimated. How sure the estimate is was not judged on brakes
    whose friction depends on the pressure, although their solid shoes can be solved.
    """
    return reason_why_width_model_does_not_apply(brake) or reason_if_friction_depends_on_pressure(
        brake, "the correction for the widths"
    )


def _reason_against_modelling_width_of_shoe(shoe: Shoe) -> str | None:
    """The reason why the model of the width does not apply to a shoe; None where it applies."""
    if shoe.mesh is not None:
        return (
            "it has a mesh of its own, which is drawn in the plane: the estimate needs the widths "
            "of parts such as web and table, which [shoe.body] without mesh gives"
        )
    if shoe.body is not None and shoe.body.bending_stiffness is not None:
        return "its bending_stiffness is not that of a section of its thickness and width"
    for name, part in (("lining", shoe.lining), ("backing", shoe.backing), ("body", shoe.body)):
        material = getattr(part, "material", None)
        if isinstance(material, Material) and material.nu > LARGEST_POISSON_RATIO_OF_WIDTH_MODEL:
            given = f"{name}.material.nu = {material.nu:g}"
            largest = f"{LARGEST_POISSON_RATIO_OF_WIDTH_MODEL:g}"
            return f"{given} is all but incompressible; at most {largest}"
    return None


def prepare_model_with_shoe_widths(
    brake: Brake,
    level: RefinementLevel,
    degree: int | MakeWidthFunctionsOfShoe,
    points: SingularPointsByShoeShape | None = None,
    *,
    answers: Sequence[Response] = (),
    cache: CacheOfCondensedBodies | None = None,
    most_contact_nodes: int = MOST_NODES_OF_CONTACT_FACE,
) -> PreparedModel:
    """Make the prepared model of a brake with widths: condense and couple its shoes.

    Shoes of one shape share one condensed body.

    Parameters
    ----------
    brake : the brake
    level : degree of the section's hp elements, and their sizes at singular points
    degree : degree across the width, or a function from a shoe to its functions across the width; 0
        is plane stress
    points : singular points of the pressure, by the index of the first shoe of each shape
    answers : earlier answers; columns that are open in all of them keep few contact nodes
        (`open_columns`)
    cache : cache of condensed bodies; bodies found in it are used again, and new ones are added
    most_contact_nodes : largest number of nodes of a contact face

    Raises
    ------
    BadInput
        if the model does not apply to the brake, or if the degree is out of range
    NoAnswer
        for a singular stiffness, and for more than `most_contact_nodes` nodes of a contact face
    """
    alike = indices_of_first_shoes_of_equal_shape(brake)
    tip = brake.actuation is not None and brake.actuation.is_cam_or_wedge

    def hp_element_division_of_shoe(i: int) -> ShoeElementDivision:
        """The division of the section of the shoe with index `i` into hp elements."""
        places = (points or {}).get(i, ())
        return divide_shoe_into_hp_elements(
            brake.shoes[i], brake.size, level, places, grades_loaded_end=tip
        )

    reason = reason_why_width_model_does_not_apply(brake)
    if reason is not None:
        raise BadInput(f"the model of the width does not apply to this brake: {reason}")
    if not callable(degree) and not 0 <= degree <= LARGEST_WIDTH_DEGREE:
        raise BadInput(f"--across = {degree}: must be from 0 to {LARGEST_WIDTH_DEGREE}")
    level = refinement_level_for_narrow_shoes(brake, level)
    divisions = {i: hp_element_division_of_shoe(i) for i in dict.fromkeys(alike)}
    return prepare_model_with_widths_on_given_elements(
        brake,
        divisions_with_open_columns(brake, divisions, answers),
        degree,
        cache=cache,
        most_contact_nodes=most_contact_nodes,
    )


def refinement_level_for_narrow_shoes(brake: Brake, level: RefinementLevel) -> RefinementLevel:
    """The level, with layers of elements at bonds no thicker than half the width of any shoe.

    Far from a bond two materials have different lateral contractions. The contractions become equal
    within about half the width from the bond. With thicker layers of elements, the answer of a very
    narrow shoe would not approach the answer of plane stress: on the first level, a difference of
    0.02 % of the double-shoe brake's torque would remain. With layers of at most half the width the
    difference falls in proportion to the width.
    """
    size = level.interface_layer_size
    for shoe in brake.shoes:
        half = max(half_widths_of_parts(shoe).values())
        size = min(size, half / shoe.lining.thickness)
    return replace(level, interface_layer_size=size)


def prepare_model_with_widths_on_given_elements(
    brake: Brake,
    divisions: Mapping[int, ShoeElementDivision],
    degree: int | MakeWidthFunctionsOfShoe,
    *,
    cache: CacheOfCondensedBodies | None = None,
    most_contact_nodes: int = MOST_NODES_OF_CONTACT_FACE,
) -> PreparedModel:
    """Make the prepared model of a brake with widths, on given hp elements of the shoes' sections.

    Parameters
    ----------
    brake : the brake, to which the model of the width must apply:
        `reason_why_width_model_does_not_apply` returns None for it
    divisions : divisions of the sections into hp elements, by the index of the first shoe of each
        shape
    degree : degree across the width, or a function from a shoe to its functions across the width
    cache : cache of condensed bodies, to which new ones are added
    most_contact_nodes : largest number of nodes of a contact face

    Raises
    ------
    NoAnswer
        for a singular stiffness, and for more than `most_contact_nodes` nodes of a contact face
    """
    make = degree if callable(degree) else partial(functions_across_width_of_shoe, degree=degree)
    seconds: SecondsOfEachPhase = {}
    cache = cache or CacheOfCondensedBodies()
    alike = indices_of_first_shoes_of_equal_shape(brake)
    made: dict[int, ShoeSubstructure] = {}
    # One body is condensed for each different shape of shoe.
    for i in dict.fromkeys(alike):
        shoe, division = brake.shoes[i], divisions[i]
        functions = make(shoe)
        _require_few_nodes_of_contact_face(shoe, division, functions, most_contact_nodes)
        friction = brake.friction > 0
        shape = shoe_without_loads_and_clearances(shoe), brake.size, friction
        key = ("width", *shape, division.dictionary_key_of_division, functions)
        body = partial(
            condense_and_couple_shoe_with_width,
            shoe,
            brake.size,
            division,
            functions,
            friction,
            seconds,
        )
        made[i] = cache.get(key, body, memory_bytes_of_condensed_solid_shoe)
    bodies = tuple(made[i] for i in alike)
    left_out = (
        NO_INTERIOR_RESULTS_MESSAGE,
        ONLY_HALF_OF_SOLID_SHOES_MESSAGE,
        *messages_on_shoes_of_equal_shape(brake, len(made)),
        *messages_on_rigid_parts(brake),
    )
    return PreparedModel(brake, bodies, None, seconds, left_out, model="solid", divisions=divisions)


def _require_few_nodes_of_contact_face(
    shoe: Shoe, division: ShoeElementDivision, functions: FunctionsAcrossWidth, most: int
) -> None:
    """Raise NoAnswer if the contact face of a shoe has more than `most` nodes."""
    nodes = _number_of_contact_face_nodes(shoe, division, functions)
    if nodes > most:
        raise NoAnswer(f"its {nodes} contact nodes are more than the {most} that are allowed")


def memory_bytes_of_condensed_solid_shoe(body: ShoeSubstructure) -> int:
    """The approximate memory [bytes] of a body: three matrices (n, n) for n contact nodes.

    A small body has its Cholesky factor as well, which is as large as four matrices (n, n).
    """
    n = len(body.line.nodes)
    forgets = isinstance(body.condensed, CondensedBodyThatForgetsCholeskyFactor)
    return 8 * (3 if forgets else 3 + 4) * n**2


class CondensedBodyThatForgetsCholeskyFactor(CondensedBody):
    """A condensed shoe with a width that computes its Cholesky factor anew at each access.

    The factor takes more memory than all other matrices of the shoe. Few computations need it once
    the shoe is coupled with the drum: the forces that hold a brake at rest.
    """

    inner: EliminatedUnknownsOfShoeWithWidth

    def __init__(self, body: CondensedBody) -> None:
        for own in fields(body):
            if own.name != "L_cc":
                object.__setattr__(self, own.name, getattr(body, own.name))

    @property
    def L_cc(self) -> Floats:
        """The Cholesky factor (2n, 2n); each access condenses the shoe once more."""
        return _condensed_body_of_shoe_with_width(self.inner).body.L_cc


class _CondensedBodyWithCentreOfLoads(NamedTuple):
    """A condensed body, and the point (2,) [m] at which the unit loads of its actuation act."""

    body: CondensedBody
    centre: Floats


def _condensed_body_of_shoe_with_width(
    inner: EliminatedUnknownsOfShoeWithWidth,
) -> _CondensedBodyWithCentreOfLoads:
    """Condense a shoe with a width; `inner` has the shoe and its division into elements."""
    found = condense_shoe_with_width(inner.shoe, inner.radius, inner.division, inner.functions)
    return _CondensedBodyWithCentreOfLoads(
        condensed_body_with_cholesky_factor(found, inner), found.centre
    )


def condense_and_couple_shoe_with_width(
    shoe: Shoe,
    radius: float,
    division: ShoeElementDivision,
    functions: FunctionsAcrossWidth,
    friction: bool,
    seconds: SecondsOfEachPhase,
) -> ShoeSubstructure:
    """Condense a shoe with a width, and couple the condensed body with the drum or the plane.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    division : division of the shoe's section into hp elements
    functions : functions across the shoe's width
    friction : whether the brake has friction
    seconds : time of each phase [s], to which this function adds its own times

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    with add_elapsed_time_of_block_to_phase(seconds, "condensation"):
        inner = EliminatedUnknownsOfShoeWithWidth(shoe, radius, division, functions)
        condensed, centre = _condensed_body_of_shoe_with_width(inner)
    with add_elapsed_time_of_block_to_phase(seconds, "coupling"):
        face = contact_face_of_shoe_with_width(shoe, radius, division, functions)
        basis = NumberOfUnknownsOfBodyWithWidth(
            number_of_displacement_unknowns_of_shoe(shoe, division, functions)
        )
        divided = ShoeBodyElements(basis, basis, face)
        body = make_shoe_substructure(
            ShoeSubstructureWithWidth, shoe, divided, condensed, centre, friction=friction
        )
        if condensed.L_cc.nbytes <= MOST_BYTES_OF_KEPT_CHOLESKY_FACTOR:
            return body
        return replace(body, condensed=CondensedBodyThatForgetsCholeskyFactor(condensed))


def contact_face_of_shoe_with_width(
    shoe: Shoe, radius: float, division: ShoeElementDivision, functions: FunctionsAcrossWidth
) -> ContactFaceWithWidth:
    """The friction surface of a divided shoe with functions across the shoe's width."""
    line, half = contact_line_of_lining_face_nodes(shoe, radius, division), shoe.lining.width / 2
    count = len(functions.node_distances_across_half_width_of_part(half))
    kept = division.indices_of_kept_contact_nodes
    return ContactFaceWithWidth(
        nodes=np.arange(len(kept) * count),
        xy=np.repeat(line.xy[:, kept], count, axis=1),
        phi=np.repeat(line.phi[kept], count),
        pieces=line.pieces,
        edge=line.edge,
        line=line,
        functions=functions,
        half=half,
        kept=kept,
    )


def memory_bytes_of_condensation_on_divisions(
    brake: Brake, divisions: Mapping[int, ShoeElementDivision], make: MakeWidthFunctionsOfShoe
) -> float:
    """The approximate memory [bytes] that the matrices of all shoes take while they are condensed.

    The memory is inf if a contact face has more than MOST_NODES_OF_CONTACT_FACE nodes, since there
    is no model of it.

    Parameters
    ----------
    brake : the brake
    divisions : divisions of the sections into hp elements, by the index of the first shoe of each
        shape
    make : function from a shoe to its functions across the width
    """
    largest = kept = 0.0
    for i, division in divisions.items():
        functions = make(brake.shoes[i])
        nodes = _number_of_contact_face_nodes(brake.shoes[i], division, functions)
        if nodes > MOST_NODES_OF_CONTACT_FACE:
            return math.inf
        own = _memory_bytes_of_condensation(
            brake.shoes[i], division, functions, nodes, friction=brake.friction > 0
        )
        # Of a shoe that is condensed already three matrices are left.
        largest = max(largest, kept + own)
        kept += 3 * nodes**2 * np.dtype(float).itemsize
    return largest


def _number_of_contact_face_nodes(
    shoe: Shoe, division: ShoeElementDivision, functions: FunctionsAcrossWidth
) -> int:
    """The number of nodes on the contact face of a shoe with functions across its width."""
    across = functions.node_distances_across_half_width_of_part(shoe.lining.width / 2)
    return len(division.indices_of_kept_contact_nodes) * len(across)


def _memory_bytes_of_condensation(
    shoe: Shoe,
    division: ShoeElementDivision,
    functions: FunctionsAcrossWidth,
    nodes: int,
    *,
    friction: bool,
) -> float:
    """The approximate memory [bytes] of a shoe's matrices while it is condensed to `nodes` nodes.

    The larger one of two numbers counts: the memory of the matrices of the contact nodes, and the
    memory of the matrices of the columns under the lining while these are joined.
    """
    layers = layers_with_width_functions(shoe, division, functions)
    stack = layers.layers_of_element_column_from_given_layer(
        division.degree, 0, contact=True, back=ConditionAtEdgeFarthestFromContact.FREE
    )
    shared = stack.number_of_unknowns_of_contact // (division.degree + 1)
    contact = [stack.number_of_unknowns_of_contact] * max(2, len(division.angles) - 1)
    for column in division.open_columns:
        contact[column] = 2 * shared
    entries_of_joins = matrix_entries_while_columns_are_joined(
        stack.number_of_unknowns_on_each_side, contact, shared
    )
    matrices = (
        MATRICES_OF_CONTACT_NODES_WITH_FRICTION
        if friction
        else MATRICES_OF_CONTACT_NODES_WITHOUT_FRICTION
    )
    entries = max(matrices * nodes**2, entries_of_joins)
    return entries * np.dtype(float).itemsize


def number_of_displacement_unknowns_of_shoe(
    shoe: Shoe, division: ShoeElementDivision, functions: FunctionsAcrossWidth
) -> int:
    """Number of displacements of a shoe with functions across its width, of all nodes.

    A row of nodes between two layers has the functions of the layer with more functions.
    Displacements that are zero at supports are counted as well.
    """
    p, layers = division.degree, layers_with_width_functions(shoe, division, functions)
    beyond = (
        len(division.column_ends_before_lining) + len(division.column_ends_behind_lining) - 2
    ) * p
    # The columns beyond the ends of the lining have the layers of the body only.
    rows_of_nodes = [(0, division.contact_nodes), (division.index_of_first_body_layer, beyond)]
    count = 0
    for first, nodes in rows_of_nodes:
        if first == division.number_of_element_layers:
            continue
        stack = layers.layers_of_element_column_from_given_layer(
            p, first, contact=False, back=ConditionAtEdgeFarthestFromContact.FREE
        )
        for row in range((division.number_of_element_layers - first) * p + 1):
            even, odd = stack.counts_of_even_and_odd_functions_at_node_row(row)
            count += (2 * even + odd) * nodes
    return count
