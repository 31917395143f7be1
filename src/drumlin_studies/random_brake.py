"""Random brakes of every kind that a brake file can express, drawn from a seed.

Sizes are drawn on logarithmic scales: drums of 20 mm to 3 m, linings of R/1000 to R/3 and of 1 to
170 deg, moduli over decades. Forces follow from the pressures that linings are made for, clearances
and misfits from the compression that these make, so that the contact is now whole, now partial.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import brake_from, vary
from drumlin.fem.solve import solve
from drumlin.laws import locking_friction, sine

COARSE = 4  # elements of the mesh that shows whether a brake has an answer without friction
TRIED = 16  # and of that which shows whether it has one with its own
BELOW = 0.7  # of the friction at which the sine law locks, that a brake has at most
MARGIN = 1.2  # of its friction up to which the elastic brake must have an answer too
ATTEMPTS = 400

Draw = Callable[[np.random.Generator], dict[str, Any]]


def random_brake(seed: int, kind: str | None = None) -> Brake:
    """The brake of a seed; `kind`: one of KINDS, by default seed modulo their number, or of WAYS.

    Every shoe is pressed, and friction is 0 or below what locks. Of WAYS: one shoe, "locking" where
    the sine law locks below mu = 1.5, "opposed" where it never does, with friction left to the
    caller.
    """
    if kind in WAYS:
        return _one_shoe(seed, str(kind))
    names = list(KINDS)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, names.index(kind), attempt])
        data = KINDS[kind](rng)
        mu, rotation = rng.uniform(0.02, 0.6), str(rng.choice(["clockwise", "counter-clockwise"]))
        data |= {"title": f"random {kind} {seed}", "rotation": rotation, "friction": 0.1}
        without = rng.random() < 0.12
        try:
            brake = brake_from(data)
            lock = min(locking_friction(brake, shoe) for shoe in brake.shoes)
            friction = 0.0 if without else min(mu, BELOW * lock)
            brake = vary(brake, {"friction": float(f"{friction:.4g}")})
            if _pressed(brake, MARGIN) and _pressed(brake, 1.0):
                return brake
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(f"no brake of kind {kind} from seed {seed} in {ATTEMPTS} attempts")


def _pressed(brake: Brake, margin: float) -> bool:
    response = solve(vary(brake, {"friction": margin * brake.friction}), elements=TRIED)
    return all(shoe.contact_arcs for shoe in response.shoes)


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    """Between 10^low and 10^high."""
    return float(f"{10 ** rng.uniform(low, high):.4g}")


def _material(rng: np.random.Generator, low: float, high: float) -> dict[str, float]:
    return {"E": _log(rng, low, high), "nu": round(float(rng.uniform(0.0, 0.45)), 3)}


def _arc_shoe(
    rng: np.random.Generator,
    R: float,
    *,
    body: bool = True,
    backing: bool = False,
    arc: tuple[float, float] = (0.35, 2.6),
    lining: tuple[float, float] = (-2.0, -1.0),
    E: tuple[float, float] = (7.7, 9.5),
    E_body: tuple[float, float] = (10.0, 11.5),
    depth: tuple[float, float] = (-1.3, -0.6),
    inside: bool | None = None,
    largest: float = 2.9,
) -> dict[str, Any]:
    """A shoe whose lining lies on an arc [rad], from its hinge at a random angle."""
    u = rng.uniform
    inside = bool(rng.random() < 0.6) if inside is None else inside
    origin, hand = u(-3, 3), int(rng.choice([-1, 1]))
    gap, span = u(0.05, 0.35), math.exp(u(*np.log(arc)))
    span = min(span, largest - gap)
    start, end = sorted([origin + hand * gap, origin + hand * (gap + span)])
    far = origin + hand * (gap + span)
    width = R * _log(rng, -0.9, -0.2)
    t = R * _log(rng, *lining)
    shoe: dict[str, Any] = {
        "name": "shoe",
        "side": "internal" if inside else "external",
        "hinge": {"radius": R * (u(0.5, 0.9) if inside else u(1.1, 1.5)), "angle": origin},
        "lining": {
            "start": start,
            "end": end,
            "thickness": t,
            "width": width,
            "material": _material(rng, *E),
        },
        "actuation": {
            "direction": far + (0 if inside else math.pi) + u(-0.6, 0.6),
            "point": {
                "radius": R * (u(0.6, 0.95) if inside else u(1.05, 1.5)),
                "angle": far + hand * u(0.0, 0.15),
            },
        },
    }
    if backing:
        shoe["backing"] = {
            "thickness": R * _log(rng, -2.3, -1.0),
            "material": _material(rng, 8.7, 11.3),
        }
    if body:
        over = [gap * u(0.1, 0.9), u(0.005, 0.12)][::hand]
        shoe["body"] = {
            "thickness": R * _log(rng, *depth), "width": width * _log(rng, -0.8, 0.2),
            "start": start - over[0], "end": end + over[1], "material": _material(rng, *E_body),
        }  # fmt: skip
    shoe["actuation"]["force"] = _force(rng, shoe, R)
    return shoe


def _force(rng: np.random.Generator, shoe: dict[str, Any], R: float) -> float:
    """A force that presses the lining by 1e-4 to 1e-2 of its modulus if spread over a third of it."""
    lining = shoe["lining"]
    pressure = lining["material"]["E"] * _log(rng, -4, -2)
    return float(f"{pressure * R * (lining['end'] - lining['start']) * lining['width'] / 3:.4g}")


def _compression(shoe: dict[str, Any], R: float) -> float:
    """How far that force presses the lining together [m], about."""
    lining = shoe["lining"]
    area = R * (lining["end"] - lining["start"]) * lining["width"]
    return shoe["actuation"]["force"] / area * lining["thickness"] / lining["material"]["E"]


def _post(rng: np.random.Generator, R: float) -> dict[str, Any]:
    """A straight beam outside the drum, with a block between it and the lining."""
    u = rng.uniform
    turn, hand = u(-math.pi, math.pi), int(rng.choice([-1, 1]))
    t, depth = R * _log(rng, -2.2, -1.1), R * _log(rng, -0.9, -0.35)
    back = R + t
    distance = back + R * u(0.04, 0.3) + depth / 2
    half = u(0.25, 0.85)
    first, last = -half * u(0.6, 1.0), half * u(0.6, 1.0)
    foot, far = back * math.sin(-first) + R * u(0.15, 0.8), back * math.sin(last) + R * u(0.15, 0.8)

    def point(along: float) -> dict[str, float]:
        """At this distance along the beam from where it is nearest to the drum."""
        c, s = math.cos(turn), math.sin(turn)
        return {"x": distance * c - hand * along * s, "y": distance * s + hand * along * c}

    start, end = sorted([turn + hand * first, turn + hand * last])
    width = R * _log(rng, -0.9, -0.3)
    shoe = {
        "name": "shoe",
        "side": "external",
        "hinge": point(-foot),
        "lining": {"start": start, "end": end, "thickness": t, "width": width, "material": _material(rng, 7.7, 9.3)},
        "backing": {"thickness": 0.2 * R, "material": _material(rng, 8.5, 11.0)},
        "body": {
            "shape": "beam", "thickness": depth, "width": width * _log(rng, -0.9, 0.2),
            "material": _material(rng, 9.8, 11.4),
        },
        "actuation": {"direction": turn + math.pi + u(-0.4, 0.4), "point": point(far)},
    }  # fmt: skip
    shoe["actuation"]["force"] = _force(rng, shoe, R)  # type: ignore[index]
    return shoe


def _mirrored(shoe: dict[str, Any], about: float) -> dict[str, Any]:
    """The mirror image of a shoe about the line through the drum's centre at an angle [rad]."""
    c, s = math.cos(2 * about), math.sin(2 * about)

    def place(point: dict[str, float]) -> dict[str, float]:
        if "radius" in point:
            return {"radius": point["radius"], "angle": 2 * about - point["angle"]}
        return {"x": c * point["x"] + s * point["y"], "y": s * point["x"] - c * point["y"]}

    def arc(part: dict[str, Any]) -> dict[str, Any]:
        if "start" not in part:
            return part
        return part | {"start": 2 * about - part["end"], "end": 2 * about - part["start"]}

    actuation = shoe["actuation"]
    other = shoe | {
        "name": "other",
        "hinge": place(shoe["hinge"]),
        "lining": arc(shoe["lining"]),
        "actuation": actuation
        | {"direction": 2 * about - actuation["direction"], "point": place(actuation["point"])},
    }
    return other | ({"body": arc(shoe["body"])} if "body" in shoe else {})


