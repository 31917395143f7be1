"""Substructures: bodies reduced to the displacements of their contact nodes and supports.

The reduction is static condensation (Schur complement). Its input is a mesh with the elasticity of
its layers. Its results are condensed bodies, the matrices that couple the contact line of a lining
with the drum or the plane (mortar method), and the flexibility of an elastic drum ring under all
linings.
"""
