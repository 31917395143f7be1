"""Random brakes of every way to hold and push shoes, drawn from a seed; and brakes moved and
scaled.

Drawn about the x axis, then turned and mirrored at random. Linings, bodies and forces are of the
sizes that brakes have: drums of 60 mm to 1.2 m, linings of R/60 to R/8, moduli over a decade.
"""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import validated, vary
from drumlin.brake.plane_brake import any_from
from drumlin.fem.solve import solve
from drumlin.laws import law

ATTEMPTS = 200
MARGIN = 1.2  # of its friction, up to which law and finite elements must have an answer
TRIED = 10  # elements of the mesh that shows it
POINTS = ("hinge", "pivot")
Rng = np.random.Generator
Draw = Callable[[Rng], dict[str, Any]]


def random_kind(seed: int, kind: str | None = None, *, rigid: bool = False) -> Brake:
    """The brake of a seed; `kind`: one of KINDS, by default seed modulo their number; rigid:
    without bodies, with thin linings that are alike. All shoes press, up to MARGIN of its friction.
    """
    names = list(KINDS)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, names.index(kind), attempt])
        data = KINDS[kind](rng) | {"title": f"random {kind} {seed}"}
        data["friction"] = round(float(rng.uniform(0.03, 0.5)), 4)
        turn, mirrored = float(rng.uniform(-3, 3)), bool(rng.random() < 0.5)
        try:
            brake = any_from(_rigid(data) if rigid else data)
            brake = placed(brake, turn=0.0 if brake.surface.straight else turn, mirrored=mirrored)
            for friction in (brake.friction, MARGIN * brake.friction):
                other = vary(brake, {"friction": friction})
                if not all(
                    shoe.contact_arcs
                    for shoe in (*law(other).shoes, *solve(other, elements=TRIED).shoes)
                ):
                    raise NoAnswer("a shoe does not press")
            return brake
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(f"no brake of kind {kind} from seed {seed} in {ATTEMPTS} attempts")


def _rigid(data: dict[str, Any]) -> dict[str, Any]:
    size = data.get("drum", {"radius": 0.1})["radius"]
    alike = {
        "thickness": size / 300,
        "material": data["shoe"][0]["lining"]["material"],
    }  # a cam's law asks for it
    fits = {"clearance": 0.0, "misfit": {}}
    shoes = [
        {key: part for key, part in shoe.items() if key != "body"}
        | {"lining": shoe["lining"] | alike | fits}
        for shoe in data["shoe"]
    ]
    return data | {"shoe": shoes}


def log_between(rng: Rng, low: float, high: float) -> float:
    """Between low and high, on a logarithmic scale."""
    return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.4g}")


def _drum(
    rng: Rng, shoes: Callable[[Rng, float], list[dict[str, Any]]], **more: Any
) -> dict[str, Any]:
    R = log_between(rng, 0.06, 1.2)
    rotation = str(rng.choice(["clockwise", "counter-clockwise"]))
    return {"rotation": rotation, "drum": {"radius": R}, "shoe": shoes(rng, R)} | more


def _lining(rng: Rng, R: float, *, inside: bool = True) -> dict[str, Any]:
    """A shoe about the x axis without what holds and pushes it, now with an elastic body, now
    rigid.
    """
    u = rng.uniform
    half, middle, width = u(0.45, 1.0), u(-0.1, 0.1), R * u(0.2, 0.6)
    thickness = R * log_between(rng, 1 / 60, 1 / 8)
    material = {"E": log_between(rng, 1e8, 1e9), "nu": round(float(u(0.1, 0.4)), 3)}
    shoe: dict[str, Any] = {
        "name": "first",
        "side": "internal" if inside else "external",
        "lining": {
            "start": middle - half, "end": middle + half, "thickness": thickness, "width": width, "material": material,
        },
    }  # fmt: skip
    if rng.random() < 0.7:
        shoe["body"] = {
            "thickness": R * u(0.06, 0.2), "width": width, "start": middle - half - u(0.03, 0.2),
            "end": middle + half + u(0.03, 0.2), "material": {"E": log_between(rng, 7e10, 2.1e11), "nu": 0.3},
        }  # fmt: skip
    return shoe


