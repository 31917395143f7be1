"""Reading and writing files: replaced files, protected ones, pipes and limits of size."""

import math
import os
import signal
import stat
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from conftest import STUDY
from drumlin.base.errors import (
    BadInput,
    NoAnswer,
    StoppedBySignal,
    call_function_and_return_exit_status,
    error_line_and_exit_status,
)
from drumlin.base.files import (
    check_output_files_are_writable,
    check_path_can_be_folder,
    delete_output_of_earlier_run,
    protect_input_files_within_block,
    read_bytes,
    read_text,
    spreadsheet_cell_safe_from_being_run_as_formula,
    temporary_file_replacing_output,
    write_text,
)
from drumlin.base.texts import (
    MAX_CONSECUTIVE_DIGITS_OF_NUMBER,
    check_numbers_have_few_digits,
    check_toml_parses_quickly,
    command_text_without_folders,
    printable_single_line,
)
from drumlin.cli.process import run_command_line
from picking import picked


def node(path, kind, minor):
    """A device file in the tests' own folder."""
    try:
        os.mknod(path, kind | 0o666, os.makedev(1, minor))
        path.open("wb").close()
    except PermissionError:
        pytest.skip("devices can only be made by root")
    return path


# writing


def test_a_device_is_written_to_and_stays(tmp_path):
    null = node(tmp_path / "null", stat.S_IFCHR, 3)
    write_text(null, "x")
    assert null.is_char_device() and picked(tmp_path.iterdir(), "name") == ["null"]


def test_a_full_device_is_no_answer_in_one_line(tmp_path):
    full = node(tmp_path / "full", stat.S_IFCHR, 7)
    with pytest.raises(NoAnswer, match=r"full: cannot be written \(No space left on device\)"):
        write_text(full, "x")


def test_an_output_of_an_earlier_run_is_deleted_but_no_input_and_no_folder(tmp_path):
    path = tmp_path / "fields.vtu"
    delete_output_of_earlier_run(path)
    path.write_text("earlier")
    with protect_input_files_within_block():
        read_text(path, 100, "a mesh")
        delete_output_of_earlier_run(path)
        assert path.read_text() == "earlier"
    delete_output_of_earlier_run(path)
    path.mkdir()
    delete_output_of_earlier_run(path)
    assert path.is_dir()


def test_a_disk_is_refused(tmp_path):
    try:
        os.mknod(tmp_path / "disk", stat.S_IFBLK | 0o600, os.makedev(250, 250))
    except PermissionError:
        pytest.skip("devices can only be made by root")
    with pytest.raises(BadInput, match="disk"):
        write_text(tmp_path / "disk", "x")


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "there").mkdir()
    target = tmp_path / "there" / "t.json"
    target.write_text("earlier")
    for link, to in (("l.json", "there/t.json"), ("again.json", "l.json")):
        (tmp_path / link).symlink_to(to)
    write_text(tmp_path / "again.json", "new")
    assert (
        target.read_text() == "new"
        and (tmp_path / "again.json").is_symlink()
        and (tmp_path / "l.json").is_symlink()
    )
    (tmp_path / "dangling").symlink_to("there/made.json")
    write_text(tmp_path / "dangling", "made")
    assert (tmp_path / "there" / "made.json").read_text() == "made" and (
        tmp_path / "dangling"
    ).is_symlink()
    os.mkfifo(tmp_path / "pipe")
    # /dev/stdout is such a link, to whatever standard output is.
    (tmp_path / "to pipe").symlink_to("pipe")
    got = []
    reader = threading.Thread(target=lambda: got.append((tmp_path / "pipe").read_text()))
    reader.start()
    try:
        write_text(tmp_path / "to pipe", "sent")
    except BadInput:
        # Without this write the reader would wait for ever.
        (tmp_path / "pipe").write_text("")
        raise
    finally:
        reader.join()
    assert got == ["sent"] and (tmp_path / "to pipe").is_symlink()
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(BadInput, match="circle"):
        write_text(tmp_path / "loop", "x")


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o755])
def test_the_mode_of_a_file_is_kept(tmp_path, mode):
    path = tmp_path / "m.json"
    path.write_text("earlier")
    path.chmod(mode)
    write_text(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == mode and path.read_text() == "new"


@pytest.mark.parametrize("mask", [0o077, 0o022, 0o002])
def test_a_new_file_has_the_mode_that_the_umask_leaves(tmp_path, mask):
    before = os.umask(mask)
    try:
        write_text(tmp_path / "m.json", "new")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "m.json").stat().st_mode) == 0o666 & ~mask


