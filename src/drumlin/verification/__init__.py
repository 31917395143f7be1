"""Verification: reference values, checks of users' results, a second solver, the cost of a solve.

This package imports the models of drumlin. The models do not import this package.
"""
