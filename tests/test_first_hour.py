"""The first hour from an empty folder: results as text, sweeps, laws of one's own, wrong arguments.

Each test is of something that stopped a person who was new to drumlin.
"""

import copy
import math
import pickle
import re
import sys
import traceback
import types
from pathlib import Path

import meshio
import numpy as np
import pytest

import drumlin
from command_line import drumlin as run
from conftest import ROOT, partly
from drumlin.base.arrays import are_nested_values_with_arrays_equal
from drumlin.base.texts import error_text_in_percent
from drumlin.cli.solving import _BrakeWithResponseOrFailure
from drumlin.fem import solve as fem_solve
from drumlin.fem.error_control.adapt import solve_brake_to_tolerance
from drumlin.models import MODELS, NAMES_OF_BUILT_IN_MODELS
from drumlin.studies import OPTIONAL_PACKAGE_BY_STUDY_NAME, paths_of_all_examples
from drumlin.sweeps.sweep_table import SweepTable
from drumlin.verification.reference_file import read_reference_file


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, which is the current one and has the brake file my.toml."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text(run("init", "double_shoe").stdout)
    return tmp_path


@pytest.fixture
def laws():
    """The registered models, which are as they were after the test."""
    yield MODELS
    for name in set(MODELS) - NAMES_OF_BUILT_IN_MODELS:
        del MODELS[name]


# From Python: paths, equality, what is shown.


def test_a_path_serves_as_well_as_a_brake(here):
    brake = drumlin.read_brake("my.toml")
    assert drumlin.solve("my.toml", "sine") == drumlin.solve(brake, "sine")
    assert drumlin.compare("my.toml", models=["sine"]) == drumlin.compare(brake, models=["sine"])
    table = drumlin.sweep("my.toml", {"friction": [0.3]}, model="sine")
    assert table == drumlin.sweep(brake, {"friction": [0.3]}, model="sine")
    for wrong in (None, {"shoe": []}, 3):
        said = f"path of a brake file, not {type(wrong).__name__}"
        with pytest.raises(drumlin.BadInput, match=said):
            drumlin.solve(wrong)


def test_answers_are_equal_if_all_their_numbers_are(brake):
    sine, other = drumlin.solve(brake, "sine"), drumlin.solve(brake, "cosine")
    assert sine == drumlin.solve(brake, "sine") != other
    assert sine.shoes[0] != sine.shoes[1] and sine != "sine"
    right, left = drumlin.fields(brake, elements=6)
    assert right == drumlin.fields(brake, elements=6)[0] != left
    run = drumlin.hold(brake, elements=6, steps=1)
    assert run == drumlin.hold(brake, elements=6, steps=1) and run.states[0] != run.states[1]
    zeros = np.zeros(2)
    assert are_nested_values_with_arrays_equal({"a": (zeros, 1)}, {"a": (zeros, 1)})
    for unequal in ({"a": (zeros, 2)}, {"b": (zeros, 1)}, {"a": (np.zeros(3), 1)}, {"a": (zeros,)}):
        assert not are_nested_values_with_arrays_equal({"a": (zeros, 1)}, unequal)


def test_results_of_every_analysis_show_what_the_terminal_prints(brake):
    """The text of a run in Python holds the terminal's lines, and no arrays of the run."""
    worn = drumlin.wear(brake, elements=6, distance=10.0)
    held = drumlin.hold(brake, elements=6, steps=2)
    slopes = drumlin.sensitivity(brake, elements=6)
    sized = drumlin.size(brake, "shoe.actuation.force", torque=400.0, model="sine")
    for shown, word in (
        (worn, "worn in (law): torque 435.2"),
        (held, "holds up to "),
        (slopes, "S = (mu/T) dT/dmu = "),
        (sized, "shoe.actuation.force = 1838."),
    ):
        lines = repr(shown).splitlines()
        assert len(lines) < 40 and max(map(len, lines)) < 160
        assert word in repr(shown) and "array(" not in repr(shown)
    assert repr(worn) == "\n".join(worn.lines())
    assert repr(held).splitlines() == [brake.title, *held.lines()]
    assert repr(sized).endswith(repr(sized.response))
    assert "brake" not in slopes.as_dict()


def test_parts_of_results_show_no_arrays(brake):
    """Shapes stand in place of arrays; a body with its fields has a line on its largest values."""
    response = drumlin.solve(brake, elements=6)
    state = drumlin.hold(brake, elements=6, steps=2).states[1]
    worn = drumlin.wear(brake, elements=6, distance=10.0).states[0]
    for shown in (response.shoes[0], state, worn):
        text = repr(shown)
        assert "\n" not in text and f"pressure={shapes(shown.pressure)}" in text
        assert text.startswith(f"{type(shown).__name__}(") and len(text) < 2000
    assert "ContactNodesOfHeldLiningFace(z=array(1,), pressure=array(13, 1)" in repr(state)
    body = drumlin.fields(brake, elements=6)[0]
    assert repr(body) == (
        f"right: {len(body.points)} nodes, {len(body.cells)} cells quad, displacement up to "
        f"{1e3 * np.hypot(*body.displacement.T).max():.3g} mm, von Mises stress up to "
        f"{body.von_mises.max() / 1e6:.3g} MPa"
    )


