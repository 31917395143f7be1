"""Equilibrium: the contact problem of shoes that share a force, a strut, a cam or an elastic drum.

The room finds which shoes have to be solved together, states their rigid-body modes and their
constraints, and assembles the equations of contact. A prepared model and the friction come in.
Groups of shoes go out, each as one contact problem whose solution gives the nodal pressure, the
forces at supports and the motion of every shoe.
"""
