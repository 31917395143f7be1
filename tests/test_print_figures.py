"""Figures for print: widths, sizes of text, nothing beyond the edge, and pictures of stresses."""

import csv
import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib import image
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

import drumlin
from conftest import ROOT
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.door import fields, solve
from drumlin.models import MODELS
from drumlin.report import figures
from drumlin.report.field_picture import (
    FORCE_SHAFT_WIDTH,
    LARGEST_CELL_SAMPLE_SPACING_IN_PIXELS,
    _draw_arrows,
    _figure_that_shows_all_points,
    _friction_surface_of_brake,
    _pressure_arrows,
    draw_stress_in_shoes_and_ring,
    paint_values_of_cells,
)
from drumlin.report.rendered_figure import figure_around_pixels, radii_of_drawn_rim
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies.misfit_rows import QUANTITIES_SHOWN_OVER_RANDOM_BRAKES
from drumlin_studies.plane_stress import (
    PlaneStressErrorMap,
    TimeAndErrors,
    solve_with_solid_shoes,
)
from drumlin_studies.post_brake_rows import TorqueErrorMapOverStiffnessGroups
from drumlin_studies.run_in_limits import (
    WearWithRegularDrumReversals,
    prepare_wear_setup_by_model,
    rows_and_last_states_of_wear_runs_in_equal_steps,
    wear_brake_until_pressure_settles,
)
from drumlin_studies.stated_true_figure import plot_stated_over_true_errors

KEPT = ROOT / "reports" / "reference"
# Elsevier's "Artwork sizing": 7 points for normal text, at least 6 for exponents and indices.
LEAST_TEXT = 7.0
LEAST_EXPONENT = 6.0
WIDTHS = (figures.FULL_WIDTH, figures.COLUMN_WIDTH)


def number_or_text(value):
    """A field of a table as a float, or as it stands if it is no number."""
    try:
        return float(value)
    except ValueError:
        return value


def stored(name):
    """The rows of a stored table, with numbers as floats; empty fields are left out."""
    rows = []
    for line in csv.DictReader((KEPT / name).read_text().splitlines()):
        rows.append({key: number_or_text(value) for key, value in line.items() if value})
    return rows


def texts_in(figure):
    """The visible texts of a figure that are not empty, after its layout."""
    figure.draw_without_rendering()
    return [one for one in figure.findobj(Text) if one.get_visible() and one.get_text().strip()]


def drawn_box(one):
    """The box of a text [pixels]: left, bottom, right, top."""
    return one.get_window_extent().extents


def overlap(a, b):
    """Whether two boxes share more than a pixel."""
    return min(a[2], b[2]) - max(a[0], b[0]) > 1 and min(a[3], b[3]) - max(a[1], b[1]) > 1


def check_legible(figure):
    """The figure is as wide as a column or a page, and its texts are large, whole and apart."""
    width = figure.get_figwidth() * 25.4
    assert width == pytest.approx(85) or width == pytest.approx(170)
    # The figure and its caption fit on a page of A4.
    assert figure.get_figheight() * 25.4 <= 235 + 1e-9
    # save_figure does the same.
    figures.number_logarithmic_axes_plainly(figure)
    texts = texts_in(figure)
    assert texts
    edge = figure.bbox.extents
    for one in texts:
        assert one.get_fontsize() >= LEAST_TEXT, one
        has_small_signs = one.get_parse_math() and re.search(r"\$.*[\^_]", one.get_text())
        assert not has_small_signs or 0.7 * one.get_fontsize() >= LEAST_EXPONENT, one
    # Ticks outside the limits of their axis are not drawn, but have a place.
    labels = {id(one) for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)
              for one in axis.get_ticklabels(which="both")}  # fmt: skip
    shown = [one for one in texts if id(one) not in labels and one.get_clip_path() is None]
    for one in shown:
        left, bottom, right, top = drawn_box(one)
        assert left >= edge[0] - 1 and bottom >= edge[1] - 1, one
        assert right <= edge[2] + 1 and top <= edge[3] + 1, one
    titles = [axes.title for axes in figure.axes] + [axes._left_title for axes in figure.axes]
    boxes = [drawn_box(one) for one in titles if one.get_text()]
    for i, a in enumerate(boxes):
        assert not any(overlap(a, b) for b in boxes[:i])


def study_module(name):
    """The module of a study."""
    return import_study_and_find_folder_above_studies(name)[0]