def _ring(rng: np.random.Generator, R: float, width: float) -> dict[str, Any]:
    return {
        "thickness": R * _log(rng, -1.5, -0.7),
        "width": width * _log(rng, -0.2, 0.3),
        "material": _material(rng, 10.0, 11.4),
        "support": str(rng.choice(["fixed", "free"])),
    }


def _radius(rng: np.random.Generator) -> float:
    return _log(rng, -1.7, 0.45)


def _arc(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    return {"drum": {"radius": R}, "shoe": [_arc_shoe(rng, R)]}


def _backed(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    return {"drum": {"radius": R}, "shoe": [_arc_shoe(rng, R, backing=True)]}


def _rigid(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    return {
        "drum": {"radius": R},
        "shoe": [_arc_shoe(rng, R, body=False, backing=rng.random() < 0.5)],
    }


def _post_brake(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    return {"drum": {"radius": R}, "shoe": [_post(rng, R)]}


def _post_ring(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    shoe = _post(rng, R)
    middle = 0.5 * (shoe["lining"]["start"] + shoe["lining"]["end"])
    shoes = [shoe, _mirrored(shoe, middle + math.pi / 2)] if rng.random() < 0.4 else [shoe]
    return {"drum": {"radius": R, "ring": _ring(rng, R, shoe["lining"]["width"])}, "shoe": shoes}


def _arc_ring(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    shoe = _arc_shoe(rng, R)
    return {"drum": {"radius": R, "ring": _ring(rng, R, shoe["lining"]["width"])}, "shoe": [shoe]}


def _linings_on_ring(rng: np.random.Generator) -> dict[str, Any]:
    R = _radius(rng)
    shoe = _arc_shoe(rng, R, arc=(0.3, 2.2), largest=2.6)
    shoes = [shoe, _mirrored(shoe, shoe["hinge"]["angle"])]
    return {"drum": {"radius": R, "ring": _ring(rng, R, shoe["lining"]["width"])}, "shoe": shoes}


def _misfitted(rng: np.random.Generator) -> dict[str, Any]:
    R, u = _radius(rng), rng.uniform
    shoe = _post(rng, R) if rng.random() < 0.25 else _arc_shoe(rng, R, backing=rng.random() < 0.3)
    lining, size = shoe["lining"], _compression(shoe, R)
    how = rng.integers(5)
    if how == 0:
        lining["clearance"] = size * u(0.0, 2.0)
    elif how == 1:
        angles = np.linspace(lining["start"], lining["end"], int(rng.integers(2, 6)))
        lining["clearance"] = [[float(x), float(size * u(0, 2))] for x in angles]
    elif how == 2:
        lining["misfit"] = {"taper": float(size * u(-2, 2))}
    elif how == 3:
        lining["misfit"] = {
            "radius": float(R + size * u(-4, 4)),
            "offset": {"x": float(size * u(-1, 1)), "y": 0.0},
        }
    else:
        places = np.linspace(lining["start"], lining["end"], 4)[1:-1]
        lining["misfit"] = {"blocks": [[float(x), float(size * u(0, 1))] for x in places]}
    return {"drum": {"radius": R}, "shoe": [shoe]}


def _out_of_round(rng: np.random.Generator) -> dict[str, Any]:
    R, u = _radius(rng), rng.uniform
    shoe = _arc_shoe(rng, R, backing=rng.random() < 0.3)
    size = _compression(shoe, R)
    lobes = [
        {
            "order": int(rng.integers(0, 9)),
            "amplitude": float(size * u(-1, 1)),
            "phase": float(u(0, 6)),
        }
        for _ in range(int(rng.integers(1, 4)))
    ]
    return {"drum": {"radius": R, "out_of_round": lobes, "angle": float(u(0, 6))}, "shoe": [shoe]}


def _small_contact(rng: np.random.Generator) -> dict[str, Any]:
    """A lining of another radius pressed in by a force for which Hertz has a contact of 0.5 to 8
    deg.
    """
    R, u = _radius(rng), rng.uniform
    shoe = _arc_shoe(rng, R, arc=(0.35, 1.2), lining=(-1.3, -0.6), body=rng.random() < 0.6)
    lining, inside = shoe["lining"], shoe["side"] == "internal"
    r = R * (1 - u(0.003, 0.04)) if inside else R * (1 + u(0.003, 0.04))
    lining["misfit"] = {"radius": float(r)}
    half = R * math.radians(0.5 * _log(rng, -0.3, 0.9))
    E = lining["material"]["E"]
    load = math.pi / 4 * half**2 * E * abs(1 / r - 1 / R) * lining["width"]
    shoe["actuation"]["force"] = float(f"{load * u(0.5, 1.0):.4g}")
    return {"drum": {"radius": R}, "shoe": [shoe]}


def _extreme(rng: np.random.Generator) -> dict[str, Any]:
    """Stiffnesses, thicknesses and arcs far apart."""
    R = _radius(rng)
    shoe = _arc_shoe(
        rng, R, backing=rng.random() < 0.4, arc=(0.02, 2.85), lining=(-3.0, -0.48), E=(6.0, 12.0), E_body=(7.0, 13.0),
        depth=(-2.5, -0.5),
    )  # fmt: skip
    return {"drum": {"radius": R}, "shoe": [shoe]}


KINDS: dict[str, Draw] = {
    "arc": _arc,
    "backed": _backed,
    "rigid": _rigid,
    "post": _post_brake,
    "post on ring": _post_ring,
    "arc on ring": _arc_ring,
    "linings on ring": _linings_on_ring,
    "misfit": _misfitted,
    "out of round": _out_of_round,
    "small contact": _small_contact,
    "extreme": _extreme,
}
WAYS = ("locking", "opposed")


def _one_shoe(seed: int, way: str, attempt: int = 0) -> Brake:
    rng = np.random.default_rng([seed, attempt])
    u, R, inside = rng.uniform, 0.15, bool(rng.random() < 0.6)
    origin, hand, gap, arc = u(-3, 3), rng.choice([-1, 1]), u(0.05, 0.4), u(0.4, 2.4)
    start, end = sorted([origin + hand * gap, origin + hand * (gap + arc)])
    far, even = origin + hand * (gap + arc), u(-2e-4, 1e-3) * R
    table = [[x, u(-2e-4, 1e-3) * R] for x in np.linspace(start, end, 5).tolist()]
    shoe: dict[str, Any] = {
        "name": "shoe", "side": "internal" if inside else "external",
        "hinge": {"radius": R * (u(0.25, 0.95) if inside else u(1.05, 1.6)), "angle": origin},
        "lining": {
            "start": start, "end": end, "thickness": R * 10 ** u(-2, -0.7), "width": 0.04,
            "material": {"E": 10 ** u(7.7, 9.7), "nu": u(0, 0.45)}, "clearance": [0.0, even, table][rng.integers(3)],
        },
        "actuation": {
            "force": 10 ** u(2, 5), "direction": far + (0 if inside else math.pi) + u(-0.9, 0.9),
            "point": {"radius": R * (u(0.5, 1) if inside else u(1, 1.6)), "angle": far},
        },
    }  # fmt: skip
    if rng.random() < 0.75:
        shoe["body"] = {"thickness": R * u(0.03, 0.25), "width": 0.04, "start": start - gap / 2, "end": end + gap / 2,
                        "material": {"E": 10 ** u(9.7, 11.5), "nu": 0.3}}  # fmt: skip
    data = {"title": f"random {seed}", "friction": 0.3, "drum": {"radius": R}, "shoe": [shoe]}
    try:
        for rotation in ("clockwise", "counter-clockwise"):
            brake = brake_from(data | {"rotation": rotation})
            law = locking_friction(brake, brake.shoes[0])
            if law < 1.5 if way == "locking" else math.isinf(law):
                sine(
                    vary(brake, {"friction": 0.1 * min(law, 1.0)})
                )  # is it pressed, and within what the law covers?
                if (
                    solve(brake.model_copy(update={"friction": 0.0}), elements=COARSE)
                    .shoes[0]
                    .contact_arcs
                ):
                    return brake
    except (BadInput, NoAnswer):
        pass
    return _one_shoe(seed, way, attempt + 1)
