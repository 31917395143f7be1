"""Peak memory of this process, and processor time of its child processes that have ended.

Linux and macOS count both for every process, and Python reads them with the module `resource`. On
Windows, where Python has no such module, the functions return nan, and reports show no number.
"""

import math
import sys
from pathlib import Path

try:
    import resource
except ImportError:
    resource = None  # type: ignore[assignment]


def peak_memory_of_process() -> float:
    """The largest resident memory of this process so far [bytes]; nan where it is not known."""
    # On Linux, getrusage may give the peak memory of the parent process. VmHWM in this file is the
    # peak memory of the process itself.
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return 1024.0 * int(line.split()[1])
    if resource is None:
        return math.nan
    size = float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    # getrusage gives bytes on macOS, elsewhere units of 1024 bytes.
    return size if sys.platform == "darwin" else 1024 * size


def processor_time_of_ended_child_processes() -> float:
    """Processor time [s] of the child processes that have ended; nan where it is not known.

    Unlike wall-clock time it hardly depends on other programs that keep the machine busy.
    """
    if resource is None:
        return math.nan
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