def shapes(value):
    """The text of an array, or of a tuple of arrays, by their shapes."""
    if isinstance(value, tuple):
        return f"({', '.join(map(shapes, value))})"
    return f"array{value.shape}"


def test_reference_values_show_their_uncertainties():
    brake = drumlin.example("duplex")
    lines = repr(
        read_reference_file(ROOT / "reports/reference/values/brakes_duplex.json")
    ).splitlines()
    assert re.match(rf"{brake.title}: torque 403\.9\d+ \+- \de-\d+ N m$", lines[0])
    assert re.match(r"right: torque 201\.9\d+ \+- .* N m, peak pressure 2\.48\d+ \+-", lines[1])
    assert len(lines) == 1 + len(brake.shoes)


def test_what_is_shown_is_short(brake):
    compared = drumlin.compare(brake, models=["sine", "cosine"])
    table = drumlin.sweep(brake, {"friction": [0.2, 0.3, 0.9]}, model="sine")
    for shown in (brake, drumlin.solve(brake, "sine"), compared, table):
        assert len(repr(shown).splitlines()) < 20 and max(map(len, repr(shown).splitlines())) < 160
        assert shown._repr_html_().startswith("<table><caption>")
    assert repr(brake).splitlines()[2].split() == [
        *("right", "-70", "to", "55", "8", "40", "2000", "hinge")
    ]
    assert "435.22" in repr(compared) and "458.73" in repr(compared)
    assert len(compared.plot().lines) == 4


def test_plots_cut_the_unbounded_pressure_at_sharp_edges(brake):
    """The axis ends above the largest peak of all models, not at the largest number drawn."""
    compared = drumlin.compare(brake, models=["fem", "sine"])
    peaks = [1e-6 * shoe.peak_pressure for one in compared.responses.values() for shoe in one.shoes]
    axes = compared.plot()
    assert axes.get_ylim() == pytest.approx((0, 1.12 * max(peaks)))
    assert max(line.get_ydata().max() for line in axes.lines) > 1.5 * max(peaks)
    # Axes that show a higher curve already keep it.
    axes.figure.clear()
    axes = axes.figure.subplots()
    axes.plot([0.0, 1.0], [0.0, 30.0])
    assert compared.plot(axes).get_ylim()[1] >= 30


def test_a_comparison_of_own_brakes_shows_planes_too():
    pad = drumlin.example("pad")
    assert "60 to 180" in repr(pad) and "braking force [N]" in repr(
        drumlin.compare(pad, models=["linear"])
    )


# Arrays and functions as values of keys.


@pytest.mark.slow
def test_an_array_and_a_function_are_a_clearance(brake):
    """A parabola touches at one angle; twice as many rows change the torque by less than 1e-5."""

    def gap(theta):
        return 1e-5 * theta**2

    key = "shoe.right.lining.clearance"
    given = drumlin.vary(brake, {key: gap})
    lining = given.shoes[0].lining
    theta = np.linspace(lining.start, lining.end, 2001)
    at = lining.clearances_at_surface_coordinates(theta)
    assert np.abs(at - gap(theta)).max() < 1e-6 * at.max()
    finer = drumlin.vary(brake, {key: np.column_stack([theta, gap(theta)])})
    assert drumlin.solve(given).torque == pytest.approx(drumlin.solve(finer).torque, rel=1e-5)
    for wrong, said in (
        (np.zeros((3, 3)), r"has? .*shape \(3, 3\); must have the shape \(N, 2\)"),
        (lambda theta: None, "must be a function from a number to a number"),
        (lambda theta: math.nan, "must be finite"),
    ):
        with pytest.raises(drumlin.BadInput, match=said.replace("has? ", "is an array ")):
            drumlin.vary(brake, {key: wrong})


@pytest.mark.slow
def test_an_array_and_a_function_are_a_friction(brake):
    """The uniform law has one pressure a shoe: its friction is the function at this pressure."""

    def mu(p):
        return 0.4 / (1 + p / 5e6)

    pressures = np.linspace(0, 2e6, 101)
    for given in (mu, np.column_stack([pressures, mu(pressures)])):
        fading = drumlin.vary(brake, {"friction": given})
        response = drumlin.solve(fading, "uniform")
        for shoe in response.shoes:
            ratio = shoe.torque / (0.15 * 0.04 * 0.15 * math.radians(125) * shoe.peak_pressure)
            assert ratio == pytest.approx(mu(shoe.peak_pressure), rel=1e-4)
    assert drumlin.vary(brake, {"friction": lambda p: 0.35}).friction == 0.35
    with pytest.raises(drumlin.BadInput, match="friction: is an array of shape"):
        drumlin.vary(brake, {"friction": np.zeros(3)})


def test_a_brake_that_is_set_in_place_names_the_function_that_varies_it(brake):
    said = (
        r"^friction: a brake cannot be changed; drumlin.vary\(brake, {KEY: VALUE}\) makes another"
    )
    with pytest.raises(drumlin.BadInput, match=said):
        brake.friction = 0.4
    with pytest.raises(drumlin.BadInput, match=r"^thickness: a brake cannot be changed"):
        brake.shoes[0].lining.thickness = 0.01
    assert brake == drumlin.example("double_shoe")
    assert copy.deepcopy(brake) == pickle.loads(pickle.dumps(brake)) == brake


