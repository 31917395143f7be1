"""Forces at points of an elastic shoe, and forces on its mass, as load columns of its body.

A force at a point acts on the cross-section of the body there. It is spread uniformly over the
body's thickness, and along the body by the normal distribution with a standard deviation of
FORCE_SPREAD_RELATIVE_TO_BODY_THICKNESS times the thickness. A traction that grows linearly from the
centre of the loaded area adds a couple, so that the resultant acts at the point of the force. If
the point lies beyond an end of the body, the cross-section at this end is loaded.

Lining, backing and body of a shoe have one common density. Weight and centrifugal force act on this
mass everywhere. The centre of mass in the brake file may differ from the centre of the uniformly
distributed mass. An additional load makes up for the difference: it acts on the cross-section at
the file's centre of mass, and gives the load on the mass the right resultant.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.brake.elasticity import ElasticLayer
from drumlin.fem.substructure.body import quadrature_of_elements
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.loads import (
    FURTHER_FORCE_LOAD_NAME,
    MASS_LOAD_NAME,
    ColumnsOfUnitLoads,
)

FORCE_SPREAD_RELATIVE_TO_BODY_THICKNESS = 0.5
"""Standard deviation of the distribution of a force along the body, relative to its thickness.

Two thirds of the force then act on a length of one thickness of the body. At more than about one
thickness from the force it does not matter how the force is spread (Saint-Venant's principle). A
smaller value needs smaller elements and raises the lining's pressure opposite the force; with a
larger value the force is smeared over more of the body. The value is a judgement.
"""
NAMES_OF_BODY_LAYERS = ("table", "shoe")
"""Names of the layers of a shoe's body, on which forces at points of the shoe act."""


NAMES_OF_LOADS_AT_POINTS_AND_MASS = (FURTHER_FORCE_LOAD_NAME, MASS_LOAD_NAME)
"""Names of the unit loads that `unit_loads_at_points_and_mass` returns."""


def points_where_shoe_body_is_loaded(shoe: Shoe) -> Floats:
    """The points (k, 2) [m] at which an elastic shoe is loaded, in the shoe's own frame.

    They are the points of all forces besides the actuation, and last the centre of mass if the
    brake file gives the shoe a mass. A rigid shoe has no such points, because only the resultant of
    its forces matters.
    """
    if shoe.body is None or shoe.are_all_loads_moved_to_actuation:
        return np.zeros((0, 2))
    points = [each.point for each in shoe.forces_at_points_besides_actuation]
    if shoe.mass is not None:
        points.append((shoe.mass.point.x, shoe.mass.point.y))
    return shoe.convert_points_to_shoe_frame(np.reshape(points, (-1, 2)))


class _LoadedBodyQuadrature(NamedTuple):
    """The quadrature points of the elements of a body on which forces act.

    Attributes
    ----------
    xy : (2, e, q) quadrature points [m]
    shapes : (a, q) shape functions
    areas : (e, q) part of the element's area that each point stands for [m^2]
    nodes : (e, a) indices of the nodes of each element
    node_places : (2, N) coordinates of all nodes of the mesh [m]
    """

    xy: Floats
    shapes: Floats
    areas: Floats
    nodes: Ints
    node_places: Floats

    def integrals_with_shape_functions(self, density: Floats) -> Floats:
        """The integrals (N,) over the area of each node's shape function times a density (e, q).

        The density is given at the quadrature points of the elements.
        """
        values = (density * self.areas) @ self.shapes.T
        count = self.node_places.shape[1]
        found = np.bincount(self.nodes.ravel(), values.ravel(), minlength=count)
        return np.asarray(found, dtype=float)

    def resultant(self, forces: Floats) -> Floats:
        """Force x, force y [N] and moment about the origin [N m] of nodal forces (2, N)."""
        x, y = self.node_places
        return np.array([*forces.sum(axis=1), float(x @ forces[1] - y @ forces[0])])


class _UnitLoadsOnCrossSection(NamedTuple):
    """Unit loads on a cross-section of a body, as forces on all nodes.

    `forces` (3, 2, N) are the nodal forces of unit force x, unit force y and unit couple, and
    `centre` (2,) [m] is the point at which the unit forces act.
    """

    forces: Floats
    centre: Floats

    def nodal_forces_of_load_at_point(
        self, force: Floats, point: Floats, couple: float = 0.0
    ) -> Floats:
        """Nodal forces (2, N) of a force (2,) [N] at a point (2,) [m] and a couple [N m]."""
        x, y = point - self.centre
        factors = [*force, x * force[1] - y * force[0] + couple]
        return np.einsum("l,lcn->cn", factors, self.forces)


def unit_loads_at_points_and_mass(basis: Any, shoe: Shoe, radius: float) -> dict[str, Floats]:
    """The nodal forces (2 nodes, l) of unit loads at points of a shoe and on its mass, by name.

    Under the name FURTHER_FORCE_LOAD_NAME are the unit force x and the unit force y at the point of
    each force besides the actuation. Under the name MASS_LOAD_NAME are the forces on a mass of 1 kg
    by unit acceleration x, unit acceleration y and unit square of the angular speed, in the axes of
    the shoe's frame. The result is empty for a shoe without such loads, for a shoe without a body,
    and for a mesh file without elements of a body.

    Parameters
    ----------
    basis : scalar basis of the shoe's mesh, or its grid of hp elements
    shoe : the shoe
    radius : radius of the drum [m]; on a plane the length of phi = 1
    """
    places = points_where_shoe_body_is_loaded(shoe)
    if not len(places):
        return {}
    elements = quadrature_of_elements(basis)
    members = [elements.parts[name] for name in NAMES_OF_BODY_LAYERS if name in elements.parts]
    if not members:
        return {}
    on_body = np.concatenate(members)
    layers = elastic_layers_of_shoe(shoe)
    body = _LoadedBodyQuadrature(
        elements.xy[:, on_body],
        elements.shapes,
        elements.areas[on_body],
        elements.nodes[on_body],
        basis.doflocs,
    )
    at_places = [
        _unit_loads_on_cross_section_at_point(body, shoe, layers, radius, place) for place in places
    ]
    found: dict[str, Floats] = {}
    forces = len(shoe.forces_at_points_besides_actuation)
    if forces:
        columns = []
        for at_place, place in zip(at_places[:forces], places, strict=False):
            columns += [at_place.nodal_forces_of_load_at_point(unit, place) for unit in np.eye(2)]
        found[FURTHER_FORCE_LOAD_NAME] = _stack_nodal_forces_as_columns(columns)
    if shoe.mass is not None:
        volume = np.zeros_like(elements.areas)
        for name, own in elements.parts.items():
            volume[own] = layers[name].width
        whole = _LoadedBodyQuadrature(*elements[:4], basis.doflocs)
        centre = shoe.convert_points_to_shoe_frame(np.zeros(2))
        found[MASS_LOAD_NAME] = _stack_nodal_forces_as_columns(
            _unit_loads_on_mass(whole, volume, at_places[-1], places[-1], centre)
        )
    return found


def _stack_nodal_forces_as_columns(loads: list[Floats]) -> Floats:
    """One array (2 nodes, k) of nodal forces, from a list of k arrays (2, nodes)."""
    return np.array(loads).transpose(2, 1, 0).reshape(-1, len(loads))


def _unit_loads_on_cross_section_at_point(
    body: _LoadedBodyQuadrature,
    shoe: Shoe,
    layers: Mapping[str, ElasticLayer],
    radius: float,
    place: Floats,
) -> _UnitLoadsOnCrossSection:
    """The unit loads on a body's cross-section at a point `place` (2,) [m] in the shoe's frame.

    The loads are spread along the body as described for FORCE_SPREAD_RELATIVE_TO_BODY_THICKNESS.
    """
    along = layers["shoe"].along

    def positions_along_body(xy: Floats) -> Floats:
        """The position (...) of points (2, ...) along the body: an angle, or a length [m]."""
        if along is None:
            return shoe.surface_coordinates_of_points_in_shoe_frame(xy, radius)
        return np.asarray(np.tensordot(along, xy, axes=1))

    area = float(body.areas.sum())
    mean_radius = float((np.hypot(*body.xy) * body.areas).sum()) / area
    unit = mean_radius if along is None else 1.0
    ends = positions_along_body(body.node_places[:, np.unique(body.nodes)])
    first, last = float(ends.min()), float(ends.max())
    thickness = area / (unit * (last - first))
    at = np.clip(float(positions_along_body(place)), first, last)
    distance = (
        (positions_along_body(body.xy) - at)
        * unit
        / (FORCE_SPREAD_RELATIVE_TO_BODY_THICKNESS * thickness)
    )
    density = np.exp(-0.5 * distance**2)
    total = float((density * body.areas).sum())
    even = body.integrals_with_shape_functions(density / total)
    centre = body.node_places @ even
    x, y = (body.integrals_with_shape_functions(density / total * own) for own in body.xy)
    couple = np.array([centre[1] * even - y, x - centre[0] * even])
    couple /= body.resultant(couple)[2]
    zero = np.zeros_like(even)
    return _UnitLoadsOnCrossSection(np.array([[even, zero], [zero, even], couple]), centre)


def _unit_loads_on_mass(
    whole: _LoadedBodyQuadrature,
    volume: Floats,
    at_place: _UnitLoadsOnCrossSection,
    place: Floats,
    centre: Floats,
) -> list[Floats]:
    """The nodal forces (2, N) on 1 kg by unit acceleration x, unit acceleration y and rotation.

    The rotation has the angular speed of 1 rad/s.

    Parameters
    ----------
    whole : all elements of the shoe
    volume : (e, q) width of the shoe's parts at the quadrature points: volume per area [m]
    at_place : the unit loads on the body's cross-section at the centre of mass of the brake file
    place : (2,) the centre of mass of the brake file [m]
    centre : (2,) point about which the shoe rotates [m]
    """
    density = volume / float((volume * whole.areas).sum())
    even = whole.integrals_with_shape_functions(density)
    arms = whole.xy - centre[:, None, None]
    zero = np.zeros_like(even)
    # A load on the uniformly distributed mass has a resultant (fx, fy, moment). The wanted
    # resultant is a force that acts at `place`, the centre of mass of the brake file. The
    # difference acts on the body's cross-section at `place`.
    loads = [np.array([even, zero]), np.array([zero, even])]
    loads.append(np.array([whole.integrals_with_shape_functions(density * arm) for arm in arms]))
    corrected = []
    for load, wanted in zip(loads, [*np.eye(2), place - centre], strict=True):
        fx, fy, moment = whole.resultant(load)
        rest = wanted - [fx, fy]
        turned = place[0] * fy - place[1] * fx
        corrected.append(
            load + at_place.nodal_forces_of_load_at_point(rest, place, turned - moment)
        )
    return corrected


def unit_load_factors_of_forces_at_points_and_mass(shoe: Shoe) -> dict[str, Floats]:
    """The factors by which `unit_loads_at_points_and_mass` make up a shoe's loads, by load name."""
    found = {}
    forces = shoe.forces_at_points_besides_actuation
    if forces:
        in_brake = np.array([each.force for each in forces])
        found[FURTHER_FORCE_LOAD_NAME] = shoe.frame.convert_vectors_to_shoe_frame(in_brake).ravel()
    if shoe.mass is not None:
        loads = shoe.spring_lever_and_mass_loads
        gravity = shoe.frame.convert_vectors_to_shoe_frame(np.array(loads.gravity))
        found[MASS_LOAD_NAME] = shoe.mass.mass * np.append(gravity, loads.squared_angular_velocity)
    return found


def has_unit_loads_of_forces_at_points_or_mass(columns: ColumnsOfUnitLoads) -> bool:
    """Whether a body has load columns for forces at points of the shoe, or on its mass."""
    return any(
        name in columns.column_slice_of_each_load for name in NAMES_OF_LOADS_AT_POINTS_AND_MASS
    )