def draw_map_of_plane_stress(width=figures.FULL_WIDTH):
    rows = stored("plane_stress/maps.csv")
    study = study_module("plane_stress")
    charts = []
    for name in dict.fromkeys(row["map"] for row in rows):
        own = [row for row in rows if row["map"] == name]
        x, y = (list(dict.fromkeys(row[key] for row in own)) for key in "xy")
        values = {
            key: np.reshape([row[key] for row in own], (len(y), len(x)))
            for key in study.figures.PANELS
        }
        labels = ("web width / lining width", "table thickness [mm]")
        charts.append(PlaneStressErrorMap(name, labels, np.array(x), np.array(y), values))
    return study.figures.draw_error_maps(charts, width)


def draw_ladder(width=figures.FULL_WIDTH):
    found = {}
    for row in stored("plane_stress/ladder.csv"):
        own = {key: row.get(key, np.nan) for key in TimeAndErrors._fields}
        found.setdefault(row["brake"], []).append(TimeAndErrors(**own))
    return study_module("plane_stress").figures.draw_error_over_time(found, width)


def draw_limits(width=figures.FULL_WIDTH):
    study = study_module("plane_stress")
    brakes = {"T-section": read_brake(ROOT / "studies" / "plane_stress" / "brake.toml")}
    usual = study.marked_values(brakes)
    return study.draw_plane_stress_limits(stored("plane_stress/limits.csv"), usual, width)


def draw_work_precision(width=figures.FULL_WIDTH):
    study = study_module("error_vs_runtime")
    rows = [
        row for row in stored("error_vs_runtime/results.csv") if row["brake"] == "double_shoe/brake"
    ]
    floors = {"torque_error": 1e-9, "pressure_error": 1e-5}
    return study.draw_error_over_time("internal double-shoe brake", rows, floors, width)


def draw_solid():
    study = study_module("error_vs_runtime")
    rows = stored("error_vs_runtime/solid_plane_stress_brake.csv")
    return study.draw_error_against_solid(rows, {"pressure": 2e-3})


def draw_left_out():
    rows = stored("error_vs_runtime/left_out.csv")
    return study_module("error_vs_runtime").draw_predicted_changes(rows)


def draw_map_of_post_brake(width=figures.FULL_WIDTH):
    study = study_module("post_brake")
    x = np.geomspace(0.3, 300, 7)
    error = np.linspace(-0.5, 0.5, 49).reshape(7, 7)
    names = ("sine law", "foundation, as published", "foundation, unsimplified")
    rows = [
        [TorqueErrorMapOverStiffnessGroups(f"{name}, {lining}", x, x, error) for name in names]
        for lining in ("soft lining", "wooden block")
    ]
    return study.figures.draw_error_maps(rows, [(2.0, 15.0), (15.0, 90.0)], width)


def draw_histograms(width=figures.FULL_WIDTH):
    random = np.random.default_rng(7)
    values = {name: random.normal(1.0, 0.1, 200) for name in QUANTITIES_SHOWN_OVER_RANDOM_BRAKES}
    brakes = SimpleNamespace(
        values_of_quantity_for_random_brakes=lambda _, name: values[name],
    )
    nominal = dict.fromkeys(QUANTITIES_SHOWN_OVER_RANDOM_BRAKES, 1.0)
    return study_module("misfit").figures.draw_histograms(brakes, nominal, width)


def draw_stated_true(width=figures.FULL_WIDTH):
    return plot_stated_over_true_errors(stored("verification/stated_true.csv")[::20], width)


@cache
def solid_shoes_of_t_section():
    """The brake of the study of plane stress, and its response with degree 2 across the width."""
    brake = read_brake(ROOT / "studies" / "plane_stress" / "brake.toml")
    return brake, solve_with_solid_shoes(brake, 2)


def draw_face(width=figures.FULL_WIDTH):
    brake, solid = solid_shoes_of_t_section()
    three = SimpleNamespace(brake=brake, solid=solid)
    worn = SimpleNamespace(last=solid.shoes)
    return study_module("plane_stress").figures.draw_face_pressures(three, worn, width)


@cache
def run_of_double_shoe_brake():
    """The run of the double-shoe brake on few elements until its pressure settles."""
    brake = read_brake(ROOT / "studies" / "double_shoe" / "brake.toml")
    setup = prepare_wear_setup_by_model("fem", brake, 12)
    return wear_brake_until_pressure_settles("double_shoe/brake, fem", setup)


