"""Verification: reference values by a second solver, checks of results, the cost of a solve.

This package imports the parts of drumlin that compute; no part that computes imports this package.
"""
