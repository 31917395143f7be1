"""A second solver for brakes: curved triangles of high degree with contact node by node.

This solver shares nothing with drumlin's hp elements but the brake. Its triangles are graded
geometrically to every corner of lining, backing, shoe and beam, to the ring below the lining's
ends, to the kinks of the gap and to the ends of the contact. Coarser meshes find these ends first.

Contact is enforced exactly at every node of the lining's face. A node is either open, or it lies on
the drum (or on the opposite node of an elastic ring) and carries a force with Coulomb friction at
full slip. A sequence of meshes of growing degree and grading gives each quantity; its change over
the last meshes shows how well the quantity is known.
"""

from drumlin.verification.triangles.levels import TRIANGLE_LEVELS, solve, solve_sequence
from drumlin.verification.triangles.outline import TriangleLevel
from drumlin.verification.triangles.solution import ShoeSolution

__all__ = ["TRIANGLE_LEVELS", "ShoeSolution", "TriangleLevel", "solve", "solve_sequence"]