def draw_run_in(width=figures.FULL_WIDTH):
    study = study_module("run_in")
    run = run_of_double_shoe_brake()
    return study.figures.draw_pressures_over_distance(run, study.CURVES["stiff"], width)


def draw_worn_profiles():
    run = run_of_double_shoe_brake()
    return study_module("run_in").figures.draw_worn_profiles(run, (0.01, 0.1, 1.0))


def draw_torques_of_runs():
    """The figure of many runs, of which only a few have names."""
    run = run_of_double_shoe_brake()
    runs = [replace(run, name=f"linings/linings_apart, turned back {i}, fem") for i in range(22)]
    figure = study_module("run_in").figures.draw_torques_over_distance(runs)
    assert len(figure.legends[0].get_texts()) == 9
    return figure


def draw_held_force():
    return study_module("run_in").figures.draw_held_force(run_of_double_shoe_brake())


def draw_reversals():
    run = run_of_double_shoe_brake()
    turned = WearWithRegularDrumReversals(50.0, run.states, [0.1] * len(run.states), 0.0)
    return study_module("run_in").figures.draw_reversals(run, turned)


def draw_checkerboards():
    study = study_module("run_in")
    run = run_of_double_shoe_brake()
    _, boards = rows_and_last_states_of_wear_runs_in_equal_steps(run, study.END, study.STEPS)
    return study.figures.draw_checkerboards(run.setup.surfaces[0], boards)


@pytest.mark.parametrize(
    "draw",
    [
        draw_solid,
        draw_worn_profiles,
        draw_torques_of_runs,
        draw_held_force,
        draw_reversals,
        draw_checkerboards,
        pytest.param(draw_left_out, marks=pytest.mark.slow),
    ],
)
def test_figures_of_one_width_are_legible_at_it(draw):
    check_legible(draw())


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(
    "draw",
    [
        draw_limits,
        draw_run_in,
        draw_face,
        *(
            pytest.param(draw, marks=pytest.mark.slow)
            for draw in (
                draw_histograms,
                draw_map_of_plane_stress,
                draw_ladder,
                draw_work_precision,
                draw_map_of_post_brake,
                draw_stated_true,
            )
        ),
    ],
)
def test_kept_figures_are_legible_on_a_page_and_in_a_column(draw, width):
    """Each figure for a page has a version for a column, with one panel in a row."""
    figure = draw(width)
    assert figure.get_figwidth() == width
    check_legible(figure)


def width_in_print(picture):
    """The width [mm] for which a kept PNG file is drawn, as the file itself states it."""
    with Image.open(picture) as opened:
        said = str(opened.info.get("Description", ""))
    found = re.fullmatch(r"drawn for print at a width of (\d+) mm", said)
    return int(found[1]) if found else None


def test_every_kept_picture_is_drawn_for_a_column_or_has_a_version_for_it():
    pictures = sorted(KEPT.glob("**/*.png"))
    assert len(pictures) > 15
    widths = {}
    for picture in pictures:
        widths[picture.relative_to(KEPT).with_suffix("").as_posix()] = width_in_print(picture)
    assert set(widths.values()) == {85, 170}, widths
    for name, width in widths.items():
        assert width == 85 or widths.get(f"{name}{figures.END_OF_COLUMN_FILE_NAME}") == 85, name


def test_small_or_cut_text_is_found():
    """The check itself sees a small text, a text beyond the edge and titles that overlap."""
    for place, size in (((0.5, 0.5), 6.0), ((0.95, 0.5), 8.0)):
        figure = Figure(figsize=(figures.FULL_WIDTH, 2))
        figure.text(*place, "a text of some length", fontsize=size)
        with pytest.raises(AssertionError):
            check_legible(figure)
    figure = Figure(figsize=(figures.FULL_WIDTH, 2))
    for axes in figure.subplots(1, 2):
        axes.set_title("a title that is far longer than its panel is wide " * 2, loc="left")
    with pytest.raises(AssertionError):
        check_legible(figure)
    with pytest.raises(AssertionError):
        check_legible(Figure(figsize=(9, 2)))


