"""Error control: a posteriori error estimates, finer levels up to a tolerance, and round-off.

The package solves a brake on finer and finer divisions into finite elements, the levels. From the
difference of two levels it estimates the error of the finer level, with factors that were fitted on
random brakes (factors.json). It grades the next division to the ends of the contact and to other
singular points of the pressure. Its functions take a brake, a tolerance and a function that solves
a prepared model, and return the last response with its estimated errors. Where stiffnesses are far
apart, iterative refinement in long double removes the round-off errors of a group of shoes.
"""
