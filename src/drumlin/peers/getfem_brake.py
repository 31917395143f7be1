"""The same brake through GetFEM: run by a Python that imports getfem, which needs nothing of
drumlin.

    python3 getfem_brake.py PROBLEM.npz RESULT.json

PROBLEM.npz is written by drumlin.peers.getfem: for each body its mesh, and in the text "data" all
numbers. Plane stress, each shoe in its own frame, everything per width of the lining; lengths in
drum radii, stresses in moduli of the lining. Two formulations of full slip:

    "full slip"  the drum drags the lining by mu p wherever it touches: a weak form written by hand, with the pressure
                 p as multiplier and the law  p = max(0, p + r (u.n - g))
    "coulomb"    GetFEM's own brick of integral contact with friction on a rigid obstacle, the obstacle moved so far
                 that it slips everywhere

The tangents are unsymmetric; MUMPS, a direct solver, takes each Newton step. Equal shoes share one
model; another friction coefficient starts from each shoe's last state, and keeps mesh, model and
elastic stiffness.
"""

import json
import re
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import getfem as gf  # type: ignore[import-not-found]
import numpy as np

CONTACT, HINGE, ACTUATION = 1, 2, 3
GROUPS = {CONTACT: "contact", HINGE: "hinge", ACTUATION: "actuation"}
SLIDE = 1e-2  # drum radii, the obstacle's way in the "coulomb" form; far more than the lining moves
UNKNOWNS = ("u", "hold", "p")  # and the amounts of the free motions


class Kind(NamedTuple):
    """GetFEM's names for a kind of cell: geometry, elements of displacement, constants and
    obstacle, integration inside and on the contact; and its order of the nodes, in that of the
    problem file.
    """

    geometry: str
    element: str
    constant: str
    obstacle: str
    inside: str
    surface: str
    order: list[int]


KINDS = {  # by the nodes of a cell
    9: Kind("GT_QK(2,2)", "FEM_QK(2,2)", "FEM_QK(2,0)", "FEM_QK(2,4)",
            "IM_GAUSS_PARALLELEPIPED(2,5)", "IM_GAUSS_PARALLELEPIPED(2,9)", [0, 4, 1, 7, 8, 5, 3, 6, 2]),
    4: Kind("GT_QK(2,1)", "FEM_QK(2,1)", "FEM_QK(2,0)", "FEM_QK(2,4)",
            "IM_GAUSS_PARALLELEPIPED(2,3)", "IM_GAUSS_PARALLELEPIPED(2,9)", [0, 1, 3, 2]),
    6: Kind("GT_PK(2,2)", "FEM_PK(2,2)", "FEM_PK(2,0)", "FEM_PK(2,4)",
            "IM_TRIANGLE(5)", "IM_TRIANGLE(9)", [0, 3, 1, 5, 4, 2]),
    3: Kind("GT_PK(2,1)", "FEM_PK(2,1)", "FEM_PK(2,0)", "FEM_PK(2,4)",
            "IM_TRIANGLE(3)", "IM_TRIANGLE(9)", [0, 1, 2]),
}  # fmt: skip


