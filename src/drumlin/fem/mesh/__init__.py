"""Meshes of shoes: parametric meshes of an arc or a straight beam, and meshes in files.

This package makes and checks meshes of elements of degree one or two, and gives the elements of
mesh files a higher degree. Its input is a shoe and a number of elements, or the content of a mesh
file, which `drumlin.mesh_files` reads. Its output is a mesh with named groups: the layers of the
shoe, the contact, the face that the hinge holds, and the face that the actuation force acts on. The
package uses the data of the brake; it assembles no stiffness and computes no contact.
"""
