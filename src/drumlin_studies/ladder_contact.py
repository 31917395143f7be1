"""The ladder's contact without friction history: half-planes, discs, rings, layers, sharp sliding
edges.
"""

import math
from functools import cache, partial

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import Problem
from drumlin.fem.mesh.grading import graded
from drumlin.response.resultants import integrate
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import DISCRETE, MODEL, KnownAnswer
from drumlin_studies.two_bodies import (
    LADDER_STEEL,
    BodyPair,
    ContactBody,
    body,
    both_sides,
    closed,
    nested_start,
    sector,
    towards,
)

HALF_WIDTH = 0.005
"""Half-width of the contact between half-planes [m].

Thick sectors of radius 1 m stand for the half-planes. The contact is so short against the radius
that the curvature of the sectors has no effect.
"""
GAP_RADIUS = 2.0
RING_WAVES = 40


def half_plane(sign: int, per_half: int, material: Material = LADDER_STEEL) -> ContactBody:
    """A thick sector of radius 1 with even elements, `per_half` to the half-width A, near the
    contact.
    """
    angles = both_sides(2 * HALF_WIDTH, 4 * per_half, 1.35, 0.5)
    return body(sector(angles, towards(HALF_WIDTH / per_half, 1.3, 0.5), 1.0, sign), material)


def answer(problem: Problem) -> Floats:
    """Pressures (n,) [Pa]."""
    return active_set.solve(problem, nested_start(problem)).p


def _hertz() -> float:
    """Peak pressure of equal half-planes over the closed form."""
    load = HALF_WIDTH**2 * math.pi * LADDER_STEEL.E / 2 / (4 * GAP_RADIUS)
    pair = BodyPair.of(half_plane(-1, 16), half_plane(1, 13), motions="x")
    p = answer(pair.normal(pair.angle**2 / (2 * GAP_RADIUS), [load]))
    return float(p.max() / closed_forms.hertz(load, GAP_RADIUS, LADDER_STEEL.E / 2)[1])


@cache
def _cylinder_on_block() -> tuple[float, float]:
    """Peak pressure [N/mm^2] and half-width [mm] of the benchmark's steel cylinder on aluminium, 35
    kN on 1 mm.

    Plane strain is plane stress of E/(1 - nu^2), nu/(1 - nu); lengths are scaled so that the
    half-width is A.
    """
    steel, aluminium = (Material(E=E / (1 - 0.3**2), nu=0.3 / 0.7) for E in (210e9, 70e9))
    scale = 6.21e-3 / HALF_WIDTH
    load = 35e3 / 1e-3 / scale
    pair = BodyPair.of(half_plane(-1, 16, steel), half_plane(1, 13, aluminium), motions="x")
    s = pair.angle
    p = answer(pair.normal(s**2 / (2 * 0.05 / scale), [load]))
    # p^2 falls linearly in s^2 towards a^2
    near = np.abs(s) < 0.8 * HALF_WIDTH
    slope, top = np.polyfit(s[near] ** 2, p[near] ** 2, 1)
    return float(p.max() * 1e-6), math.sqrt(-top / slope) * scale * 1e3


def _flat_punch() -> float:
    """Pressure in the middle of a rigid punch of half-width A on a half-plane, over P/(pi A)."""
    pair = BodyPair.of(half_plane(-1, 24), None, motions="x")
    s = pair.angle
    load = 1e6
    p = answer(pair.normal(np.where(np.abs(s) < HALF_WIDTH * (1 + 1e-9), 0.0, 1.0), [load]))
    inside = np.abs(s) < 0.5 * HALF_WIDTH
    return float(np.mean(p[inside] / closed_forms.flat_punch(load, HALF_WIDTH, s[inside])))


@cache
def _disc(half_angle: float) -> tuple[float, float]:
    """Pressure in the middle and contact half-angle over Persson's, of a disc in a hole of a large
    plate.
    """
    eps, load = math.radians(half_angle), 1e6

    def angles(count: int) -> Floats:
        inner = graded(-eps, eps, count, eps / 2, 1 / 40)
        return np.concatenate([inner, graded(eps, 2 * math.pi - eps, count, 0.4, eps / 200)[1:-1]])

    disc = body(closed(angles(30), towards(0.01, 1.3, 0.985), 1.0, -1), LADDER_STEEL)
    plate = body(closed(angles(36), towards(0.01, 1.3, 39.0), 1.0, 1), LADDER_STEEL)
    pair = BodyPair.of(disc, plate, motions="x")
    b = math.tan(eps / 2)
    gap = closed_forms.persson_clearance(b) * load / LADDER_STEEL.E * (1 - np.cos(pair.angle))
    p = answer(pair.normal(gap, [load]))
    middle = int(np.argmin(np.abs(pair.angle)))
    touching = pair.angle[p > 0]
    exact = closed_forms.persson_pressure(b, pair.angle[[middle]])[0] * load
    return float(p[middle] / exact), float(np.ptp(touching) / (2 * eps))


