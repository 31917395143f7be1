"""Condensed bodies on meshes: each shoe has a parametric mesh or the mesh of a file."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple, cast

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import IsotropicOrOrthotropicMaterial
from drumlin.fem.hp.division import (
    SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS,
    RefinementLevel,
    SingularPoint,
    grading_point_at_singular_point,
)
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.degree import (
    nodal_basis_of_mesh,
    nodal_basis_of_shoe_mesh,
    number_of_nodes_at_degree,
)
from drumlin.fem.mesh.from_file import ShoeMeshReadFromFile
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
    cache_key_of_shoe_shape,
    digest_of_mesh_file_of_shoe,
    memory_bytes_of_condensed_body,
    shoe_without_loads_and_clearances,
)
from drumlin.fem.preparation.load_places import unit_loads_at_points_and_mass
from drumlin.fem.preparation.scene import (
    CondensedBodiesOfBrake,
    SecondsOfEachPhase,
    add_elapsed_time_of_block_to_phase,
)
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    MultiPointConstraints,
    meshed_body_with_eliminated_contact,
    multi_point_constraints_of_body,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.interface import (
    ContactLine,
    make_contact_line_of_lining,
    nodal_forces_of_unit_end_loads_and_end_centre,
)
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME, ColumnsOfUnitLoads
from drumlin.fem.substructure.ring import condense_meshed_drum_ring_to_contact_nodes
from drumlin.response.response import angle_of_edge_zone_left_out_of_peak_search

DEFAULT_ELEMENTS_ALONG_LINING = 80
"""Default number of elements of a mesh along a lining.

With this number the relative error of the pressure p (L2 norm) is about 0.2 % on most brakes, and
the error of the torque 0.001 %. On 22 random brakes, half the number made the median error of p
twice as large, and the median error of the torque three times as large. Twice the number multiplied
these errors by 0.7 and by 0.5 and took four times the work.
"""
MOST_ELEMENTS_ALONG_LINING = 4000
"""Largest number of elements of a mesh along a lining; larger numbers are refused.

The dense matrices of a contact with this number of elements fill 2 GB.
"""

Mesher = Callable[[Shoe, float], Any]
"""The type of a function that makes the mesh of a shoe, in the frame of the shoe.

The arguments of the function are the shoe and the drum's radius [m].
"""


MOST_NODES_AT_RAISED_DEGREE = 250_000
"""Largest number of nodes of a shoe whose mesh gets elements of a higher degree than in the file.

A degree that needs more nodes is refused, because the factors of the stiffness matrix take
gigabytes of memory. A shoe of a drum of 300 mm, in triangles of 0.44 mm, has 242 996 nodes at
degree 2: a solve takes 10 s of processor time and 2.0 GB. In triangles of 0.66 mm it has 242 272
nodes at degree 3: 9 s and 1.7 GB. With 348 304 nodes at degree 3 a solve takes 2.2 GB, and with
some 360 000 nodes of another mesh 2.8 GB.
"""
MOST_NODES_WITHOUT_KEPT_FACTORS = 500_000
"""Largest number of nodes at degree 2 of a mesh whose sides all lie on the arcs of the outline.

Sides off the arcs, such as straight ones, cause an error whose estimate needs the factors of the
stiffness, which take most of the memory: MOST_NODES_AT_RAISED_DEGREE is the limit of such meshes. A
shoe of a drum of 300 mm, in triangles of 0.36 mm with curved sides, has 358 556 nodes at degree 2:
a solve takes 22 s of processor time and 1.2 GB. In triangles of 0.31 mm it has 475 614 nodes: 40 s
and 1.7 GB.
"""


DEGREE_OF_SPLIT_ELEMENT_GEOMETRY = 5
"""Degree of the polynomials that describe the shape of elements that are split into triangles.

