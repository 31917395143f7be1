"""Broken inputs of every generator give a finite answer or one line, and faults are noticed."""

import math
import random
import threading
import time
import warnings
import zlib
from types import SimpleNamespace

import pytest

from conftest import ROOT, partly
from drumlin import solve
from drumlin.base.errors import BadInput
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.cli import process
from drumlin.mesh_files import vtu
from drumlin.mesh_files.inp import read_mesh_from_inp_text
from drumlin_studies.fuzzing import endings, soundness, trials
from drumlin_studies.fuzzing.broken_meshes import (
    SUFFIXES_OF_BROKEN_MESH_FILES,
    input_with_mesh_file,
    valid_mesh_files_by_suffix,
)
from drumlin_studies.fuzzing.endings import (
    describe_fault_of_run,
    run_command_of_input_in_new_process,
    run_input_in_this_process,
)
from drumlin_studies.fuzzing.faults import (
    command_line_as_text,
    content_of_reference_file,
    csv_table_of_pressure_over_angle,
)
from drumlin_studies.fuzzing.inputs import FilesAndCommandLineOfBrokenInput, content_of_brake_file
from judged_endings import BAD, GIVEN, GOOD, REFUSED
from picking import saying

SECONDS = 30.0
FIRST = {"changed sweeps": 25, "impossible meshes": 25, "structure": 15, "journals": 2}
OTHERS_FIRST = 8
"""Number of inputs of a generator that each run of the fast tests tries, by generator and for all
other generators.

Impossible meshes and changed sweeps end in some 20 ms; each journal takes a sweep. The slow test
below begins with the same inputs and goes on.
"""


@pytest.mark.parametrize(
    "generator",
    partly(
        trials.INPUT_GENERATORS_BY_NAME,
        set(trials.INPUT_GENERATORS_BY_NAME) - {"huge", "impossible meshes"},
    ),
)
def test_the_first_inputs_of_a_generator_end_as_promised(generator):
    verdicts = [
        trials.run_and_judge_input(generator, number)
        for number in range(FIRST.get(generator, OTHERS_FIRST))
    ]
    assert [verdict.fault for verdict in verdicts if verdict.fault] == []


@pytest.mark.slow
def test_no_broken_input_ends_in_a_fault():
    """No random broken input ends in a fault.

    Each generator makes as many inputs as the time allows, always the same ones in the same order.
    """
    start, number, faults = time.monotonic(), 0, []
    while number < 30 or (time.monotonic() - start < SECONDS and number < 300):
        faults += [
            trials.run_and_judge_input(generator, number).fault
            for generator in trials.INPUT_GENERATORS_BY_NAME
        ]
        number += 1
    assert not any(faults), "\n".join(filter(None, faults))


def test_each_generator_repeats_itself_and_varies():
    for maker, _ in trials.INPUT_GENERATORS_BY_NAME.values():
        assert maker(random.Random(1)) == maker(random.Random(1))
        assert len({repr(maker(random.Random(i))) for i in range(8)}) > 4


@pytest.mark.slow
@pytest.mark.parametrize("generator", ["sizes", "tables"])
def test_a_process_of_its_own_ends_alike(generator):
    given = trials.make_numbered_input_of_generator(generator, 0)
    one, other = run_input_in_this_process(given), run_command_of_input_in_new_process(given)
    assert (one.status, one.err) == (other.status, other.err)


def test_words_that_no_process_can_be_given_are_tried_in_this_one():
    """Words that the operating system cannot pass to a process are tried in this process.

    Examples are a NUL character and half of a surrogate pair.
    """
    numbers = [
        n
        for n in range(190)
        # The version is printed before other words are read.
        if "--version" not in trials.make_numbered_input_of_generator("words", n).words
        and not all(
            map(
                trials.can_be_process_argument,
                trials.make_numbered_input_of_generator("words", n).words,
            )
        )
    ]
    assert {True, False} == {
        bool(saying(trials.make_numbered_input_of_generator("words", n).words, "\0"))
        for n in numbers
    }
    assert [trials.run_and_judge_input("words", n, apart=True).status for n in numbers[:6]] == [
        2
    ] * len(numbers[:6])


def test_what_waits_without_end_is_found(monkeypatch):
    monkeypatch.setattr(endings, "WALL_SECONDS_AFTER_WHICH_RUN_IS_STOPPED", 0.05)
    monkeypatch.setattr(process, "run_command_line", lambda words: threading.Event().wait(60))
    assert "RunTooLong" in describe_fault_of_run(GIVEN, run_input_in_this_process(GIVEN))