def test_a_figure_for_print_says_its_width(tmp_path):
    figure = figures.make_figure_for_print(1.0, figures.COLUMN_WIDTH)
    figures.save_figure_as_files(figure, tmp_path / "a")
    assert "drawn for print at a width of 85 mm" in (tmp_path / "a.svg").read_text()
    assert b"drawn for print at a width of 85 mm" in (tmp_path / "a.png").read_bytes()
    pixels = image.imread(tmp_path / "a.png").shape[1]
    assert pixels == pytest.approx(85 / 25.4 * figures.PIXELS_PER_INCH, abs=1)


def test_powers_of_ten_are_plain_numbers_in_a_file(tmp_path):
    """Numbers at the ticks of logarithmic axes have no exponents: these are too small in print."""
    figure = figures.make_figure_for_print(2.0, figures.COLUMN_WIDTH)
    axes = figure.subplots()
    axes.loglog([1e-4, 1e5], [1e-9, 20.0])
    axes.set_xticks([1e-3, 10, 1e4, 1e5])
    axes.set_yticks([1e-9, 1e-5])
    figures.save_figure(figure, tmp_path / "a.svg")
    drawn = re.findall("<!-- (.*?) -->", (tmp_path / "a.svg").read_text())
    assert {"0.001", "10", "10000", "1e5"} <= set(drawn)
    assert {"1e-9", "1e-5"} <= set(drawn) and not any("$" in one for one in drawn)
    # Within a decade the ticks between powers of ten have numbers, too.
    axes.set_xscale("linear")
    axes.set_xscale("log")
    axes.set_xlim(1.5, 8)
    figures.save_figure(figure, tmp_path / "b.svg")
    drawn = re.findall("<!-- (.*?) -->", (tmp_path / "b.svg").read_text())
    assert {"2", "3"} <= set(drawn) and not any("$" in one for one in drawn)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1e-3, "0.001"),
        (9.9e-4, "9.9e-4"),
        (1e4, "10000"),
        (1.1e4, "1.1e4"),
        (-1e-7, "-1e-7"),
        (20.0, "20"),
        (10.0**-3.0000000001, "0.001"),
    ],
)
def test_numbers_at_ticks(value, text):
    assert figures.plain_number(value) == text


@pytest.mark.parametrize(
    "name",
    [
        "double_shoe/brake",
        pytest.param("brakes/rail_clamp", marks=pytest.mark.slow),
        pytest.param("brakes/uni_servo", marks=pytest.mark.slow),
    ],
)
def test_a_picture_of_stresses_is_legible_and_shows_the_pressure_of_the_response(name):
    brake = read_drum_or_plane_brake(ROOT / "studies" / f"{name}.toml")
    response = solve(brake, elements=8)
    bodies = fields(brake, elements=8)
    figure = draw_stress_in_shoes_and_ring(brake, response, bodies)
    check_legible(figure)
    title, motion = figure.texts[0].get_text().split("\n")
    assert title == brake.title and motion.startswith(f"{brake.motion_as_text}; displacements × ")
    (legend,) = figure.legends
    labels = [one.get_text() for one in legend.get_texts()]
    # The legend gives the arrows of pressure their length.
    longest = _pressure_arrows(brake, response, _friction_surface_of_brake(brake).size)
    stated = f"(longest arrows: {1e-6 * longest.pressure_of_longest:.2g} MPa or more)"
    assert any(one.endswith(f"on the lining\n{stated}") for one in labels)
    assert ("force of actuation or link" in labels) == (name == "brakes/uni_servo")
    arrows = longest.places
    tips, pushes = arrows[:, 1], arrows[:, 1] - arrows[:, 0]
    lengths = np.linalg.norm(pushes, axis=1)
    # The response's p(theta) at the tips; the longest tenth of the arrows is cut.
    found_at_tips = []
    for tip in tips:
        place = tip[0] if brake.surface.is_plane_and_not_drum else np.arctan2(*tip[::-1])
        found = 0.0
        for shoe in response.shoes:
            for turn in (-2 * np.pi, 0.0, 2 * np.pi):
                if shoe.theta[0] <= place + turn <= shoe.theta[-1]:
                    found = max(found, float(shoe.pressure_at(np.array([place + turn]))[0]))
        found_at_tips.append(found)
    p = np.array(found_at_tips)
    uncut = lengths < 0.999 * lengths.max()
    assert p[~uncut].min() >= longest.pressure_of_longest * (1 - 1e-9) > p[uncut].max() * 0.999
    assert uncut.sum() > 0.8 * len(p)
    np.testing.assert_allclose(lengths[uncut] / p[uncut], (lengths / p)[uncut][0], rtol=1e-6)
    # The drum pushes an internal lining inwards, the plane pushes a lining upwards.
    outward = np.array([0.0, -1.0]) if brake.surface.is_plane_and_not_drum else tips
    assert ((pushes * outward).sum(axis=1) < 0).all()


