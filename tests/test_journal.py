"""A journal keeps finished cases, drops damaged ones alone, and serves one program and run."""

import errno
import json
import math
import os
import random
import shutil
from pathlib import Path

import pytest

from drumlin.base import journal as journals
from drumlin.base.errors import BadInput
from drumlin.base.journal import JournalOfCaseResults, checksum_of_source_and_libraries

CASES = 40


def test_cases_survive_and_are_not_computed_again(tmp_path):
    path = tmp_path / "journal.jsonl"
    with JournalOfCaseResults(path, "a") as journal:
        assert journal.get_or_compute_case_result(
            {"n": 1, "mu": 0.3}, lambda: {"torque": math.inf}
        ) == {"torque": math.inf}
    with JournalOfCaseResults(path, "a") as journal:
        assert journal.get_or_compute_case_result(
            {"mu": 0.3, "n": 1}, lambda: pytest.fail("computed again")
        ) == {"torque": math.inf}
        assert len(journal) == 1 and not journal.notes


@pytest.mark.parametrize("cut", range(1, 40, 6))
def test_a_torn_last_line_is_dropped(tmp_path, cut):
    path = tmp_path / "journal.jsonl"
    with JournalOfCaseResults(path, "a") as journal:
        journal.add({"n": 1}, {"torque": 1.0})
        journal.add({"n": 2}, {"torque": 2.0})
    path.write_bytes(path.read_bytes()[:-cut])
    with JournalOfCaseResults(path, "a") as journal:
        assert {"n": 1} in journal and {"n": 2} not in journal
        journal.add({"n": 2}, {"torque": 2.0})
    with JournalOfCaseResults(path, "a") as journal:
        assert journal[{"n": 2}] == {"torque": 2.0} and len(journal) == 2


def filled(path, stamp="a"):
    with JournalOfCaseResults(path, stamp) as journal:
        for n in range(CASES):
            journal.add({"n": n}, {"torque": n / 7})
    return path.read_bytes()


def damaged(data, rng):
    """The bytes of a journal, damaged in up to five places.

    Bits are flipped, or parts are lost, doubled or set to zero.
    """
    data = bytearray(data)
    for _ in range(rng.randint(1, 5)):
        at, length = rng.randrange(len(data)), rng.randrange(1, 200)
        match rng.randrange(5):
            case 0 | 1:
                data[at] ^= 1 << rng.randrange(8)
            case 2:
                del data[at : at + length]
            case 3:
                data[at:at] = data[at : at + length]
            case 4:
                data[at : at + length] = bytes(len(data[at : at + length]))
        if not data:
            break
    return bytes(data)


@pytest.mark.parametrize("seed", range(100))
def test_damage_costs_the_damaged_records_alone(tmp_path, seed):
    """Damage costs only the damaged records.

    All records that are read are right, and the next run computes the others.
    """
    path = tmp_path / "journal"
    whole = filled(path)
    data = damaged(whole, random.Random(seed))
    sound = sum(line in data.split(b"\n") for line in whole.split(b"\n")[1:-1])
    path.write_bytes(data)
    for _ in range(2):
        with JournalOfCaseResults(path, "a") as journal:
            # The last line may have lost its end.
            assert CASES >= len(journal) >= sound - 1
            assert all(
                journal[{"n": n}] == {"torque": n / 7} for n in range(CASES) if {"n": n} in journal
            )
            if (
                data.startswith(whole[:17])
                and data.count(b"\n") == CASES + 1
                and len(journal) < CASES
            ):
                assert "damaged lines are skipped" in journal.notes[0]
            for n in range(CASES):
                journal.get_or_compute_case_result({"n": n}, lambda n=n: {"torque": n / 7})
    with JournalOfCaseResults(path, "a") as journal:
        assert len(journal) == CASES


@pytest.mark.parametrize("head", (b'{"stomp": "a"}', b'{"stamp": "b"}', b"\0\0\0", b"[[[["))
def test_a_damaged_head_costs_nothing(head, tmp_path):
    """A damaged first line costs no records, even if it looks like that of another version."""
    path = tmp_path / "journal"
    data = filled(path)
    path.write_bytes(head + data[data.index(b"\n") :])
    with JournalOfCaseResults(path, "a") as journal:
        assert len(journal) == CASES and "1 damaged lines" in journal.notes[0]
    path.unlink()


