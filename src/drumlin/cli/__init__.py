"""The command line of drumlin.

`process` runs a command, `commands` lists all commands, and `terminal` prints lines and tables.
"""

import os

# A solve factorises many small dense matrices. Several BLAS threads make this slower, most of all
# where several processes share the cores. The number of threads must be set before numpy is loaded.
# It is set for this process alone. A number that the user has set stays.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Without this setting pydantic searches all installed packages for plugins, which takes 30 ms.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def main() -> None:
    """Run the command line of this process, and end the process with its exit status."""
    from drumlin.cli import process

    process.main()
