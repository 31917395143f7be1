"""Error control: a posteriori error estimates, finer levels up to a tolerance, and round-off.

The package solves a brake on finer and finer divisions into finite elements, the levels. From the
difference of two levels it estimates the error of the finer level, with factors that were fitted on
random brakes (factors.json). In the next division the elements become smaller towards singular
points: the ends of the contact, and other places where the pressure is unbounded or not smooth. The
functions of the package take a brake, a tolerance and a function that solves the brake on a
division, and return the last response with its estimated errors. If the parts of the brake differ
widely in stiffness, iterative refinement in long double removes the round-off errors.
"""
