"""A sweep from its file to its table, in one call."""

from pathlib import Path

from drumlin.sweeps.cases import Row, run
from drumlin.sweeps.file import read_sweep
from drumlin.sweeps.table import table
from drumlin.sweeps.workers import executor


def sweep(path: Path | str, *, jobs: int = 1) -> list[Row]:
    """Solve every case of a sweep file.

    Parameters
    ----------
    path : of the TOML file that names the brake, the keys that vary and how
    jobs : processes that solve side by side

    Returns
    -------
    one row a case, in the file's order: its changed keys, then its numbers in SI, and "status",
    which says why a case has none

    Raises
    ------
    BadInput
        for a file that cannot be read or is no sweep, in one line
    """
    prepared = read_sweep(Path(path))
    with executor(jobs) as (pool, workers):
        rows = run(prepared.cases, executor=pool, workers=workers)
    return table(prepared.cases, rows, Path(path).parent.resolve(), prepared.pressure)
