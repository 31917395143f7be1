"""Figures: colours that the colour-blind can tell apart, names of curves, and curves cut off."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.figure import Figure

from drumlin.brake import read_drum_or_plane_brake
from drumlin.door import solve
from drumlin.report import figures
from drumlin.report.drawing import draw_brake
from drumlin.report.field_picture import rounded_up_to_end_of_colour_bar
from drumlin.report.palette import COLOR_AND_LINE_STYLE_BY_MODEL, CURVE_COLORS, ERROR_SCALE_COLORS
from picking import saying

# Dichromats by Machado, Oliveira & Fernandes (2009), severity 1, on linear RGB
SIGHT = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
}
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.119192, 0.9503041],
    ]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
# The CIE 1976 distance is ten times the least that is noticed side by side.
APART = 25.0


def texts_of(artists):
    """The strings of Matplotlib's text objects."""
    return [artist.get_text() for artist in artists]


def labelled(panels):
    """Whether each panel has a label below its axis."""
    return [bool(panel.get_xlabel()) for panel in panels]


def lab(colour, sight):
    """The CIE L*a*b* coordinates of a colour #rrggbb."""
    c = np.array(list(bytes.fromhex(colour[1:]))) / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    x = TO_XYZ @ np.clip(np.array(SIGHT[sight]) @ linear, 0, 1) / WHITE
    f = np.where(x > 216 / 24389, np.cbrt(x), (24389 / 27 * x + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def distance(a, b, sight):
    return float(np.linalg.norm(lab(a, sight) - lab(b, sight)))


def test_the_simulation_knows_what_dichromats_confuse():
    assert distance("#ff0000", "#00a000", "normal") > 100
    assert lab("#ffffff", "normal") == pytest.approx([100, 0, 0], abs=0.01)
    # People with deuteranopia confuse these two colours.
    olive, brick = "#8a7a00", "#b06a00"
    assert distance(olive, brick, "deuteranopia") < 0.5 * distance(olive, brick, "normal")
    for grey in ("#000000", "#777777", "#ffffff"):
        for sight in SIGHT:
            # Grey must stay grey in the eyes of everybody.
            assert lab(grey, sight)[1:] == pytest.approx([0, 0], abs=0.6)


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("colours", [CURVE_COLORS, ERROR_SCALE_COLORS])
def test_the_colours_stay_apart(colours, sight):
    assert len(set(colours)) == len(colours)
    for a, b in combinations(colours, 2):
        assert distance(a, b, sight) > APART, (a, b)
    for colour in CURVE_COLORS:
        assert distance(colour, "#ffffff", sight) > APART


def test_every_model_has_a_look_of_its_own():
    looks = [(colour, str(style)) for colour, style in COLOR_AND_LINE_STYLE_BY_MODEL.values()]
    assert len(set(looks)) == len(looks)
    assert {colour for colour, _ in COLOR_AND_LINE_STYLE_BY_MODEL.values()} <= set(CURVE_COLORS)


def test_a_pressure_that_is_cut_off_is_marked_and_two_curves_have_their_names_beside_them(brake):
    fem, sine = solve(brake, elements=30), solve(brake, "sine")
    few = figures.draw_pressure_along_lining_of_each_shoe(
        [("right", {"fem": fem.shoes[0], "sine": sine.shoes[0]})]
    )
    axes = few.axes[0]
    assert set(texts_of(axes.texts)) == {"finite elements", "sine law"}
    theta, p = figures.evenly_spaced_pressure_curve_of_shoe(fem.shoes[0])
    top = axes.get_ylim()[1]
    cut = [line for line in axes.lines if line.get_marker() == "^"]
    assert bool(p.max() * 1e-6 > top) is bool(cut)
    lower = Figure().subplots()
    lower.set_ylim(0, 0.5 * p.max())
    figures.draw_triangles_where_curve_leaves_axes(lower, theta, p, "#000000")
    assert [line.get_ydata()[0] for line in lower.lines] == [0.5 * p.max()] * len(
        lower.lines
    ) and lower.lines
    # A legend must not lie over the data.
    assert not any(axes.get_legend() for axes in few.axes)
    many = figures.draw_pressure_along_lining_of_each_shoe(
        [("right", {name: solve(brake, name).shoes[0] for name in ("sine", "cosine", "uniform")})]
    )
    assert set(texts_of(many.legends[0].get_texts())) >= {
        "sine law",
        "cosine law",
        "uniform pressure",
    }


# drawings of brakes


def drawn(path):
    figure = Figure()
    axes = figure.subplots()
    draw_brake(axes, read_drum_or_plane_brake(path))
    dashed = [np.array(line.get_xydata()) for line in axes.lines if line.get_linestyle() == "--"]
    return axes, texts_of(axes.texts), dashed


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("simplex_hinged", ["1.861 kN each"]),
        ("duplex", ["1.094 kN", "1.094 kN"]),
        ("uni_servo", ["1.117 kN"]),
        ("duo_servo", ["1.117 kN each"]),
        ("s_cam", ["53.15 kN in all"]),
        ("crane", ["3 kN", "3 kN"]),
        ("rail_clamp", ["20 kN"]),
        ("band", ["2 kN"]),
    ],
)
def test_forces_are_written_once_a_place(root, name, words):
    """Forces at the same place have one label; that of a cam is the sum of its forces.

    The cam has 0.75 of 900 N m at an arm of 12.7 mm.
    """
    _, texts, _ = drawn(root / f"studies/brakes/{name}.toml")
    assert saying(texts, "kN") == words