def test_a_function_below_zero_is_refused_with_its_pressure(brake):
    said = (
        r"^friction: the function gives -0\.00\d+ at 15\.\d+ MPa; it must give at least 0\.000001"
    )
    with pytest.raises(drumlin.BadInput, match=said) as refused:
        drumlin.vary(brake, {"friction": lambda p: 0.3 - 0.02e-6 * p})
    # Python shows the line alone, without that of pydantic above it.
    shown = "".join(traceback.format_exception(refused.value))
    assert "pydantic" not in shown and len(shown.splitlines()) < 25
    with pytest.raises(drumlin.BadInput, match="the function gives nan at 0 MPa"):
        drumlin.vary(brake, {"friction": lambda p: math.nan if p == 0 else 0.3})


def test_a_brake_of_arrays_and_functions_has_a_file(brake, here):
    made = drumlin.vary(
        brake, {"shoe.lining.clearance": lambda t: 1e-5, "friction": lambda p: 0.4 - 1e-9 * p}
    )
    drumlin.write_brake(made, "made.toml")
    assert drumlin.read_brake("made.toml") == made


# Sweeps from Python.


def test_a_sweep_from_python_is_a_table_with_columns_by_name(brake, here):
    calls = []
    table = drumlin.sweep(
        brake,
        {"friction": np.array([0.2, 0.3, 0.9]), "shoe.actuation.force": [2000.0, "1 kN"]},
        model=["sine"],
        progress=lambda finished, of: calls.append((finished, of)),
    )
    assert calls[0] == (0, 6) and calls[-1] == (6, 6)
    assert len(table) == 6 and table["friction"].tolist() == [0.2, 0.2, 0.3, 0.3, 0.9, 0.9]
    assert table["shoe.actuation.force"].tolist() == [2000.0, 1000.0] * 3
    torque = drumlin.solve(drumlin.vary(brake, {"friction": 0.2}), "sine").torque
    assert table["torque"][:2] == pytest.approx([torque, torque / 2], rel=1e-12)
    assert np.isnan(table["torque [N m]"][4:]).all() and table["status"][0] == "solved"
    assert table.failures.total() == 2 and "self-locking" in next(iter(table.failures))
    assert [row["case"] for row in table[1:3]] == [1, 2]
    with pytest.raises(drumlin.BadInput, match=r"unknown \(did you mean 'torque'"):
        table["torqe"]
    table.write("table.csv")
    assert len((here / "table.csv").read_text().splitlines()) == 7
    with pytest.raises(drumlin.BadInput, match=r"^output = 'table\.png': must end in"):
        table.write("table.png")


def test_a_table_is_drawn_over_the_key_that_varies(brake):
    table = drumlin.sweep(brake, {"friction": [0.2, 0.3]}, model="sine")
    axes = table.plot()
    assert axes.get_xlabel() == "friction" and axes.get_ylabel().startswith("torque")
    assert axes.lines[0].get_xdata() == pytest.approx([0.2, 0.3], rel=1e-15)
    senses = {"friction": [0.2, 0.3], "rotation": ["clockwise", "counter-clockwise"]}
    # Only one of these keys has numbers.
    assert drumlin.sweep(brake, senses, model="sine").plot().get_xlabel() == "friction"
    both = {"friction": [0.2, 0.3], "drum.radius": [0.15]}
    said = "^x: must name the column to draw over; this sweep varies 'friction', 'drum.radius'$"
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.sweep(brake, both, model="sine").plot()
    with pytest.raises(drumlin.BadInput, match="this sweep varies no key with numbers"):
        drumlin.sweep(brake, {"rotation": ["clockwise"]}, model="sine").plot()


def test_its_statistics_are_those_of_numpy(brake):
    spread = {"distribution": "normal", "deviation": "5 %"}
    table = drumlin.sweep(brake, {"friction": spread}, cases=50, model=["sine", "cosine"])
    torque = table["torque"].reshape(-1, 2)
    for column, found in zip(torque.T, table.statistics("torque"), strict=True):
        assert found.cases == 50
        assert [found.mean, found.deviation] == pytest.approx([column.mean(), column.std(ddof=1)])
        assert [found.low, found.high] == pytest.approx(np.quantile(column, [0.05, 0.95]))
        assert [found.smallest, found.largest] == [column.min(), column.max()]
    peak = [row for row in table.cells_of_statistics() if row[0] == "sine: peak pressure [MPa]"]
    assert float(peak[0][1]) == pytest.approx(table["peak_pressure"][::2].mean() * 1e-6, rel=1e-3)
    table.plot("friction")


