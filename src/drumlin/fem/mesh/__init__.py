"""Meshes of shoes: parametric ones of an arc and of a straight beam, where elements meet, and
meshes in files.

Imports the brake; knows nothing of stiffness or contact.
"""
