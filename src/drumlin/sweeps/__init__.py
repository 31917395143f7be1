"""Sweeps: one brake solved for many values of its keys, with the results as one table.

The package reads sweep files, has the cases solved by worker processes or a cluster, and evaluates
manufacturing tolerances. The table does not depend on the process that solved a case.
"""