def test_a_table_goes_to_pandas(brake):
    table = drumlin.sweep(brake, {"friction": [0.3]}, model="sine")
    try:
        import pandas  # noqa: F401
    except ImportError:
        with pytest.raises(drumlin.BadInput, match="to_pandas: needs the package pandas"):
            table.to_pandas()
    else:
        assert list(table.to_pandas()["torque [N m]"]) == [pytest.approx(435.216, rel=1e-5)]


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        (None, "vary: is missing"),
        ({}, "vary: must be a dict of keys and their values"),
        ({"frction": [1]}, r"vary: frction: unknown key 'frction' \(did you mean 'friction'\?\)"),
        ({"drum.diameter": [0.3]}, "unknown key 'diameter' .write 'radius', half of the diameter."),
        ({"friction": 0.3}, r"vary\['friction'\] = 0.3: must be a list or an array"),
        ({"friction": "0.3"}, r"vary\['friction'\] = '0.3': must be a list or an array"),
        ({"friction": [-1.0]}, "friction = -1"),
        ({"shoe.lining.clearance": [lambda t: t]}, "name one shoe"),
        ({1: [3]}, "vary: has the key 1; a key is a text"),
        (
            {"friction": {"from": np.array([0.3, 0.4]), "to": 1.0, "count": 2}},
            "from: must be a number",
        ),
        (
            {"friction": [np.array([0.3, 0.4]), np.zeros((2, 2, 2))]},
            "friction: is an array of shape",
        ),
    ],
)
def test_wrong_values_of_a_sweep_are_refused(brake, vary, said):
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.sweep(brake, vary, model="sine")


@pytest.mark.parametrize("model", [5, [5], [["fem"]], {5: {}}, {"fem": 5}, []])
def test_wrong_models_of_a_sweep_are_refused(brake, model):
    with pytest.raises(drumlin.BadInput, match=r"^model"):
        drumlin.sweep(brake, {"friction": [0.3]}, model=model)


@pytest.mark.parametrize(
    "given",
    [{"model": "sine"}, {"combine": "zip"}, {"cases": 5}, {"seed": 1}, {"certify": "every 10th"}],
)
def test_a_sweep_file_takes_no_second_word_on_its_keys(here, given):
    (here / "s.toml").write_text('brake = "my.toml"\n[model.sine]\n[vary]\nfriction = [0.3]\n')
    assert len(drumlin.sweep("s.toml")) == 1
    ((name, value),) = given.items()
    with pytest.raises(drumlin.BadInput, match=f"^{name} = {value!r}: belongs to vary"):
        drumlin.sweep("s.toml", **given)


def test_numbers_of_failed_cases_are_not_counted_nor_drawn():
    rows = []
    for torque, status in ((1.0, "solved"), (3.0, "solved"), (1e9, "failed: not converged")):
        rows.append({"model": "fem", "friction": 0.3, "torque [N m]": torque, "status": status})
    table = SweepTable("title", rows, ["friction"])
    (found,) = table.statistics("torque")
    assert found.cases == 2 and found.mean == 2.0 and found.largest == 3.0
    assert np.array_equal(table["torque"], [1.0, 3.0, np.nan], equal_nan=True)
    assert table["friction"].tolist() == [0.3, 0.3, 0.3] and table[2]["torque [N m]"] == 1e9
    assert "1e+09" not in repr(table)
    (line,) = table.plot("friction").lines
    assert line.get_ydata().tolist() == [1.0, 3.0]
    for x, y in (("model", ""), ("friction", "status")):
        with pytest.raises(drumlin.BadInput, match="has texts; only numbers can be drawn"):
            table.plot(x, y)


def test_a_data_frame_has_no_numbers_of_failed_cases(monkeypatch):
    """Its columns are those of the table; a stub stands in for pandas, which few have."""

    class Stub:
        """A data frame that keeps what it was made from."""

        def __init__(self, records, columns):
            self.records, self.columns = records, columns

    monkeypatch.setitem(sys.modules, "pandas", types.SimpleNamespace(DataFrame=Stub))
    rows = []
    for torque, status in ((1.0, "solved"), (1e9, "failed: not converged")):
        rows.append({"model": "fem", "friction": 0.3, "torque [N m]": torque, "status": status})
    table = SweepTable("title", rows, ["friction"])
    frame = table.to_pandas()
    assert frame.columns == table.headings
    for name in ("model", "friction", "torque [N m]", "status"):
        np.testing.assert_array_equal([row[name] for row in frame.records], table[name])
    assert table.rows[1]["torque [N m]"] == 1e9


# Python writes integers of up to some 4300 digits; no floating-point number has 350.
@pytest.mark.parametrize("digits", [350, 5000])
@pytest.mark.parametrize(
    ("where", "call"),
    [
        (r"vary\['friction'\]", lambda b, n: drumlin.sweep(b, {"friction": [0.3, n]})),
        (r"vary\['friction'\]", lambda b, n: drumlin.sweep(b, {"friction": np.array([0.3, n])})),
        ("jobs", lambda b, n: drumlin.sweep(b, {"friction": [0.3]}, jobs=n)),
        (r"model\['fem'\]", lambda b, n: drumlin.sweep(b, {}, model={"fem": {"penalty": n}})),
        ("elements", lambda b, n: drumlin.solve(b, elements=n)),
        ("tolerance", lambda b, n: drumlin.solve(b, tolerance=-n)),
        ("penalty", lambda b, n: drumlin.solve(b, penalty=n)),
        ("across", lambda b, n: drumlin.solve(b, "solid", across=n)),
        ("distance", lambda b, n: drumlin.wear(b, distance=n)),
        ("repeats", lambda b, n: drumlin.compare(b, "", n)),
        ("torque", lambda b, n: drumlin.size(b, "friction", torque=n)),
    ],
)
def test_integers_of_too_many_digits_are_refused_in_one_line(brake, digits, where, call):
    with pytest.raises(drumlin.BadInput, match=f"^{where}.* = .*: must have at most 308 digits$"):
        call(brake, 10**digits)


