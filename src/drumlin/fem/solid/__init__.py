"""Solid shoes: the section of the plane model, as wide as its parts are.

The room starts the solve of `--model solid`. Without options `fem.width` solves the brake, to a
stated error. A given number of elements takes hexahedra, which this room meshes and condenses. One
half of the shoe stands for the whole, by symmetry. Contact, response and self-locking are those of
the plane model. The room also samples displacements and stresses inside solid shoes of both kinds.
"""

MOST_ELEMENTS = 200
"""Largest number of hexahedra along a lining; more take more memory than most computers have."""
MOST_ACROSS = 24
"""Largest number of hexahedra over half the width of a lining; more take too much memory."""
