"""Analyses of an elastic brake beyond its torque: holding, self-locking, sensitivity, and fields.

The holding analysis turns the drum from rest to full slip. The self-locking analysis finds the
friction coefficient at which the brake locks. The sensitivity analysis gives exact derivatives of
the torque by the adjoint method. The fields are the displacements and stresses inside the bodies.
Each analysis takes a prepared model and its brake.
"""
