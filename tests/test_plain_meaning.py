"""Arguments whose meaning is plain are taken, and others are refused in a line with the cause."""

import copy
import dataclasses
import math
import pickle
import re
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import drumlin
from command_line import drumlin as run
from drumlin.models import MODELS, NAMES_OF_BUILT_IN_MODELS
from drumlin.response.show import matplotlib_axes_itself_or_new


@pytest.fixture
def laws():
    """The registered models, which are as they were after the test."""
    yield MODELS
    for name in set(MODELS) - NAMES_OF_BUILT_IN_MODELS:
        del MODELS[name]


@pytest.fixture
def brake_file(tmp_path, monkeypatch):
    """The name of a brake file in an empty folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text(run("init", "double_shoe").stdout)
    return "my.toml"


def test_a_shoe_of_a_response_is_found_by_its_name(brake):
    response = drumlin.solve(brake, "sine")
    names = [shoe.name for shoe in response.shoes]
    assert [response.shoes[name] for name in names] == list(response.shoes)
    assert response.shoes[1:] == (response.shoes[names[1]],)
    said = r"^shoe = 'lft': no such shoe \(did you mean 'left'\?\); allowed: right, left$"
    with pytest.raises(drumlin.BadInput, match=said):
        response.shoes["lft"]
    # Copies of the response keep the names.
    copies = (
        pickle.loads(pickle.dumps(response)),
        copy.deepcopy(response),
        dataclasses.replace(response, shoes=tuple(response.shoes)),
    )
    for copied in copies:
        assert copied == response
        assert copied.shoes["left"] == response.shoes["left"]


def test_a_number_of_another_type_is_the_same_number(brake):
    expected = drumlin.solve(brake, elements=6, penalty=12.5)
    for elements in (6.0, np.float64(6), np.array(6), Fraction(6), Decimal("6.0")):
        assert drumlin.solve(brake, elements=elements, penalty=12.5) == expected
    for penalty in (Fraction(25, 2), Decimal("12.5"), np.float32(12.5)):
        assert drumlin.solve(brake, elements=6, penalty=penalty) == expected
    for wrong in (6.5, math.inf, math.nan, "6", np.array([6]), Fraction(13, 2), Fraction(10**400)):
        with pytest.raises(drumlin.BadInput, match=r"^elements = .*: must be a whole number or "):
            drumlin.solve(brake, elements=wrong)
    with pytest.raises(drumlin.BadInput, match=r"^most = -0.333333: must be greater than 0"):
        drumlin.self_locking(brake, most=Fraction(-1, 3))


def test_one_and_zero_are_truth_values(brake):
    worn = drumlin.solve(brake, elements=6, worn_in=True)
    assert drumlin.solve(brake, elements=6, worn_in=1) == worn
    assert drumlin.solve(brake, elements=6, worn_in=0.0) == drumlin.solve(brake, elements=6)
    for wrong in (2, 0.5, None, "1"):
        with pytest.raises(drumlin.BadInput, match=r"^worn_in = .*: must be True or False$"):
            drumlin.solve(brake, worn_in=wrong)


def test_a_set_of_models_is_a_list_in_the_order_of_the_alphabet(brake):
    names = {"uniform", "sine", "block"}
    expected = drumlin.compare(brake, models=sorted(names))
    for given in (names, frozenset(names), dict.fromkeys(names).keys()):
        assert drumlin.compare(brake, models=given) == expected
    swept = drumlin.sweep(brake, {"friction": [0.3]}, model=names)
    assert [row["model"] for row in swept] == sorted(names)
    for wrong in ({"sine", 5}, (name for name in names)):
        with pytest.raises(drumlin.BadInput, match=r"^models = .*: must be a list of texts or No"):
            drumlin.compare(brake, models=wrong)


@pytest.mark.parametrize("turn", [math.nextafter(2 * math.pi, 7), 6.28319, -6.2831853072])
def test_a_turn_that_is_rounded_up_is_a_turn(brake, turn):
    assert drumlin.hold(brake, elements=6, steps=1, rotation=turn).states[-1].rotation == turn
    with pytest.raises(drumlin.BadInput, match=r"must be at most 360 deg to either side$"):
        drumlin.hold(brake, elements=6, steps=1, rotation=math.copysign(6.2832, turn))


@pytest.mark.parametrize("changes", [None, 5, [("friction", 0.3)], "friction"])
def test_changes_of_a_brake_are_a_dict(brake, changes):
    said = f"^changes = {re.escape(repr(changes))}: must be a dict of new values by key, such as "
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.vary(brake, changes)


@pytest.mark.parametrize("key", ["[0].force", "shoe[].hinge.angle", "", ".", "friction.", 5])
def test_a_key_without_a_name_is_refused_with_the_form_of_keys(brake, key):
    said = f"^key = {re.escape(repr(key))}: must be names joined by dots, with an index only behin"
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.vary(brake, {key: 1.0})
    if isinstance(key, str):
        with pytest.raises(drumlin.BadInput, match=said):
            drumlin.size(brake, key, torque=400.0)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("shoe[0]", "is an entry of a list; allowed: a key of it, such as 'shoe[0].name', or the"),
        ("shoe.left.lining.clearance[0]", "is an entry of a list; allowed: the whole list"),
        ("shoe[5].lining.width", "there is no number 5; allowed: 0 to 1"),
    ],
)
def test_a_key_of_an_entry_names_what_is_allowed(brake, key, said):
    table = [["130 deg", "0 mm"], ["240 deg", "0.01 mm"]]
    with pytest.raises(drumlin.BadInput, match=re.escape(f"{key}: {said}")):
        drumlin.vary(brake, {"shoe.left.lining.clearance": table, key: 3})


def test_plots_take_axes_of_matplotlib_alone(brake):
    plots = (
        drumlin.solve(brake, "sine").plot,
        drumlin.compare(brake, models=["sine"]).plot,
        drumlin.sweep(brake, {"friction": [0.3, 0.4]}, model="sine").plot,
    )
    for plot in plots:
        for wrong in (5, [5], "new"):
            said = f"^axes = {re.escape(repr(wrong))}: must be one axes of matplotlib, or None$"
            with pytest.raises(drumlin.BadInput, match=said):
                plot(axes=wrong)


def test_curves_are_drawn_beside_a_line_without_points(brake):
    axes = matplotlib_axes_itself_or_new(None)
    axes.plot([], [], label="measured")
    assert len(drumlin.solve(brake, "sine").plot(axes).lines) == 3


def test_a_function_of_numpy_with_one_argument_is_no_law(laws):
    asked = "^law 'wrong': must be a function of two arguments, .*; it is <ufunc 'sin'>, a function"
    with pytest.raises(drumlin.BadInput, match=asked):
        drumlin.law("wrong")(np.sin)
    assert "wrong" not in laws


RETURNED_BY_WRONG_LAWS = {
    "function": (lambda phi, layout: np.sin, r"returned <ufunc 'sin'>$"),
    "text": (lambda phi, layout: "0.5", r"returned '0\.5'$"),
    "nothing": (lambda phi, layout: None, r"returned None$"),
    "complex": (lambda phi, layout: 1 + 1j, r"returned \(1\+1j\)$"),
    "ragged": (lambda phi, layout: [[1.0], [1.0, 2.0]], r"returned \[\[1\.0\], \[1\.0, 2\.0\]\]$"),
    "raised": (
        lambda phi, layout: phi / layout.radius_of_hinge,
        r"failed with AttributeError: .*radius_of_hinge.* \(test_plain_meaning\.py, line \d+\); ",
    ),
}


@pytest.mark.filterwarnings("ignore::numpy.exceptions.ComplexWarning")
@pytest.mark.parametrize("wrong", RETURNED_BY_WRONG_LAWS)
def test_a_law_that_returns_no_numbers_is_refused_in_a_line(brake, laws, wrong):
    shape, said = RETURNED_BY_WRONG_LAWS[wrong]
    drumlin.law("wrong")(shape)
    asked = "^law 'wrong': its function must return a finite number for each angle; it "
    with pytest.raises(drumlin.BadInput, match=asked + said):
        drumlin.solve(brake, "wrong")


def test_export_writes_for_the_only_program_that_it_knows(brake_file, tmp_path):
    done = run("export", brake_file, "--elements", "6")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "my_left.inp").is_file() and (tmp_path / "my_right.inp").is_file()


READ_NUMBERS = {
    "--elements": ("6.0", "6,0", " 6"),
    "--tolerance": ("0,01", "1 %", "1/100"),
    "--penalty": ("12,5", "1250 %", "25/2"),
}


@pytest.mark.parametrize("option", READ_NUMBERS)
def test_numbers_of_options_are_read_as_people_write_them(brake_file, option):
    plain = {"--elements": "6", "--tolerance": "0.01", "--penalty": "12.5"}[option]
    few = ("--elements", "6") if option == "--penalty" else ()
    lines = run("solve", brake_file, *few, option, plain).stdout
    assert "torque" in lines
    for written in READ_NUMBERS[option]:
        assert run("solve", brake_file, *few, option, written).stdout == lines


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("solve my.toml --elements 1_0", "'1_0': must be a whole number without underscores"),
        ("solve my.toml --elements 6.5", "'6.5': must be a whole number"),
        ("solve my.toml --elements 1e3", "'1e3': must be a whole number"),
        ("solve my.toml --tolerance 1_0", "'1_0': must be a number without underscores"),
        ("solve my.toml --tolerance 0x1", "'0x1': must be a number"),
        ("solve my.toml --penalty 1_0", "'1_0': must be a number greater than 0, or inf"),
        ("solve my.toml --penalty 1,500", "'1,500': must have a decimal point: 1,500 may be 1.50"),
        ("wear my.toml --exponent inf", "'inf': must be a number"),
        ("wear my.toml --reverse 1_0", "'1_0': must be a length: a number and its unit"),
        ("wear my.toml --reverse 1,500", "'1,500': must have a decimal point: 1,500 may be 1.50"),
        ("wear my.toml --reverse inf", "'inf': must be finite"),
        ("wear my.toml --distance nan", "'nan': must be finite"),
        ("hold my.toml --steps many", "'many': must be a whole number"),
    ],
)
def test_other_numbers_of_options_are_refused_with_the_cause(brake_file, words, said):
    done = run(*words.split())
    assert done.returncode == 2
    assert done.stderr.startswith(f"drumlin: {words.split()[2]} = {said}")


def test_the_range_of_a_wear_law_is_checked_before_the_brake_is_solved(brake):
    for exponent in (math.inf, 0.2, 5.0, math.nan):
        with pytest.raises(drumlin.BadInput, match=r"^exponent = .*: must be from 0\.3 to 4$"):
            drumlin.wear(brake, exponent=exponent)
    with pytest.raises(drumlin.BadInput, match=r"^coefficient = inf: must not be negative, and f"):
        drumlin.wear(brake, coefficient=math.inf, distance=1.0)
    with pytest.raises(drumlin.BadInput, match=r"^reverse = inf: must be finite$"):
        drumlin.wear(brake, elements=6, reverse=math.inf, distance=1.0)
