"""A second way to the same answer: curved triangles of high degree, contact node by node.

Shares nothing with drumlin's finite elements but the brake. The triangles are graded geometrically
to every corner of lining, backing, shoe and beam, to the ring below the lining's ends, to the kinks
of the gap and to the ends of the contact, which earlier meshes found. Contact is Lagrange's, node
by node: each node of the lining's face is open, or lies on the drum (on the ring's node opposite)
and carries a force with Coulomb's friction at full slip. A sequence of meshes of growing degree and
grading gives each value, and how far the last steps still moved it.
"""

from drumlin.verification.triangles.levels import TRIANGLE_LEVELS, sequence, solve
from drumlin.verification.triangles.outline import TriangleLevel
from drumlin.verification.triangles.solution import ShoeSolution

__all__ = ["TRIANGLE_LEVELS", "ShoeSolution", "TriangleLevel", "sequence", "solve"]
