"""Sweeps: many cases of one brake as a table, their file, tolerances and whose share they are, and
who solves them.

Stands on the models; whatever a case is solved by, the table is the same.
"""
