"""Analyses: questions to a prepared or a solved brake beyond its response.

The room holds the brake at rest and turns it to full slip, finds the friction at which it locks,
computes exact sensitivities of the torque by adjoints, and recovers displacements and stresses
inside the bodies. A brake or a prepared model comes in. A result of its own for each question goes
out.
"""
