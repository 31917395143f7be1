"""Preparation: from a brake to its prepared model, all bodies divided, condensed and coupled.

The package decides which shoes have equal bodies. It divides each different body once, into hp
elements or by a mesh, and keeps condensed bodies for later solves. From a brake and the sizes of
its elements it makes a prepared model, which has a body for each shoe and a body for an elastic
ring of the drum.
"""