def test_functions_are_swept(brake):
    gaps = [lambda theta: 0.0, np.array([[-2.0, 1e-5], [2.0, 1e-5]])]
    table = drumlin.sweep(brake, {"shoe.right.lining.clearance": gaps}, model="sine")
    assert table["status"] == ["solved", "solved"]


def test_progress_is_one_line(brake, capsys):
    drumlin.sweep(brake, {"friction": [0.2, 0.3]}, model="sine", progress=True)
    said = capsys.readouterr().err
    assert said.endswith("\r2 of 2 cases, 100 %\n") and said.count("\n") == 1


# From Python: fields, own laws, errors.


def test_fields_are_meshes_of_meshio_and_pyvista(brake):
    right, _ = drumlin.fields(brake, elements=6)
    mesh = right.to_meshio()
    assert isinstance(mesh, meshio.Mesh) and len(mesh.points) == len(right.points)
    assert np.array_equal(mesh.point_data["von Mises [Pa]"], right.von_mises)
    grid = right.to_pyvista()
    assert grid.n_points == len(right.points) and grid.n_cells == len(right.cells)


def test_a_law_of_your_own_is_a_model(brake, laws):
    """The sine law written as a function has the torque and reactions of the closed form."""

    @drumlin.law("my_sine")
    def my_sine(phi, layout):
        """The sine of the angle from the hinge."""
        return 3.0 * np.sin(phi)

    assert my_sine(np.pi / 2, None) == 3.0
    for name in ("double_shoe", "linings_apart", "double_shoe_external"):
        one = drumlin.example(name)
        own, closed = drumlin.solve(one, "my_sine"), drumlin.solve(one, "sine")
        assert own.torque == pytest.approx(closed.torque, rel=1e-12)
        for a, b in zip(own.shoes, closed.shoes, strict=True):
            assert a.hinge_reaction == pytest.approx(b.hinge_reaction, rel=1e-9)
            assert a.peak_pressure == pytest.approx(b.peak_pressure, rel=1e-6)
    compared = drumlin.compare(brake, models=["sine", "my_sine"])
    assert set(compared.responses) == {"sine", "my_sine"}
    assert len(compared.plot().lines) == 4
    assert laws["my_sine"].assumes == "The sine of the angle from the hinge."
    assert drumlin.sweep(brake, {"friction": [0.3]}, model="my_sine")["status"] == ["solved"]
    for jobs in (2, None):
        with pytest.raises(
            drumlin.BadInput, match=rf"^jobs = {jobs}: .*\(my_sine\) is solved with"
        ):
            drumlin.sweep(brake, {"friction": [0.3]}, model=["sine", "my_sine"], jobs=jobs)


@pytest.mark.parametrize(
    ("shape", "error", "said"),
    [
        (lambda phi, layout: -phi, drumlin.NoAnswer, "the lining cannot pull: -.* deg from the"),
        (lambda phi, layout: 0.0, drumlin.NoAnswer, "zero on the whole lining"),
        (lambda phi, layout: [1.0, 2.0], drumlin.BadInput, "returned an array of shape"),
        (
            lambda phi, layout: phi * math.nan,
            drumlin.BadInput,
            "a finite number .* returned nan at",
        ),
    ],
)
def test_a_wrong_law_of_your_own_gives_no_number(brake, laws, shape, error, said):
    drumlin.law("wrong")(shape)
    with pytest.raises(error, match=said):
        drumlin.solve(brake, "wrong")


def test_round_off_below_zero_is_no_pull(brake, laws):
    @drumlin.law("parabola")
    def _(phi, layout):
        x = (2 * phi - layout.phi_1 - layout.phi_2) / (layout.phi_2 - layout.phi_1)
        return 1 - x**2 - 1e-15

    drumlin.law("safe")(
        lambda phi, layout: (layout.phi_2 - phi).clip(0) * (phi - layout.phi_1).clip(0)
    )
    found = [drumlin.solve(brake, name).torque for name in ("parabola", "safe")]
    assert found[0] == pytest.approx(found[1], rel=1e-9)


def test_a_comparison_of_named_models_names_all_of_them(brake):
    with pytest.raises(drumlin.BadInput, match=r"^models = 'sin': unknown model \(did you mean"):
        drumlin.compare(brake, models=["sin"])
    compared = drumlin.compare(brake, models=["sine", "pivoted"])
    failures = {outcome.model: outcome.failure for outcome in compared.outcomes}
    assert failures["sine"] == "" and failures["pivoted"].startswith("does not apply: ")


