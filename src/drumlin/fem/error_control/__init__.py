"""Error control: a posteriori error estimates, finer levels until they suffice, and round-off.

The room compares the answers of a brake on finer and finer divisions, estimates the error that is
left (with factors fitted on random brakes, factors.json), and grades the next division to the ends
of contact. A brake, tolerances and a function that solves a prepared model come in. The last
answer with its stated errors goes out. Iterative refinement in long double removes round-off error
from a group of shoes where stiffnesses are far apart.
"""
