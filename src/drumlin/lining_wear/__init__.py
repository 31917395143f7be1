"""Wear: Archard's law in implicit steps of contact problems, and the end of wear in a single step.

The package sets the linings of a brake up to be worn, runs a brake in, and finds the worn-in state
directly. It stands on the finite elements, the foundation model and the laws. The models stand on
it.
"""