@pytest.mark.parametrize(
    "title", ["W" * 19 + " " + "wide words " * 10, "M" * 180, "costs $5 per $x_{" + " a" * 60, "a"]
)
def test_a_long_title_is_whole_above_the_picture_and_its_last_line_stands_alone(title):
    """Wide letters, a word wider than a line, signs that would begin a formula, a short title."""
    last = "drum turns counter-clockwise; displacements × 500"
    lines = figures.title_folded_into_lines(title, last)
    *folded, found = lines.split("\n")
    assert found == last and (len(folded) == 1) == (title == "a")
    assert "".join(folded).replace(" ", "") == title.replace(" ", "")
    places = np.array([[0.0, 0.0], [300.0, 200.0]])
    figure, axes, _ = _figure_that_shows_all_points(places, 100.0, lines)
    figures.write_title_above_picture(figure, lines)
    check_legible(figure)
    (text,) = figure.texts
    assert drawn_box(text)[1] >= axes.get_window_extent().y1


def test_a_factor_stays_with_its_word_in_a_narrow_title():
    last = "drum turns counter-clockwise; displacements × 50"
    lines = figures.title_folded_into_lines("a title", last, figures.COLUMN_WIDTH).split("\n")
    assert lines == ["a title", "drum turns counter-clockwise;", "displacements × 50"]


def test_the_title_of_a_picture_of_solid_shoes_is_whole():
    title = figures.title_folded_into_lines(
        "a wide shoe of a brake " * 5, "displacements × 50", figures.COLUMN_WIDTH
    )
    assert title.count("\n") >= 2 and title.endswith("\ndisplacements × 50")
    figure = figure_around_pixels(np.zeros((40, 80, 3), np.uint8), title, 10.0, beyond=True)
    check_legible(figure)
    (text,) = figure.texts
    assert drawn_box(text)[1] >= figure.axes[0].get_window_extent().y1


@pytest.mark.parametrize("angle", [0.0, np.pi / 2, np.pi])
def test_heads_of_arrows_at_the_edge_of_a_picture_are_whole(angle):
    """The heads of arrows up and down at the left and right edges are within the axes."""
    corners = np.array([[0.0, 0.0], [900.0, 500.0]])
    arrow = 50 * np.array([np.cos(angle), np.sin(angle)])
    tails = np.array([[0.0, 100.0], [900.0, 100.0]])
    arrows = np.stack([tails, tails + arrow], axis=1)
    places = np.concatenate([corners, arrows.reshape(-1, 2)])
    _, axes, _ = _figure_that_shows_all_points(places, 1.0, "a title")
    _draw_arrows(axes, arrows, "black", FORCE_SHAFT_WIDTH)
    axes.figure.draw_without_rendering()
    (drawn,) = axes.collections
    shape = np.concatenate([path.vertices for path in drawn.get_paths()])
    # Heads reach to both sides of the arrow's line, in pixels of the figure.
    across = 0.5 * np.ptp(shape @ [-np.sin(angle), np.cos(angle)])
    across *= np.linalg.norm(drawn.get_transform().transform([[1, 0]])[0]
                             - drawn.get_transform().transform([[0, 0]])[0])  # fmt: skip
    ends = axes.transData.transform(arrows.reshape(-1, 2))
    reach = across * np.abs([np.sin(angle), np.cos(angle)])
    box = axes.get_window_extent()
    assert (ends.min(axis=0) - reach >= box.min).all()
    assert (ends.max(axis=0) + reach <= box.max).all()


@pytest.mark.parametrize(("rows", "columns"), [(30, 400), (200, 200), (900, 60)])
def test_rendered_bodies_of_any_shape_keep_their_shape_and_fit_on_a_page(rows, columns):
    pixels = np.zeros((rows, columns, 3), np.uint8)
    figure = figure_around_pixels(pixels, "a title\na line", 10.0, beyond=False)
    check_legible(figure)
    axes, bar = figure.axes
    box = axes.get_window_extent()
    np.testing.assert_allclose(box.height / box.width, rows / columns)
    # Round-off of pixels is no overlap.
    assert min(box.x0, box.y0) > -0.1 and box.x1 < bar.get_window_extent().x0
    assert figure.get_figheight() <= 8.5


