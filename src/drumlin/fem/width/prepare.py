"""The prepared model of a brake whose shoes have a finite width (hierarchic model of the width)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Material
from drumlin.brake.orthotropic import isotropic_only
from drumlin.fem.hp.body import factorised_shoe, shoe_contact_line
from drumlin.fem.hp.division import Level, ShoeDivision, divide_shoe
from drumlin.fem.preparation.bodies import DividedBody, ShoeSubstructure, make_shoe_substructure
from drumlin.fem.preparation.cache import Cache, first_shoes_of_equal_shape, shoe_without_loads
from drumlin.fem.preparation.columns import MOST_CONTACT_NODES, PointsByShape
from drumlin.fem.preparation.scene import (
    PreparedModel,
    Seconds,
    add_elapsed_time,
    lines_on_equal_shapes,
)
from drumlin.fem.preparation.scene import reason_why_not_modelled as plane_why_not
from drumlin.fem.substructure.body import InnerSystem, InnerUnknowns
from drumlin.fem.substructure.elimination import CondensedSystem
from drumlin.fem.width.face import WidthFace
from drumlin.fem.width.functions import WidthFunctions, functions_of
from drumlin.fem.width.shoe import condense_width, width_layers

LARGEST_WIDTH_NU = 0.499
"""Largest Poisson's ratio that the model of the width allows.

Nearly incompressible materials need pressures as further unknowns beside the displacements.
"""
LARGEST_WIDTH_DEGREE = 9
"""Largest degree of the polynomials across the width.

The Gauss rules over the width are exact up to degree 11.
"""
INTERIOR = "interior fields: not recovered across the width"
"""Line on what a prepared model with a width leaves out: displacements and stresses in bodies."""
OTHER_HALF = "the other half of each shoe: symmetric"
"""Line on what a prepared model with a width leaves out: the half shoe behind the mid-plane."""

MakeFunctions = Callable[[Shoe], WidthFunctions]
"""A function from a shoe to the functions across the shoe's width."""


@dataclass(frozen=True)
class NodesOverWidth:
    """The number of nodes of a body whose nodes have several functions across the width.

    `N` is half the number of the body's displacements: the number of nodes of a plane section with
    as many unknowns.
    """

    N: int


class NotRecovered:
    """The eliminated unknowns of a body with a width, in the place of `InnerUnknowns`.

    They are not recovered after condensation, so that each method raises NotImplementedError.
    """

    def system(self) -> InnerSystem:
        """Raise NotImplementedError instead of returning the body's equations on all nodes."""
        raise NotImplementedError(INTERIOR)

    def eliminate_loads(self) -> CondensedSystem:
        """Raise NotImplementedError instead of condensing the unit loads to contact and frame."""
        raise NotImplementedError(INTERIOR)

    def with_forces(self, forces: Floats) -> InnerUnknowns:
        """Raise NotImplementedError instead of adding unit loads to the unknowns."""
        raise NotImplementedError(INTERIOR)

    def displacements(self, nodal: Floats, frame: Floats, loads: Floats) -> Floats:
        """Raise NotImplementedError instead of returning the displacements of all nodes."""
        raise NotImplementedError(INTERIOR)


def width_why_not(brake: Brake) -> str | None:
    """The reason why the model of the width does not apply to a brake; None where it applies."""
    on_ring = "its drum is an elastic ring, whose own width is not modelled"
    return reason_against_widths(brake, "the model of the width", on_ring)


def reason_against_widths(brake: Brake, model: str, on_ring: str) -> str | None:
    """The reason why no model of shoes with widths applies to a brake; None where one applies.

    Parameters
    ----------
    brake : the brake
    model : name of the model, for the text of the reason
    on_ring : the reason that is given for a brake with an elastic drum ring
    """
    if brake.unmeshable() is not None:
        return brake.unmeshable()
    if brake.ring is not None:
        return on_ring
    for shoe in brake.shoes:
        reason = _reason_against_widths_of_shoe(shoe)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return isotropic_only(brake, model) or plane_why_not(brake)


def _reason_against_widths_of_shoe(shoe: Shoe) -> str | None:
    """The reason why no model of shoes with widths applies to a shoe; None where one applies."""
    if shoe.mesh is not None:
        return "a mesh of its own is a section without widths"
    if shoe.body is not None and shoe.body.bending_stiffness is not None:
        return "its bending_stiffness is not that of a section of its thickness and width"
    for name, part in (("lining", shoe.lining), ("backing", shoe.backing), ("body", shoe.body)):
        material = getattr(part, "material", None)
        if isinstance(material, Material) and material.nu > LARGEST_WIDTH_NU:
            given = f"{name}.material.nu = {material.nu:g}"
            return f"{given} is all but incompressible; at most {LARGEST_WIDTH_NU:g}"
    return None


