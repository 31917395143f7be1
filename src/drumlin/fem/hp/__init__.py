"""Finite elements of high degree, few and graded to the places where the stress is not smooth."""
