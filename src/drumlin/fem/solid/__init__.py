"""The solid shoe: the section of the plane model, as wide as its parts are, in hexahedra.

One half of the shoe stands for the whole, by symmetry. The room only meshes and condenses. Contact,
response and self-locking are those of the plane model.
"""

MOST_ELEMENTS = 200
"""Largest number of hexahedra along a lining; more take more memory than most computers have."""
MOST_ACROSS = 24
"""Largest number of hexahedra over half the width of a lining; more take too much memory."""
