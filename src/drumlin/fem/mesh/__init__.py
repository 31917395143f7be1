"""Meshes of shoes: parametric ones of an arc and of a straight beam, and meshes in files.

The room makes, reads, checks and writes meshes of elements of degree one or two. A shoe and a
number of elements, or a mesh file, come in. A mesh with named groups (layers, contact, hinge,
actuation) goes out. The room imports the brake; it knows nothing of stiffness or contact.
"""
