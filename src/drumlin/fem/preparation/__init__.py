"""Preparation: a brake becomes a prepared model, all its bodies divided, condensed and coupled.

The room decides which bodies are equal, divides each of them once (in hp elements or on a mesh) and
keeps condensed bodies for later solves. A brake, and the level of its division, come in. A prepared
model, with a body for each shoe and the drum's ring, goes out. The correction for a finite width of
the lining also belongs here, since it changes a brake before it is divided.
"""
