"""Sweeps: one brake solved for many values of its keys, with the results as one table.

The package reads sweep files, solves the cases in worker processes or on a cluster, and evaluates
manufacturing tolerances. The table does not depend on which process solved which case.
"""