The polynomials give the positions of the triangles' nodes. An element side on the drum, a third of
the drum's radius long, then follows the drum to 1e-7 of the radius. This distance is far less than
the compression of the lining. A higher degree takes longer and changes nothing.
"""


class DegreeAndSplittingOfMesh(NamedTuple):
    """The degree of the displacements on a mesh from a file, and how the mesh's elements are split.

    Attributes
    ----------
    degree : the degree of the displacements; None for the degree that the mesh has in the file
    fitting : whether contact nodes are put on the drum or the plane if their distance from it is
        not larger than the rounding of the file's coordinates
    level : sizes of the elements at singular points; None if no element is split
    points : singular points of the pressure on each shoe; none for a shoe that has the same shape
        as an earlier shoe
    keep_factors : whether the Cholesky factors of the eliminated unknowns are kept; additional
        loads and displacements inside the body are then cheap to compute
    most_nodes : largest number of nodes at the degree; a mesh with more nodes is refused
    """

    degree: int | None = None
    fitting: bool = False
    level: RefinementLevel | None = None
    points: tuple[tuple[SingularPoint, ...], ...] = ()
    keep_factors: bool = False
    most_nodes: int = MOST_NODES_AT_RAISED_DEGREE


UNSPLIT_MESH_AT_FILE_DEGREE = DegreeAndSplittingOfMesh()
"""The degree that the mesh has in its file, without splitting of elements."""


def make_condensed_shoes_from_meshes(
    brake: Brake,
    elements: int,
    kind: str,
    mesher: Mesher | None,
    cache: CacheOfCondensedBodies,
    seconds: SecondsOfEachPhase,
) -> CondensedBodiesOfBrake:
    """Make the condensed bodies of a brake on meshes; shoes of one shape share one body.

    The mesh of a file keeps its degree and its elements.

    Parameters
    ----------
    brake : the brake
    elements : number of elements along each lining with a parametric mesh, and number of elements
        of an elastic ring along each lining
    kind : kind of the elements, "quad2", "quad1", "tri2" or "tri1"
    mesher : function that makes the mesh of a shoe without a file, in place of
        `parametric_mesh_of_shoe`; its bodies are not taken from the cache
    cache : cache of condensed bodies; bodies found in it are used again, and new ones are added
    seconds : time of each phase [s], which this function adds to

    Raises
    ------
    BadInput
        if the number of elements is out of range, or if a mesh file cannot be used
    """
    if not 1 <= elements <= MOST_ELEMENTS_ALONG_LINING:
        raise BadInput(f"--elements = {elements}: must be from 1 to {MOST_ELEMENTS_ALONG_LINING}")
    cache = cache if mesher is None else CacheOfCondensedBodies()
    mesher = mesher or partial(parametric_mesh_of_shoe, elements=elements, kind=kind)
    # Shoes of one shape share a body within the brake. The cache shares equal bodies between
    # brakes.
    made: dict[tuple[object, ...], ShoeSubstructure] = {}
    for shoe in brake.shoes:
        shape = cache_key_of_shoe_shape(brake, shoe)
        if shape not in made:
            key = (*_cache_key_of_meshed_body(brake, shoe), elements, kind)
            make = partial(
                _mesh_condense_and_couple_shoe,
                brake,
                shoe,
                mesher,
                seconds,
                UNSPLIT_MESH_AT_FILE_DEGREE,
                cache,
            )
            made[shape] = cache.get(key, make, memory_bytes_of_condensed_body)
    bodies = tuple(made[cache_key_of_shoe_shape(brake, shoe)] for shoe in brake.shoes)
    ring = None
    ring_under = partial(condense_meshed_drum_ring_to_contact_nodes, brake, elements)
    if brake.ring is not None:
        digests = map(digest_of_mesh_file_of_shoe, brake.shoes)
        ring_key = (brake_without_loads_and_clearances(brake), elements, kind, *digests)
        lines = tuple(body.line for body in bodies)
        with add_elapsed_time_of_block_to_phase(seconds, "ring"):
            ring = cache.get(ring_key, partial(ring_under, lines), memory_bytes_of_condensed_body)
    nodes_of = partial(_mesh_nodes_of_changed_shoe, mesher, brake.size, bodies)
    return CondensedBodiesOfBrake(bodies, ring, nodes_of, ring_under)


def condensed_bodies_of_mesh_files(
    brake: Brake,
    raised: DegreeAndSplittingOfMesh,
    alike: Sequence[int],
    cache: CacheOfCondensedBodies,
    seconds: SecondsOfEachPhase,
) -> dict[int, ShoeSubstructure]:
    """The condensed bodies of all shoes that have mesh files.

    The key of a body is the index of the first shoe of its shape.

    Parameters
    ----------
    brake : the brake
    raised : degree of the displacements on the meshes, and how their elements are split
    alike : for each shoe the index of the first shoe of the same shape
    cache : cache of condensed bodies; bodies found in it are used again, and new ones are added
    seconds : time of each phase [s], which this function adds to

    Raises
    ------
    BadInput
        if a mesh file cannot be used
    """
    made = {}
    for i in dict.fromkeys(alike):
        shoe = brake.shoes[i]
        if shoe.mesh is None:
            continue
        own = raised._replace(points=raised.points[i : i + 1])
        make = partial(_mesh_condense_and_couple_shoe, brake, shoe, None, seconds, own, cache)
        key = (*_cache_key_of_meshed_body(brake, shoe), own)
        made[i] = cache.get(key, make, memory_bytes_of_condensed_body)
    return made


def _cache_key_of_meshed_body(brake: Brake, shoe: Shoe) -> tuple[object, ...]:
    """The first part of the cache key of a meshed shoe's body.

    It does not contain the number, kind or degree of the elements, which the caller appends.
    """
    return (
        shoe_without_loads_and_clearances(shoe),
        brake.size,
        brake.friction > 0,
        digest_of_mesh_file_of_shoe(shoe),
    )


def _mesh_nodes_of_changed_shoe(
    mesher: Mesher, radius: float, bodies: tuple[ShoeSubstructure, ...], i: int, shoe: Shoe
) -> NodePositionsAndActuationForces:
    """The nodes that the meshed body of shoe `i` would have if the shoe were changed to `shoe`.

    The changed shoe is meshed with the same number and kind of elements. A mesh from a file stays
    the same in the frame of the shoe.
    """
    if shoe.mesh is not None:
        return nodes_of_changed_shoe_with_mesh_file(radius, bodies[i], shoe)
    mesh = mesher(shoe, radius)
    return _nodes_and_forces_of_mesh(mesh, nodal_basis_of_mesh(mesh), shoe, radius)


def nodes_of_changed_shoe_with_mesh_file(
    radius: float, body: ShoeSubstructure, shoe: Shoe
) -> NodePositionsAndActuationForces:
    """The nodes of a mesh file's body if its shoe were changed to `shoe`.

    In the frame of the shoe the mesh stays the same.
    """
    return _nodes_and_forces_of_mesh(body.mesh, body.basis, shoe, radius)


def _nodes_and_forces_of_mesh(
    mesh: Any, basis: Any, shoe: Shoe, radius: float
) -> NodePositionsAndActuationForces:
    """The nodes of a mesh with its basis, and the nodal forces of the shoe's loads."""
    further = unit_loads_at_points_and_mass(basis, shoe, radius)
    if "actuation" not in mesh.boundaries or shoe.has_support_on_back_of_body:
        unloaded = np.zeros(basis.doflocs.shape)
        return NodePositionsAndActuationForces(basis.doflocs, unloaded, further)
    unit_loads, centre = nodal_forces_of_unit_end_loads_and_end_centre(
        basis, mesh.boundaries["actuation"]
    )
    factors, _ = actuation_force_and_moments_per_newton(centre, shoe)
    load = unit_loads @ factors
    return NodePositionsAndActuationForces(basis.doflocs, load.reshape(-1, 2).T, further)


