"""The command line: `process` runs it, `commands` names them all, `terminal` is what a person at it
sees.
"""

import os

# The dense systems are many and small: more BLAS threads make them slower, by far where processes
# share the cores. Set before numpy is loaded, in this process alone; your own number overrules it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Nor does pydantic look through all that is installed for plugins, which takes it 30 ms.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def main() -> None:
    """Run the command line of this process, and end it."""
    from drumlin.cli import process

    process.main()
