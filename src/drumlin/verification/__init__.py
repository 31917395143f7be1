"""Verification: reference values, error against run time, extreme and random brakes, independent
discretisations.

Stands on everything that computes; nothing that computes stands on it.
"""
