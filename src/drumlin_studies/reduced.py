"""A brake sketched: its linings on coarse meshes, shoes and ring in closed form: a scene like any
other.

What is behind the lining only adds flexibility to its contact nodes. Where a part is left out, the
change of such a sketch says beforehand what that does to the brake: see omission.py.

Shoe: a bar that carries, beyond each of its sections, the contact's forces and the actuation
(Timoshenko: Strength of Materials II). With bending moment m, normal force n and shear force v of
unit loads the flexibility is

    F_ij = Int (m_i m_j/EI + n_i n_j/EA + kappa v_i v_j/GA) ds.

Ring: plane stress in Fourier series around the drum, u_r = U(r) cos k theta, u_theta = V(r) sin k
theta, polynomials of degree DEGREE through its thickness: exact for both supports, thick and thin
(DEGREE is not seen in any digit that is used). Waves much shorter than the thickness meet a
half-plane (Johnson, Contact Mechanics, section 13.2): to 1 %.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Backing, Bar, Beam, Lining, Ring, Section, bonded
from drumlin.brake.fields import Material
from drumlin.brake.orthotropic import isotropic_only
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.cache import shape_of
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel, why_not
from drumlin.fem.substructure.interface import edge_points
from drumlin.fem.substructure.ring import RingSubstructure

ELEMENTS = 24
"""Default number along a lining of a sketch, whose change is to be within a factor of two."""
SECTIONS = 4 * ELEMENTS
"""Sections of a shoe: some a contact element, as the shoe is longer than its lining. Half of them
is not noticed by any test of the predictions.
"""
WAVES = 8
"""Waves of the ring on the shortest contact: a pressure that rises and falls has few that are
shorter.
"""
MODES = 3 * ELEMENTS
"""Least number of modes of the ring: as many as the nodes of a lining resolve over a third of the
drum.
"""
MOST_MODES = 4000
DEGREE = 6
"""Degree of a ring's displacement through its thickness: it is not seen in any digit that is used.
"""
SHORT = 7.0
"""Radians of a wave through the ring's thickness from which on the wave meets a half-plane, to 1 %.
"""
STIFF = 1e5
"""Factor by which a sketched straight beam is meshed stiffer than it is: rigid, but for 1e-5."""
SHEAR = 6 / 5  # kappa of a rectangular section


def sketcher(elements: int = ELEMENTS) -> Callable[[Brake], PreparedModel]:
    """A function that makes the sketch of a brake, a scene to `respond` on; it meshes equal linings
    once.

    It raises BadInput for what finite elements do not cover.
    """
    meshed: dict[Brake, PreparedModel] = {}

    def sketch(brake: Brake) -> PreparedModel:
        reason = why_not(brake) or isotropic_only(brake, "a sketch")
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")
        bare = _rigid(brake)
        if bare not in meshed:
            meshed[bare] = prepare(bare, elements=elements, kind=DEFAULT_KIND)
        return _with_closed_forms(
            meshed[bare], brake, min(end - start for start, end in (s.arc for s in brake.shoes))
        )

    return sketch


def _with_closed_forms(scene: PreparedModel, brake: Brake, shortest: float) -> PreparedModel:
    """A scene of rigid shoes on a rigid drum with the flexibilities added that `brake` has and its
    own has not.

    shortest [rad]: contact that the ring's waves are to resolve. Raises NoAnswer where that takes
    too many.
    """
    made: dict[tuple[object, ...], ShoeSubstructure] = {}
    bodies = []
    for body, shoe, bare in zip(scene.bodies, brake.shoes, scene.brake.shoes, strict=True):
        key = shape_of(brake, shoe)
        if key not in made:
            made[key] = body if shoe.body == bare.body else _flexible(body, shoe, brake.size)
        bodies.append(made[key])
    ring = scene.ring
    if ring is None and brake.ring is not None:
        count = max(MODES, math.ceil(2 * math.pi * WAVES / max(shortest, 1e-9)))
        if count > MOST_MODES:
            raise NoAnswer(f"a contact of {shortest:.1e} rad is too short for the waves of a ring")
        ring = _ring(brake, brake.ring, tuple(bodies), count)
    return replace(scene, brake=brake, bodies=tuple(bodies), ring=ring)


def _rigid(brake: Brake) -> Brake:
    """The brake without ring and with rigid shoes; a straight beam stays, as the end of its block,
    and is stiff.
    """

    def rigid(shoe: Shoe) -> Shoe:
        if not isinstance(shoe.body, Beam):
            return shoe.model_copy(update={"body": None}) if shoe.mesh is None else shoe
        section = shoe.body.section
        assert section is not None  # why_not
        stiff = section.material.model_copy(
            update={key: STIFF * E for key, E in section.material.moduli.items()}
        )
        body = shoe.body.model_copy(
            update={"width": section.width, "material": stiff, "bending_stiffness": None}
        )
        return shoe.model_copy(update={"body": body})

    return brake.without_ring().model_copy(
        update={"shoes": tuple(rigid(shoe) for shoe in brake.shoes)}
    )


def _flexible(body: ShoeSubstructure, shoe: Shoe, radius: float) -> ShoeSubstructure:
    """The body of a rigid shoe with the shoe's own flexibility added."""
    bar, coupling = _bar(shoe, radius), body.coupling
    nodal = bar.half(body.line.xy)
    pressed, dragged = -nodal @ coupling.N.T, nodal @ coupling.T.T
    load = bar.half(body.load_centre[:, None], beyond=np.ones((len(bar.along), 1)))
    couple = np.concatenate([bar.bending, np.zeros(2 * len(bar.along))])[:, None]
    loaded = np.hstack([load, couple])
    return replace(
        body,
        closure_by_pressure=body.closure_by_pressure - pressed.T @ pressed,
        closure_by_friction=None
        if body.closure_by_friction is None
        else body.closure_by_friction - pressed.T @ dragged,
        closure_by_load=body.closure_by_load - pressed.T @ loaded,
    )


