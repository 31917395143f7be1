"""The command line: `process` runs it, `commands` lists its commands, `terminal` prints."""

import os

# A solve factorises many small dense matrices, and several BLAS threads make each of them slower,
# most of all where processes share the cores. The number must be set before numpy is loaded. It
# holds for this process alone, and a number that you set yourself stays.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Without this setting pydantic searches all installed packages for plugins, which takes 30 ms.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def main() -> None:
    """Run the command line of this process, and end the process with its exit status."""
    from drumlin.cli import process

    process.main()
