"""A second solver for brakes: curved triangles of high degree with contact node by node.

This solver shares nothing with drumlin's hp elements but the brake. The sizes of the triangles
shrink geometrically towards every corner of lining, backing, shoe and beam, towards the kinks of
the gap and the ends of the contact, and in the drum's ring towards the points opposite the lining's
ends. Coarser meshes are solved first to find the ends of the contact.

Contact is enforced exactly at every node of the lining's face. A node is either open, or it lies on
the drum (or on the opposite node of an elastic ring) and carries a force with Coulomb friction at
full slip. The brake is solved on a sequence of meshes with more and smaller elements of growing
degree. The change of a quantity over the last meshes estimates its error.
"""

from drumlin.verification.triangles.levels import (
    TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_one_triangle_mesh,
    solve_brake_on_sequence_of_triangle_meshes,
)
from drumlin.verification.triangles.outline import DegreeAndGradingOfTriangleMesh
from drumlin.verification.triangles.solution import ShoeSolution

__all__ = [
    "TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE",
    "DegreeAndGradingOfTriangleMesh",
    "ShoeSolution",
    "solve_brake_on_one_triangle_mesh",
    "solve_brake_on_sequence_of_triangle_meshes",
]
