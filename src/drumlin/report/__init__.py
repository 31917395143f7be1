"""Figures, pictures of stress fields, and HTML pages.

The modules of this package import matplotlib and pyvista, which take long to load.
"""
