"""The command line of drumlin.

`process` runs a command, `commands` lists all commands, and `terminal` prints lines and tables.
"""

import os

from drumlin.base.threads import variables_for_one_blas_thread_unless_user_set_number

# The number of threads must be set before numpy is loaded. It is set for this process alone. A
# number that the user has set stays.
os.environ.update(variables_for_one_blas_thread_unless_user_set_number())
# Without this setting pydantic searches all installed packages for plugins, which takes 30 ms.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def main() -> None:
    """Run the command line of this process, and end the process with its exit status."""
    from drumlin.cli import process

    process.main()