def test_the_journal_of_another_program_is_kept_aside(tmp_path):
    path = tmp_path / "j.jsonl"
    old = filled(path, "a")
    for number, stamp in ((1, "b"), (2, "c")):
        with JournalOfCaseResults(path, stamp) as journal:
            assert len(journal) == 0 and journal.notes == [
                f"{path}: was of another drumlin and is kept as j.jsonl.{number}; every case "
                f"is solved anew"
            ]
            journal.add({"n": 3}, {})
        with JournalOfCaseResults(path, stamp) as journal:
            assert {"n": 3} in journal and not journal.notes
    assert (tmp_path / "j.jsonl.1").read_bytes() == old
    (tmp_path / "j.jsonl.1").replace(path)
    with JournalOfCaseResults(path, "a") as journal:
        assert len(journal) == CASES


def test_two_runs_at_a_time_are_refused(tmp_path):
    with JournalOfCaseResults(tmp_path / "j.jsonl"), pytest.raises(BadInput, match="another run"):
        JournalOfCaseResults(tmp_path / "j.jsonl")
    # Both journals are moved aside and begun anew.
    with (
        JournalOfCaseResults(tmp_path / "j.jsonl", "a"),
        pytest.raises(BadInput, match="another run"),
    ):
        JournalOfCaseResults(tmp_path / "j.jsonl", "a")


def test_a_finished_journal_is_kept_aside(tmp_path):
    with JournalOfCaseResults(tmp_path / "journal.jsonl") as journal:
        journal.add({"n": 1}, {})
        journal.close_and_rename_complete_journal()
    assert (tmp_path / "cases.jsonl").exists() and not (tmp_path / "journal.jsonl").exists()


FOREIGN = {
    "text": b"torque: 447 N m\n",
    "without an end of line": b"torque: 447 N m",
    "a brace": b"{",
    "JSON": b'{"torque": 447}\n',
    "a list": b"[1, 2]\n[3]\n",
    "lines": b'{"a": 1}\n' * 5000,
    "a table": b"case,torque\n0,447.0\n",
    "deep": b"[" * 100_000 + b"\n",
    "a number": b"9" * 5000 + b"\n",
    "zeros": bytes(3_000_000),
    "bytes": bytes(range(256)) * 40,
    "nearly": b'{"stamp": "x", "y": 1}\n',
    "no text": b'{"stamp": 3}\n',
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_file_that_is_no_journal_is_left_alone(tmp_path, name):
    (tmp_path / "notes").write_bytes(FOREIGN[name])
    with pytest.raises(BadInput, match="is no journal"):
        JournalOfCaseResults(tmp_path / "notes", "a")
    assert (tmp_path / "notes").read_bytes() == FOREIGN[name] and list(tmp_path.iterdir()) == [
        tmp_path / "notes"
    ]


@pytest.mark.parametrize("data", (b"", b'{"stamp": "a', b'{"stamp": "a"}'))
def test_an_empty_file_and_a_torn_first_line_are_new_journals(data, tmp_path):
    (tmp_path / "j").write_bytes(data)
    with JournalOfCaseResults(tmp_path / "j", "a") as journal:
        assert not len(journal) and not journal.notes
    assert json.loads((tmp_path / "j").read_text()) == {"stamp": "a"}


def test_paths_that_cannot_be_files(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "file").touch()
    for name in (".", "pipe", "file/journal", "a\0b", "a" * 5000):
        with pytest.raises(BadInput, match="cannot be written"):
            JournalOfCaseResults(tmp_path / name)


def test_a_full_disk_is_said_in_one_line(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with JournalOfCaseResults(tmp_path / "journal", "a") as journal:
        monkeypatch.setattr("os.write", full)
        with pytest.raises(BadInput, match="cannot be written"):
            journal.add({"n": 1}, {})


def test_a_change_of_any_source_file_of_drumlin_is_another_stamp(tmp_path, monkeypatch):
    """A copy of the package has the stamp of the package until one of its files is changed."""
    package = tmp_path / "drumlin"
    shutil.copytree(Path(journals.__file__).parents[1], package)
    whole = checksum_of_source_and_libraries()
    monkeypatch.setattr(journals, "__file__", str(package / "base" / "journal.py"))
    assert checksum_of_source_and_libraries() == whole
    (package / "laws" / "rigid.py").write_text("")
    assert checksum_of_source_and_libraries() != whole
