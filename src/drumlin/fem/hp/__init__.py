"""hp elements of shoes and rings: few finite elements of high degree, smaller near singular points.

This package divides a parametric shoe, a pad or the drum's ring into columns of elements. A column
is a stack of elements through the thickness of the body. It takes a shoe with its layers, the
degree and sizes of the elements, and the points where the stress is not smooth. It returns the
stiffness of the shoe or ring, statically condensed to its contact nodes and supports, and a grid of
all nodes. Pictures and derivatives of the torque are computed on this grid.
"""
