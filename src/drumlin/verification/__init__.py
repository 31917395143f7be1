"""Verification: reference values by a second solver, checks of results, the cost of a solve.

This package uses the models of drumlin. The models do not use this package.
"""