def test_a_rigid_arm_is_drawn_from_what_holds_and_pushes_a_block_to_its_grip(root):
    brake = read_drum_or_plane_brake(root / "studies/brakes/block_on_lever.toml")
    axes, _, dashed = drawn(root / "studies/brakes/block_on_lever.toml")
    ends = [line[-1].tolist() for line in dashed]
    assert ends == [[-250, 200], [450, 200]]
    # Both lines begin in the middle of the block's back.
    np.testing.assert_allclose([line[0] for line in dashed], [[0, 200]] * 2, atol=1e-9)
    back = [
        line.get_xydata() for line in axes.lines if np.allclose(np.hypot(*line.get_xydata().T), 200)
    ]
    lengths = [float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in back]
    assert any(
        length == pytest.approx(1e3 * brake.shoes[0].body.grip, rel=1e-3) for length in lengths
    )


def test_a_strut_reaches_from_a_foot_to_the_shoe_that_it_pushes(root):
    axes, _, _ = drawn(root / "studies/brakes/duo_servo.toml")
    (strut,) = [line.get_xydata() for line in axes.lines if line.get_linewidth() == 5]
    np.testing.assert_allclose(strut, [[25, -112], [-25, -112]])
    axes, _, _ = drawn(root / "studies/brakes/uni_servo.toml")
    (strut,) = [line.get_xydata() for line in axes.lines if line.get_linewidth() == 5]
    np.testing.assert_allclose(strut[0], [25, -112])
    assert strut[1][1] == pytest.approx(-112)
    assert np.hypot(*strut[1]) < 139.7 and strut[1][0] < 0


def test_the_top_of_a_colour_bar_is_round_in_its_quarters_and_near():
    for value in np.geomspace(0.013, 900, 300):
        top = rounded_up_to_end_of_colour_bar(float(value))
        assert value <= top * (1 + 1e-9) and top <= 1.51 * value
        assert len(f"{top / 4:.6g}".replace("0.", "").strip("0.").replace(".", "")) <= 2
    assert rounded_up_to_end_of_colour_bar(10.6) == pytest.approx(12)


def test_panels_of_other_angles_say_their_own(root, brake):
    """Panels of blocks at different angles have separate axes; rotations of a shoe share one."""
    band = read_drum_or_plane_brake(root / "studies/brakes/band.toml")
    blocks = [(shoe.name, {"rigid": shoe}) for shoe in solve(band, "rigid").shoes]
    shown = [
        axes
        for axes in figures.draw_pressure_along_lining_of_each_shoe(blocks).axes
        if axes.get_visible()
    ]
    assert labelled(shown) == [True] * 5
    both = [(shoe.name, {"sine": shoe}) for _ in range(2) for shoe in solve(brake, "sine").shoes]
    assert labelled(figures.draw_pressure_along_lining_of_each_shoe(both).axes) == [
        False,
        False,
        True,
        True,
    ]
