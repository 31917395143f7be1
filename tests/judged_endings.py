"""Ways to end a command that the fuzzing tests must count as faults, with the inputs given."""

from drumlin_studies.fuzzing.endings import EndOfCommandLineRun
from drumlin_studies.fuzzing.inputs import FilesAndCommandLineOfBrokenInput

GIVEN = FilesAndCommandLineOfBrokenInput("x", {"b.toml": b"title"}, ["solve", "b.toml"])
GOOD = EndOfCommandLineRun(
    0, "torque 3 N m\n", "", {"r.json": b'{"p": 1.0}', "r.csv": b"shoe,p\nleft,1\n"}, 0.1
)
REFUSED = EndOfCommandLineRun(2, "", "drumlin: friction = 2: must be less\n", {}, 0.1)
BAD = {
    "hang": REFUSED._replace(seconds=11.0),
    "traceback": REFUSED._replace(status=1),
    "two lines": REFUSED._replace(err="drumlin: a\nb\n"),
    "not drumlin's": REFUSED._replace(err="Usage: x\n"),
    "escape": REFUSED._replace(err="drumlin: \x1b[31m\n"),
    "files": REFUSED._replace(written={"r.json": b"{}"}),
    "warning": GOOD._replace(err="UserWarning\n"),
    "nan": GOOD._replace(out="torque nan N m\n"),
    "inf": GOOD._replace(out="coefficient -inf\n"),
    "JSON": GOOD._replace(written={"r.json": b'{"p": NaN}'}),
    "CSV": GOOD._replace(written={"r.csv": b"shoe,p\nleft,nan\n"}),
    "formula": GOOD._replace(written={"r.csv": b"shoe,p\n=1,3\n"}),
    "input": GOOD._replace(written={"b.toml": b"{}"}),
    "temporary": GOOD._replace(written={".drumlin-0123.json": b""}),
}
