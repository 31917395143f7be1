"""Analyses of a prepared or solved brake that go beyond the response of a solve.

Holding turns the drum from rest to full slip. Self-locking finds the friction coefficient at which
the brake locks. Sensitivity gives exact derivatives of the torque by adjoints. Fields recover
displacements and stresses inside the bodies. Each analysis takes a prepared model with a brake and
returns a result class of its own.
"""
