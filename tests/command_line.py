"""Functions that run drumlin commands for tests, in this process or in a separate one."""

import io
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout

import pytest

from drumlin.cli import main

DRUMLIN = [sys.executable, "-c", "from drumlin.cli import main; main()"]


def process(*words, code=None, **options):
    """The command line that runs `code` in a separate Python interpreter."""
    command = DRUMLIN if code is None else [sys.executable, "-c", code]
    return subprocess.run(
        [*command, *map(str, words)], capture_output=True, text=True, check=False, **options
    )


def drumlin(*words):
    """Run a drumlin command in this process; returns output and exit status as in a shell.

    This saves the second that an interpreter takes to start.
    """
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.setattr("sys.argv", ["drumlin", *map(str, words)])
        with pytest.raises(SystemExit) as end:
            main()
    status = end.value.code or 0
    # An exit with a text instead of a number would print the text and have the status 1.
    assert isinstance(status, int)
    return subprocess.CompletedProcess(words, status, out.getvalue(), err.getvalue())
