"""The two ways in which drumlin ends without a number, each one plain line."""


class DrumlinError(Exception):
    """A problem that is said in one line; `exit_status` is what the command line returns."""

    exit_status = 1


class BadInput(DrumlinError):
    """The input is wrong: the line names the key, the value and what is allowed."""

    exit_status = 2


class NoAnswer(DrumlinError):
    """The input is right and the question has no answer: self-locking, no equilibrium, not converged."""

    exit_status = 3
