"""Bodies of hp elements: divide each parametric shoe into columns of elements and condense it.

A column is a stack of elements through the thickness of the shoe. Some shoes of the brake may have
the mesh of a file; the condensed bodies of these shoes are given. The ring is always divided into
hp elements.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody
from drumlin.contact.equations import MAX_NODES_OF_CONTACT_PROBLEM
from drumlin.fem.hp.body import (
    condensed_shoe_body,
    contact_line_of_lining_face_nodes,
    element_grid_of_whole_shoe,
    nodal_forces_of_unit_actuations_and_their_centre,
)
from drumlin.fem.hp.corner import pressure_exponents_at_both_lining_corners
from drumlin.fem.hp.division import (
    LONGEST_CONTACT_WITH_CORNER_COLUMNS,
    KindOfSingularPoint,
    RefinementLevel,
    ShoeElementDivision,
    SingularPoint,
    divide_shoe_into_hp_elements,
    shoe_layers_with_their_thickness,
)
from drumlin.fem.hp.ring import condensed_ring_in_hp_elements
from drumlin.fem.hp.shoe import condense_shoe_to_contact_nodes
from drumlin.fem.preparation.bodies import (
    NodePositionsAndActuationForces,
    ShoeBodyElements,
    ShoeSubstructure,
    actuation_force_and_moments_per_newton,
    make_shoe_substructure,
    nodal_forces_of_unit_loads_besides_actuation,
)
from drumlin.fem.preparation.cache import (
    CacheOfCondensedBodies,
    brake_without_loads_and_clearances,
    memory_bytes_of_condensed_body,
    shoe_without_loads_and_clearances,
)
from drumlin.fem.preparation.load_places import (
    NAMES_OF_BODY_LAYERS,
    points_where_shoe_body_is_loaded,
    unit_loads_at_points_and_mass,
)
from drumlin.fem.preparation.meshes import nodes_of_changed_shoe_with_mesh_file
from drumlin.fem.preparation.scene import (
    CondensedBodiesOfBrake,
    SecondsOfEachPhase,
    SingularPointsByShoeShape,
    add_elapsed_time_of_block_to_phase,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe


class _RuleForDividingShoesOfOneShape(NamedTuple):
    """The choices by which the shoes of one shape are divided into columns of hp elements.

    Attributes
    ----------
    shoe : the first shoe of the shape
    level : degree of the elements, and their sizes at singular points
    points : singular points of the pressure on the lining
    has_small_elements_at_loaded_end : whether elements become small towards the loaded end of the
        shoe's body
    pressure_exponents_at_lining_ends : exponents with which the pressure is a power of the distance
        from the lining's start and from its end; 0 if the elements do not depend on them
    division : the division that follows from all other attributes
    """

    shoe: Shoe
    level: RefinementLevel
    points: Sequence[SingularPoint]
    has_small_elements_at_loaded_end: bool
    pressure_exponents_at_lining_ends: tuple[float, float]
    division: ShoeElementDivision


def make_condensed_shoes_of_hp_elements(
    brake: Brake,
    level: RefinementLevel,
    places: SingularPointsByShoeShape | None,
    alike: Sequence[int],
    cache: CacheOfCondensedBodies,
    seconds: SecondsOfEachPhase,
    of_files: Mapping[int, ShoeSubstructure] | None = None,
) -> CondensedBodiesOfBrake:
    """Make the condensed bodies of a brake from hp elements; shoes of one shape share one body.

    Parameters
    ----------
    brake : the brake
    level : degree of the elements, and their sizes at singular points
    places : singular points of the pressure, for each shape of shoe
    alike : for each shoe the index of the first shoe of the same shape, see
        `cache.indices_of_first_shoes_of_equal_shape`
    cache : cache of condensed bodies; bodies found in it are used again, and new ones are added
    seconds : time of each phase [s], to which this function adds its own times
    of_files : condensed bodies of the shoes that have mesh files, by the index of the first shoe of
        each shape; None if no shoe has a mesh file

    Raises
    ------
    NoAnswer
        if more than MAX_NODES_OF_CONTACT_PROBLEM contact nodes are coupled
    """
    # Each shape is divided and condensed once.
    made = dict(of_files or {})
    rules = {
        i: _rule_for_dividing_shoes_of_one_shape(brake, level, places or {}, alike, i)
        for i in dict.fromkeys(alike)
        if i not in made
    }
    contact_node_counts = {i: len(body.line.nodes) for i, body in made.items()}
    contact_node_counts |= {i: rule.division.contact_nodes for i, rule in rules.items()}
    _require_few_contact_nodes(brake, [contact_node_counts[i] for i in alike])
    for i, rule in rules.items():
        made[i] = _cached_or_newly_condensed_body(brake, rule, cache, seconds)
    bodies = tuple(made[i] for i in alike)

    # The smallest elements of the ring are as small as the smallest hp elements of the linings.
    face_layer_size_at_unbounded_pressure = min(
        (rule.division.face_layer_size_at_unbounded_pressure for rule in rules.values()),
        default=math.inf,
    )
    ring = None
    ring_under = partial(
        condensed_ring_in_hp_elements,
        brake,
        level,
        face_layer_size_at_unbounded_pressure=face_layer_size_at_unbounded_pressure,
    )
    if brake.ring is not None:
        lines = tuple(body.line for body in bodies)
        # Under linings with equal nodes the ring is divided in the same way.
        keys = [
            (line.interpolation_degree_along_contact_line, line.phi.tobytes()) for line in lines
        ]
        loadless = brake_without_loads_and_clearances(brake)
        key = (loadless, level, face_layer_size_at_unbounded_pressure, *keys)
        with add_elapsed_time_of_block_to_phase(seconds, "ring"):
            ring = cache.get(key, partial(ring_under, lines), memory_bytes_of_condensed_body)

    # Some analyses compare a shoe with a slightly changed shoe. Both are divided by the same rule.
    nodes_by_shape: dict[int, Callable[[Shoe], NodePositionsAndActuationForces]] = {
        i: partial(nodes_of_changed_shoe_with_mesh_file, brake.size, body)
        for i, body in (of_files or {}).items()
    }
    for i, rule in rules.items():
        nodes_by_shape[i] = partial(_hp_nodes_of_changed_shoe_by_division_rule, rule, brake.size)
    nodes_of = partial(_nodes_of_changed_shoe_divided_as_before, nodes_by_shape, alike)
    divisions = {i: rule.division for i, rule in rules.items()}
    return CondensedBodiesOfBrake(bodies, ring, nodes_of, ring_under, divisions)


def _require_few_contact_nodes(brake: Brake, of_shoes: Sequence[int]) -> None:
    """Raise NoAnswer if a contact problem has more than MAX_NODES_OF_CONTACT_PROBLEM contact nodes.

    `of_shoes` has the number of contact nodes of each shoe.
    """
    # An elastic ring couples the contact nodes of all shoes. On a rigid drum each shoe is a contact
    # problem of its own.
    together = sum if brake.ring is not None else max
    nodes = together(of_shoes)
    if nodes > MAX_NODES_OF_CONTACT_PROBLEM:
        raise NoAnswer(
            f"its {nodes} contact nodes are more than the {MAX_NODES_OF_CONTACT_PROBLEM} that "
            f"are allowed"
        )


def _rule_for_dividing_shoes_of_one_shape(
    brake: Brake,
    level: RefinementLevel,
    places: SingularPointsByShoeShape,
    alike: Sequence[int],
    i: int,
) -> _RuleForDividingShoesOfOneShape:
    """The rule that divides the shoes of one shape, whose first shoe has the index `i`."""
    shoe = brake.shoes[i]
    points = places.get(i, ())
    # A cam touches the loaded ends of the shoes, so that the cam's forces depend on the
    # displacements of these ends. Small elements at the ends make these displacements accurate.
    has_small_elements_at_loaded_end = (
        brake.actuation is not None and brake.actuation.is_cam_or_wedge
    )
    pressure_exponents_at_lining_ends = _smallest_pressure_exponents_at_lining_ends(
        brake, alike, i, points
    )
    level = _refinement_level_for_loads_on_body(shoe, brake.size, level)
    division = divide_shoe_into_hp_elements(
        shoe,
        brake.size,
        level,
        points,
        grades_loaded_end=has_small_elements_at_loaded_end,
        exponents=pressure_exponents_at_lining_ends,
    )
    return _RuleForDividingShoesOfOneShape(
        shoe,
        level,
        points,
        has_small_elements_at_loaded_end,
        pressure_exponents_at_lining_ends,
        division,
    )


def _refinement_level_for_loads_on_body(
    shoe: Shoe, radius: float, level: RefinementLevel
) -> RefinementLevel:
    """The level; if forces act on points of the body, with columns no wider than the body is thick.

    A force at a point of the body is spread over a length of about the body's thickness. Wider
    columns would not resolve this distribution.
    """
    if not len(points_where_shoe_body_is_loaded(shoe)):
        return level
    body = sum(
        layer.thickness
        for layer in shoe_layers_with_their_thickness(shoe, radius)
        if layer.part in NAMES_OF_BODY_LAYERS
    )
    return replace(level, largest_column=min(level.largest_column, body / radius))


def _cached_or_newly_condensed_body(
    brake: Brake,
    rule: _RuleForDividingShoesOfOneShape,
    cache: CacheOfCondensedBodies,
    seconds: SecondsOfEachPhase,
) -> ShoeSubstructure:
    """The condensed body of the shoes of one shape, from the cache or newly made."""
    shoe, division = rule.shoe, rule.division
    friction = brake.friction > 0
    key = (
        shoe_without_loads_and_clearances(shoe),
        brake.size,
        friction,
        division.dictionary_key_of_division,
    )
    make = partial(_condense_and_couple_hp_shoe, shoe, brake.size, division, friction, seconds)
    return cache.get(key, make, memory_bytes_of_condensed_body)


def _condense_and_couple_hp_shoe(
    shoe: Shoe,
    radius: float,
    division: ShoeElementDivision,
    friction: bool,
    seconds: SecondsOfEachPhase,
) -> ShoeSubstructure:
    """Make the condensed body of a parametric shoe, coupled with the drum or the plane."""
    with add_elapsed_time_of_block_to_phase(seconds, "condensation"):
        found = condense_shoe_to_contact_nodes(shoe, radius, division, elastic_layers_of_shoe(shoe))
        line = contact_line_of_lining_face_nodes(shoe, radius, division)
        grid = element_grid_of_whole_shoe(shoe, radius, division)
        inner = condensed_shoe_body(shoe, division, found, grid)
        if loads := nodal_forces_of_unit_loads_besides_actuation(grid, shoe, radius):
            inner = inner.body_with_further_loads(loads)
    with add_elapsed_time_of_block_to_phase(seconds, "coupling"):
        divided = ShoeBodyElements(grid, grid, line)
        return make_shoe_substructure(
            ShoeSubstructure, shoe, divided, inner, found.centre, friction=friction
        )


def _smallest_pressure_exponents_at_lining_ends(
    brake: Brake, alike: Sequence[int], first: int, points: Sequence[SingularPoint]
) -> tuple[float, float]:
    """The smallest exponents of the pressure at the start and the end of the linings of one shape.

    Near a corner of the lining the pressure p is a power of the distance to the corner. The shoes
    of one shape may have different exponents, of which the smallest is taken. If all contacts are
    longer than LONGEST_CONTACT_WITH_CORNER_COLUMNS or the drum has an elastic ring, the elements do
    not depend on the exponents, and both are returned as 0. `first` is the index of the first shoe
    of the shape, and `points` are the singular points of its pressure.
    """
    # An exponent would make the columns of the lining and of the ring at the corner very narrow.
    # Since the ring bends as a whole, round-off in columns of width w changes the forces of a ring
    # of radius R by a fraction of about 1e-16 (R/w)^2: by 1e-4 at the width of columns at a corner.
    if brake.ring is not None and brake.ring.section is not None:
        return 0.0, 0.0
    ends = [point.length for point in points if point.kind == KindOfSingularPoint.END]
    if not any(length <= LONGEST_CONTACT_WITH_CORNER_COLUMNS for length in ends):
        return 0.0, 0.0
    pressure_exponents_at_lining_ends = [
        pressure_exponents_at_both_lining_corners(brake, j)
        for j, shape in enumerate(alike)
        if shape == first
    ]
    at_start = min(start for start, _ in pressure_exponents_at_lining_ends)
    at_end = min(end for _, end in pressure_exponents_at_lining_ends)
    return at_start, at_end


def _hp_nodes_of_changed_shoe_by_division_rule(
    rule: _RuleForDividingShoesOfOneShape, radius: float, other: Shoe
) -> NodePositionsAndActuationForces:
    """The nodes of a changed shoe's body, divided by the rule by which the present shoe is divided.

    The singular points keep their distance from the lining's start. The columns of a straight beam
    under the lining stay where they are on the drum, although the frame of the shoe turns with its
    hinge.
    """
    shoe = rule.shoe
    turn = other.arc[0] - shoe.arc[0]
    points = [point._replace(position=point.position + turn) for point in rule.points]
    division = divide_shoe_into_hp_elements(
        other,
        radius,
        rule.level,
        points,
        grades_loaded_end=rule.has_small_elements_at_loaded_end,
        exponents=rule.pressure_exponents_at_lining_ends,
    )
    if isinstance(shoe.body, BeamBody):
        division = replace(division, angles=rule.division.angles + turn)
    grid = element_grid_of_whole_shoe(other, radius, division)
    further = unit_loads_at_points_and_mass(grid, other, radius)
    if "actuation" not in grid.sets:
        unloaded = np.zeros(grid.doflocs.shape)
        return NodePositionsAndActuationForces(grid.doflocs, unloaded, further)
    unit_loads, centre = nodal_forces_of_unit_actuations_and_their_centre(division, grid)
    factors, _ = actuation_force_and_moments_per_newton(centre, other)
    load = unit_loads @ factors
    return NodePositionsAndActuationForces(grid.doflocs, load.reshape(-1, 2).T, further)


def _nodes_of_changed_shoe_divided_as_before(
    nodes_by_shape: Mapping[int, Callable[[Shoe], NodePositionsAndActuationForces]],
    alike: Sequence[int],
    i: int,
    shoe: Shoe,
) -> NodePositionsAndActuationForces:
    """The nodes that the body of shoe `i` would have if the shoe were changed to `shoe`.

    The changed shoe is divided by the rule by which shoe `i` is divided. `nodes_by_shape` has a
    function from a changed shoe to its nodes, by the index of the first shoe of each shape.
    """
    return nodes_by_shape[alike[i]](shoe)
