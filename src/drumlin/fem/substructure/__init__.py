"""Substructures: the stiffness of bodies, their static condensation, and their coupling at contact.

The room reduces an elastic body to the unknowns that contact and supports need (Schur complement).
A mesh with the elasticity of its layers comes in. A condensed body, the matrices that couple its
contact line with a counterface (mortar), and the compliance of an elastic drum ring under all
linings go out.
"""