def _push(
    rng: Rng, shoe: dict[str, Any], R: float, direction: float, at: tuple[float, float]
) -> dict[str, Any]:
    """Its actuation: a force that presses the lining by a thousandth or so of its modulus."""
    lining = shoe["lining"]
    area = R * (lining["end"] - lining["start"]) * lining["width"]
    force = float(f"{lining['material']['E'] * area * log_between(rng, 1e-4, 3e-3):.4g}")
    return {"force": force, "direction": direction, "point": {"x": R * at[0], "y": R * at[1]}}


def _point(R: float, x: float, y: float) -> dict[str, float]:
    return {"x": R * x, "y": R * y}


def _abutted(rng: Rng, R: float, *, rough: bool) -> dict[str, Any]:
    u, shoe = rng.uniform, _lining(rng, R)
    face = {"point": _point(R, u(0.1, 0.4), -u(0.65, 0.85)), "direction": u(-0.3, 0.3)}
    face |= {"friction": round(float(u(0.05, 0.4)), 3)} if rough else {}
    push = _push(rng, shoe, R, u(-0.2, 0.2), (u(0.1, 0.4), u(0.65, 0.85)))
    return shoe | {"abutment": face, "actuation": push}


def _hinged(rng: Rng, R: float) -> dict[str, Any]:
    u, shoe = rng.uniform, _lining(rng, R)
    push = _push(rng, shoe, R, u(-0.2, 0.2), (u(0.1, 0.4), u(0.65, 0.85)))
    return shoe | {"hinge": _point(R, u(0.05, 0.3), -u(0.65, 0.85)), "actuation": push}


def _pivoted(rng: Rng, R: float) -> dict[str, Any]:
    u, inside = rng.uniform, bool(rng.random() < 0.3)
    shoe = _lining(rng, R, inside=inside)
    if inside:
        lever, pivot = _point(R, u(-0.3, 0.3), -u(0.6, 0.9)), _point(R, u(0.55, 0.85), u(-0.1, 0.1))
        push = _push(rng, shoe, R, u(-0.2, 0.2), (u(0.0, 0.3), u(0.6, 0.85)))
    else:
        lever, pivot = _point(R, u(1.1, 1.3), -u(1.1, 1.5)), _point(R, u(1.1, 1.3), u(-0.1, 0.1))
        push = _push(rng, shoe, R, math.pi + u(-0.2, 0.2), (u(1.1, 1.4), u(1.2, 1.7)))
    return shoe | {"hinge": lever, "pivot": pivot, "actuation": push}


def _guided(rng: Rng, R: float) -> dict[str, Any]:
    u, inside = rng.uniform, bool(rng.random() < 0.5)
    shoe = _lining(rng, R, inside=inside)
    way = (0.0 if inside else math.pi) + u(-0.3, 0.3)
    push = _push(
        rng, shoe, R, way + u(-0.2, 0.2), (u(0.7, 0.9) if inside else u(1.1, 1.3), u(-0.15, 0.15))
    )
    return shoe | {"guide": {"direction": way}, "actuation": push}


def _unforced(shoe: dict[str, Any]) -> dict[str, Any]:
    actuation = {key: value for key, value in shoe["actuation"].items() if key != "force"}
    return shoe | {"actuation": actuation}


def facing(shoe: dict[str, Any]) -> dict[str, Any]:
    """A shoe of data as drawn here, mirrored to the other side of the drum."""
    return _shoe_placed(shoe | {"name": "second"}, math.pi, mirrored=True)


def _cam(rng: Rng) -> dict[str, Any]:
    make = (
        _hinged
        if rng.random() < 0.6
        else lambda rng, R: _abutted(rng, R, rough=bool(rng.random() < 0.5))
    )
    data = _drum(rng, lambda rng, R: [make(rng, R), facing(make(rng, R))])
    force = 2 * min(shoe["actuation"]["force"] for shoe in data["shoe"])
    return data | {
        "shoe": [_unforced(shoe) for shoe in data["shoe"]],
        "actuation": {"force": force},
    }