def test_a_law_of_your_own_takes_no_name_of_drumlin(laws):
    for name in ("sine", "fem", "two words", ""):
        with pytest.raises(drumlin.BadInput, match=f"^name = {name!r}: must be a word"):
            drumlin.law(name)
    # The name of a decorator without brackets is the decorated function.
    for forgotten in (5, len):
        with pytest.raises(drumlin.BadInput, match="must be a word"):
            drumlin.law(forgotten)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda phi: phi, r"its arguments are \(phi\)"),
        (lambda phi, layout, more: phi, r"its arguments are \(phi, layout, more\)"),
        ("sine", "it is 'sine'"),
    ],
)
def test_a_law_of_your_own_takes_angles_and_layout(laws, function, said):
    asked = "^law 'wrong': must be a function of two arguments, the angles phi from the hinge and "
    with pytest.raises(drumlin.BadInput, match=f"{asked}.*def shape.phi, layout.; {said}$"):
        drumlin.law("wrong")(function)
    assert "wrong" not in laws
    # Further arguments with a default, and functions that do not tell their arguments, pass.
    drumlin.law("right")(lambda phi, layout, power=2: np.sin(phi) ** power)
    drumlin.law("max")(max)


WRONG_TYPES = {
    "whole number": ("solve", {"elements": True}, "elements = True: must be a whole number or No"),
    "half": ("solve", {"elements": 1.5}, "elements = 1.5: must be a whole number or None"),
    "number": ("self_locking", {"most": "x"}, "most = 'x': must be a number or None"),
    "truth": ("solve", {"finite_width": "no"}, "finite_width = 'no': must be True or False"),
    "text": ("size", {"key": 5, "torque": 1.0}, "key = 5: must be a text"),
    "path": ("solve", {"fields": 5}, "fields = 5: must be a path, a text or None"),
    "list": ("compare", {"models": "sine"}, "models = 'sine': must be a list of texts or None"),
    "entry": ("compare", {"models": [5]}, "models = [5]: must be a list of texts or None"),
    "quantity": ("wear", {"torque": [1.0]}, "torque = [1.0]: must be a number, a text or None"),
    "name": ("solve", {"model": None}, "model = None: unknown model (did you mean 'cosine'?); al"),
    "allowed": ("solve", {"kind": 5}, "kind = 5: unknown kind of mesh; allowed: quad2, quad1,"),
    "names": ("solve", {"model": ["sine"]}, "model = ['sine']: must be a text"),
    "several": (
        "solve",
        {"worn_in": np.array([True, False])},
        "worn_in = array([ True, False]): m",
    ),
    "no repeats": ("compare", {"repeats": 0}, "repeats = 0: must be at least 1"),
}


@pytest.mark.parametrize("wrong", WRONG_TYPES)
def test_a_value_of_another_type_is_refused_in_a_line(brake, wrong):
    call, options, said = WRONG_TYPES[wrong]
    with pytest.raises(drumlin.BadInput, match=f"^{re.escape(said)}"):
        getattr(drumlin, call)(brake, **options)


def test_numbers_of_numpy_are_numbers(brake):
    options = {"elements": np.int64(6), "penalty": np.float64(64), "worn_in": np.bool_(False)}
    assert drumlin.solve(brake, **options) == drumlin.solve(brake, elements=6, penalty=64.0)
    # An integer serves as a float, and so does an array without dimensions.
    assert drumlin.solve(brake, elements=6, penalty=64) == drumlin.solve(brake, **options)
    assert drumlin.solve(brake, **options | {"penalty": np.array(64.0)}).torque == pytest.approx(
        drumlin.solve(brake, **options).torque, rel=1e-15
    )


def test_an_object_with_a_path_is_a_path(brake, tmp_path):
    class PathOfOtherKind:
        """An object that is no `pathlib.Path` and has a path."""

        def __fspath__(self):
            """The path of a file in the folder of this test."""
            return str(tmp_path / "other.toml")

    drumlin.write_brake(brake, PathOfOtherKind())
    assert drumlin.read_brake(tmp_path / "other.toml") == brake


@pytest.mark.parametrize("number", [np.int64(3000), np.float32(3000), 3000])
def test_a_number_of_numpy_is_a_quantity_of_a_brake(brake, number):
    varied = drumlin.vary(brake, {"shoe.actuation.force": number})
    assert [shoe.actuation.force for shoe in varied.shoes] == [3000.0, 3000.0]
    with pytest.raises(drumlin.BadInput, match="must be a force such as"):
        drumlin.vary(brake, {"shoe.actuation.force": np.bool_(True)})


@pytest.mark.parametrize("key", ["spring.preload", "shoe.force.force", "link.from"])
def test_a_key_of_parts_that_the_brake_has_none_of_is_refused(brake, key):
    """The key means each spring, force or strut. Without one, nothing would be set."""
    with pytest.raises(drumlin.BadInput, match=f"^{key}: the brake has no such part$"):
        drumlin.vary(brake, {key: 1.0})
    spring = {"shoe": "left", "point": {"x": -0.05, "y": 0.1}, "end": {"x": 0.0, "y": 0.1}}
    sprung = drumlin.vary(brake, {"spring": [spring | {"preload": 5.0}]})
    assert drumlin.vary(sprung, {"spring.preload": 7.0}).springs[0].preload == 7.0


