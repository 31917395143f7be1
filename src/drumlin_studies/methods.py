"""The list of solution methods whose error and run time the study of methods compares.

A method is a law, a model or a mesh with its options: see `work_precision.SolutionMethodOfBrake`.
"""

from collections.abc import Iterator

from drumlin.brake.brake import Brake
from drumlin.fem.mesh.arc import MESH_KINDS
from drumlin.models import reasons_why_models_do_not_apply
from drumlin_studies.work_precision import SolutionMethodOfBrake


def list_solution_methods_to_compare(
    brake: Brake, *, peers: bool = False, short: bool = False
) -> list[SolutionMethodOfBrake]:
    """The list of all methods that are compared on a brake.

    The list holds the laws, the foundation model, finite elements on meshes of all element kinds
    and sizes, hp elements, and penalty contact as textbooks describe it.

    Parameters
    ----------
    brake : Brake
        The brake to be solved. It decides whether the foundation model applies, and how fine the
        finest mesh is.
    peers : bool
        Whether the list includes the peers (other finite element programs), and drumlin on two of
        the peers' meshes.
    short : bool
        Whether the list has fewer element kinds and fewer mesh sizes, for a quick run.
    """
    result = [
        SolutionMethodOfBrake("law", law, {"model": law}) for law in ("sine", "cosine", "uniform")
    ]
    if "foundation" not in reasons_why_models_do_not_apply(brake):
        result += _list_methods_of_foundation_model()
    result += _list_fixed_mesh_methods(brake, short=short)
    result += _list_hp_element_methods(short=short)
    result += _list_penalty_contact_methods(short=short)
    return result + (list(_list_methods_of_peer_programs()) if peers else [])


def _list_methods_of_foundation_model() -> Iterator[SolutionMethodOfBrake]:
    """Methods that solve a brake by the foundation model, with 20 to 180 sections of each beam.

    Each number of sections gives two methods: the model as published, and the model without its
    simplifications ("lifted").
    """
    for sections in (20, 60, 180):
        options = {"model": "foundation", "sections": sections}
        yield SolutionMethodOfBrake("foundation", f"{sections} sections", options)
        yield SolutionMethodOfBrake(
            "foundation", f"{sections} sections, lifted", options | {"lift": ["all"]}
        )


def _list_fixed_mesh_methods(brake: Brake, *, short: bool) -> Iterator[SolutionMethodOfBrake]:
    """Methods that solve a brake by finite elements with a fixed number of elements per lining.

    The meshes have elements of equal length ("even mesh") or elements that shrink towards the
    lining's ends ("graded mesh").
    """
    sizes = (20, 40) if short else (20, 40, 80)
    # The mesh of 160 elements is left out for a brake with an elastic drum ring, which would take
    # far longer, and for rigid shoes.
    if not short and brake.ring is None and any(shoe.body is not None for shoe in brake.shoes):
        sizes = (*sizes, 160)
    for kind in ("quad2", "tri1"):
        for elements in sizes:
            yield _method_on_one_mesh("even mesh", kind, elements, even=True)
    for kind in ("quad2", "tri1") if short else tuple(MESH_KINDS):
        for elements in sizes:
            yield _method_on_one_mesh("graded mesh", kind, elements)


def _list_hp_element_methods(*, short: bool) -> Iterator[SolutionMethodOfBrake]:
    """Methods that solve a brake by hp elements, which have high degree and are smaller at corners.

    Some methods use one fixed level of refinement. The others refine until the estimated error is
    below a tolerance.
    """
    for level in range(2 if short else 5):
        yield SolutionMethodOfBrake("columns", f"level {level + 1}", {"level": level})
    for tolerance in (5e-3,) if short else (5e-3, 1e-3, 1e-4, 1e-5):
        options = {"tolerance": tolerance}
        yield SolutionMethodOfBrake("columns, error stated", f"tolerance {tolerance:g}", options)


def _list_penalty_contact_methods(*, short: bool) -> Iterator[SolutionMethodOfBrake]:
    """Methods that solve a brake with penalty contact, for several penalty factors.

    The penalty acts on the nodes of the lining ("weak penalty") or on the quadrature points of its
    edges ("pointwise penalty").
    """
    elements = 40 if short else 80
    penalties = (1e3, 1e6) if short else (1e1, 1e3, 1e6)
    for family in ("weak penalty", "pointwise penalty"):
        for penalty in penalties:
            options = {"elements": elements, "penalty": penalty}
            yield SolutionMethodOfBrake(family, f"{penalty:g} E/t, {elements} elements", options)


def _list_methods_of_peer_programs() -> Iterator[SolutionMethodOfBrake]:
    """Methods that solve a brake by the programs GetFEM and CalculiX on several meshes.

    Two further methods solve the brake by drumlin on two of these meshes.
    """
    # These two methods are drumlin, on the meshes on which its pressure p has an error of 0.5 %.
    yield _method_on_one_mesh("graded mesh", "quad2", 56)
    yield _method_on_one_mesh("graded mesh", "quad1", 112)
    for elements in (20, 40, 56, 80, 112):
        yield _method_on_one_mesh("GetFEM", "quad2", elements)
    for elements in (40, 80, 112):
        yield _method_on_one_mesh("GetFEM", "quad1", elements)
    # On these four refined meshes the error of the pressure p falls from 0.5 % to 0.01 %.
    for elements, layers in ((42, 5), (62, 6), (81, 7), (144, 9)):
        options = {"kind": "quad2", "elements": elements, "layers": layers}
        yield SolutionMethodOfBrake("GetFEM", f"refined, quad2, {elements} elements", options)
    for elements in (40, 80, 160):
        options = {"kind": "quad2", "elements": elements, "even": True}
        yield SolutionMethodOfBrake("GetFEM", f"even, quad2, {elements} elements", options)
    for elements in (40, 56, 112):
        yield _method_on_one_mesh("CalculiX", "quad2", elements)


def _method_on_one_mesh(
    family: str, kind: str, elements: int, **more: bool
) -> SolutionMethodOfBrake:
    """The method that solves a brake on one mesh.

    Parameters
    ----------
    family : str
        Key of the method's family.
    kind : str
        Kind of the elements, for example "quad2" for quadratic quadrilaterals.
    elements : int
        Number of elements along each lining.
    **more : bool
        Further options of the family's solver.
    """
    name = f"{kind}, {elements} elements"
    return SolutionMethodOfBrake(family, name, {"kind": kind, "elements": elements, **more})
