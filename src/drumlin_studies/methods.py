"""The ways to solve a brake that are held against each other (`work_precision`)."""

from drumlin.brake.brake import Brake
from drumlin.fem.mesh.arc import MESH_KINDS
from drumlin.models import refusals
from drumlin_studies.work_precision import Method


def methods(brake: Brake, *, peers: bool = False, short: bool = False) -> list[Method]:
    """Laws, foundation, meshes of every kind and size, textbook contact; `peers`: other solvers as
    well, and the meshes that they are held against; `short`: fewer kinds and sizes.
    """
    kinds = ("quad2", "tri1") if short else tuple(MESH_KINDS)
    elastic = (
        any(shoe.body is not None for shoe in brake.shoes) and brake.ring is None
    )  # a ring costs much more
    sizes = (20, 40) if short else (20, 40, 80, 160) if elastic else (20, 40, 80)
    penalties = (1e3, 1e6) if short else (1e1, 1e3, 1e6)
    found = [Method("law", law, {"model": law}) for law in ("sine", "cosine", "uniform")]
    if "foundation" not in refusals(brake):
        found += [
            Method("foundation", f"{sections} sections{', lifted' if lift else ''}", options | lift)
            for sections in (20, 60, 180)
            for options in ({"model": "foundation", "sections": sections},)
            for lift in ({}, {"lift": ["all"]})
        ]
    found += [_meshed("even mesh", kind, n, even=True) for kind in ("quad2", "tri1") for n in sizes]
    found += [_meshed("graded mesh", kind, n) for kind in kinds for n in sizes]
    found += [
        Method("columns", f"level {level + 1}", {"level": level})
        for level in range(2 if short else 5)
    ]
    found += [
        Method("columns, error stated", f"tolerance {tolerance:g}", {"tolerance": tolerance})
        for tolerance in ((5e-3,) if short else (5e-3, 1e-3, 1e-4, 1e-5))
    ]
    n = 40 if short else 80
    for family in ("weak penalty", "pointwise penalty"):
        found += [
            Method(family, f"{penalty:g} E/t, {n} elements", {"elements": n, "penalty": penalty})
            for penalty in penalties
        ]
    return found + (_with_peers() if peers else [])


def _with_peers() -> list[Method]:
    found = [
        _meshed("graded mesh", kind, n) for kind, n in (("quad2", 56), ("quad1", 112))
    ]  # half a percent of p
    found += [
        _meshed("GetFEM", kind, n)
        for kind, sizes in (("quad2", (20, 40, 56, 80, 112)), ("quad1", (40, 80, 112)))
        for n in sizes
    ]
    found += [
        Method(
            "GetFEM",
            f"refined, quad2, {n} elements",
            {"kind": "quad2", "elements": n, "layers": layers},
        )
        for n, layers in (
            (42, 5),
            (62, 6),
            (81, 7),
            (144, 9),
        )  # half, a tenth and a hundredth of a percent
    ]
    found += [
        Method(
            "GetFEM", f"even, quad2, {n} elements", {"kind": "quad2", "elements": n, "even": True}
        )
        for n in (40, 80, 160)
    ]
    return found + [_meshed("CalculiX", "quad2", n) for n in (40, 56, 112)]


def _meshed(family: str, kind: str, elements: int, **more: bool) -> Method:
    return Method(
        family, f"{kind}, {elements} elements", {"kind": kind, "elements": elements, **more}
    )