@dataclass(frozen=True)
class AssembledUncondensedShoe:
    """One shoe with its lining, meshed and assembled, before static condensation.

    All arrays are in the frame of the shoe.

    Attributes
    ----------
    mesh, basis : the mesh, and its scalar basis of nodes and shape functions
    line : the contact line
    K : (2 nodes, 2 nodes) sparse stiffness without boundary conditions [N/m]
    constraints : the multi-point constraints, which tie the nodes of the hinge's face to the frame
    loads : unit loads (unknowns, k) by their name, on the unknowns that the constraints leave
    application_point_of_actuation_loads : (2,) point [m] at which unit force x, unit force y and
        unit couple of the actuation act
    mesh_read_from_file : the mesh that was read from a file, with notes on how it was adapted; None
        without a file
    """

    mesh: Any
    basis: Any
    line: ContactLine
    K: Any
    constraints: MultiPointConstraints
    loads: dict[str, Floats]
    application_point_of_actuation_loads: Floats
    mesh_read_from_file: ShoeMeshReadFromFile | None = None

    @cached_property
    def load_matrix_columns_by_load_name(self) -> ColumnsOfUnitLoads:
        """Which columns of the shoe's load matrix belong to each load, by the load's name."""
        return ColumnsOfUnitLoads.columns_of_named_unit_loads(self.loads)


