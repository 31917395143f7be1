"""The lowest package of drumlin: array types, texts, errors, files, journals and LAPACK.

Its modules know nothing of brakes, and they import no other package of drumlin. Every other package
may import them. They define the types of numpy arrays, lines of text for people, and the exceptions
BadInput and NoAnswer. They round numbers for scales and ticks of figures. They write files whole or
not at all, and they keep the results of a long computation in a journal, so that a stopped
computation can go on.
"""
