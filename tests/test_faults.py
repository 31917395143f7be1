"""Broken inputs of every generator: an answer that is finite, or one line. And the judge itself,
which can say no.
"""

import random
import time
import zlib

import pytest

from drumlin.base.errors import BadInput
from drumlin.fem.mesh import vtu
from drumlin.fem.mesh.abaqus import read_inp
from drumlin_studies.fuzzing import endings, trials
from drumlin_studies.fuzzing.endings import fault_of, in_process, in_subprocess
from drumlin_studies.fuzzing.faults import (
    MAKERS,
    Input,
    brake_text,
    make,
    mesh_files,
    reference_text,
    result_text,
    shown,
)
from judged_endings import BAD, GIVEN, GOOD, REFUSED

SECONDS = 15.0


@pytest.mark.slow
def test_no_broken_input_ends_in_a_fault():
    """As many as fit; the same ones in the same order every time."""
    start, number, kinds, faults = time.monotonic(), 0, set(), []
    while number < 60 or (time.monotonic() - start < SECONDS and number < 2000):
        given = make(number)
        fault = fault_of(given, in_process(given))
        if fault:
            faults.append(f"{number}: {shown(given)}: {fault}")
        kinds.add(given.kind.split(":")[0])
        number += 1
    assert not faults, "\n".join(faults)
    assert {"brake file", "command line", "mesh"} <= kinds


def test_each_generator_repeats_itself_and_varies():
    for maker in MAKERS:
        assert maker(random.Random(1)) == maker(random.Random(1))
        assert len({repr(maker(random.Random(i))) for i in range(8)}) > 4


def test_a_process_of_its_own_ends_alike():
    for number in (0, 3):
        given = make(number)
        if not all(map(trials.passes, given.words)):
            continue
        one, other = in_process(given), in_subprocess(given)
        assert (one.status, one.err) == (other.status, other.err)


def test_words_that_no_process_can_be_given_are_tried_in_this_one():
    """A NUL, half of a surrogate pair: both are among the words."""
    numbers = [n for n in range(60) if not all(map(trials.passes, trials.made("words", n).words))]
    assert {True, False} == {
        any("\0" in word for word in trials.made("words", n).words) for n in numbers
    }
    assert [trials.tried("words", n, apart=True).status for n in numbers[:6]] == [2] * len(
        numbers[:6]
    )


def test_what_waits_without_end_is_found(monkeypatch):
    import threading

    from drumlin.cli import process

    monkeypatch.setattr(endings, "LONGEST_WAIT", 0.05)
    monkeypatch.setattr(process, "run", lambda words: threading.Event().wait(60))
    assert "Late" in fault_of(GIVEN, in_process(GIVEN))


@pytest.mark.parametrize("case", BAD)
def test_the_judge_finds_each_kind_of_fault(case):
    assert fault_of(GIVEN, GOOD) == fault_of(GIVEN, REFUSED) == ""
    assert fault_of(GIVEN, BAD[case])


def test_a_name_that_reads_like_no_number_is_none():
    named = GIVEN._replace(files={"b.toml": b'shoe = [{name = "nan mm"}, {name = "inf"}]'})
    end = GOOD._replace(out="nan mm  3 N m\n", written={"r.csv": b"shoe,p\ninf,1\n"})
    assert fault_of(named, end) == "" != fault_of(GIVEN, end)
    assert fault_of(named, end._replace(out="nan mm  nan N m\n"))


# the ones that a list names

BRAKE = "double_shoe/brake"
TEXTS = {
    "integer of 4301 digits": ("friction = 0.3", "friction = " + "9" * 4301),
    "integer of 399 digits": ("friction = 0.3", "friction = " + "9" * 399),
    "quantity of 100000 digits": ('"150 mm"', '"' + "9" * 100_000 + ' mm"'),
    "drum is a list of nan": ("[drum]\n", "drum = [nan]\n[x]\n"),
    "power of two": ("[[shoe]]", '["shoe[²]"]\nx = 1\n[[shoe]]'),
    "NUL in a path": ('side = "internal"', 'mesh = "a\\u0000b.msh"\nside = "internal"'),
    "long path": ('side = "internal"', f'mesh = "{"x" * 5000}.msh"\nside = "internal"'),
    "mesh is a folder": ('side = "internal"', 'mesh = "sub"\nside = "internal"'),
    "escapes in a key": ('side = "internal"', '"a\\nb\\u001b[31m" = 1\nside = "internal"'),
    "deep key": ("friction = 0.3", "friction = 0.3\n" + ".".join("a" * 20_000) + " = 1"),
    "date": ("friction = 0.3", "friction = 1979-05-27"),
}


