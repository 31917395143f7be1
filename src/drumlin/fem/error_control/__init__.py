"""Error control: a posteriori error estimates, finer levels up to a tolerance, and round-off.

The room solves a brake on finer and finer divisions. From the difference of two levels it estimates
the error of the finer one, with factors that were fitted on random brakes (factors.json). It grades
the next division to the ends of the contact and to other singular points. A brake, a tolerance and
a function that solves a prepared model come in. The last response with its estimated errors goes
out. Where stiffnesses are far apart, iterative refinement in long double removes the round-off
errors of a group of shoes.
"""