def _wavy(share: float) -> float:
    """Pressure at the crests of a ring in a wavy ring over Westergaard's, mean pressure about
    `share` of p*.
    """
    count = 12 * RING_WAVES
    angles = np.linspace(-math.pi, math.pi, count + 1)[:-1]
    depths = towards(2 * math.pi / count, 1.4, 0.5)
    inner, outer = (body(closed(angles, depths, 1.0, sign), LADDER_STEEL) for sign in (-1, 1))
    pair = BodyPair.of(inner, outer)
    height = 1e-6
    full = math.pi * LADDER_STEEL.E / 2 * height * RING_WAVES / (2 * math.pi)
    soft = sum(
        abs(closed_forms.ring_yield(0, 1.0, held, LADDER_STEEL.E, LADDER_STEEL.nu))
        for held in (0.5, 1.5)
    )
    p = active_set.solve(
        pair.normal(-height * np.cos(RING_WAVES * pair.angle) - share * full * soft)
    ).p
    mean = float(integrate(pair.angle, p, 2) / np.ptp(pair.angle))
    crests = np.abs(np.cos(RING_WAVES * pair.angle) - 1) < 1e-9
    return float(p[crests].mean() / closed_forms.westergaard(mean, full, np.array(0.0)))


@cache
def _rings() -> tuple[BodyPair, Floats]:
    """Two concentric rings held at .6 and 1.4, on meshes that do not match; and their angles."""
    circle = [np.linspace(-math.pi, math.pi, count + 1)[:-1] for count in (48, 60)]
    inner = body(closed(circle[0], np.linspace(0, 0.4, 6), 1.0, -1), LADDER_STEEL)
    outer = body(closed(circle[1] + 0.01, np.linspace(0, 0.4, 7), 1.0, 1), LADDER_STEEL)
    pair = BodyPair.of(inner, outer)
    return pair, pair.angle


@cache
def _pressed_rings(n: int) -> tuple[float, float]:
    """Mean and n-th harmonic [Pa] of p between the rings, where the gap is that of 3 MPa + 1 MPa
    cos(n theta).
    """
    pair, angle = _rings()
    soft = [
        closed_forms.ring_yield(k, 1.0, 0.6, LADDER_STEEL.E, LADDER_STEEL.nu)
        - closed_forms.ring_yield(k, 1.0, 1.4, LADDER_STEEL.E, LADDER_STEEL.nu)
        for k in (0, n)
    ]
    p = active_set.solve(pair.normal(3e6 * soft[0] + 1e6 * soft[1] * np.cos(n * angle))).p
    columns = np.column_stack([np.ones_like(angle), np.cos(n * angle), np.sin(n * angle)])
    fit = np.linalg.lstsq(columns, p, rcond=None)[0]
    return float(fit[0]), float(fit[1])


