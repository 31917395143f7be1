"""Equilibrium: the contact problems of groups of shoes that must be solved together.

Shoes must be solved together if they share a strut, a cam or an elastic drum. The package takes a
prepared model and the friction coefficient, and divides the shoes into groups. For each group it
determines the rigid-body modes and assembles one contact problem. The solution of the problem gives
the nodal pressures, the forces at supports and the motion of every shoe.
"""
