"""Figures, pictures of stress fields, and HTML pages.

Only this package imports matplotlib, pyvista and other libraries that take long to load.
"""