class _Bar(NamedTuple):
    """A shoe's axis in its own frame: section points `at` (m, 2) [m] and unit `tangent` (m, 2) away
    from the hinge.

    `along` (m,): the place of a section, and `place(xy)` of a contact point, on the way from the
    hinge; `bending`, `stretching`, `shearing` (m,): roots of ds/EI, ds/EA and kappa ds/GA.
    """

    at: Floats
    tangent: Floats
    along: Floats
    foot: Floats
    bending: Floats
    stretching: Floats
    shearing: Floats
    round: bool

    def half(self, xy: Floats, beyond: Floats | None = None) -> Floats:
        """S (3 m, 2 n) with S^T S the flexibility of forces x, y at the points xy (2, n)."""
        if beyond is None:
            if self.round:  # place: angle from the shoe's hinged end
                turn = np.abs(np.arctan2(xy[1], xy[0]) - self.foot[0])
            else:
                turn = (xy.T - self.foot) @ self.tangent[0]
            beyond = (turn > self.along[:, None]).astype(float)
        arm = xy.T - self.at[:, None]  # (m, n, 2)
        moment = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)  # of forces x and y
        normal = np.broadcast_to(self.tangent[:, None], arm.shape)
        shear = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
        parts = [(moment, self.bending), (normal, self.stretching), (shear, self.shearing)]
        return np.concatenate(
            [
                (part * (beyond * root[:, None])[..., None]).reshape(len(root), -1)
                for part, root in parts
            ]
        )


def _bar(shoe: Shoe, radius: float) -> _Bar:
    """The bar of a shoe. Behind its lining an arc bends as one section with its backing and lining."""
    body = shoe.body
    assert body is not None  # why_not
    plates = list(body.plates.values())[::-1]
    middle = (np.arange(SECTIONS) + 0.5) / SECTIONS
    if isinstance(body, Bar):
        near, far = sorted(shoe.frame.phis((body.start, body.end)), key=abs)
        phi = near + (far - near) * middle
        start, end = shoe.arc
        over = [_layer(shoe, layer) for layer in (shoe.backing, shoe.lining) if layer is not None]
        alone, together = bonded(plates), bonded([*plates, *over])
        lined = (phi > start) & (phi < end)
        depth, EI, EA, GA = np.where(lined, np.array(together)[:, None], np.array(alone)[:, None])
        axis = radius - shoe.sign * (shoe.depth - depth)
        along, foot = np.abs(phi - near), np.array([near])
        at = (axis * np.array([np.cos(phi), np.sin(phi)])).T
        tangent = math.copysign(1.0, far - near) * np.column_stack([-np.sin(phi), np.cos(phi)])
        ds = axis * abs(far - near) / SECTIONS
    else:
        hinge, end_ = shoe.frame.to_shoe(shoe.pin.xy), shoe.frame.to_shoe(shoe.actuation.point.xy)
        line = axis_of(hinge, end_)
        along, foot = line.length * middle, hinge
        at, tangent = hinge + along[:, None] * line.along, np.tile(line.along, (SECTIONS, 1))
        ds = np.full(SECTIONS, line.length / SECTIONS)
        _, EI, EA, GA = np.array(bonded(plates))[:, None]
    return _Bar(
        at=at,
        tangent=tangent,
        along=along,
        foot=foot,
        bending=np.sqrt(ds / EI),
        stretching=np.sqrt(ds / EA),
        shearing=np.sqrt(SHEAR * ds / GA),
        round=isinstance(body, Bar),
    )


def _layer(shoe: Shoe, layer: Lining | Backing) -> Section:
    return Section(layer.thickness, shoe.lining.width, layer.material)


