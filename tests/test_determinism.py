"""Equal runs write equal bytes but for times; threads move no number by more than 1e-9.

That one and two processes, and a sweep that was stopped, give the same bytes stands in
test_sweep_stopped.
"""

import datetime
import json
import os
import subprocess
import sys
import time
from itertools import chain

import numpy as np
import pytest

from conftest import ROOT
from drumlin.cli.process import run_command_line

pytestmark = pytest.mark.slow

BRAKES = ("double_shoe/brake", "post_brake/brake")
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
CHILD = """
import json, sys, drumlin
brakes = [drumlin.read_brake(path) for path in sys.argv[1:]]
print(json.dumps([drumlin.solve(brake, tolerance=1e-3).as_dict() for brake in brakes]))
"""


def test_equal_runs_write_equal_files_but_for_times(tmp_path, monkeypatch, capsys):
    """Equal runs write equal pages, figures, field pictures, tables, JSON and meshes.

    Clocks stand still in these runs.
    """
    brake = str(ROOT / "studies" / BRAKES[0]) + ".toml"
    monkeypatch.setattr(time, "perf_counter", lambda: 0.0)
    written = []
    for turn in ("1", "2"):
        folder = tmp_path / turn
        folder.mkdir()
        monkeypatch.chdir(folder)
        monkeypatch.setattr(sys, "argv", ["drumlin"])
        for words in (
            ["compare", brake, "--elements", "8", "--output", "report"],
            ["solve", brake, "--json", "r.json", "--pressure", "r.csv"],
            ["wear", brake, "--elements", "6", "--distance", "0.1", "--json", "w.json"],
            ["sensitivity", brake, "--elements", "8", "--json", "s.json"],
            ["mesh", brake, "--format", "vtu"],
            ["mesh", brake, "--format", "msh"],
            ["mesh", brake, "--format", "inp"],
            ["export", brake, "--to", "calculix", "--output", "decks"],
            ["view", brake, "--output", "v.svg"],
        ):
            assert run_command_line(words) == 0
        written.append(
            {
                path.relative_to(folder): path.read_bytes()
                for path in folder.rglob("*")
                if path.is_file()
            }
        )
        written[-1]["printed"] = capsys.readouterr().out
    assert len(written[0]) > 10 and written[0].keys() == written[1].keys()
    today = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d").encode()
    assert (
        today in written[0][next(path for path in written[0] if str(path).endswith("index.html"))]
    )
    for path, data in written[0].items():
        assert data == written[1][path], path


def numbers(data):
    """All numbers of an answer by their place, times apart."""
    if isinstance(data, dict):
        return [
            x
            for key, value in sorted(data.items())
            if key not in {"seconds", "balance"}
            for x in numbers(value)
        ]
    if isinstance(data, list):
        return list(chain.from_iterable(map(numbers, data)))
    return [float(data)] if isinstance(data, int | float) else []


def test_the_number_of_threads_moves_no_number():
    """The number of threads moves torques and forces by at most 1e-9 of their size.

    Pressures feel round-off in thin columns and move by up to 3e-7.
    """
    paths = [str(ROOT / "studies" / brake) + ".toml" for brake in BRAKES]
    answers = []
    for threads in ("1", "2"):
        env = {
            **os.environ,
            **dict.fromkeys(THREADS, threads),
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        }
        done = subprocess.run(
            [sys.executable, "-c", CHILD, *paths],
            capture_output=True,
            text=True,
            env=env,
            check=True,
            timeout=300,
        )
        answers.append(json.loads(done.stdout))
    for one, two in zip(*answers, strict=True):
        assert one["torque"] == pytest.approx(two["torque"], rel=1e-9)
        for a, b in zip(one["shoes"], two["shoes"], strict=True):
            for key, value in a.items():
                x, y = np.array(numbers(value)), np.array(numbers(b[key]))
                # Stated errors are relative already.
                size = 1.0 if key == "error" else np.abs(x).max(initial=1e-300)
                within = 1e-9 if key in {"torque", "normal_force", "hinge_reaction"} else 3e-7
                np.testing.assert_allclose(x, y, rtol=0, atol=within * size, err_msg=key)