def test_a_pipe_is_written_to_and_read(tmp_path):
    pipe = tmp_path / "p"
    os.mkfifo(pipe)
    # A pipe holds less than this text.
    got, text = [], "x" * 300_000
    reader = threading.Thread(target=lambda: got.append(pipe.read_text()))
    reader.start()
    write_text(pipe, text)
    reader.join()
    assert got == [text] and pipe.is_fifo()
    writer = threading.Thread(target=lambda: pipe.write_text(text))
    writer.start()
    assert read_bytes(pipe, len(text), "a file") == text.encode()
    writer.join()


def test_a_file_that_standard_output_goes_to_keeps_what_is_printed(tmp_path):
    code = (
        "from pathlib import Path; from drumlin.base.files import write_text; print('first', "
        "flush=True);"
        "write_text(Path('out'), 'written\\n'); print('last')"
    )
    with (tmp_path / "out").open("wb") as out:
        subprocess.run([sys.executable, "-c", code], stdout=out, cwd=tmp_path, check=True)
    assert (tmp_path / "out").read_text() == "first\nwritten\nlast\n"


def test_a_stopped_run_leaves_the_earlier_file_and_no_other(tmp_path):
    path = tmp_path / "r.json"
    path.write_text("earlier")
    for error in (StoppedBySignal(15), KeyboardInterrupt(), ValueError()):
        with pytest.raises(type(error)), temporary_file_replacing_output(path) as partial:
            partial.write_text("half")
            raise error
    assert path.read_text() == "earlier" and picked(tmp_path.iterdir(), "name") == ["r.json"]


FOLDERS = {
    "a folder": "sub",
    "below a file": "b.json/x.json",
    "NUL": "a\0b",
    "too long": "x" * 300,
    "no name": "",
}


@pytest.mark.parametrize("case", FOLDERS)
def test_what_cannot_be_written_is_one_line(tmp_path, monkeypatch, case):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    (tmp_path / "b.json").write_text("")
    with pytest.raises(BadInput, match="cannot be written"):
        write_text(Path(FOLDERS[case]), "x")
    assert sorted(picked(tmp_path.iterdir(), "name")) == ["b.json", "sub"]


def test_two_outputs_need_two_files_and_a_folder_no_file(tmp_path):
    (tmp_path / "l.json").symlink_to("r.json")
    with pytest.raises(BadInput, match="twice"):
        check_output_files_are_writable(tmp_path / "r.json", None, tmp_path / "l.json")
    check_output_files_are_writable(tmp_path / "r.json", tmp_path / "s.json")
    (tmp_path / "f").write_text("")
    for path in (tmp_path / "f", tmp_path / "f" / "below"):
        with pytest.raises(BadInput, match="not a folder"):
            check_path_can_be_folder(path)
    check_path_can_be_folder(tmp_path / "new" / "below")


# inputs


@pytest.mark.parametrize(
    "spelling", ["b.json", "./b.json", "sub/../b.json", "link.json", "hard.json"]
)
def test_no_output_is_an_input_however_it_is_spelled(tmp_path, monkeypatch, spelling):
    monkeypatch.chdir(tmp_path)
    text = (STUDY / "brake.toml").read_text()
    (tmp_path / "b.json").write_text(text)
    (tmp_path / "sub").mkdir()
    (tmp_path / "link.json").symlink_to("b.json")
    (tmp_path / "hard.json").hardlink_to("b.json")
    for words in (
        ["solve", "b.json", "--json"],
        ["solve", "b.json", "--pressure"],
        ["sensitivity", "b.json", "--json"],
    ):
        with pytest.raises(
            BadInput, match="one of the files that are read; must not be written over"
        ):
            run_command_line([*words, spelling])
    assert (tmp_path / "b.json").read_text() == text