def _ring(
    brake: Brake, ring: Ring, bodies: tuple[ShoeSubstructure, ...], count: int
) -> RingSubstructure:
    """The ring under the linings of all shoes: half flexibilities (2 count + 2, n) of each."""
    sign, radius, section = brake.shoes[0].sign, brake.size, ring.section
    assert section is not None  # why_not
    k = np.arange(count + 1)
    radial, shear = ring_modes(ring, radius, sign, k)
    share = np.where(k == 0, 0.5, 1.0) / (math.pi * radius * section.width)
    root = np.sqrt(share * radial)
    turned = np.where(k == 0, 0.0, sign * share * shear / root)
    pressed, dragged = [], []
    for body, shoe in zip(bodies, brake.shoes, strict=True):
        c, s = _waves(body, shoe, k)
        pressed.append(np.vstack([root[:, None] * c, root[:, None] * s]))
        dragged.append(np.vstack([-turned[:, None] * s, turned[:, None] * c]))
    return RingSubstructure(
        mesh=None,
        basis=None,
        line=bodies[0].line,
        condensed=None,  # type: ignore[arg-type]
        pressed=tuple(pressed),
        dragged=tuple(dragged),
        coupled=(),
        support=k,
        free=None,
    )


def _waves(body: ShoeSubstructure, shoe: Shoe, k: Ints) -> tuple[Floats, Floats]:
    """b Int psi_i cos k theta ds and that with sin, of the brake's angle theta: two arrays (modes,
    n) [m^2].
    """
    line = body.line
    psi, x, ds = edge_points(line.xy[:, line.pieces])
    wave = np.exp(1j * k[:, None, None] * shoe.frame.theta(shoe.phi_of(x, 1.0)))
    found = np.zeros((len(k), len(line.nodes)), dtype=complex)
    for value, nodes in zip(psi, line.pieces, strict=True):  # no node twice in one row of pieces
        found[:, nodes] += shoe.lining.width * (wave * (value * ds)).sum(axis=2)
    return found.real, found.imag


def ring_modes(ring: Ring, radius: float, sign: int, modes: Ints) -> tuple[Floats, Floats]:
    """Radial displacement [m] of the friction surface per Pa of its traction, for the modes k (m,),
    growing: two arrays (m,).

    Of the traction cos k theta along the radius, and of sin k theta around the drum. The mean
    motion of a free rim is zero and the force that it takes is spread over it as a rigid motion.
    """
    section = ring.section
    assert section is not None  # why_not
    assert isinstance(section.material, Material)  # sketcher
    E, nu = section.material.E, section.material.nu
    long = modes * section.thickness <= SHORT * radius
    if not long.all():
        over = radius / (E * modes[~long])
        found = ring_modes(ring, radius, sign, modes[long])
        return np.append(found[0], 2 * over), np.append(found[1], (1 - nu) * over)
    x = -np.cos(math.pi * np.arange(DEGREE + 1) / DEGREE)
    V = np.linalg.inv(np.polynomial.legendre.legvander(x, DEGREE))
    xi, w = np.polynomial.legendre.leggauss(DEGREE + 2)
    psi = np.polynomial.legendre.legvander(xi, DEGREE) @ V
    derivative = np.array(
        [np.polynomial.legendre.legval(xi, np.polynomial.legendre.legder(c)) for c in V.T]
    ).T
    half = sign * section.thickness / 2
    r = radius + half * (1 + xi)
    d, over = derivative / half, psi / r[:, None]
    zero = np.zeros_like(psi)
    n = modes[:, None, None]
    # strains (m, q, 2 nodes): radial, around, shear
    e_r = np.broadcast_to(np.hstack([d, zero]), (len(modes), len(xi), 2 * (DEGREE + 1)))
    e_t = np.concatenate([over + 0 * n, n * over], axis=2)
    g = np.concatenate([-n * over, d - over + 0 * n], axis=2)
    weight = (w * abs(half) * r)[:, None] * E / (1 - nu**2)

    def product(a: Floats, b: Floats) -> Floats:
        return np.asarray(a.transpose(0, 2, 1) @ (weight * b))

    K = product(e_r, e_r + nu * e_t) + product(e_t, e_t + nu * e_r) + (1 - nu) / 2 * product(g, g)
    size, rim = DEGREE + 1, DEGREE
    hold = np.zeros((len(modes), 2 * size, 2))
    if ring.support == "fixed":
        hold[:, rim, 0] = hold[:, size + rim, 1] = 1.0
    else:
        hold[modes == 0, size + rim, 0] = 1.0
        hold[modes == 1, rim, 0], hold[modes == 1, size + rim, 0] = 1.0, -1.0
    scale = np.abs(K).max()
    bordered = np.zeros((len(modes), 2 * size + 2, 2 * size + 2))
    bordered[:, : 2 * size, : 2 * size] = K
    bordered[:, : 2 * size, 2 * size :] = scale * hold
    bordered[:, 2 * size :, : 2 * size] = scale * hold.transpose(0, 2, 1)
    for j in range(2):  # holds that a mode does not have
        bordered[:, 2 * size + j, 2 * size + j] = np.where(hold[:, :, j].any(axis=1), 0.0, scale)
    load = np.zeros((len(modes), 2 * size + 2, 2))
    load[:, 0, 0] = load[:, size, 1] = radius
    u = np.linalg.solve(bordered, load)
    return np.asarray(u[:, 0, 0]), np.asarray(u[:, 0, 1])
