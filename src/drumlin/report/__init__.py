"""Figures, pictures of stress fields, and HTML pages.

Most modules of this package import matplotlib, which takes long to load. The modules solid_picture
and plane_picture also import pyvista, in the process that draws their picture.
"""