@pytest.mark.parametrize("rotation", ["361 deg", -7.0, math.nan])
def test_no_brake_is_turned_by_more_than_a_turn_as_it_holds(brake, rotation):
    said = f"^rotation = {re.escape(repr(rotation))}: must be at most 360 deg to either side$"
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.hold(brake, elements=6, rotation=rotation)
    with pytest.raises(drumlin.BadInput, match=r"^rotation = 1.1: must be at most 1000 mm to"):
        drumlin.hold(drumlin.example("rail_clamp"), elements=6, rotation=1.1)


def test_linings_that_slip_back_at_rest_and_stick_then_slip_from_their_last_state_on():
    """On rough abutments the linings slip back as the forces come on, before the drum turns."""
    run = drumlin.hold(drumlin.example("duplex"), elements=8, steps=4)
    assert run.states[0].sticking == 0 < run.states[3].sticking
    last, end = np.degrees([run.states[3].rotation, run.states[4].rotation])
    between = f"between {last:.4g} and {end:.4g} deg"
    assert run.lines()[1] == f"the whole contact slips from a rotation {between} on"


def test_a_turned_brake_has_the_moment_of_full_slip(brake):
    turned = drumlin.hold(brake, elements=6, steps=1, rotation=2 * math.pi)
    assert turned.states[1].torque == pytest.approx(drumlin.solve(brake, elements=6).torque, 1e-12)


@pytest.mark.parametrize(
    ("call", "options", "said"),
    [
        ("solve", {"model": "sinee"}, "model = 'sinee': unknown model (did you mean 'sine'?)"),
        ("solve", {"elements": 0}, "elements = 0: must be from 1"),
        ("solve", {"model": "sine", "elements": 9}, 'and fields belong to model="fem"'),
        ("solve", {"finite_width": True, "model_error": False}, "model_error=False: finite_width"),
        ("solve", {"fields": "x.png"}, "fields = 'x.png': must end in .vtu"),
        ("fields", {"output": "x.png"}, "output = 'x.png': must end in .vtu"),
        ("hold", {"steps": 0}, "steps = 0: must be from 1 to 10000"),
        ("size", {"key": "friction", "torque": 1.0, "low": 2.0, "high": 1.0}, "low = 2: must be"),
        ("wear", {"model": "sine"}, "model = 'sine': does not wear"),
        ("example", None, "name = 'duplx': no such example (did you mean 'duplex'?)"),
    ],
)
def test_errors_name_the_arguments_of_python(brake, call, options, said):
    with pytest.raises(drumlin.BadInput) as error:
        if options is None:
            drumlin.example("duplx")
        else:
            getattr(drumlin, call)(brake, **options)
    assert said in str(error.value) and "--" not in str(error.value)


# The terminal.


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda brake: drumlin.solve("nowhere.toml"), drumlin.BadInput),
        (lambda brake: drumlin.solve(drumlin.vary(brake, {"friction": 1.3})), drumlin.NoAnswer),
    ],
    ids=["no file", "self-locking"],
)
def test_a_traceback_shows_one_error(brake, call, kind):
    with pytest.raises(kind) as refused:
        call(brake)
    shown = "".join(traceback.format_exception(refused.value))
    assert shown.count("Traceback") == 1 and shown.splitlines()[-1].endswith(str(refused.value))
    # The first error is still there for those who look for it.
    assert refused.value.__context__ is not None and refused.value.__cause__ is None


def test_the_terminal_names_its_options(here):
    for words in (["--model", "sinee"], ["--elements", 0], ["--fields", "x.png"]):
        assert f"{words[0]} = {words[1]!r}" in run("solve", "my.toml", *words).stderr
    both = run("solve", "my.toml", "my.toml", "--model", "sine", "--elements", 9)
    assert "--fields belong to --model fem" in both.stderr


def test_json_of_the_terminal_names_its_options_too(brake):
    failure = drumlin.NoAnswer("--tolerance = 1e-12: is not reached")
    failure.replace_options_by_python_arguments_in_message()
    data = _BrakeWithResponseOrFailure(Path("my.toml"), brake, None, failure).as_dict()
    assert data == {"brake_file": "my.toml", "failure": "--tolerance = 1e-12: is not reached"}


def test_every_command_has_a_short_help():
    for command in ("", "solve", "sweep", "init", "study", "wear", "hold"):
        done = run(*filter(None, [command, "-h"]))
        assert done.returncode == 0 and "Usage: drumlin" in done.stdout


def test_a_sweep_ends_with_its_statistics(here, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    (here / "sweep.toml").write_text(
        'brake = "my.toml"\n[model.sine]\n[vary]\nfriction = [0.2, 0.3, 0.9]\n'
    )
    done = run("sweep", "sweep.toml", "--jobs", 1)
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0] == "3 cases: 2 solved, 1 failed" and "self-locking" in lines[1]
    head = next(line for line in lines if "spread" in line)
    assert head.split() == ["mean", "spread", "5", "%", "95", "%", "least", "most"]
    peak = next(line for line in lines if line.startswith("left peak pressure [MPa]")).split()
    brake, pressures = drumlin.read_brake("my.toml"), []
    for mu in (0.2, 0.3):
        response = drumlin.solve(drumlin.vary(brake, {"friction": mu}), "sine")
        pressures.append(response.shoes[1].peak_pressure * 1e-6)
    assert float(peak[4]) == pytest.approx(np.mean(pressures), rel=1e-3)
    assert [float(peak[-2]), float(peak[-1])] == pytest.approx(sorted(pressures), rel=1e-3)
    # All is done, and nothing but the table is left.
    assert sorted(path.name for path in here.iterdir()) == ["my.toml", "sweep.csv", "sweep.toml"]
    assert "peak_pressure [Pa]" in (here / "sweep.csv").read_text()


