"""A journal keeps finished cases, drops a torn line, and belongs to one state of the program and one run."""

import errno
import math
import os

import pytest

from drumlin.errors import BadInput
from drumlin.journal import Journal


def test_cases_survive_and_are_not_computed_again(tmp_path):
    path = tmp_path / "journal.jsonl"
    with Journal(path, "a") as journal:
        assert journal.once({"n": 1, "mu": 0.3}, lambda: {"torque": math.inf}) == {"torque": math.inf}
    with Journal(path, "a") as journal:
        assert journal.once({"mu": 0.3, "n": 1}, lambda: pytest.fail("computed again")) == {"torque": math.inf}
        assert len(journal) == 1


@pytest.mark.parametrize("cut", range(1, 40, 6))
def test_a_torn_last_line_is_dropped(tmp_path, cut):
    path = tmp_path / "journal.jsonl"
    with Journal(path, "a") as journal:
        journal.add({"n": 1}, {"torque": 1.0})
        journal.add({"n": 2}, {"torque": 2.0})
    path.write_bytes(path.read_bytes()[:-cut])
    with Journal(path, "a") as journal:
        assert {"n": 1} in journal and {"n": 2} not in journal
        journal.add({"n": 2}, {"torque": 2.0})
    with Journal(path, "a") as journal:
        assert journal[{"n": 2}] == {"torque": 2.0} and len(journal) == 2


def test_another_program_begins_anew(tmp_path):
    with Journal(tmp_path / "j.jsonl", "a") as journal:
        journal.add({"n": 1}, {})
    with Journal(tmp_path / "j.jsonl", "b") as journal:
        assert len(journal) == 0
        journal.add({"n": 3}, {})
    with Journal(tmp_path / "j.jsonl", "b") as journal:
        assert {"n": 3} in journal


def test_two_runs_at_a_time_are_refused(tmp_path):
    with Journal(tmp_path / "j.jsonl"), pytest.raises(BadInput, match="another run"):
        Journal(tmp_path / "j.jsonl")


def test_a_finished_journal_is_kept_aside(tmp_path):
    with Journal(tmp_path / "journal.jsonl") as journal:
        journal.add({"n": 1}, {})
        journal.finish()
    assert (tmp_path / "cases.jsonl").exists() and not (tmp_path / "journal.jsonl").exists()


def test_a_file_that_is_no_journal_is_left_alone(tmp_path):
    (tmp_path / "notes").write_text("torque: 447 N m\n")
    with pytest.raises(BadInput, match="is no journal"):
        Journal(tmp_path / "notes")
    assert (tmp_path / "notes").read_text() == "torque: 447 N m\n"


def test_a_full_disk_is_said_in_one_line(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with Journal(tmp_path / "journal", "a") as journal:
        monkeypatch.setattr("os.write", full)
        with pytest.raises(BadInput, match="cannot be written"):
            journal.add({"n": 1}, {})
