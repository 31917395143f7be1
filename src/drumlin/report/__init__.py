"""Figures, pictures of stress fields, and HTML pages.

Libraries that take long to load, such as matplotlib and pyvista, are imported here.
"""