def _cylinder(rng: Rng) -> dict[str, Any]:
    data = _drum(rng, lambda rng, R: [_abutted(rng, R, rough=True), facing(_hinged(rng, R))])
    force, bore = (
        min(shoe["actuation"]["force"] for shoe in data["shoe"]),
        data["drum"]["radius"] / 5,
    )
    drive = {
        "pressure": force / (math.pi * bore**2 / 4) / 0.95,
        "diameter": bore,
        "efficiency": 0.95,
    }
    return data | {"shoe": [_unforced(shoe) for shoe in data["shoe"]], "actuation": drive}


def _strut(rng: Rng) -> dict[str, Any]:
    def shoes(rng: Rng, R: float) -> list[dict[str, Any]]:
        u, second = rng.uniform, _lining(rng, R)
        second |= {
            "hinge": _point(R, u(0.05, 0.3), u(0.65, 0.85)),
            "actuation": _push(rng, second, R, 0.0, (0.0, 0.0)),
        }
        other = facing(second)
        del other["actuation"]
        return [_abutted(rng, R, rough=False), other]

    return _drum(rng, shoes, link=[{"from": "first", "to": "second"}])


def _elastic(
    rng: Rng, R: float, makes: Sequence[Callable[[Rng, float], dict[str, Any]]]
) -> dict[str, Any]:
    """A shoe by one of the makes that has a body."""
    make = makes[int(rng.integers(len(makes)))]
    while "body" not in (shoe := make(rng, R)):
        pass
    return shoe


def _sloped(rng: Rng, R: float) -> dict[str, Any]:
    return _abutted(rng, R, rough=True)


def _tee(rng: Rng, R: float) -> dict[str, Any]:
    """A shoe whose body is a table with a web."""
    shoe, u = _elastic(rng, R, (_hinged, _sloped, _pivoted, _guided)), rng.uniform
    body, width = shoe["body"], shoe["lining"]["width"]
    table = {"thickness": u(0.1, 0.5) * body["thickness"], "width": u(1.0, 1.3) * width}
    return shoe | {"body": body | {"width": u(0.1, 0.6) * width, "table": table}}


def _gripped(rng: Rng, R: float) -> dict[str, Any]:
    """A shoe of which a length of its body's back is held."""
    shoe = _elastic(rng, R, (_hinged, _pivoted, _guided))
    return shoe | {"body": shoe["body"] | {"grip": R * rng.uniform(0.05, 0.4)}}


def _chain(rng: Rng) -> dict[str, Any]:
    """Blocks outside, each hanging on the next by a strap."""
    names = ("first", "second", "third", "fourth")[: int(rng.integers(2, 5))]

    def shoes(rng: Rng, R: float) -> list[dict[str, Any]]:
        u, strap, at = rng.uniform, rng.uniform(1.05, 1.15), float(rng.uniform(-1.5, -0.5))
        found: list[dict[str, Any]] = []
        for name in names:
            shoe, half, pulled = _lining(rng, R, inside=False), u(0.15, 0.35), at
            ends = {"start": at + 0.05, "end": at + 0.05 + 2 * half}
            shoe |= {"name": name, "lining": shoe["lining"] | ends}
            if "body" in shoe:
                shoe["body"] |= {"start": ends["start"] - 0.03, "end": ends["end"] + 0.03}
            at = ends["end"] + 0.05
            face = {
                "point": _point(R, strap * math.cos(at), strap * math.sin(at)),
                "direction": at + math.pi / 2,
            }
            shoe["abutment"] = face
            if not found:
                point = strap * math.cos(pulled), strap * math.sin(pulled)
                shoe["actuation"] = _push(rng, shoe, R, pulled - math.pi / 2, point)
            found.append(shoe)
        return found

    return _drum(rng, shoes, link=[{"from": a, "to": b} for a, b in pairwise(names)])