def _bonded_layer() -> float:
    """Stiffness [Pa/m] in the middle of a thin lining, held at its back, under a rigid drum pressed
    in evenly.
    """
    thickness, depth = 1e-3, 1e-6
    angles = np.linspace(-0.03, 0.03, 61)
    pair = BodyPair.of(
        body(sector(angles, np.linspace(0, thickness, 4), 1.0, -1), CONTACT_LINING), None
    )
    p = active_set.solve(pair.normal(np.full(len(pair.angle), -depth))).p
    return float(p[len(p) // 2] / depth)


@cache
def _strip(nu: float) -> BodyPair:
    """A strip with sharp edges, rigid at its back; elements shrink to 1e-7 of its thickness at its
    ends and face.
    """
    fine = towards(1e-8, 1.45, 0.1)
    angles = np.concatenate([-0.1 + fine, (0.1 - fine)[::-1][1:]])
    return BodyPair.of(
        body(sector(angles, towards(1e-8, 1.45, 0.05), 1.0, -1), Material(E=3e8, nu=nu)), None
    )


def _edge_exponent(mu: float, nu: float) -> float:
    """lambda of p ~ r^(lambda - 1) at the edge that the drum runs onto."""
    pair, thickness = _strip(nu), 0.05
    matrix = pair.pressed.T @ (pair.pressed + mu * pair.dragged)
    n = len(pair.angle)
    q = pair.coupling.M @ np.full(n, -1e-4 * thickness)
    p = active_set.solve(Problem(matrix, q, np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0))).p
    r = pair.angle - pair.angle[0]
    near = (r > 1e-5 * thickness) & (r < 3e-3 * thickness)
    return float(1 + np.polyfit(np.log(r[near]), np.log(p[near]), 1)[0])


CONTACT_LINING = Material(E=3e8, nu=0.25)
KONTER = "Konter, Advanced FE contact benchmarks (NAFEMS 2006), 2D cylinder; Hertz"
MICHELL, PERSSON = (
    "Michell 1899, rings held at .6 and 1.4",
    "Persson 1964; Ciavarella & Decuzzi 2001",
)
CONTACT_CASES = (
    KnownAnswer(
        "equal cylinders",
        "contact of two bodies",
        "Hertz 1881",
        "p_0 over the closed form",
        1.0,
        4e-3,
        DISCRETE,
        _hertz,
    ),
    KnownAnswer(
        "cylinder on a block",
        "contact of two materials",
        KONTER,
        "peak pressure [N/mm^2]",
        3585.37,
        1e-2,
        DISCRETE,
        lambda: _cylinder_on_block()[0],
    ),
    KnownAnswer(
        "cylinder on a block",
        "contact of two materials",
        KONTER,
        "half-width [mm]",
        6.21,
        1e-2,
        DISCRETE,
        lambda: _cylinder_on_block()[1],
    ),
    KnownAnswer(
        "rigid flat punch",
        "contact with a sharp end",
        "Sadowsky 1928",
        "p over the closed form, |x| < a/2",
        1.0,
        2e-2,
        DISCRETE,
        _flat_punch,
    ),
    *(
        KnownAnswer(
            "disc in a hole",
            "conforming contact",
            PERSSON,
            f"p(0) over the closed form, {angle} deg",
            1.0,
            1e-2,
            DISCRETE,
            partial(lambda angle: _disc(angle)[0], angle),
        )
        for angle in (30, 75)
    ),
    KnownAnswer(
        "disc in a hole",
        "conforming contact",
        PERSSON,
        "half-angle of contact over the closed form, 75 deg",
        1.0,
        1e-2,
        DISCRETE,
        lambda: _disc(75)[1],
    ),
    KnownAnswer(
        "wavy surface, full contact",
        "contact without ends",
        "Westergaard 1939",
        "p at crests over the closed form",
        1.0,
        1e-2,
        DISCRETE,
        partial(_wavy, 1.5),
    ),
    KnownAnswer(
        "wavy surface, partial contact",
        "many contacts",
        "Westergaard 1939",
        "p at crests over the closed form",
        1.0,
        3e-2,
        DISCRETE,
        partial(_wavy, 0.2),
    ),
    KnownAnswer(
        "ring pressed into a ring",
        "patch test on the arc, other meshes",
        "Lame 1852",
        "mean p [Pa]",
        3e6,
        2e-4,
        DISCRETE,
        lambda: _pressed_rings(2)[0],
    ),
    KnownAnswer(
        "rings pressed by p_0 + p_1 cos 2 theta",
        "contact of rings, other meshes",
        MICHELL,
        "p_1 [Pa]",
        1e6,
        5e-4,
        DISCRETE,
        lambda: _pressed_rings(2)[1],
    ),
    KnownAnswer(
        "eccentric ring in a ring",
        "contact of rings, other meshes",
        MICHELL + ", off centre: cos theta",
        "p_1 [Pa]",
        1e6,
        5e-4,
        DISCRETE,
        lambda: _pressed_rings(1)[1],
    ),
    KnownAnswer(
        "thin bonded lining",
        "lining as springs",
        "E/((1 - nu^2) t) in the limit",
        "stiffness [Pa/m]",
        closed_forms.bonded_layer(CONTACT_LINING.E, CONTACT_LINING.nu, 1e-3),
        5e-3,
        MODEL,
        _bonded_layer,
    ),
    *(
        KnownAnswer(
            "sharp sliding edge",
            "singular pressure",
            "eigenvalue of the corner (Williams 1952)",
            f"lambda, nu = {nu}, mu = {mu}",
            closed_forms.corner_exponent(mu, nu),
            1e-2,
            DISCRETE,
            partial(_edge_exponent, mu, nu),
        )
        for nu, mu in ((0.1, 0.3), (0.3, 0.3), (0.3, 0.5), (0.45, 0.3))
    ),
)