def prepare_width(
    brake: Brake,
    level: Level,
    degree: int | MakeFunctions,
    points: PointsByShape | None = None,
    *,
    cache: Cache | None = None,
) -> PreparedModel:
    """The prepared model of a brake with widths: its shoes, condensed and coupled with the drum.

    Shoes of one shape share one condensed body.

    Parameters
    ----------
    brake : the brake
    level : degree and grading of the hp elements of the section
    degree : degree across the width, or a function from a shoe to its functions across the width; 0
        is plane stress
    points : singular points of the pressure, by the position of the first shoe of each shape
    cache : cache of condensed bodies; bodies found in it are used again, and new ones are added

    Raises
    ------
    BadInput
        where the model does not apply, and for a degree out of range
    NoAnswer
        for a singular stiffness, and for more than MOST_CONTACT_NODES nodes of a contact face
    """
    reason = width_why_not(brake)
    if reason is not None:
        raise BadInput(f"the model of the width does not apply to this brake: {reason}")
    if not callable(degree) and not 0 <= degree <= LARGEST_WIDTH_DEGREE:
        raise BadInput(f"--across = {degree}: must be from 0 to {LARGEST_WIDTH_DEGREE}")
    make = degree if callable(degree) else partial(functions_of, degree=degree)
    seconds: Seconds = {}
    cache = cache or Cache()
    alike = first_shoes_of_equal_shape(brake)
    tip = brake.actuation is not None and brake.actuation.is_cam
    made: dict[int, ShoeSubstructure] = {}
    # One body is condensed for each different shape of shoe.
    for i in dict.fromkeys(alike):
        shoe = brake.shoes[i]
        functions = make(shoe)
        division = divide_shoe(
            shoe, brake.size, level, (points or {}).get(i, ()), grades_loaded_end=tip
        )
        nodes = division.contact_nodes * len(functions.face_nodes(shoe.lining.width / 2))
        if nodes > MOST_CONTACT_NODES:
            raise NoAnswer(
                f"its {nodes} contact nodes are more than the {MOST_CONTACT_NODES} that are allowed"
            )
        friction = brake.friction > 0
        key = ("width", shoe_without_loads(shoe), brake.size, friction, division.key, functions)
        body = partial(width_body, shoe, brake.size, division, functions, friction, seconds)
        made[i] = cache.get(key, body, _size_of)
    bodies = tuple(made[i] for i in alike)
    left_out = (INTERIOR, OTHER_HALF, *lines_on_equal_shapes(brake, len(made)))
    return PreparedModel(brake, bodies, None, seconds, left_out, model="solid")


def _size_of(body: ShoeSubstructure) -> int:
    """The memory [bytes] of a condensed body, approximately: six matrices on its contact nodes."""
    return 8 * 6 * len(body.line.nodes) ** 2


def width_body(
    shoe: Shoe,
    radius: float,
    division: ShoeDivision,
    functions: WidthFunctions,
    friction: bool,
    seconds: Seconds,
) -> ShoeSubstructure:
    """The condensed body of a shoe with a width, coupled with the drum or the plane.

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
    with add_elapsed_time(seconds, "condensation"):
        found = condense_width(shoe, radius, division, functions)
        condensed = factorised_shoe(found, NotRecovered())
    with add_elapsed_time(seconds, "coupling"):
        face = face_of(shoe, radius, division, functions)
        basis = NodesOverWidth(unknowns_of(shoe, division, functions) // 2)
        divided = DividedBody(basis, basis, face)
        return make_shoe_substructure(
            ShoeSubstructure, shoe, divided, condensed, found.centre, friction=friction
        )


def face_of(
    shoe: Shoe, radius: float, division: ShoeDivision, functions: WidthFunctions
) -> WidthFace:
    """The friction surface of a divided shoe with functions across the shoe's width."""
    line, half = shoe_contact_line(shoe, radius, division), shoe.lining.width / 2
    count = len(functions.face_nodes(half))
    return WidthFace(
        nodes=np.arange(len(line.nodes) * count),
        xy=np.repeat(line.xy, count, axis=1),
        phi=np.repeat(line.phi, count),
        pieces=line.pieces,
        edge=line.edge,
        line=line,
        functions=functions,
        half=half,
    )


def unknowns_of(shoe: Shoe, division: ShoeDivision, functions: WidthFunctions) -> int:
    """Number of displacements of a divided shoe with functions across the shoe's width.

    A row of nodes between two layers counts with the functions of the layer nearer to the contact.
    The displacements that supports hold are counted as well.
    """
    p, beyond = division.degree, len(division.before) + len(division.after) - 2
    count = 0
    layers = width_layers(shoe, division, functions)
    for k, half in enumerate(layers.halves):
        even, odd = functions.counts(half)
        nodes = division.contact_nodes + (beyond * p if k >= division.first_body_layer else 0)
        count += (2 * even + odd) * nodes * (p + (k == 0))
    return count
