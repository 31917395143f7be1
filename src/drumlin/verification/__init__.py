"""Verification: reference values by a second solver, results that are checked against them, and the
time of a solve against its own assembly.

Stands on everything that computes; nothing that computes stands on it.
"""