def test_a_warning_and_a_run_that_works_without_end_are_found(monkeypatch):
    monkeypatch.setattr(
        process, "run_command_line", lambda words: warnings.warn("x", stacklevel=1) or 0
    )
    assert "UserWarning" in describe_fault_of_run(GIVEN, run_input_in_this_process(GIVEN))

    def slow(words):
        while True:
            pass

    monkeypatch.setattr(endings, "PROCESSOR_SECONDS_ABOVE_WHICH_RUN_IS_FAULT", 0.2)
    monkeypatch.setattr(process, "run_command_line", slow)
    assert "took" in describe_fault_of_run(GIVEN, run_input_in_this_process(GIVEN))


@pytest.mark.slow
@pytest.mark.parametrize("suffix", SUFFIXES_OF_BROKEN_MESH_FILES)
def test_a_sound_mesh_is_answered_and_that_of_an_impossible_one_is_a_fault(suffix, monkeypatch):
    """A sound mesh is answered, and a generator that calls a sound mesh impossible is caught.

    Impossible meshes are made from meshes that drumlin takes: otherwise a refusal would prove
    nothing.
    """
    sound = input_with_mesh_file(
        "sound", valid_mesh_files_by_suffix()[suffix], suffix, must_fail=False
    )
    end = run_input_in_this_process(sound)
    assert end.status == 0 and describe_fault_of_run(sound, end) == ""
    assert "has none" in describe_fault_of_run(sound._replace(must_fail=True), end)


ANSWER_IN_JSON = b'{"torque": 1.0, "seconds": {"mesh": 0.1}}'


@pytest.mark.parametrize(
    ("status", "answer", "fault"),
    [
        (0, b'{"torque": 1.0, "seconds": {"mesh": 0.7}}', ""),
        (0, b'{"torque": 1.0000001, "seconds": {"mesh": 0.1}}', "another answer"),
        (2, ANSWER_IN_JSON, "another answer"),
    ],
)
def test_a_mesh_under_another_suffix_may_only_have_its_own_answer(
    status, answer, fault, monkeypatch
):
    """The undamaged files are solved too, and all numbers but the run times are compared."""
    undamaged = {"b.toml": b"", "m.inp": b"*NODE"}
    given = input_with_mesh_file("renamed", b"*NODE", ".msh", must_fail=False)
    given = given._replace(undamaged_files=undamaged)

    def run(other):
        assert dict(other.files) == undamaged
        return GOOD._replace(status=status, written={"r.json": answer})

    monkeypatch.setattr(endings, "run_input_in_this_process", run)
    said = describe_fault_of_run(given, GOOD._replace(written={"r.json": ANSWER_IN_JSON}))
    assert said.startswith(fault) and bool(said) == bool(fault)


def test_only_a_whole_mesh_under_another_suffix_may_have_an_answer():
    """An input that may be answered holds exactly the bytes of the undamaged mesh."""
    made = [
        trials.make_numbered_input_of_generator("impossible meshes", number)
        for number in range(400)
    ]
    answered = [given for given in made if not given.must_fail]
    assert len(answered) > 3 and all("another format" in given.kind for given in answered)
    for given in answered:
        (mesh,) = (data for name, data in given.files.items() if name != "b.toml")
        assert mesh in given.undamaged_files.values()
    assert not any(given.undamaged_files for given in made if given.must_fail)


def test_an_answer_that_cannot_be_true_is_found(monkeypatch):
    brake = read_drum_or_plane_brake(ROOT / "studies" / f"{BRAKE}.toml")
    answer = solve(brake, "fem", elements=6)
    assert soundness.explain_wrong_response(brake, answer) == ""

    def seen(**changed):
        parts = {name: getattr(answer, name) for name in ("torque", "balance", "shoes", "model")}
        return soundness.explain_wrong_response(brake, SimpleNamespace(**parts | changed))

    assert seen(torque=math.nan) == "not finite"
    assert "negative" in seen(torque=-answer.torque)
    assert "out of balance" in seen(balance=SimpleNamespace(force=1e-3, moment=0.0))
    no_moment = SimpleNamespace(moment=0.0)
    monkeypatch.setattr(soundness, "resultant_of_contact_on_shoe", lambda *_: no_moment)
    assert "of its pressure" in seen()


@pytest.mark.parametrize("case", BAD)
def test_the_judge_finds_each_kind_of_fault(case):
    assert describe_fault_of_run(GIVEN, GOOD) == describe_fault_of_run(GIVEN, REFUSED) == ""
    assert describe_fault_of_run(GIVEN, BAD[case])