def test_hold_ends_with_what_is_held_and_when_it_slips(here):
    lines = run("hold", "my.toml", "--elements", 6, "--steps", 2).stdout.splitlines()
    held = drumlin.hold("my.toml", elements=6, steps=2)
    assert lines[-2].startswith(f"holds up to {held.states[-1].torque:.6g} N m, at rotation")
    assert lines[-1].startswith("the whole contact slips from a rotation between")
    short = drumlin.hold("my.toml", elements=6, steps=1, rotation="0.001 deg")
    assert short.lines()[1].startswith("no full slip: at rotation 0.001 deg, ")


def test_wear_prints_columns_apart_and_states_its_error(here):
    lines = run("wear", "my.toml", "--elements", 6, "--distance", 0.2).stdout.splitlines()
    first = next(i for i, line in enumerate(lines) if line.split()[:1] == ["[km]"])
    rows = [line for line in lines[first + 1 :] if re.fullmatch(r"[-+\d.e ]+", line)]
    assert len(rows) > 2 and {len(row.split()) for row in rows} == {8}
    assert "estimated error: not known on chosen elements" in " ".join(lines)


@pytest.mark.slow
def test_wear_starts_where_solve_is_and_states_its_error(here, monkeypatch):
    solves = []

    def solve_and_count(*given, **options):
        solves.append(given)
        return solve_brake_to_tolerance(*given, **options)

    monkeypatch.setattr(fem_solve, "solve_brake_to_tolerance", solve_and_count)
    worn = drumlin.wear("my.toml", distance=0.1)
    # The error is that of the solve that finds the elements for the wear.
    assert len(solves) == 1
    solved = drumlin.solve("my.toml")
    assert worn.states[0].torque == pytest.approx(solved.torque, rel=solved.error["torque"])
    said = worn.lines()[-1]
    for key in ("pressure", "torque"):
        assert worn.start_error[key] == pytest.approx(solved.error[key])
        assert error_text_in_percent(solved.error[key]) in said
    assert worn.as_dict()["start_error"] == worn.start_error


def test_plane_stress_writes_its_fields(here):
    done = run("solve", "my.toml", "--elements", 6, "--fields", "fields.vtu", "--no-model-error")
    assert done.returncode == 0
    mesh = meshio.read(here / "fields.vtu")
    right, left = drumlin.fields("my.toml", elements=6)
    both = np.concatenate([right.von_mises, left.von_mises])
    assert np.allclose(mesh.point_data["von Mises [Pa]"], both, rtol=1e-9)
    done = run("solve", "my.toml", "--fields", "other.vtu", "--finite-width")
    assert done.returncode == 2 and "--fields: does not apply" in done.stderr
    assert not (here / "other.vtu").exists()


NEED_FILES = ("web_shoe", "sweep_grid", "notebook_engineer", "double_shoe")


@pytest.mark.parametrize("name", partly(paths_of_all_examples(), NEED_FILES))
def test_init_writes_files_that_work_in_another_folder(name, here):
    run("init", name, "--output", "before")
    (here / "before").rename(here / "after")
    text = "".join(path.read_text(encoding="utf-8") for path in (here / "after").glob("*.toml"))
    for named in re.findall(r'(?m)^(?:#:schema |mesh = "|brake = ")([^"\n]+)', text):
        assert (here / "after" / named).is_file()
    if name.startswith("sweep_"):
        (here / "after" / "table.csv").touch()
        from drumlin.sweeps.file import read_sweep_from_toml_file

        assert read_sweep_from_toml_file(here / "after" / f"{name}.toml").cases
    elif not name.startswith("notebook_"):
        assert drumlin.read_brake(here / "after" / f"{name}.toml").title
    again = run("init", name, "--output", "after")
    assert again.returncode == 2 and "exists already" in again.stderr


def test_a_printed_example_names_no_schema_that_is_not_there():
    assert "#:schema" not in run("init", "double_shoe").stdout


def test_the_manual_names_its_extra(here, monkeypatch):
    monkeypatch.setitem(OPTIONAL_PACKAGE_BY_STUDY_NAME, "manual", "no_such_package")
    done = run("study", "manual")
    assert done.returncode == 3 and 'pip install "drumlin[manual]"' in done.stderr


def test_errors_are_in_per_cent(here):
    said = run("solve", "my.toml", "--no-model-error").stdout
    line = said[said.index("estimated error") :].replace("\n ", "")
    assert re.match(r"estimated error: p 0\.0\d+ % \(L2, worst shoe\), torque 0\.0\d+ %", line)
    shown = {5.8e-4: "0.058 %", 0.123: "12 %", 0.994: "99 %", 0.996: "100 %", 12.3: "1230 %"}
    assert {error: error_text_in_percent(error) for error in shown} == shown