class Body:
    """A meshed body with its elastic model; load, gap and friction of a shoe are set before each
    solve.
    """

    def __init__(
        self, problem: dict[str, Any], number: int, shoe: dict[str, Any], formulation: str
    ) -> None:
        points, cells = problem[f"points{number}"], problem[f"cells{number}"]
        self.formulation, self.kind = formulation, KINDS[cells.shape[1]]
        self.mesh = gf.Mesh("empty", 2)
        numbers = self.mesh.add_convex(
            gf.GeoTrans(self.kind.geometry), points[cells[:, self.kind.order]].transpose(2, 1, 0)
        )
        self.loaded, self.amounts = (
            shoe["on_body"],
            [f"amount{k}" for k in range(len(shoe["motions"]))],
        )
        for region, name in GROUPS.items():
            if region != ACTUATION or self.loaded:
                nodes = problem[f"{name}{number}"]
                faces = self.mesh.faces_from_pid(self.mesh.pid_from_coords(points[nodes].T, 1e-12))
                self.mesh.set_region(region, faces)
        self.displacement, self.scalar = (
            self.space(self.kind.element, 2),
            self.space(self.kind.element),
        )
        self.inside = gf.MeshIm(self.mesh, gf.Integ(self.kind.inside))
        self.surface = gf.MeshIm(self.mesh, gf.Integ(self.kind.surface))
        self.model = gf.Model("real")
        self._elasticity(problem[f"constants{number}"], problem[f"straight{number}"], numbers)
        self._held(shoe)
        self._load(shoe)
        self.nodes = self.scalar.basic_dof_on_region(CONTACT)
        self.xy = self.scalar.basic_dof_nodes(self.nodes)
        self._contact(shoe)

    def space(self, element: str, components: int = 1) -> Any:
        """A finite element space on the mesh."""
        made = gf.MeshFem(self.mesh, components)
        made.set_fem(gf.Fem(element))
        return made

    def _elasticity(self, constants: Any, straight: Any, numbers: Any) -> None:
        """Plane stress with lambda and mu, and what cells are stiffer along and through their
        layer.

        constants (4, cells): of drumlin.fem.substructure.elasticity.split; straight (2, cells): the direction
        along a straight layer, (0, 0) in one that runs around the origin.
        """
        constant = self.space(self.kind.constant)
        place = np.empty(constants.shape[1], dtype=int)
        place[constant.basic_dof_from_cvid(numbers)[0]] = np.arange(constants.shape[1])
        self.model.add_fem_variable("u", self.displacement)
        self.model.add_initialized_fem_data("lam", constant, constants[0][place])
        self.model.add_initialized_fem_data("shear", constant, constants[1][place])
        self.model.add_isotropic_linearized_elasticity_brick(self.inside, "u", "lam", "shear")
        if not constants[2:].any():
            return
        around = (
            1.0 - np.abs(straight).max(axis=0).round()
        )  # a unit vector's larger component is 0.7 and more
        fields = {
            "stiff1": constants[2],
            "stiff2": constants[3],
            "tx": straight[0],
            "ty": straight[1],
            "turns": around,
        }
        for name, values in fields.items():
            self.model.add_initialized_fem_data(name, constant, values[place])
        self.model.add_macro("along1", "(turns*[-X(2); X(1)]/Norm(X) + [tx; ty])")
        self.model.add_macro("along2", "(turns*[X(1); X(2)]/Norm(X) + [-ty; tx])")
        for k in (1, 2):
            stretch, tested = (
                f"(along{k}.({field}*along{k}))" for field in ("Grad_u", "Grad_Test_u")
            )
            self.model.add_linear_term(self.inside, f"stiff{k}*{stretch}*{tested}")

    def _held(self, shoe: dict[str, Any]) -> None:
        """The edge that is held moves by the sum of the shoe's free motions, by the traction `hold`
        that holds it. That works on the tests what the loads on the holder do.
        """
        held = gf.MeshFem(
            "partial", self.displacement, self.displacement.basic_dof_on_region(HINGE)
        )
        self.model.add_fem_variable("hold", held)
        self.model.add_initialized_data("pin", shoe["pin"])
        self.model.add_macro(
            "moved(m)", "[m(1) + m(3)*(pin(2) - X(2)); m(2) + m(3)*(X(1) - pin(1))]"
        )
        self.model.add_linear_term(self.inside, "-hold.Test_u - u.Test_hold", HINGE)
        length = self.integral("1", HINGE)
        for k, amount in enumerate(self.amounts):
            self.model.add_variable(amount, 1)
            for name, size in (("motion", 3), ("test", 3), ("work", 1)):
                self.model.add_initialized_data(f"{name}{k}", np.zeros(size))
            self.model.add_linear_term(
                self.inside,
                f"{amount}*(moved(motion{k}).Test_hold) + (hold.moved(test{k}) - work{k}/{length!r})*Test_{amount}",
                HINGE,
            )

    def _load(self, shoe: dict[str, Any]) -> None:
        """A force and a couple about `centre`, as tractions on the loaded end; else what holds the
        shoe takes them.
        """
        for name, size in (("force", 2), ("couple", 1), ("drag", 1)):
            self.model.add_initialized_data(name, np.zeros(size))
        self.model.add_initialized_data("centre", shoe["centre"])
        self.model.add_macro("arm", "[centre(2) - X(2); X(1) - centre(1)]")
        if self.loaded:
            length, polar = self.integral("1", ACTUATION), self.integral("arm.arm", ACTUATION)
            self.push = f"(force/{length!r} + couple/{polar!r}*arm)"
            self.model.add_linear_term(self.inside, f"-{self.push}.Test_u", ACTUATION)

    def _contact(self, shoe: dict[str, Any]) -> None:
        md = self.model
        md.add_initialized_data("side", [float(shoe["side"])])
        md.add_initialized_data("augment", [shoe["augment"]])
        md.add_macro("normal", "[0; -1]" if shoe["flat"] else "side*Normalized(X)")
        md.add_macro("along", "[1; 0]" if shoe["flat"] else "[-X(2); X(1)]/Norm(X)")
        md.add_macro("lever", "1" if shoe["flat"] else "Norm(X)")
        self.normals = normals(self.xy, shoe)
        if self.formulation == "full slip":
            pressure = gf.MeshFem("partial", self.scalar, self.nodes)
            md.add_fem_variable("p", pressure)
            md.add_fem_data("gap", pressure)
            md.add_nonlinear_term(
                self.surface,
                "p*((normal - drag*along).Test_u) + (p - pos_part(p + augment*(u.normal - gap)))/augment*Test_p",
                CONTACT,
            )
            return
        traction = gf.MeshFem(
            "partial", self.displacement, self.displacement.basic_dof_on_region(CONTACT)
        )
        self.obstacle = self.space(self.kind.obstacle)
        md.add_fem_variable("p", traction)
        md.add_fem_data("obstacle", self.obstacle)
        md.add_fem_data("slid", self.displacement)
        md.add_initialized_data("mu", [0.0])
        md.add_initialized_data("alpha", [1.0])
        md.add_integral_contact_with_rigid_obstacle_brick(
            self.surface, "u", "p", "obstacle", "augment", "mu", CONTACT, 1, "alpha", "slid"
        )
        x, y = normals(self.displacement.basic_dof_nodes()[:, ::2], shoe) * shoe["side"]
        self.sliding = np.array([-y, x])

    def integral(self, expression: str, region: int) -> float:
        """The integral of an expression of the model over a region."""
        mim = self.surface if region == CONTACT else self.inside
        return float(gf.asm_generic(mim, 0, expression, region, self.model))

    def integrals(self, expression: str, region: int) -> list[float]:
        """The integral of a vector (2,), component by component."""
        return [self.integral(f"({expression})({k})", region) for k in (1, 2)]

    def start(self, shoe: dict[str, Any]) -> dict[str, Any]:
        """At rest, with a pressure under which all of the lining counts as touching."""
        values = {
            name: np.zeros(len(self.model.variable(name))) for name in (*UNKNOWNS, *self.amounts)
        }
        pressure = shoe["augment"] * max(shoe["gap"]) + float(np.hypot(*shoe["force"]))
        if self.formulation == "full slip":
            values["p"] += pressure
        else:
            values["p"] -= pressure * self.normals.ravel(order="F")
        return values

    def solve(self, shoe: dict[str, Any], friction: float) -> dict[str, Any]:
        """What one shoe does: pressure at the contact nodes, torque, hinge reaction, Newton steps.

        "slipping": its shear over mu p. The shoe keeps its state, from which its next solve starts.
        """
        md, drag = self.model, friction * shoe["drag_sense"]
        for name, value in (
            ("force", shoe["force"]),
            ("couple", [shoe["couple"]]),
            ("drag", [drag]),
        ):
            md.set_variable(name, np.array(value))
        for k, held in enumerate(zip(shoe["motions"], shoe["tests"], shoe["work"], strict=True)):
            for name, given in zip(("motion", "test", "work"), held, strict=True):
                md.set_variable(f"{name}{k}", np.atleast_1d(given))
        if self.formulation == "full slip":
            md.set_variable("gap", np.interp(angles(self.xy, shoe), shoe["phi"], shoe["gap"]))
        else:
            x = self.obstacle.basic_dof_nodes()
            clearance = np.interp(angles(x, shoe), shoe["phi"], shoe["clearance"])
            off = x[1] if shoe["flat"] else shoe["side"] * (1 - np.hypot(*x))
            md.set_variable("obstacle", off + clearance)
            md.set_variable("slid", (SLIDE * np.sign(drag) * self.sliding).ravel(order="F"))
            md.set_variable("mu", np.array([abs(drag)]))
        for name, value in (shoe.get("state") or self.start(shoe)).items():
            md.set_variable(name, value)
        steps, converged = md.solve(
            "max_iter",
            60,
            "max_res",
            1e-11,
            "lsolver",
            "mumps",
            "lsearch",
            "simplest",
            "alpha min",
            1.0,
        )
        shoe["state"] = {name: md.variable(name) for name in (*UNKNOWNS, *self.amounts)}
        p = shoe["state"]["p"]
        pressed, shear = "p", "drag*p"
        if self.formulation == "coulomb":
            pressed, shear = "(-p.normal)", "(p.along)"
            p = -(p[::2] * self.normals[0] + p[1::2] * self.normals[1])
        torque, full = (self.integral(f"{of}*lever", CONTACT) for of in (shear, f"drag*{pressed}"))
        traction = f"({shear}*along - {pressed}*normal)"
        return {
            "converged": bool(converged) and bool(np.isfinite(p).all()),
            "steps": int(steps),
            "slipping": torque / full if full else 0.0,
            "xy": self.xy.tolist(),
            "pressure": p.tolist(),
            "amounts": [float(md.variable(name)[0]) for name in self.amounts],
            "load_work": self.integral(f"{self.push}.u", ACTUATION) if self.loaded else 0.0,
            "torque": torque,
            "normal": self.integrals(f"-{pressed}*normal", CONTACT),
            "tangential": self.integrals(f"{shear}*along", CONTACT),
            "moment": self.integral(f"X(1)*{traction}(2) - X(2)*{traction}(1)", CONTACT),
            "hold": [
                *self.integrals("hold", HINGE),
                self.integral("hold.[pin(2) - X(2); X(1) - pin(1)]", HINGE),
            ],
        }


