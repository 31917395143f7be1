"""Wear: Archard's law in implicit steps of contact problems, linings set up to be worn, running in,
and the worn-in state found in one step.

Stands on the finite elements, the foundation model and the laws; the models stand on it.
"""
