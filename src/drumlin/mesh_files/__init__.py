"""Mesh files: the readers of Gmsh, Abaqus, VTK, Nastran, MED and universal files, and writers.

The input of this package is a mesh file. Its output is the content of the file: nodes, plane cells
of one kind, named groups, and notes on what was ignored. The package knows nothing about shoes,
brakes and finite elements. `drumlin.fem.mesh` makes a mesh of a shoe from the content, and checks
the mesh.
"""