def _pad(rng: Rng, held: str) -> dict[str, Any]:
    u = rng.uniform
    long, start = log_between(rng, 0.04, 0.3), float(u(-0.3, 0.3))
    middle, width, t = start + long / 2, long * u(0.2, 0.8), long * log_between(rng, 1 / 40, 1 / 8)
    material = {"E": log_between(rng, 1e8, 1e10), "nu": round(float(u(0.1, 0.4)), 3)}
    lining = {
        "start": start,
        "end": start + long,
        "thickness": t,
        "width": width,
        "material": material,
    }
    shoe: dict[str, Any] = {"name": "pad", "lining": lining}
    if rng.random() < 0.7:
        shoe["body"] = {
            "thickness": long * u(0.1, 0.3), "width": width, "start": start - long * u(0.02, 0.1),
            "end": start + long * u(1.02, 1.1), "material": {"E": 2.1e11, "nu": 0.3},
        }  # fmt: skip
    away, high = long * u(0.8, 1.5), long * u(0.1, 0.5)
    pin, at = {"x": middle - away, "y": high}, {"x": middle + away, "y": high}
    down = -math.pi / 2
    if held == "pivot":
        shoe |= {
            "hinge": pin,
            "pivot": {"x": middle + long * u(-0.1, 0.1), "y": long * u(0.05, 0.3)},
        }
    elif held == "hinge":
        shoe |= {"hinge": pin}
    else:
        at, down = {"x": middle + long * u(-0.1, 0.1), "y": high}, down + u(-0.1, 0.1)
        face = {
            "point": {"x": start - 0.1 * long, "y": long * u(0.05, 0.2)},
            "direction": u(-0.2, 0.2),
        }
        face["friction"] = round(float(u(0.0, 0.3)), 3)
        shoe |= (
            {"guide": {"direction": -math.pi / 2 + u(-0.2, 0.2)}}
            if held == "guide"
            else {"abutment": face}
        )
    force = float(f"{material['E'] * long * width * log_between(rng, 1e-4, 3e-3):.4g}")
    shoe["actuation"] = {"force": force, "direction": down, "point": at}
    lining |= _ill_fitting(rng.spawn(1)[0], lining, force / (material["E"] * long * width) * t)
    return {"plane": {"sliding": str(rng.choice(["+x", "-x"]))}, "shoe": [shoe]}


def _ill_fitting(rng: Rng, lining: dict[str, Any], size: float) -> dict[str, Any]:
    """Clearance and misfit of a pad of about this size [m], by which its force squeezes it; of most
    pads none.
    """
    u, long = rng.uniform, lining["end"] - lining["start"]
    way = int(rng.integers(10))
    if way == 0:
        radius = long**2 / (8 * size * u(0.2, 3.0)) * float(rng.choice([-1, 1]))
        return {
            "misfit": {
                "radius": radius,
                "offset": {"x": long * u(-0.04, 0.04), "y": size * u(-1, 1)},
            }
        }
    if way == 1:
        return {"misfit": {"taper": size * u(-2, 2)}, "clearance": size * u(0, 2)}
    if way == 2:
        places = np.linspace(lining["start"], lining["end"], int(rng.integers(2, 5)))
        return {"clearance": [[float(x), float(size * u(0, 2))] for x in places]}
    return {}


KINDS: dict[str, Draw] = {
    "hinge": lambda rng: _drum(rng, lambda rng, R: [_hinged(rng, R)]),
    "abutment": lambda rng: _drum(rng, lambda rng, R: [_abutted(rng, R, rough=False)]),
    "rough abutment": lambda rng: _drum(rng, lambda rng, R: [_abutted(rng, R, rough=True)]),
    "pivot": lambda rng: _drum(rng, lambda rng, R: [_pivoted(rng, R)]),
    "guide": lambda rng: _drum(rng, lambda rng, R: [_guided(rng, R)]),
    "cylinder": _cylinder,
    "cam": _cam,
    "strut": _strut,
    "pad on a hinge": lambda rng: _pad(rng, "hinge"),
    "pad on a pivot": lambda rng: _pad(rng, "pivot"),
    "pad on a guide": lambda rng: _pad(rng, "guide"),
    "pad on an abutment": lambda rng: _pad(rng, "abutment"),
    "table": lambda rng: _drum(rng, lambda rng, R: [_tee(rng, R)]),
    "grip": lambda rng: _drum(rng, lambda rng, R: [_gripped(rng, R)]),
    "chain": _chain,
}