def contact_line_of_meshed_shoe(basis: Any, facets: Ints, shoe: Shoe, radius: float) -> ContactLine:
    """The contact line of a shoe with a mesh.

    `basis` is the scalar basis of the mesh. `facets` are the indices of the element sides on the
    friction surface, and `radius` is the radius of the drum [m].
    """
    middle = sum(shoe.arc) / 2
    unit = radius if shoe.is_on_plane else None
    line = make_contact_line_of_lining(
        basis, facets, middle, unit, angle_of_edge_zone_left_out_of_peak_search(shoe, radius)
    )
    # A lining ends with an edge of the contact line whose last node is not the first node of the
    # next edge.
    first, last = line.pieces[0], line.pieces[-1]
    return replace(line, further_linings=tuple(first[1:][first[1:] != last[:-1]].tolist()))


def mesh_and_assemble_shoe(
    brake: Brake,
    shoe: Shoe,
    mesher: Mesher | None,
    seconds: SecondsOfEachPhase,
    raised: DegreeAndSplittingOfMesh = UNSPLIT_MESH_AT_FILE_DEGREE,
    cache: CacheOfCondensedBodies | None = None,
) -> AssembledUncondensedShoe:
    """Mesh a shoe, and assemble its stiffness, its constraints and its unit loads.

    Parameters
    ----------
    brake : the brake
    shoe : the shoe
    mesher : function that makes the mesh of a shoe without a file; None for a shoe with a file
    seconds : time of each phase [s], which this function adds to
    raised : degree of the displacements on a mesh from a file, and how its elements are split
    cache : cache of meshes that were read from files

    Raises
    ------
    BadInput
        if a mesh file cannot be used
    """
    with add_elapsed_time_of_block_to_phase(seconds, "mesh"):
        mesh_read_from_file = read_mesh_file_of_shoe(brake, shoe, cache or CacheOfCondensedBodies())
        if mesh_read_from_file is not None:
            mesh = mesh_read_from_file.mesh
            if raised.fitting:
                # The module loads scipy's interpolation, which takes long.
                from drumlin.fem.mesh.contact_surface import (  # noqa: PLC0415
                    mesh_without_gaps_below_rounding,
                )

                slack = mesh_read_from_file.contact.largest_rounding_offset
                mesh = mesh_without_gaps_below_rounding(mesh, slack, shoe, brake.size)
        else:
            assert mesher is not None
            mesh = mesher(shoe, brake.size)
        basis = _basis_of_raised_degree(mesh, raised, shoe, brake.size)
        mesh = basis.mesh
    with add_elapsed_time_of_block_to_phase(seconds, "assembly"):
        K = sparse_stiffness_of_body(basis, elastic_layers_of_shoe(shoe))
    with add_elapsed_time_of_block_to_phase(seconds, "ties"):
        pin = shoe.pin_position_in_shoe_frame
        line = contact_line_of_meshed_shoe(basis, mesh.boundaries["contact"], shoe, brake.size)
        rigid = basis.get_dofs(mesh.boundaries["hinge"]).flatten()
        constraints = multi_point_constraints_of_body(basis, line.nodes, rigid, pin)
        if "actuation" in mesh.boundaries and not shoe.has_support_on_back_of_body:
            unit_loads, application_point_of_actuation_loads = (
                nodal_forces_of_unit_end_loads_and_end_centre(basis, mesh.boundaries["actuation"])
            )
            actuated = constraints.matrix.T @ unit_loads
        else:
            # The actuation force acts on the rigid frame: on the rigid shoe itself, or on the grip
            # that holds the back of the body.
            application_point_of_actuation_loads = pin
            actuated = np.zeros((constraints.matrix.shape[1], DEGREES_OF_FREEDOM_OF_BODY_FRAME))
            actuated[-DEGREES_OF_FREEDOM_OF_BODY_FRAME:] = np.eye(DEGREES_OF_FREEDOM_OF_BODY_FRAME)
        others = nodal_forces_of_unit_loads_besides_actuation(basis, shoe, brake.size)
    loads = {ACTUATION_LOAD_NAME: actuated} | {
        name: constraints.matrix.T @ forces for name, forces in others.items()
    }
    return AssembledUncondensedShoe(
        mesh,
        basis,
        line,
        K,
        constraints,
        loads,
        application_point_of_actuation_loads,
        mesh_read_from_file,
    )