def test_the_band_of_a_rigid_drum_lies_beside_the_linings():
    internal, external = drumlin.example("double_shoe"), drumlin.example("double_shoe_external")
    assert radii_of_drawn_rim(internal).inner == internal.size
    assert radii_of_drawn_rim(external).outer == external.size
    for brake in (internal, external):
        rim = radii_of_drawn_rim(brake)
        np.testing.assert_allclose((rim.outer - rim.inner) / brake.size, 0.025)
    # An elastic ring is drawn as a body, and a plane has no rim.
    assert radii_of_drawn_rim(drumlin.example("post_brake")) is None
    assert radii_of_drawn_rim(drumlin.example("pad")) is None


@pytest.mark.parametrize("corners", [4, 3])
def test_cells_are_painted_whole_with_values_between_those_of_their_nodes(corners):
    """A linear function is painted on a distorted mesh: every pixel within, and none outside."""
    random = np.random.default_rng(3)
    n = 6
    grid = np.stack(np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij"), axis=-1)
    points = 10.0 + 12.0 * grid.reshape(-1, 2).astype(float)
    inner = ((grid > 0) & (grid < n)).all(axis=-1).ravel()
    points[inner] += random.uniform(-4, 4, (inner.sum(), 2))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.stack([first, first + n + 1, first + n + 2, first + 1], axis=1)
    if corners == 3:
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    slope = np.array([0.5, -1.25])
    painted = np.full((100, 100), np.nan)
    paint_values_of_cells(painted, points, cells, points @ slope)
    filled = ~np.isnan(painted)
    expected = np.zeros_like(filled)
    expected[10:82, 10:82] = True
    np.testing.assert_array_equal(filled, expected)
    row, column = np.nonzero(filled)
    middle = np.stack([column, row], axis=1) + 0.5
    # A sample lies within half a pixel of the middle of its pixel in both directions.
    difference = np.abs(painted[filled] - middle @ slope)
    assert difference.max() <= 0.5 * np.abs(slope).sum() + 1e-9
    assert LARGEST_CELL_SAMPLE_SPACING_IN_PIXELS < 1


@pytest.mark.parametrize("width", [figures.FULL_WIDTH, figures.COLUMN_WIDTH])
@pytest.mark.parametrize("shoes", [8, 20, 40])
def test_pressures_on_many_shoes_fit_on_a_page(brake, shoes, width):
    """Panels that show several shoes have all curves, and name the first and the last shoe."""
    law = MODELS["sine"].solve(brake).shoes
    panels = [(f"block {i + 1}", {"sine": law[i % 2]}) for i in range(shoes)]
    figure = figures.draw_pressure_along_lining_of_each_shoe(panels, width=width)
    check_legible(figure)
    used = [axes for axes in figure.axes if axes.get_visible()]
    assert len(used) <= 7 * (2 if width == figures.FULL_WIDTH else 1)
    assert sum(len(line.get_xdata()) > 1 for axes in used for line in axes.lines) == shoes
    titles = [axes.get_title(loc="left") for axes in used]
    assert titles[0].startswith("block 1") and titles[-1].endswith(f"block {shoes}")
    # The boxes of the curves are at least a centimetre high.
    assert min(axes.get_window_extent().height for axes in used) / figure.dpi * 25.4 > 10
    for axes in used:
        low, high = axes.get_xlim()
        assert all(low < x < high for line in axes.lines for x in line.get_xdata()[[0, -1]])


def test_worn_linings_and_laws_have_their_figures_in_a_column(brake):
    """A figure of one panel is as wide as a column."""
    one = vary(brake, {"rotation": "clockwise"})
    law = MODELS["sine"].solve(one)
    panels = [("right", {"sine": law.shoes[0]})]
    figure = figures.draw_pressure_along_lining_of_each_shoe(panels)
    assert figure.get_figwidth() == figures.COLUMN_WIDTH
    check_legible(figure)
    both = [("right", {"sine": law.shoes[0]}), ("left", {"sine": law.shoes[1]})]
    check_legible(figures.draw_pressure_along_lining_of_each_shoe(both))
