"""Division and hp elements: finite elements of high degree, few and graded to the singular points.

The room divides a parametric shoe, a pad or the drum's ring into columns of elements. A shoe with
its layers, a level (degree and grading) and the points where the stress is not smooth come in.
Condensed bodies, with the unknowns that contact and supports need, and a grid of all nodes for
pictures and slopes go out.
"""