def _basis_of_raised_degree(
    mesh: Any, raised: DegreeAndSplittingOfMesh, shoe: Shoe, radius: float
) -> Any:
    """The basis of nodes and shape functions on a shoe's mesh, with split elements if needed.

    `raised` tells the degree of the displacements and how elements are split. `radius` is the
    radius of the drum [m], on a plane the length of the pad. Raises NoAnswer if the basis has too
    many nodes.
    """
    if raised.degree is None:
        return nodal_basis_of_mesh(mesh)
    # The imported module loads scikit-fem, which takes long. So it is imported only here.
    from drumlin.fem.mesh import splitting  # noqa: PLC0415

    nodes = number_of_nodes_at_degree(mesh, raised.degree)
    if nodes > raised.most_nodes:
        raise NoAnswer(
            f"its mesh has {nodes} nodes at degree {raised.degree}; at most {raised.most_nodes}"
        )

    if raised.level is None:
        return nodal_basis_of_shoe_mesh(mesh, raised.degree, shoe, radius)
    shape = nodal_basis_of_shoe_mesh(mesh, DEGREE_OF_SPLIT_ELEMENT_GEOMETRY, shoe, radius)
    finest = _largest_allowed_sides_at_singular_points(mesh, raised, shoe, radius)
    # A mesh of triangles of degree p has about p^2 / 2 nodes for each triangle.
    most = 2 * raised.most_nodes // raised.degree**2
    parts = splitting.split_mesh_into_triangles_towards_points(shape, finest, most)
    if parts is None:
        return nodal_basis_of_shoe_mesh(mesh, raised.degree, shoe, radius)
    return splitting.nodal_basis_on_split_triangles(shape, parts, raised.degree)


def _largest_allowed_sides_at_singular_points(
    mesh: Any, raised: DegreeAndSplittingOfMesh, shoe: Shoe, radius: float
) -> Any:
    """The singular points of a shoe's mesh, and the longest side that an element may have there.

    Singular points are the corners of the mesh and the singular points of the pressure. The result
    is a `splitting.LargestSidesAtSingularPoints`.

    Parameters
    ----------
    mesh : the mesh, which was read from a file
    raised : sizes of the elements at singular points, and the singular points of the pressure
    shoe : the shoe
    radius : radius of the drum [m], on a plane the length of the pad
    """
    # The imported modules load scikit-fem, which takes long. So they are imported only here.
    from drumlin.fem.mesh.smooth_outline import singular_corners_of_mesh  # noqa: PLC0415
    from drumlin.fem.mesh.splitting import LargestSidesAtSingularPoints  # noqa: PLC0415

    level, (start, end) = raised.level, shoe.arc
    assert level is not None
    thickness = shoe.lining.thickness / radius
    corners = singular_corners_of_mesh(mesh)
    angles, sides = [], [level.lining_end_column_size * shoe.lining.thickness] * len(corners)
    for point in itertools.chain.from_iterable(raised.points):
        distance = min(point.position - start, end - point.position)
        graded = grading_point_at_singular_point(point, level, thickness, distance)
        angles.append(graded.position)
        sides.append(
            max(graded.column_size, SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS * thickness)
            * radius
        )
    phi = np.array(angles)
    circle = [phi, 0 * phi] if shoe.is_on_plane else [np.cos(phi), np.sin(phi)]
    on_surface = radius * np.array(circle)
    return LargestSidesAtSingularPoints(
        np.hstack([mesh.p[:, corners], on_surface]), np.array(sides)
    )


