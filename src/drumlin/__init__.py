"""drumlin: shoe brakes by the pressure laws and by finite elements in frictional contact, side by side."""

import os

__version__ = "0.1.0"

# The dense systems are many and small: more BLAS threads make them slower, by far where processes share the cores.
# Set your own number to overrule it; it counts only where numpy has not been loaded before.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
