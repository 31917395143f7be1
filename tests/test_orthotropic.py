"""Orthotropic materials: keys and refusals, closed forms, other solvers, and physics."""

import math
import re

import numpy as np
import pytest
import skfem
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.linalg import spsolve

import drumlin
from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.brake.elasticity import ElasticLayer, plane_stress_elasticity_matrix
from drumlin.brake.fields import Material, OrthotropicMaterial
from drumlin.brake.file import make_drum_brake_from_data, make_validated_brake_part, vary
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.brake.schema import json_schema_of_brake_file
from drumlin.brake.writing import brake_file_text
from drumlin.comparison import compare
from drumlin.explore.knobs import sliders_for_brake
from drumlin.fem.analysis.fields import stress_and_displacement_fields_of_shoe
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity, sensitivity_as_text_lines
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.corner import (
    pressure_exponent_at_lining_corner,
    pressure_exponent_at_orthotropic_corner,
    pressure_exponents_at_both_lining_corners,
)
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import prepared_model_with_finest_elements, solve
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin.models import (
    MODELS,
    applicable_models,
    model_with_name_that_applies_to_brake,
    reasons_why_models_do_not_apply,
)
from drumlin.peers import calculix, getfem, install_hint_if_missing
from drumlin_studies.consistency_slopes import (
    ALLOWED_SLOPE_DIFFERENCE,
    MeshKindForSlopes,
    all_torque_sensitivities_printed_for_brake,
    largest_relative_difference_from_central_differences,
)
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import (
    draw_random_brake_of_support_kind,
    mirror_turn_and_shift_brake,
)
from drumlin_studies.stated_true import solve_fine_reference_by_triangles
from drumlin_studies.two_bodies import scikit_fem_basis_of_mesh
from picking import having, picked
from shared_parts import of_shoes

MAIN = read_drum_or_plane_brake(STUDY / "brake.toml")
FLEXIBLE = read_drum_or_plane_brake(STUDY / "flexible.toml")
POST = read_drum_or_plane_brake(ROOT / "studies/post_brake/brake.toml")
LINING = {"E_along": 9e8, "E_through": 3e8, "G_along_through": 2.1e8, "nu_along_through": 0.35}
"""Of a moulded lining: three times as stiff along as through."""
ACROSS = {
    "E_across": 9e8,
    "G_along_across": 3e8,
    "G_through_across": 2e8,
    "nu_along_across": 0.3,
    "nu_through_across": 0.1,
}
LAWS_OF_HINGED_SHOES_BY_NAME = (
    "sine",
    "cosine",
    "block",
    "uniform",
    "short",
    "pivoted",
    "linear",
    "rigid",
)


def alike(material):
    """The keys of an isotropic material, written as an orthotropic one."""
    E, nu = material.E, material.nu
    return {
        "E_along": E,
        "E_through": E,
        "G_along_through": E / (2 * (1 + nu)),
        "nu_along_through": nu,
    }


def parts_of(brake):
    """The keys of all materials of a brake, with them."""
    for i, shoe in enumerate(brake.shoes):
        for name in ("lining", "backing", "body"):
            material = getattr(getattr(shoe, name), "material", None)
            if material is not None:
                yield f"shoe[{i}].{name}.material", material
    ring = getattr(getattr(brake, "drum", None), "ring", None)
    if ring is not None and ring.material is not None:
        yield "drum.ring.material", ring.material


def orthotropic(brake, seed=0):
    """The brake with every material stiffer along or through its layer, drawn by a seed."""
    rng, changes = np.random.default_rng(seed), {}
    for key, material in parts_of(brake):
        along, through, shear = material.E * np.exp(rng.uniform(-1, 1, 3))
        nu = float(rng.uniform(-0.3, 0.8) * math.sqrt(along / through))
        changes[key] = {
            "E_along": float(along),
            "E_through": float(through),
            "G_along_through": float(0.4 * shear),
            "nu_along_through": nu,
        }
    return vary(brake, changes)


def with_lining(brake, **changes):
    return vary(brake, {"shoe.lining.material": LINING | changes})


