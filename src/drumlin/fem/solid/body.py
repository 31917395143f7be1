"""A solid shoe, assembled and condensed to what contact and hinge need: the body of the plane, with
other matrices.

The half from the mid-plane outwards stands for the whole: its stiffness counts twice, and forces
and widths are those of the whole shoe. Across the width nothing is pressed or dragged, so that
displacements along z are inner unknowns, those of the friction surface too.
"""

from functools import partial

import numpy as np
import scipy.sparse as sp

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.elasticity import ElasticLayer, solid_elasticity_matrix
from drumlin.brake.fields import Material
from drumlin.fem.mesh.edges import edge_nodes
from drumlin.fem.preparation.bodies import ShoeSubstructure, coupled_shoe
from drumlin.fem.preparation.meshes import line_of, materials_of
from drumlin.fem.preparation.scene import Seconds, clock
from drumlin.fem.solid.face import ContactFace, contact_face, width_matrix
from drumlin.fem.solid.mesh import Solid, solid_mesh
from drumlin.fem.substructure.body import FRAME, Constraints, condense, stiffness
from drumlin.fem.substructure.elimination import dissection
from drumlin.fem.substructure.interface import end_loads
from drumlin.fem.substructure.loads import ACTUATION

HALVES = 2.0


class SolidBody(ShoeSubstructure):
    """A condensed body whose mesh is of hexahedra."""

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns of the mesh."""
        return int(3 * self.basis.N)


def solid_layers(shoe: Shoe) -> dict[str, ElasticLayer]:
    """The layers of a half that stands for the whole."""
    found = {}
    for name, (material, _) in materials_of(shoe).items():
        assert isinstance(material, Material)  # model.why_not
        found[name] = ElasticLayer(solid_elasticity_matrix(material), HALVES)
    return found


def behind(shoe: Shoe) -> str:
    """The subdomain that the hinge holds: a rigid shoe holds the back of the lining or of its
    backing.
    """
    return "shoe" if shoe.body is not None else "lining" if shoe.backing is None else "backing"


def hinged(solid: Solid, shoe: Shoe) -> Ints:
    """Nodes that move as a rigid line with the pin, across the whole width."""
    line = np.unique(edge_nodes(solid.plane, solid.section.boundaries["hinge"]))
    return solid.node[line, : solid.levels(behind(shoe))].ravel()


def face_of(solid: Solid, shoe: Shoe, radius: float) -> ContactFace:
    """The friction surface; radius [m]: of the drum."""
    line = line_of(solid.plane, solid.section.boundaries["contact"], shoe, radius)
    return contact_face(line, solid.node, solid.z[: solid.levels("lining")])


def tie(solid: Solid, contact: Ints, rigid: Ints, pin: Floats, *, bonded: bool) -> Constraints:
    """The reduced unknowns, in the order of a dissection: inner ones, contact nodes as x, y pairs,
    frame.

    The `rigid` nodes move with u = (dx, dy) + turn k x (x - pin), free along z unless they are
    `bonded` to a rigid shoe; nodes of the mid-plane do not leave it.
    """
    basis = solid.basis
    order = dissection(basis.doflocs, basis.element_dofs)
    inner = np.ones((basis.N, 3), dtype=bool)
    inner[contact, :2] = inner[rigid, :2] = False
    inner[solid.node[solid.node[:, 0] >= 0, 0], 2] = False
    if bonded:
        inner[rigid, 2] = False
    inside = inner[order.nodes].ravel()
    dofs = (3 * order.nodes[:, None] + np.arange(3)).ravel()[inside]
    region = np.repeat(order.region, 3)[inside]
    _, region = np.unique(region, return_inverse=True)
    dofs = np.concatenate([dofs, (3 * contact[:, None] + np.arange(2)).ravel()])
    frame = len(dofs) + np.arange(FRAME)
    x, y = basis.doflocs[:2, rigid] - pin[:, None]
    ones = np.ones(len(rigid))
    rows = [dofs, 3 * rigid, 3 * rigid, 3 * rigid + 1, 3 * rigid + 1]
    columns = [np.arange(len(dofs)), *(np.full(len(rigid), frame[k]) for k in (0, 2, 1, 2))]
    entries = (
        np.concatenate([np.ones(len(dofs)), ones, -y, ones, x]),
        (np.concatenate(rows), np.concatenate(columns)),
    )
    return Constraints(sp.csc_matrix(entries, shape=(3 * basis.N, len(dofs) + FRAME)), region)


def end_forces(solid: Solid) -> tuple[Floats, Floats]:
    """Nodal forces (nodes, 3, 3) (node, component, unit load) of unit force x, y and unit couple on
    the loaded end, even over the width, and the point (2,) that they act at.
    """
    line, centre = end_loads(solid.plane, solid.section.boundaries["actuation"])
    nodes = np.unique(edge_nodes(solid.plane, solid.section.boundaries["actuation"]))
    count = solid.levels("shoe")
    share = width_matrix(solid.z[:count]).sum(axis=1)
    forces = np.zeros((solid.basis.N, 3, 3))
    each = line.reshape(-1, 2, 3)[nodes]
    forces[solid.node[nodes, :count], :2] = each[:, None] * (share / share.sum())[:, None, None]
    return forces, centre


def loads_on(
    solid: Solid, shoe: Shoe, constraints: Constraints
) -> tuple[dict[str, Floats], Floats]:
    """Unit loads (unknowns, k) on the reduced unknowns by name, and the point (2,) that those of the
    actuation act at.
    """
    # Without a loaded end the force acts on the rigid shoe, or on what holds its body.
    if "actuation" not in solid.section.boundaries or shoe.gripped:
        loads = np.zeros((constraints.matrix.shape[1], 3))
        loads[-FRAME:] = np.eye(3)
        return {ACTUATION: loads}, shoe.own_pin
    forces, centre = end_forces(solid)
    return {ACTUATION: np.asarray(constraints.matrix.T @ forces.reshape(-1, 3))}, centre


def solid_body(
    brake: Brake, shoe: Shoe, elements: int, across: int, seconds: Seconds
) -> ShoeSubstructure:
    """Mesh, assemble and condense a shoe."""
    with clock(seconds, "mesh"):
        solid = solid_mesh(shoe, brake.size, elements, across)
    with clock(seconds, "assembly"):
        K = stiffness(solid.basis, solid_layers(shoe))
    with clock(seconds, "ties"):
        face, rigid = face_of(solid, shoe, brake.size), hinged(solid, shoe)
        constraints = tie(solid, face.nodes, rigid, shoe.own_pin, bonded=shoe.body is None)
        loads, centre = loads_on(solid, shoe, constraints)
    with clock(seconds, "condensation"):
        condensed = condense(K, constraints, loads, 2 * len(face.nodes))
    with clock(seconds, "coupling"):
        made = partial(SolidBody, solid.mesh, solid.basis, face)
        return coupled_shoe(made, shoe, face, condensed, centre, friction=brake.friction > 0)
