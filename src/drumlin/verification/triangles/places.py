"""Nodal forces on triangles from point forces, gravity and rotation that act on a shoe's body.

A force is spread over the body by the same rule as in `drumlin.fem.preparation.load_places`.
The places along the body, its thickness and all integrals come from the outline and the triangles.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.brake import Shoe
from drumlin.brake.further_loads import ForceAtPoint
from drumlin.verification.triangles import lagrange

if TYPE_CHECKING:
    from drumlin.verification.triangles.face import BodyMeshedByTriangles

FORCE_SPREAD_DEVIATION_OVER_BODY_THICKNESS = 0.5
"""Standard deviation of a spread force along the body, divided by the body's thickness.

A normal distribution along the body spreads each force. The finite elements that are verified use
the same ratio, see `load_places.FORCE_SPREAD_RELATIVE_TO_BODY_THICKNESS`. With another value the
triangles would solve a different load.
"""


class _TriangleQuadraturePoints(NamedTuple):
    """The quadrature points of all triangles of a shoe.

    Attributes
    ----------
    xy : (m, q, 2) points in the brake's frame [m]
    s : (m, q) coordinate of each point along the shoe, as in its outline
    area : (m, q) areas that the points stand for [m^2]
    width : (m,) width of the layer of each triangle [m]
    in_body : (m,) whether each triangle belongs to the shoe's body
    """

    xy: Floats
    s: Floats
    area: Floats
    width: Floats
    in_body: Bools


def nodal_forces_of_loads_besides_actuation(body: "BodyMeshedByTriangles", shoe: Shoe) -> Floats:
    """Nodal forces (2N,) [N] of all loads on an elastic shoe besides its actuation."""
    points = _quadrature_points_of_triangles(body)
    density = np.zeros_like(points.xy)
    for force in shoe.forces_at_points_besides_actuation:
        density += _force_density_of_spread_point_force(body, points, shoe, force, np.zeros(3))
    if shoe.mass is not None:
        density += _force_density_of_gravity_and_rotation(body, points, shoe)
    values, _, _ = lagrange.triangle_shape_functions_gradients_and_weights(body.degree)
    forces = np.zeros_like(body.nodes.xy)
    np.add.at(
        forces,
        body.nodes.nodes_of_triangles,
        np.einsum("nq,mqc,mq->mnc", values, density, points.area),
    )
    return forces.ravel()


def _quadrature_points_of_triangles(body: "BodyMeshedByTriangles") -> _TriangleQuadraturePoints:
    """The quadrature points of all triangles of a meshed shoe."""
    values, slopes, weights = lagrange.triangle_shape_functions_gradients_and_weights(body.degree)
    x = body.nodes.xy[body.nodes.nodes_of_triangles]
    J = np.einsum("mnc,ndq->mqcd", x, slopes)
    widths = np.array([layer.elastic.width for layer in body.shape.layers])
    return _TriangleQuadraturePoints(
        xy=np.einsum("mnc,nq->mqc", x, values),
        s=np.einsum("mn,nq->mq", body.nodes.at[body.nodes.nodes_of_triangles, 0], values),
        area=np.abs(np.linalg.det(J)) * weights,
        width=widths[body.mesh.layer],
        in_body=body.mesh.layer >= body.shape.number_of_first_layer_of_shoe_body,
    )


def _force_density_of_spread_point_force(
    body: "BodyMeshedByTriangles",
    points: _TriangleQuadraturePoints,
    shoe: Shoe,
    force: ForceAtPoint,
    more: Floats,
) -> Floats:
    """The force density (m, q, 2) [N/m^2] of a force at a point of the body.

    The density is a normal distribution along the body times a rigid-body displacement. The three
    factors of this displacement are chosen so that the density has the force and its moment.

    Parameters
    ----------
    body, points : the meshed shoe and its quadrature points
    shoe : the shoe
    force : the force with its point
    more : (3,) further force in x and y [N] and moment about the drum's centre [N m], spread over
        the same length of the body
    """
    at = np.array(force.point)
    along = body.shape.layers[-1].elastic.along
    on, area = points.in_body, points.area[points.in_body]
    if along is None:
        # The coordinate s of an arc is the angle theta.
        place, s = np.arctan2(at[1], at[0]), points.s
        place += 2 * np.pi * np.round((shoe.lining.middle - place) / (2 * np.pi))
        length = float((np.hypot(*points.xy[on].T).T * area).sum() / area.sum())
    else:
        place, s, length = at @ along, points.xy @ along, 1.0
        place, s = float(place), np.asarray(s)
    nodes = body.nodes.nodes_of_triangles[on]
    ends = body.nodes.at[nodes, 0] if along is None else body.nodes.xy[nodes] @ along
    span = float(np.ptp(ends)) * length
    sigma = FORCE_SPREAD_DEVIATION_OVER_BODY_THICKNESS * float(area.sum()) / span
    off = (s - np.clip(place, ends.min(), ends.max())) * length / sigma
    bell = np.exp(-(off**2) / 2) * on[:, None]
    x, y = points.xy[..., 0], points.xy[..., 1]
    motions = np.array([[1 + 0 * x, 0 * x], [0 * x, 1 + 0 * x], [-y, x]])
    work = np.einsum("icmq,jcmq,mq->ij", motions, motions, bell * points.area)
    fx, fy = force.force
    wanted = np.array([fx, fy, at[0] * fy - at[1] * fx]) + more
    factors = np.linalg.solve(work, wanted)
    return np.einsum("i,icmq,mq->mqc", factors, motions, bell)


def _force_density_of_gravity_and_rotation(
    body: "BodyMeshedByTriangles", points: _TriangleQuadraturePoints, shoe: Shoe
) -> Floats:
    """The force density (m, q, 2) [N/m^2] of gravity and rotation on the mass of a shoe."""
    assert shoe.mass is not None
    loads, mass, centre = shoe.spring_lever_and_mass_loads, shoe.mass.mass, shoe.mass.point.xy
    volume = float((points.width[:, None] * points.area).sum())
    thickness = mass / volume * points.width[:, None, None]
    density = thickness * (np.array(loads.gravity) + loads.squared_angular_velocity * points.xy)
    force = np.einsum("mqc,mq->c", density, points.area)
    lever = points.xy[..., 0] * density[..., 1] - points.xy[..., 1] * density[..., 0]
    moment = float((lever * points.area).sum())
    whole = mass * (np.array(loads.gravity) + loads.squared_angular_velocity * centre)
    about = centre[0] * whole[1] - centre[1] * whole[0]
    rest = np.array([*(whole - force), about - moment])
    at_centre = ForceAtPoint((0.0, 0.0), (float(centre[0]), float(centre[1])))
    return density + _force_density_of_spread_point_force(body, points, shoe, at_centre, rest)