def _shoe_placed(
    shoe: dict[str, Any], turn: float, *, mirrored: bool, shift: float = 0.0
) -> dict[str, Any]:
    """A shoe's data, mirrored about the x axis or not, then turned by an angle [rad] and shifted
    along x [m].
    """
    sign = -1 if mirrored else 1
    c, s = math.cos(turn), math.sin(turn)

    def place(point: dict[str, float]) -> dict[str, float]:
        x, y = point["x"], sign * point["y"]
        return {"x": c * x - s * y + shift, "y": s * x + c * y}

    def angled(part: dict[str, Any]) -> dict[str, Any]:
        found = part | {"direction": turn + sign * part["direction"]}
        return found | ({"point": place(part["point"])} if "point" in part else {})

    def at(
        lining: float,
    ) -> float:  # on a plane a mirror image is one about y: mirrored and turned by 180 deg
        return turn + sign * lining if "side" in shoe else c * lining + shift

    def reach(part: dict[str, Any]) -> dict[str, Any]:
        found = part | dict(
            zip(("start", "end"), sorted(at(part[key]) for key in ("start", "end")), strict=True)
        )
        if isinstance(part.get("clearance"), list | tuple):
            found["clearance"] = sorted([at(x), gap] for x, gap in part["clearance"])
        if "misfit" in part:
            x, y = (part["misfit"]["offset"][key] for key in "xy")
            offset = {"x": c * x - s * sign * y, "y": s * x + c * sign * y}
            found["misfit"] = part["misfit"] | {"offset": offset}
        return found

    moved = dict(shoe)
    moves = {"hinge": place, "pivot": place, "abutment": angled, "guide": angled, "actuation": angled, "lining": reach,
             "body": reach}  # fmt: skip
    for key, move in moves.items():
        if moved.get(key) is not None:
            moved[key] = move(moved[key])
    return moved


def placed(brake: Brake, *, turn: float = 0.0, mirrored: bool = False, shift: float = 0.0) -> Brake:
    """The brake turned by an angle [rad], mirrored before about the x axis; on a plane shifted [m],
    mirrored about y.

    No blocks of linings' misfits. The struts' and cam's forces are as they were.
    """
    data = (brake.reversed() if mirrored else brake).model_dump(by_alias=True)
    if brake.surface.straight:
        turn = math.pi if mirrored else 0.0
    data["shoe"] = [
        _shoe_placed(shoe, turn, mirrored=mirrored, shift=shift) for shoe in data["shoe"]
    ]
    return validated(type(brake), data)


LENGTHS = {"x", "y", "radius", "thickness", "width", "grip", "clearance", "diameter", "taper"}
FORCES = {"force"}


def scaled(brake: Brake, length: float, modulus: float) -> Brake:
    """The brake with all lengths and all moduli times a factor, and forces so that strains stay as
    they are.
    """
    flat = brake.surface.straight

    def part(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: of(key, each) for key, each in value.items()}
        return [part(each) for each in value] if isinstance(value, list | tuple) else value

    def of(key: str, value: Any) -> Any:
        if key in {"clearance", "blocks"} and isinstance(value, list | tuple):
            return [[place * (length if flat else 1.0), size * length] for place, size in value]
        if isinstance(value, bool | str) or value is None or not isinstance(value, int | float):
            return part(value)
        if key in LENGTHS or (flat and key in {"start", "end"}):
            return value * length
        if key in {"E", "pressure"}:
            return value * modulus
        return (
            value * modulus * length**2
            if key in FORCES
            else value * modulus * length**3
            if key == "torque"
            else value
        )

    return validated(type(brake), part(brake.model_dump(by_alias=True)))
