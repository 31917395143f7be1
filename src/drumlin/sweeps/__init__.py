"""Sweeps: many cases of one brake as a table, their file, their workers, and tolerances.

This package stands on the models. The table is the same whatever process or cluster solved the
cases.
"""
