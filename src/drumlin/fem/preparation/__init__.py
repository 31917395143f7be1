"""Preparation: from a brake to its prepared model, all bodies divided, condensed and coupled.

The package decides which shoes have equal bodies. It divides each different body once, in hp
elements or on a mesh, and keeps condensed bodies for later solves. From a brake and a level of
division it makes a prepared model, which has a body for each shoe and one for the drum's ring.
"""