REFUSED = {
    "too large a ratio": (
        {"nu_along_through": 1.8},
        "nu_along_through = 1.8: must be greater than -1.73205 and less",
    ),
    "too small a ratio": ({"nu_along_through": -1.7321}, "the root of E_along / E_through"),
    "no shear modulus": ({"G_along_through": None}, "G_along_through: must be a stress such as"),
    "negative": ({"G_along_through": -1.0}, "G_along_through = -1.0: must be greater than 0"),
    "a ratio as a text": (
        {"nu_along_through": "a third"},
        "nu_along_through = 'a third': must be a number",
    ),
    "both kinds": (
        {"nu": 0.3},
        "unknown key 'nu'; allowed: E_along, E_through, G_along_through, nu_along_through",
    ),
    "a slip": ({"E_trough": 1e9}, r"unknown key 'E_trough' \(did you mean 'E_through'\?\)"),
    "one key across": ({"E_across": 1e9}, "G_along_across is missing: E_across, .* go together"),
    "too large across": (
        ACROSS | {"nu_along_across": 1.0},
        "nu_along_across = 1: must be .* the root of E_along / E_",
    ),
    "three that do not fit": (
        ACROSS | {"nu_along_across": 0.9, "nu_through_across": 0.4},
        "nu_through_across = 0.4: must be greater than -0.35147 and less than 0.14147, beside",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_material_is_refused_in_one_line_with_key_value_and_what_is_allowed(case):
    changes, said = REFUSED[case]
    with pytest.raises(BadInput, match=rf"^shoe\[0\].lining.material.*{said}") as refusal:
        with_lining(MAIN, **changes)
    assert "\n" not in str(refusal.value)


def test_a_missing_key_is_named():
    written = "is missing; write a stress such as '300 MPa'"
    with pytest.raises(BadInput, match=rf"^shoe\[0\].lining.material.E_through: {written}"):
        vary(MAIN, {"shoe.lining.material": {"E_along": 1e9}})
    with pytest.raises(BadInput, match=rf"^shoe\[0\].lining.material.E: {written}"):
        vary(MAIN, {"shoe.lining.material": {"nu": 0.3}})


def test_a_file_with_units_is_read_written_and_described(tmp_path):
    line = 'material = { E_along = "0.9 GPa", E_through = "300 MPa", G_along_through = "210 MPa", '
    line += "nu_along_through = 0.35 }"
    text = re.sub(r'material = \{ E = "300 MPa".*?\}', line, (STUDY / "brake.toml").read_text())
    (tmp_path / "brake.toml").write_text(text)
    brake = drumlin.read_brake(tmp_path / "brake.toml")
    assert brake.shoes[1].lining.material == OrthotropicMaterial(**LINING)
    (tmp_path / "again.toml").write_text(
        brake_file_text(vary(brake, {"shoe[0].lining.material": LINING | ACROSS}))
    )
    again = drumlin.read_brake(tmp_path / "again.toml")
    assert again.shoes[0].lining.material == OrthotropicMaterial(**LINING, **ACROSS)
    assert again.shoes[1] == brake.shoes[1]
    softer = vary(brake, {"shoe.lining.material.E_through": "100 MPa"})
    assert softer.shoes[0].lining.material.E_through == pytest.approx(1e8)
    keys = json_schema_of_brake_file()["$defs"]["OrthotropicMaterial"]
    expansion = {"expansion_along", "expansion_through"}
    assert set(keys["properties"]) == set(LINING | ACROSS) | expansion
    assert set(keys["required"]) == set(LINING)


positive = st.floats(0.05, 20.0)
ratio = st.floats(-1.5, 1.5)


@given(positive, positive, positive, ratio, ratio, ratio)
def test_a_material_is_taken_just_where_every_strain_has_a_positive_energy(
    a, t, c, nu_at, nu_ac, nu_tc
):
    shears = {"G_along_through": 1.0, "G_along_across": 1.0, "G_through_across": 1.0}
    compliance = np.array(
        [
            [1 / a, -nu_at / a, -nu_ac / a],
            [-nu_at / a, 1 / t, -nu_tc / t],
            [-nu_ac / a, -nu_tc / t, 1 / c],
        ]
    )
    unit = 1 / np.sqrt(np.diag(compliance))
    least = np.linalg.eigvalsh(unit[:, None] * compliance * unit)[0]
    if abs(least) < 1e-9:
        return
    ratios = {"nu_along_through": nu_at, "nu_along_across": nu_ac, "nu_through_across": nu_tc}
    try:
        make_validated_brake_part(
            OrthotropicMaterial, {"E_along": a, "E_through": t, "E_across": c} | ratios | shears
        )
    except BadInput:
        assert least < 0
    else:
        assert least > 0


@given(positive, positive, positive, st.floats(-0.99, 0.99))
def test_the_matrix_is_symmetric_positive_definite_and_the_inverse_of_the_compliance(
    a, t, shear, part
):
    nu = part * math.sqrt(a / t)
    D = plane_stress_elasticity_matrix(
        OrthotropicMaterial(E_along=a, E_through=t, G_along_through=shear, nu_along_through=nu)
    )
    compliance = np.array([[1 / a, -nu / a, 0], [-nu / a, 1 / t, 0], [0, 0, 1 / shear]])
    assert np.array_equal(D, D.T) and np.linalg.eigvalsh(D)[0] > 0
    assert pytest.approx(np.eye(3), abs=1e-9) == D @ compliance


def test_an_isotropic_material_has_the_same_in_all_directions():
    material, other = (
        Material(E=3e8, nu=0.25),
        OrthotropicMaterial(**alike(Material(E=3e8, nu=0.25))),
    )
    for key in ("E_along", "E_through", "G_along_through", "nu_along_through"):
        assert getattr(material, key) == getattr(other, key)
    assert other.young_modulus_of_equivalent_half_plane == pytest.approx(
        material.young_modulus_of_equivalent_half_plane, rel=1e-14
    )
    assert plane_stress_elasticity_matrix(other) == pytest.approx(
        plane_stress_elasticity_matrix(material), rel=1e-14
    )


SAME = {
    "arcs": MAIN,
    "posts on a ring": POST,
    "cam": read_drum_or_plane_brake(ROOT / "studies/brakes/s_cam.toml"),
    "pads": read_drum_or_plane_brake(ROOT / "studies/brakes/rail_clamp.toml"),
    "T-sections": read_drum_or_plane_brake(ROOT / "studies/plane_stress/brake.toml"),
}


@pytest.mark.parametrize("elements", [None, 10])
@pytest.mark.parametrize(
    "name", ["arcs", *(pytest.param(name, marks=pytest.mark.slow) for name in list(SAME)[1:])]
)
def test_an_isotropic_material_written_as_an_orthotropic_one_gives_the_same_answer(name, elements):
    brake = SAME[name]
    other = vary(brake, {key: alike(material) for key, material in parts_of(brake)})
    for _, material in parts_of(other):
        assert isinstance(material, OrthotropicMaterial)
    one, same = solve(brake, elements=elements), solve(other, elements=elements)
    for a, b in zip(one.shoes, same.shoes, strict=True):
        assert b.torque == pytest.approx(a.torque, rel=1e-12)
        assert b.normal_force == pytest.approx(a.normal_force, rel=1e-12)
        assert b.pressure == pytest.approx(a.pressure, abs=1e-12 * a.peak_pressure)


@pytest.mark.parametrize("elements", [None, 12])
def test_a_nearly_isotropic_material_gives_nearly_the_same_answer(elements):
    """A nearly isotropic material gives nearly the isotropic answer, without a jump.

    The kernels integrate the part that is stiffer along and through.
    """
    near = {
        key: {**alike(material), "G_along_through": 1.0 * material.G_along_through * (1 + 1e-7)}
        for key, material in parts_of(FLEXIBLE)
    }
    one, other = (
        solve(brake, elements=elements).torque for brake in (FLEXIBLE, vary(FLEXIBLE, near))
    )
    assert one != other and other == pytest.approx(one, rel=1e-6)


def pad(thickness, material):
    """A pad on a guide square to the plane, rigid behind its lining: 500 N on 120 mm x 40 mm."""
    lining = {
        "start": 0.0,
        "end": 0.12,
        "width": 0.04,
        "thickness": thickness,
        "material": material,
    }
    shoe = {
        "name": "pad",
        "guide": {"direction": -math.pi / 2},
        "lining": lining,
        "actuation": {"force": 500.0, "direction": -math.pi / 2, "point": {"x": 0.06, "y": 0.1}},
    }
    return make_validated_brake_part(
        FlatBrake, {"title": "pad", "friction": 0.0, "plane": {"sliding": "+x"}, "shoe": [shoe]}
    )


def test_a_thin_bonded_lining_gives_way_by_its_uniaxial_strain():
    """A thin bonded lining gives way by p t/D_22 with D_22 = E_t/(1 - nu^2 E_t/E_a).

    Its back holds it along. The error at its ends halves with t.
    """
    off = []
    for t in (1e-3, 5e-4):
        (found,) = solve(pad(t, LINING), penalty=math.inf).shoes
        strain = (
            500.0
            / (0.12 * 0.04)
            / plane_stress_elasticity_matrix(OrthotropicMaterial(**LINING))[1, 1]
        )
        off.append(-found.motion[1] / (strain * t))
    assert 2 * off[1] - off[0] == pytest.approx(1.0, rel=1e-4)


@pytest.mark.parametrize(
    ("stiffer", "kind", "close"),
    [(4.0, "MeshQuad2", 2e-5), (0.25, "MeshQuad2", 2e-5), (3.0, "MeshTri2", 2e-4)],
)
def test_a_ring_under_inner_pressure_opens_as_lekhnitskii_has_it(stiffer, kind, close):
    """A ring under inner pressure opens as Lekhnitskii says (Anisotropic Plates, s. 24).

    u = A r^k + B r^-k, k = sqrt(E_around/E_radial), sigma_r = -p inside and 0 outside.

    The directions turn with the arc: a quarter ring on two planes of symmetry.
    """
    a, b, p, width = 0.1, 0.2, 1e6, 0.03
    material = OrthotropicMaterial(
        E_along=stiffer * 1e9, E_through=1e9, G_along_through=4e8, nu_along_through=0.3
    )
    D, k = plane_stress_elasticity_matrix(material), math.sqrt(stiffer)
    make = skfem.MeshQuad if kind == "MeshQuad2" else skfem.MeshTri
    grid = make.init_tensor(np.linspace(a, b, 13), np.linspace(0, math.pi / 2, 25))
    mesh = getattr(skfem, kind).from_mesh(grid)
    r, phi = mesh.doflocs
    mesh = type(mesh)(np.array([r * np.cos(phi), r * np.sin(phi)]), mesh.t)
    mesh = mesh.with_subdomains({"ring": np.arange(mesh.nelements)})
    basis = nodal_basis_of_mesh(mesh)
    K = sparse_stiffness_of_body(
        basis, {"ring": ElasticLayer.make_layer_in_plane_stress(material, width)}
    )
    inside = mesh.facets_satisfying(lambda x: np.abs(np.hypot(*x) - a) < 2e-4, boundaries_only=True)
    boundary = skfem.FacetBasis(mesh, scikit_fem_basis_of_mesh(mesh).elem, facets=inside)
    f = np.zeros((basis.N, 2))
    for c in range(2):
        push = skfem.LinearForm(lambda v, w, c=c: p * width * w.x[c] / np.hypot(*w.x) * v)
        f[:, c] = push.assemble(boundary)
    x, y = basis.doflocs
    held = np.concatenate(
        [2 * np.flatnonzero(np.abs(x) < 1e-12), 2 * np.flatnonzero(np.abs(y) < 1e-12) + 1]
    )
    free = np.setdiff1d(np.arange(2 * basis.N), held)
    u = np.zeros(2 * basis.N)
    u[free] = spsolve(K[free][:, free], f.ravel()[free])
    # sigma_r = D_22 u' + D_12 u/r of r^k and r^-k at both edges.
    of = np.array(
        [
            [(D[1, 1] * s * k + D[0, 1]) * radius ** (s * k - 1) for s in (1, -1)]
            for radius in (a, b)
        ]
    )
    A, B = np.linalg.solve(of, [-p, 0.0])
    radial = (u.reshape(-1, 2) * np.column_stack([x, y])).sum(axis=1) / np.hypot(x, y)
    exact = A * np.hypot(x, y) ** k + B * np.hypot(x, y) ** -k
    assert radial == pytest.approx(exact, abs=close * np.abs(exact).max())


def test_the_half_plane_modulus_is_that_of_its_waves():
    """The half-plane modulus follows from waves exp(i x - s y) of the half-plane y > 0.

    A wave of pressure without shear loads the surface; s follows from equilibrium.
    """
    material = OrthotropicMaterial(**LINING)
    D = plane_stress_elasticity_matrix(material)
    (along, coupled), (_, through), shear = D[0, :2], D[1, :2], D[2, 2]
    # -D11 U + G U'' + (D12 + G) i V' = 0 and -G V + D22 V'' + (D12 + G) i U' = 0 have a
    # characteristic polynomial in s^2.
    mixed = (coupled + shear) ** 2
    squares = np.roots([shear * through, -along * through - shear**2 + mixed, along * shear])
    s = np.sqrt(squares.astype(complex))
    U, V = np.ones(2, dtype=complex), (shear * s**2 - along) / (1j * (coupled + shear) * s)
    normal = through * -s * V + coupled * 1j * U
    tangential = shear * (-s * U + 1j * V)
    factors = np.linalg.solve(np.array([normal, tangential]), np.array([-1.0, 0.0]))
    assert float(np.real(factors @ V)) == pytest.approx(
        2 / material.young_modulus_of_equivalent_half_plane, rel=1e-12
    )


def test_columns_and_meshes_of_either_shape_agree():
    """Every kind of layer: linings, backing, bodies of arcs."""
    brake = orthotropic(
        vary(FLEXIBLE, {"shoe.backing": {"thickness": 0.004, "material": {"E": 2e9, "nu": 0.3}}}), 5
    )
    found = solve(brake)
    assert found.error["torque"] < 1e-4
    for options, close in (({"elements": 60}, 1e-4), ({"elements": 40, "kind": "tri2"}, 3e-4)):
        assert solve(brake, **options).torque == pytest.approx(found.torque, rel=close)
    isotropic = solve(FLEXIBLE).torque
    assert abs(found.torque / isotropic - 1) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_the_second_solver_finds_the_same_torques(seed):
    brake = orthotropic(draw_random_brake(seed), seed)
    true, found = solve_fine_reference_by_triangles(brake), solve(brake)
    for a, b in zip(true.shoes, found.shoes, strict=True):
        assert b.torque == pytest.approx(a.torque, rel=max(1e-5, 2 * found.error["torque"]))


@pytest.mark.slow
def test_the_second_solver_finds_the_same_torque_of_one_shoe():
    one = make_drum_brake_from_data(
        {
            "title": "one",
            "rotation": "clockwise",
            "friction": 0.3,
            "drum": {"radius": 0.15},
            "shoe": [
                {
                    "name": "only",
                    "side": "internal",
                    "hinge": {"radius": 0.12, "angle": 0.0},
                    "lining": {
                        "start": 0.6,
                        "end": 1.6,
                        "thickness": 0.02,
                        "width": 0.04,
                        "material": LINING,
                    },
                    "actuation": {
                        "force": 2e3,
                        "direction": math.pi / 2,
                        "point": {"x": -0.1, "y": 0.0},
                    },
                }
            ],
        }
    )
    (true,), found = solve_fine_reference_by_triangles(one).shoes, solve(one)
    assert found.shoes[0].torque == pytest.approx(
        true.torque, rel=max(1e-6, 2 * found.error["torque"])
    )
    soft = vary(one, {"shoe.lining.material": {"E": 3e8, "nu": 0.25}})
    assert abs(solve(soft).torque / found.torque - 1) > 1e-4


@settings(deadline=None, max_examples=8)
@given(st.integers(0, 10**6), st.floats(-3, 3), st.booleans())
def test_a_brake_that_is_turned_or_mirrored_has_the_same_torque(seed, turn, mirrored):
    brake = orthotropic(draw_random_brake_of_support_kind(seed % 50), seed)
    one, other = (
        solve(b, elements=6)
        for b in (brake, mirror_turn_and_shift_brake(brake, turn=turn, mirrored=mirrored))
    )
    forces = [sum(picked(one.shoes, "normal_force")), sum(picked(other.shoes, "normal_force"))]
    assert forces[1] == pytest.approx(forces[0], rel=1e-7)
    assert other.torque == pytest.approx(one.torque, rel=1e-7)


@settings(deadline=None, max_examples=8)
@given(st.integers(0, 10**6), st.floats(0.01, 100))
def test_all_moduli_and_forces_by_one_factor_leave_the_shape_of_the_pressure(seed, factor):
    brake = orthotropic(draw_random_brake(seed % 40, "arc"), seed)
    changes = {
        f"{key}.{name}": factor * E
        for key, material in parts_of(brake)
        for name, E in material.moduli.items()
    }
    changes |= of_shoes(
        "actuation.force", factor * np.array(picked(brake.shoes, "actuation.force"))
    )
    one, other = solve(brake, elements=6), solve(vary(brake, changes), elements=6)
    for a, b in zip(one.shoes, other.shoes, strict=True):
        assert b.pressure == pytest.approx(factor * a.pressure, abs=1e-8 * factor * a.peak_pressure)


@pytest.mark.parametrize("model", LAWS_OF_HINGED_SHOES_BY_NAME)
def test_closed_form_laws_refuse_directions_in_a_line_and_take_isotropic_materials(model):
    brake = next(
        read_drum_or_plane_brake(ROOT / "studies" / name)
        for name in (
            "double_shoe/brake.toml",
            "laws/pivoted_block.toml",
            "brakes/rail_clamp.toml",
            "brakes/s_cam.toml",
            "laws/short_block.toml",
            "laws/pad.toml",
        )
        if MODELS[model].why_not(read_drum_or_plane_brake(ROOT / "studies" / name)) is None
    )
    directed = vary(brake, {"shoe[0].lining.material": LINING})
    name = brake.shoes[0].name
    said = (
        f"shoe {name!r}: lining.material is orthotropic; a closed-form law takes isotropic "
        "materials only"
    )
    assert MODELS[model].why_not(directed) == said
    with pytest.raises(BadInput, match=re.escape(said)):
        drumlin.solve(directed, model=model)


def test_foundation_solid_and_width_refuse_directions_in_a_line():
    only = "isotropic materials only"
    backing = vary(POST, {"shoe[1].backing.material": LINING})
    with pytest.raises(
        BadInput, match=rf"backing\.material is orthotropic; the foundation model takes {only}"
    ):
        model_with_name_that_applies_to_brake("foundation", backing)
    rim = {"thickness": 0.02, "width": 0.05, "material": LINING}
    ring = vary(read_drum_or_plane_brake(ROOT / "studies/laws/block.toml"), {"drum.ring": rim})
    assert (
        MODELS["short"].why_not(ring)
        == f"drum.ring.material is orthotropic; a closed-form law takes {only}"
    )
    with pytest.raises(
        BadInput, match=rf"lining\.material is orthotropic; the model of the width takes {only}"
    ):
        model_with_name_that_applies_to_brake("solid", with_lining(MAIN))
    with pytest.raises(
        BadInput,
        match=r"--finite-width: .*lining\.material is orthotropic; the model of the width takes",
    ):
        solve(with_lining(MAIN), finite_width=True)
    assert picked(applicable_models(with_lining(MAIN)), "name") == ["fem"]
    assert "orthotropic" not in " ".join(reasons_why_models_do_not_apply(MAIN).values())


def test_comparing_says_which_models_do_not_apply_and_answers_by_the_elements():
    assert list(compare(with_lining(MAIN), elements=20).responses) == ["fem"]


@pytest.mark.parametrize("elements", [None, pytest.param(16, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["arcs", pytest.param("posts", marks=pytest.mark.slow)])
def test_slopes_are_those_of_differences(name, elements):
    """Slopes by moduli and points of orthotropic parts are those of differences.

    One factor scales all moduli of a part; a straight beam's directions turn with its points.
    """
    brake = orthotropic(FLEXIBLE if name == "arcs" else vary(POST, {"drum.ring": None}), 3)
    divided = MeshKindForSlopes(elements, CacheOfCondensedBodies())
    base, found = (
        divided.solve_brake_for_torque(brake),
        divided.compute_derivatives_of_brake_torque(brake),
    )
    for slope in all_torque_sensitivities_printed_for_brake(brake, found):
        off = largest_relative_difference_from_central_differences(brake, slope, divided, base)
        assert off is None or off < 0.1 * ALLOWED_SLOPE_DIFFERENCE, slope.what


def test_slopes_by_moduli_are_said_to_be_by_one_factor_on_all():
    brake = with_lining(MAIN)
    found = compute_torque_sensitivity(
        prepared_model_with_finest_elements(brake, elements=20), brake
    )
    lines = sensitivity_as_text_lines(found, brake)
    assert lines[-1] == (
        "  d ln T/d ln E of shoe 'right': lining.material, shoe 'left': lining.material: by "
        "one factor on all moduli; "
        "not given by each of them"
    )
    assert found.law is None and "one factor" not in "\n".join(
        sensitivity_as_text_lines(found, MAIN)
    )


def test_stresses_are_those_of_the_layers_directions():
    """Stresses of an orthotropic layer are those of its directions.

    At the surface of a lining on a rigid shoe the radial stress is -p, on columns as on a mesh. The
    shoe holds the lining along; through it the strain is e, and around it e t/R, as the surface
    moves inwards by t e.
    """
    brake = with_lining(
        vary(MAIN, {"shoe.body": None, "friction": 0.0, "shoe.lining.thickness": 0.004})
    )
    for scene in (
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2]),
        prepared_model_with_finest_elements(brake, elements=60),
    ):
        found = stress_and_displacement_fields_of_shoe(
            scene, brake, solve_prepared_model(scene, brake), index=1
        )
        angle = np.degrees(np.arctan2(found.points[:, 1], found.points[:, 0])) % 360
        at = np.flatnonzero((found.pressure > 0) & (angle > 150) & (angle < 220))
        n = found.points[at] / np.hypot(*found.points[at].T)[:, None]
        xx, yy, xy = found.stress[at].T
        radial = xx * n[:, 0] ** 2 + yy * n[:, 1] ** 2 + 2 * xy * n[:, 0] * n[:, 1]
        assert np.median(np.abs(radial / found.pressure[at] + 1)) < 0.01
        around = xx + yy - radial
        D, curved = (
            plane_stress_elasticity_matrix(OrthotropicMaterial(**LINING)),
            0.004 / brake.drum.radius,
        )
        expected = (D[0, 1] + D[0, 0] * curved) / (D[1, 1] + D[0, 1] * curved)
        assert np.median(around / radial) == pytest.approx(expected, rel=0.01)


def test_the_explorers_sliders_take_all_moduli_in_proportion():
    brake = with_lining(MAIN)
    slider = having(sliders_for_brake(brake), name="lining")[0]
    assert slider.start == pytest.approx(300.0)
    (softer,) = set(picked(vary(brake, slider.changes(150.0)).shoes, "lining.material"))
    assert softer.moduli == pytest.approx(
        {key: E / 2 for key, E in OrthotropicMaterial(**LINING).moduli.items()}
    )


def test_a_deck_for_calculix_has_the_nine_constants_and_the_layers_directions(tmp_path):
    post = vary(
        POST,
        {
            "drum.ring": None,
            "shoe.backing.material": LINING | ACROSS,
            "shoe.lining.material": LINING,
        },
    )
    paths, _ = calculix.export_calculix_deck_of_each_shoe(post, tmp_path, "post", elements=6)
    text = paths[0].read_text()
    lines = (
        r"NAME=BACKING\n\*ELASTIC, TYPE=ENGINEERING CONSTANTS\n(.*),\n(.*)\n\*ORIENTATION, "
        r"(.*)\n(.*)"
    )
    constants = re.search(lines, text)
    values = list(map(float, f"{constants[1]}, {constants[2]}".split(",")))
    # Through, along, across: MPa.
    assert values == pytest.approx([300, 900, 900, 0.35 / 3, 0.1, 0.3, 210, 200, 300])
    assert constants[3] == "NAME=OBACKING, SYSTEM=RECTANGULAR"
    a = np.array(list(map(float, constants[4].split(",")))).reshape(2, 3)
    shoe = post.shoes[0]
    axis = shoe.actuation.point.xy - shoe.pin.xy
    assert abs(a[1, :2] @ axis) == pytest.approx(np.hypot(*axis)) and a[0] @ a[1] == pytest.approx(
        0, abs=1e-12
    )
    assert "*ORIENTATION, NAME=OLINING, SYSTEM=CYLINDRICAL\n0., 0., 0., 0., 0., 1.\n" in text
    assert "*SOLID SECTION, ELSET=LINING, MATERIAL=LINING, ORIENTATION=OLINING\n" in text
    assert "*MATERIAL, NAME=SHOE\n*ELASTIC\n" in text


SWAPPED = {"E_along": 7e10, "E_through": 2e11, "G_along_through": 5e10, "nu_along_through": 0.1}


@pytest.mark.slow
@pytest.mark.skipif(
    install_hint_if_missing("calculix") is not None,
    reason=install_hint_if_missing("calculix") or "",
)
def test_calculix_agrees():
    brake = vary(FLEXIBLE, {"shoe.lining.material": LINING, "shoe.body.material": SWAPPED})
    own, peer = (
        solve(brake, elements=20),
        calculix.solve_brake_by_calculix(brake, elements=20).response,
    )
    for a, b in zip(own.shoes, peer.shoes, strict=True):
        assert b.torque == pytest.approx(a.torque, rel=2e-3)


@pytest.mark.skipif(
    install_hint_if_missing("getfem") is not None, reason=install_hint_if_missing("getfem") or ""
)
@pytest.mark.parametrize("name", ["arcs", "posts"])
def test_getfem_agrees(name):
    arcs = vary(FLEXIBLE, {"shoe.lining.material": LINING, "shoe.body.material": SWAPPED})
    brake = (
        arcs if name == "arcs" else vary(POST, {"drum.ring": None, "shoe.backing.material": LINING})
    )
    own, peer = (
        solve(brake, elements=20),
        getfem.solve_brake_in_getfem_process(brake, elements=20).response,
    )
    for a, b in zip(own.shoes, peer.shoes, strict=True):
        assert b.torque == pytest.approx(a.torque, rel=1e-4 if name == "arcs" else 1e-3)


def test_a_pad_on_a_plane_has_straight_layers():
    clamp = orthotropic(read_drum_or_plane_brake(ROOT / "studies/brakes/rail_clamp.toml"), 2)
    scenes = (
        make_prepared_model(clamp, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2]),
        prepared_model_with_finest_elements(clamp, elements=60),
    )
    by_columns, by_mesh = (solve_prepared_model(scene, clamp) for scene in scenes)
    for a, b in zip(by_columns.shoes, by_mesh.shoes, strict=True):
        assert b.normal_force == pytest.approx(a.normal_force, rel=1e-4)
        assert b.hinge_reaction == pytest.approx(a.hinge_reaction, abs=1e-3 * a.normal_force)


def nearly(material):
    """An orthotropic material that is all but isotropic: Lekhnitskii's roots must differ."""
    return OrthotropicMaterial(**(alike(material) | {"E_along": material.E * (1 + 1e-4)}))


@pytest.mark.parametrize("inward", [-0.3, 0.0, 0.1, 0.4, 0.8])
@pytest.mark.parametrize("nu", [0.0, 0.45])
def test_the_power_of_p_at_a_corner_tends_to_that_of_isotropic_materials(inward, nu):
    lining = nearly(Material(E=1.0, nu=nu))
    assert pressure_exponent_at_orthotropic_corner(inward, lining) == pytest.approx(
        pressure_exponent_at_lining_corner(inward, nu), abs=1e-4
    )
    drum = Material(E=4.0, nu=0.3)
    found = pressure_exponent_at_orthotropic_corner(inward, lining, drum, 2.0)
    assert found == pytest.approx(
        pressure_exponent_at_lining_corner(inward, nu, 2.0 / 4.0, 0.3), abs=1e-4
    )
    assert pressure_exponent_at_orthotropic_corner(
        inward, lining, nearly(drum), 2.0
    ) == pytest.approx(found, abs=1e-4)


@pytest.mark.parametrize("stiffer", [1.0, pytest.param(3.0, marks=pytest.mark.slow)])
def test_a_pressed_corner_has_the_power_of_p_of_its_material(stiffer):
    """The pressure at a pressed corner has the power of its orthotropic material.

    Nodes lie near the edge of a pad on a guide that friction drags into the pad, on columns graded
    to this edge.
    """
    changes = {"shoe.lining.material.E_along": 3e8 * stiffer, "friction": 0.3}
    brake = vary(pad(0.02, LINING), changes)
    (found,) = solve_prepared_model(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[5]), brake
    ).shoes
    (lower, _) = sorted(pressure_exponents_at_both_lining_corners(brake, 0))
    r = np.geomspace(2e-6, 4e-5, 12)
    power = np.polyfit(np.log(r), np.log(found.pressure_at(r)), 1)[0]
    assert power == pytest.approx(lower, abs=5e-3)
    assert abs(lower - pressure_exponent_at_lining_corner(0.3, 0.35)) > 0.01
