"""The solid shoe: the section of the plane model, as wide as its parts are, in hexahedra; half of
it, by symmetry.

Beyond meshing and condensing it knows nothing of its own: contact, response and self-locking are
those of the plane.
"""

MOST_ELEMENTS = 200  # along a lining
MOST_ACROSS = 24  # over half its width