def test_a_name_that_reads_like_no_number_is_none():
    named = GIVEN._replace(files={"b.toml": b'shoe = [{name = "nan mm"}, {name = "inf"}]'})
    end = GOOD._replace(out="nan mm  3 N m\n", written={"r.csv": b"shoe,p\ninf,1\n"})
    assert describe_fault_of_run(named, end) == "" != describe_fault_of_run(GIVEN, end)
    assert describe_fault_of_run(named, end._replace(out="nan mm  nan N m\n"))


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
    text = content_of_brake_file(BRAKE).decode()
    assert before in text
    given = FilesAndCommandLineOfBrokenInput(
        case,
        {"b.toml": text.replace(before, after, 1).encode()},
        ["solve", "b.toml", "--elements", "6"],
    )
    end = run_input_in_this_process(given)
    assert end.status == 2 and describe_fault_of_run(given, end) == ""


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
    files = {
        "b.toml": content_of_brake_file(BRAKE),
        "post.toml": content_of_brake_file("post_brake/brake"),
    }
    given = FilesAndCommandLineOfBrokenInput(case, files, WORDS[case])
    end = run_input_in_this_process(given)
    assert end.status == 2 and describe_fault_of_run(given, end) == ""


def test_a_small_vtu_that_unpacks_to_much_is_refused_before(monkeypatch):
    data = valid_mesh_files_by_suffix()[".vtu"]
    vtu.check_decompressed_vtu_size_fits_memory(data)
    monkeypatch.setattr(vtu, "LARGEST_UNPACKED_VTU_SIZE", 1000)
    with pytest.raises(ValueError, match="unpacks to more than 1000 bytes"):
        vtu.check_decompressed_vtu_size_fits_memory(data)
    with pytest.raises(ValueError, match="unpacks"):
        vtu._size_of_decompressed_block(zlib.compress(bytes(50_000_000)), zlib.decompressobj, 1000)
    assert (
        vtu._size_of_decompressed_block(
            zlib.compress(bytes(5_000_000)), zlib.decompressobj, 5_000_000
        )
        == 5_000_000
    )
    with pytest.raises(ValueError, match="entities"):
        vtu.check_decompressed_vtu_size_fits_memory(b'<!DOCTYPE x [<!ENTITY a "b">]>' + data)


@pytest.mark.parametrize("is_base64", [True, False])
def test_arrays_that_vtk_appends_are_unpacked_to_their_size(tmp_path, monkeypatch, is_base64):
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    source, path = tmp_path / "inline.vtu", tmp_path / "appended.vtu"
    source.write_bytes(valid_mesh_files_by_suffix()[".vtu"])
    reader, writer = xml.vtkXMLUnstructuredGridReader(), xml.vtkXMLUnstructuredGridWriter()
    reader.SetFileName(str(source))
    reader.Update()
    grid = reader.GetOutput()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.SetEncodeAppendedData(is_base64)
    writer.SetCompressorTypeToZLib()
    writer.Write()
    # The points alone have three doubles each.
    monkeypatch.setattr(vtu, "LARGEST_UNPACKED_VTU_SIZE", 24 * grid.GetNumberOfPoints())
    with pytest.raises(ValueError, match="unpacks to more than"):
        vtu.check_decompressed_vtu_size_fits_memory(path.read_bytes())
    monkeypatch.setattr(vtu, "LARGEST_UNPACKED_VTU_SIZE", 200 * grid.GetNumberOfPoints())
    vtu.check_decompressed_vtu_size_fits_memory(path.read_bytes())


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
    # A shoe that needs such a set is refused with this reason.
    triangle = "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=CPS3, ELSET=E\n1, 1, 2, 3\n"
    broken = read_mesh_from_inp_text(triangle + text).broken
    reasons = ("more than 2000000 members", "is a member of itself")
    assert any(reason.endswith(reasons) or reasons[0] in reason for reason in broken.values())


def test_the_sound_files_are_sound():
    files = {
        "b.toml": content_of_brake_file(BRAKE),
        "ref.json": content_of_reference_file(),
        "r.csv": csv_table_of_pressure_over_angle(),
    }
    given = FilesAndCommandLineOfBrokenInput(
        "x", files, ["check", "b.toml", "r.csv", "--reference", "ref.json"]
    )
    end = run_input_in_this_process(given)
    assert (
        end.status == 0
        and describe_fault_of_run(given, end) == ""
        and "of the reference" in end.out
    )
    with pytest.raises(BadInput):
        raise BadInput(command_line_as_text(given))