def test_no_output_is_the_mesh_even_of_a_model_that_reads_none(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (
        (STUDY / "brake.toml").read_text().replace('name = "left"', 'name = "left"\nmesh = "m.msh"')
    )
    (tmp_path / "b.toml").write_text(text)
    (tmp_path / "m.msh").write_text("mesh")
    with pytest.raises(BadInput, match="must not be written over"):
        run_command_line(["solve", "b.toml", "--model", "sine", "--json", "m.msh"])
    assert (tmp_path / "m.msh").read_text() == "mesh"


def test_outside_of_the_command_line_what_was_read_may_be_written(tmp_path):
    path = tmp_path / "r.json"
    path.write_text("read")
    read_text(path, 100, "a file")
    write_text(path, "written")
    with protect_input_files_within_block():
        read_text(path, 100, "a file")
        with pytest.raises(BadInput, match="must not be written over"):
            write_text(path, "again")
    assert path.read_text() == "written"


# reading


def test_files_are_limited_and_utf_8_in_every_locale(tmp_path):
    (tmp_path / "long").write_bytes(b"x" * 11)
    with pytest.raises(BadInput, match="larger than 10 bytes; not a brake file"):
        read_bytes(tmp_path / "long", 10, "a brake file")
    assert read_bytes(tmp_path / "long", 11, "a brake file") == b"x" * 11
    zero = node(tmp_path / "zero", stat.S_IFCHR, 5)
    with pytest.raises(BadInput, match="larger than"):
        read_bytes(zero, 1000, "a brake file")
    (tmp_path / "bom").write_bytes("\ufeffλ\r\n".encode())
    assert read_text(tmp_path / "bom", 100, "a text") == "λ\n"
    (tmp_path / "latin").write_bytes(b"\xe9")
    with pytest.raises(BadInput, match=r"no UTF-8 text \(.* at byte 0\)"):
        read_text(tmp_path / "latin", 100, "a text")
    for name in ("none", "a\0b", "x" * 5000, "."):
        with pytest.raises(BadInput, match="cannot be read"):
            read_bytes(tmp_path / name, 100, "a text")


@contextmanager
def within(seconds):
    """Fail where the block takes longer: what waits for a pipe would wait for ever."""

    def late(number, frame):
        raise AssertionError(f"takes longer than {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def no_mesh(kind, path):
    """A file of a kind that is no mesh, at `path`; what is said of it."""
    if kind == "pipe":
        os.mkfifo(path)
        return "is a pipe or a device|is not a mesh"
    if kind == "folder":
        path.mkdir()
        return "Is a directory|is not a mesh"
    if kind == "200 GB":
        with path.open("wb") as file:
            # A file system with sparse files takes no byte of the disk for this.
            file.truncate(200 * 10**9)
        return "larger than 50000000 bytes"
    if not Path(kind).exists():
        pytest.skip(f"there is no {kind} here")
    path.symlink_to(kind)
    return "is empty|is a pipe or a device|is not a mesh"


KINDS = ["pipe", "folder", "200 GB", "/dev/zero", "/proc/self/mem", "/proc/kmsg"]


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_no_mesh_is_refused_at_once(tmp_path, monkeypatch, kind):
    """By solve, by a sweep of the brake, and by a sweep that varies the mesh."""
    monkeypatch.chdir(tmp_path)
    said = no_mesh(kind, tmp_path / "m.msh")
    brake = (STUDY / "brake.toml").read_text()
    (tmp_path / "whole.toml").write_text(brake)
    (tmp_path / "b.toml").write_text(
        brake.replace('name = "left"', 'name = "left"\nmesh = "m.msh"')
    )
    (tmp_path / "s.toml").write_text('brake = "b.toml"\n[vary]\nfriction = [0.1, 0.2]\n')
    (tmp_path / "t.toml").write_text('brake = "whole.toml"\n[vary]\n"shoe[0].mesh" = ["m.msh"]\n')
    for words in (
        ["solve", "b.toml"],
        ["sweep", "s.toml", "--jobs", "1"],
        ["sweep", "t.toml", "--jobs", "1"],
    ):
        with pytest.raises(BadInput, match=rf"m\.msh.*({said})"), within(10):
            start = time.process_time()
            run_command_line(words)
        # The libraries are loaded within this time as well.
        assert time.process_time() - start < 1.5


# texts


def test_a_page_shows_what_was_typed_without_the_machine_s_folders():
    words = [
        "drumlin",
        "compare",
        "/home/x/b <i>.toml",
        "--output=/srv/r",
        "--penalty",
        "1e5",
        "a/b.toml",
        "x\n",
        "",
    ]
    assert (
        command_text_without_folders(words)
        == "drumlin compare 'b <i>.toml' --output=r --penalty 1e5 a/b.toml 'x\\n' ''"
    )


def test_lines_for_people_are_printable_and_short():
    assert printable_single_line("a\nb\x1b[31m\u202e\udcff\x85") == r"a\nb\x1b[31m\u202e\udcff\x85"
    assert printable_single_line("θ µ 漢字 ü") == "θ µ 漢字 ü"
    long = printable_single_line("key = " + "9" * 10_000 + ": must be a number")
    assert len(long) < 700 and long.startswith("key = 9") and long.endswith(": must be a number")
    assert str(BadInput("a\nb")) == r"a\nb"


def test_texts_are_limited_before_a_parser_sees_them():
    check_numbers_have_few_digits("9" * MAX_CONSECUTIVE_DIGITS_OF_NUMBER)
    assert math.isfinite(float(int("9" * MAX_CONSECUTIVE_DIGITS_OF_NUMBER)))
    with pytest.raises(OverflowError):
        float(10 ** (MAX_CONSECUTIVE_DIGITS_OF_NUMBER + 1))
    for text in (
        "9" * (MAX_CONSECUTIVE_DIGITS_OF_NUMBER + 1),
        "x = 1" + "_1" * MAX_CONSECUTIVE_DIGITS_OF_NUMBER,
    ):
        with pytest.raises(ValueError, match="digits"):
            check_numbers_have_few_digits(text)
    check_toml_parses_quickly("# " + "." * 1000 + '\na.b."c.d" = ["1.5 mm", 2.5]\n')
    for key in (
        "a." * 20 + "a",
        "'a' . " * 20 + "a",
        '"=" .' * 20 + "a",
        "[" + "a." * 20_000 + "a]",
        "{x." + "a." * 20 + "a}",
    ):
        with pytest.raises(ValueError, match="parts"):
            check_toml_parses_quickly(key + " = 1")


@pytest.mark.parametrize(
    "text", ["=1+1", "+cmd|' /C calc'!A0", "-2+3+cmd|x", "@SUM(1)", "\t=1", "\r=1", "-x"]
)
def test_a_text_that_a_spreadsheet_would_compute_is_led_by_an_apostrophe(text):
    assert spreadsheet_cell_safe_from_being_run_as_formula(text) == f"'{text}"


@pytest.mark.parametrize(
    "value", ["-70 to 55.1", "-1e-05", "+3", "-70", "a=1", "", -3.5, None, "failed: -"]
)
def test_numbers_and_harmless_texts_are_cells_as_they_are(value):
    assert spreadsheet_cell_safe_from_being_run_as_formula(value) == value


# the last word of a process

ENDS = {
    "bad input": (BadInput("x"), "x", 2),
    "no answer": (NoAnswer("x"), "x", 3),
    "signal": (StoppedBySignal(15), "stopped by a signal", 143),
    "Ctrl-C": (KeyboardInterrupt(), "stopped", 130),
    "reader gone": (BrokenPipeError(), "", 141),
    "memory": (MemoryError(), "not enough memory", 3),
    "package": (
        ModuleNotFoundError("x", name="matplotlib"),
        "needs the package 'matplotlib', which is not installed",
        3,
    ),
    "disk": (OSError(28, "No space left on device", "f"), "f: No space left on device", 3),
    "handles": (OSError(24, "Too many open files"), "Too many open files", 3),
    "folder": (IsADirectoryError(21, "Is a directory", "f\n"), r"f\n: Is a directory", 2),
    "fault": (
        ZeroDivisionError("x"),
        "unexpected ZeroDivisionError: x; a fault of drumlin, please report it",
        1,
    ),
}


@pytest.mark.parametrize("case", ENDS)
def test_every_exception_ends_in_one_line_and_a_status(capsys, case):
    error, line, status = ENDS[case]
    assert error_line_and_exit_status(error) == (line, status)

    def run_it():
        raise error

    assert call_function_and_return_exit_status(run_it) == status
    said = capsys.readouterr().err
    assert said.count("\n") == (1 if line else 0) and (not line or said.startswith("drumlin: "))


def test_notes_of_a_stop_are_said():
    stop = KeyboardInterrupt()
    stop.add_note("5 cases are kept")
    assert error_line_and_exit_status(stop) == ("stopped; 5 cases are kept", 130)


def test_the_handler_loads_nothing_heavy():
    code = (
        "import sys; import drumlin.cli.process; print({'typer', 'numpy', 'pydantic', "
        "'rich'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
