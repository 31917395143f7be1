"""The command line: commands in `main`, what a person at the terminal sees in `terminal`."""

import os

# The dense systems are many and small: more BLAS threads make them slower, by far where processes share the cores.
# Set before numpy is loaded, in this process alone; your own number overrules it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