@pytest.mark.parametrize("case", TEXTS)
def test_brake_files_that_used_to_fall(case):
    before, after = TEXTS[case]
    text = brake_text(BRAKE).decode()
    assert before in text
    given = Input(
        case,
        {"b.toml": text.replace(before, after, 1).encode()},
        ["solve", "b.toml", "--elements", "6"],
    )
    end = in_process(given)
    assert end.status == 2 and fault_of(given, end) == ""


WORDS = {
    "wear on two elements": ["wear", "b.toml", "--elements", "2", "--distance", "0.01"],
    "no sections": ["wear", "post.toml", "--model", "foundation", "--sections", "0"],
    "no sections to solve": ["solve", "post.toml", "--model", "foundation", "--sections", "0"],
    "no elements to export": ["export", "b.toml", "--to", "calculix", "--elements", "0"],
    "a folder as JSON": ["solve", "b.toml", "--json", "sub"],
    "elements of 20 digits": ["solve", "b.toml", "--elements", "99999999999999999999"],
    "4301 digits": ["solve", "b.toml", "--elements", "9" * 4301],
    "a distance of 100000 digits": ["wear", "b.toml", "--distance", "9" * 100_000 + " km"],
    "a brake file of two lines": ["solve", "a\nb.toml"],
}


@pytest.mark.parametrize("case", WORDS)
def test_command_lines_that_used_to_fall(case):
    files = {"b.toml": brake_text(BRAKE), "post.toml": brake_text("post_brake/brake")}
    given = Input(case, files, WORDS[case])
    end = in_process(given)
    assert end.status == 2 and fault_of(given, end) == ""


def test_a_small_vtu_that_unpacks_to_much_is_refused_before(monkeypatch):
    data = mesh_files()[".vtu"]
    vtu.check_unpacked(data)
    monkeypatch.setattr(vtu, "MOST_UNPACKED", 1000)
    with pytest.raises(ValueError, match="unpacks to more than 1000 bytes"):
        vtu.check_unpacked(data)
    with pytest.raises(ValueError, match="unpacks"):
        vtu._unpacked(zlib.compress(bytes(50_000_000)), zlib.decompressobj, 1000)
    assert (
        vtu._unpacked(zlib.compress(bytes(5_000_000)), zlib.decompressobj, 5_000_000) == 5_000_000
    )
    with pytest.raises(ValueError, match="entities"):
        vtu.check_unpacked(b'<!DOCTYPE x [<!ENTITY a "b">]>' + data)


@pytest.mark.parametrize(
    "text",
    [
        "*NSET, NSET=A, GENERATE\n1, 300000000\n",
        "*NSET, NSET=A, GENERATE\n1, 99999999999999999999\n",
        "*NSET, NSET=A\n1, 2\n" + ("*NSET, NSET=A\n" + "A, " * 12 + "\n") * 12,
        "".join(f"*ELSET, ELSET=A{i}, GENERATE\n1, 1000000\n" for i in range(50)),
    ],
)
def test_sets_of_a_mesh_that_fill_the_memory_are_refused_before(text):
    with pytest.raises(ValueError, match="more than 2000000 members"):
        read_inp(text)


def test_the_sound_files_are_sound():
    given = Input("x", {"b.toml": brake_text(BRAKE), "ref.json": reference_text(), "r.csv": result_text()},
                  ["check", "b.toml", "r.csv", "--reference", "ref.json"])  # fmt: skip
    end = in_process(given)
    assert end.status == 0 and fault_of(given, end) == "" and "of the reference" in end.out
    with pytest.raises(BadInput):
        raise BadInput(shown(given))
