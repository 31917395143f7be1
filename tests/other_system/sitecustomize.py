"""What Windows lacks, taken away from each Python process that finds this file on its path.

Python runs a module of this name at its start, in child processes too. The environment variable
DRUMLIN_TEST_LACKS names further packages to hide, and "long double".
"""

import builtins
import importlib.metadata
import os
import signal
import sys
import types
from pathlib import Path

LACKS = os.environ.get("DRUMLIN_TEST_LACKS", "").split(",")
"""Further packages that this process must not find, and "long double"."""

WINDOWS_SIGNALS = [
    "SIGINT",
    "SIGTERM",
    "SIGABRT",
    "SIGFPE",
    "SIGILL",
    "SIGSEGV",
    "SIG_DFL",
    "SIG_IGN",
    "signal",
    "getsignal",
    "raise_signal",
    "default_int_handler",
    "Signals",
    "Handlers",
    "strsignal",
    "valid_signals",
    "set_wakeup_fd",
]
"""What the module signal has on Windows too, according to the documentation of Python."""

POSIX_FUNCTIONS = [
    "fork",
    "forkpty",
    "wait",
    "wait3",
    "wait4",
    "waitpid",
    "killpg",
    "setsid",
    "getuid",
    "geteuid",
    "getpgid",
    "sched_getaffinity",
    "sched_setaffinity",
    "nice",
]
"""Functions of os that Windows lacks; the library itself has taken what it needs before."""

windows_signal = types.ModuleType("signal")
for name in WINDOWS_SIGNALS:
    setattr(windows_signal, name, getattr(signal, name))
plain_import, plain_rename, plain_version = (
    builtins.__import__,
    os.rename,
    importlib.metadata.version,
)
POSIX_MODULES = {"resource", "fcntl", "pwd", "grp", "termios", "tty"}
posix = {name: getattr(os, name) for name in POSIX_FUNCTIONS if hasattr(os, name)}
windows_os = types.ModuleType("os")
windows_os.__dict__.update({k: v for k, v in vars(os).items() if k not in posix})


def is_project(package):
    """Whether a module belongs to drumlin, to its studies or to the code of a test."""
    return package.split(".")[0] in {"drumlin", "drumlin_studies"} or "study" in package


def import_of_windows(name, globals=None, *more, **named):
    """The modules signal and os of Windows for drumlin; no POSIX module and no hidden package."""
    if is_project((globals or {}).get("__name__", "")):
        if name.split(".")[0] in POSIX_MODULES:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        if name in {"signal", "os"}:
            return {"signal": windows_signal, "os": windows_os}[name]
    return plain_import(name, globals, *more, **named)


def rename_of_windows(source, target, **options):
    """Rename a file unless this process has it open: Windows refuses that."""
    for handle in Path("/proc/self/fd").iterdir():
        if handle.exists() and handle.resolve() == Path(source).resolve():
            raise PermissionError(13, "The process cannot access the file", str(source))
    return plain_rename(source, target, **options)


def version_of_package(name):
    """The version of an installed package that is not hidden."""
    if name in LACKS:
        raise importlib.metadata.PackageNotFoundError(name)
    return plain_version(name)


builtins.__import__ = import_of_windows
os.rename = rename_of_windows  # type: ignore[assignment]
importlib.metadata.version = version_of_package
for name in LACKS:
    if name and name != "long double":
        sys.modules[name] = None  # type: ignore[assignment]
if "long double" in LACKS:
    import numpy as np

    np.longdouble = np.float64  # type: ignore[assignment]