def normals(x: Any, shoe: dict[str, Any]) -> Any:
    """Normals (2, n) of the lining at the points x (2, n)."""
    if shoe["flat"]:
        return np.array([np.zeros(x.shape[1]), -np.ones(x.shape[1])])
    return shoe["side"] * x / np.hypot(*x)


def angles(x: Any, shoe: dict[str, Any]) -> Any:
    """Polar angles of the points x (2, n), within pi of the lining's middle; on a plane their
    places along it.
    """
    if shoe["flat"]:
        return x[0]
    return shoe["middle"] + np.angle(np.exp(-1j * shoe["middle"]) * (x[0] + 1j * x[1]))


def brake(problem: dict[str, Any], data: dict[str, Any]) -> dict[str, Any]:
    """All shoes at each friction coefficient in turn, bodies made once: answers and seconds (of
    processor) of each.
    """
    bodies: dict[tuple[int, bool, int], Body] = {}
    shoes = [dict(shoe) for shoe in data["shoes"]]
    answers, seconds = [], []
    for friction in data["friction"]:
        start = time.process_time()
        found = []
        for shoe in shoes:
            key = (shoe["body"], shoe["on_body"], len(shoe["motions"]))
            if key not in bodies:
                bodies[key] = Body(problem, shoe["body"], shoe, data["formulation"])
            found.append(bodies[key].solve(shoe, friction))
        seconds.append(time.process_time() - start)
        answers.append(found)
    unknowns = sum(int(body.model.nbdof()) for body in bodies.values())
    return {"answers": answers, "seconds": seconds, "unknowns": unknowns}


def version() -> str:
    """GetFEM's version: it states it only in the files that it writes."""
    with tempfile.NamedTemporaryFile("r") as file:
        gf.Mesh("empty", 2).save(file.name)
        found = re.search(r"VERSION:? *(\S+)", file.read())
        return found[1] if found else "unknown"


def main(source: str, target: str) -> None:
    """Read the problem, solve it `repeats` times from the beginning, write the last answers and all
    times.
    """
    gf.util_trace_level(0)
    gf.util_warning_level(0)
    with np.load(source) as file:
        problem = {name: file[name] for name in file.files}
    data = json.loads(str(problem.pop("data")))
    runs = [brake(problem, data) for _ in range(data["repeats"])]
    result = runs[-1] | {
        "seconds": [run["seconds"] for run in runs],
        "version": version(),
        "peak_memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    }
    Path(target).write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
