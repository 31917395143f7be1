"""The methods that are held against each other in error and run time (see `work_precision`)."""

from collections.abc import Iterator

from drumlin.brake.brake import Brake
from drumlin.fem.mesh.arc import MESH_KINDS
from drumlin.models import refusals
from drumlin_studies.work_precision import Method


def all_methods(brake: Brake, *, peers: bool = False, short: bool = False) -> list[Method]:
    """Laws, foundation model, finite elements of all kinds and sizes, and textbook contact.

    Parameters
    ----------
    brake : Brake
        The brake to be solved. It decides whether the foundation model applies and how fine the
        meshes are.
    peers : bool
        Whether other programs are included, with the meshes that they are held against.
    short : bool
        Whether fewer kinds and sizes are enough.
    """
    result = [Method("law", law, {"model": law}) for law in ("sine", "cosine", "uniform")]
    if "foundation" not in refusals(brake):
        result += _foundation_methods()
    result += _mesh_methods(brake, short=short)
    result += _level_methods(short=short)
    result += _penalty_methods(short=short)
    return result + (list(_peer_methods()) if peers else [])


def _foundation_methods() -> Iterator[Method]:
    """The foundation model as published and with all simplifications lifted."""
    for sections in (20, 60, 180):
        options = {"model": "foundation", "sections": sections}
        yield Method("foundation", f"{sections} sections", options)
        yield Method("foundation", f"{sections} sections, lifted", options | {"lift": ["all"]})


def _mesh_methods(brake: Brake, *, short: bool) -> Iterator[Method]:
    """Uniform and graded meshes of several kinds and sizes."""
    sizes = (20, 40) if short else (20, 40, 80)
    # An elastic ring makes a fine mesh cost much more.
    if not short and brake.ring is None and any(shoe.body is not None for shoe in brake.shoes):
        sizes = (*sizes, 160)
    for kind in ("quad2", "tri1"):
        for elements in sizes:
            yield _mesh_method("even mesh", kind, elements, even=True)
    for kind in ("quad2", "tri1") if short else tuple(MESH_KINDS):
        for elements in sizes:
            yield _mesh_method("graded mesh", kind, elements)


def _level_methods(*, short: bool) -> Iterator[Method]:
    """Hp elements of fixed levels, and to tolerances."""
    for level in range(2 if short else 5):
        yield Method("columns", f"level {level + 1}", {"level": level})
    for tolerance in (5e-3,) if short else (5e-3, 1e-3, 1e-4, 1e-5):
        options = {"tolerance": tolerance}
        yield Method("columns, error stated", f"tolerance {tolerance:g}", options)


def _penalty_methods(*, short: bool) -> Iterator[Method]:
    """Penalty contact of several stiffnesses, at nodes and at quadrature points."""
    elements = 40 if short else 80
    penalties = (1e3, 1e6) if short else (1e1, 1e3, 1e6)
    for family in ("weak penalty", "pointwise penalty"):
        for penalty in penalties:
            options = {"elements": elements, "penalty": penalty}
            yield Method(family, f"{penalty:g} E/t, {elements} elements", options)


def _peer_methods() -> Iterator[Method]:
    """The peers on meshes of several sizes, and drumlin on two of these meshes."""
    # On these two meshes the error of p is half a percent.
    yield _mesh_method("graded mesh", "quad2", 56)
    yield _mesh_method("graded mesh", "quad1", 112)
    for elements in (20, 40, 56, 80, 112):
        yield _mesh_method("GetFEM", "quad2", elements)
    for elements in (40, 80, 112):
        yield _mesh_method("GetFEM", "quad1", elements)
    # The error of p on these meshes falls from half a percent to a hundredth of a percent.
    for elements, layers in ((42, 5), (62, 6), (81, 7), (144, 9)):
        options = {"kind": "quad2", "elements": elements, "layers": layers}
        yield Method("GetFEM", f"refined, quad2, {elements} elements", options)
    for elements in (40, 80, 160):
        options = {"kind": "quad2", "elements": elements, "even": True}
        yield Method("GetFEM", f"even, quad2, {elements} elements", options)
    for elements in (40, 56, 112):
        yield _mesh_method("CalculiX", "quad2", elements)


def _mesh_method(family: str, kind: str, elements: int, **more: bool) -> Method:
    """A method on a mesh of a kind, with a number of elements along each lining."""
    name = f"{kind}, {elements} elements"
    return Method(family, name, {"kind": kind, "elements": elements, **more})