def read_mesh_file_of_shoe(
    brake: Brake, shoe: Shoe, cache: CacheOfCondensedBodies
) -> ShoeMeshReadFromFile | None:
    """Read the mesh of a shoe from its file; None for a shoe without a file.

    The mesh is in the frame of the shoe. The cache keeps it until the file changes.
    """
    if shoe.mesh is None:
        return None
    # The imported module loads meshio, which takes 0.1 s. So it is imported only here.
    from drumlin.fem.mesh.file import read_shoe_mesh_with_notes  # noqa: PLC0415

    key = (shoe_without_loads_and_clearances(shoe), brake.size, digest_of_mesh_file_of_shoe(shoe))
    read = partial(
        read_shoe_mesh_with_notes, shoe.mesh, shoe, brake.size, f"shoe {shoe.name!r}: mesh"
    )
    return cast("ShoeMeshReadFromFile", cache.get(key, read, _memory_bytes_of_mesh_read_from_file))


def _memory_bytes_of_mesh_read_from_file(read: ShoeMeshReadFromFile) -> int:
    """The approximate memory [bytes] of a mesh that was read from a file."""
    # Coordinates, elements and sides are some 60 numbers of 8 bytes for each node.
    return 500 * int(read.mesh.doflocs.shape[1])


def _mesh_condense_and_couple_shoe(
    brake: Brake,
    shoe: Shoe,
    mesher: Mesher | None,
    seconds: SecondsOfEachPhase,
    raised: DegreeAndSplittingOfMesh,
    cache: CacheOfCondensedBodies,
) -> ShoeSubstructure:
    """Mesh and condense a shoe, and couple it with the drum or the plane.

    Parameters
    ----------
    brake : the brake
    shoe : the shoe
    mesher : function that makes the mesh of a shoe without a file
    seconds : time of each phase [s], which this function adds to
    raised : degree of the displacements on a mesh from a file, and how its elements are split
    cache : cache of meshes that were read from files
    """
    parts = mesh_and_assemble_shoe(brake, shoe, mesher, seconds, raised, cache)
    with add_elapsed_time_of_block_to_phase(seconds, "condensation"):
        condensed = meshed_body_with_eliminated_contact(
            parts.K, parts.constraints, parts.loads, keep_factors=raised.keep_factors
        )
    divided = ShoeBodyElements(parts.mesh, parts.basis, parts.line, parts.mesh_read_from_file)
    application_point = parts.application_point_of_actuation_loads
    # The stiffness of all nodes is large, and the condensed body does without it.
    del parts
    friction = brake.friction > 0
    with add_elapsed_time_of_block_to_phase(seconds, "coupling"):
        return make_shoe_substructure(
            ShoeSubstructure,
            shoe,
            divided,
            condensed,
            application_point,
            friction=friction,
        )


def materials_and_widths_of_shoe_parts(
    shoe: Shoe,
) -> dict[str, tuple[IsotropicOrOrthotropicMaterial, float]]:
    """Material and width [m] of a shoe's lining, backing and body plates, by the part's name."""
    parts: dict[str, tuple[IsotropicOrOrthotropicMaterial, float]] = {
        "lining": (shoe.lining.material, shoe.lining.width)
    }
    if shoe.backing is not None:
        parts["backing"] = (shoe.backing.material, shoe.lining.width)
    if shoe.body is not None:
        parts |= {name: (plate.material, plate.width) for name, plate in shoe.body.plates.items()}
    return parts
