"""The same brake through GetFEM: run by a Python that imports getfem, which needs nothing of drumlin.

    python3 getfem_brake.py PROBLEM.npz RESULT.json

PROBLEM.npz is written by drumlin.peers.getfem: for each body its mesh, and in the text "data" all numbers. Plane
stress, each shoe in its own frame, everything per width of the lining; lengths in drum radii, stresses in moduli of
the lining. Two formulations of full slip:

    "full slip"  the drum drags the lining by mu p wherever it touches: a weak form written by hand, with the pressure
                 p as multiplier and the law  p = max(0, p + r (u.n - g))
    "coulomb"    GetFEM's own brick of integral contact with friction on a rigid obstacle, the obstacle moved so far
                 that it slips everywhere

The tangents are unsymmetric; a direct solver takes each Newton step.
"""

import json
import re
import resource
import sys
import tempfile
import time

import getfem as gf
import numpy as np

CONTACT, HINGE, ACTUATION = 1, 2, 3
KINDS = {  # nodes of a cell -> geometry, finite element, integration inside and on the contact, order of the nodes
    9: ("GT_QK(2,2)", "FEM_QK(2,2)", "IM_GAUSS_PARALLELEPIPED(2,5)", "IM_GAUSS_PARALLELEPIPED(2,9)",
        [0, 4, 1, 7, 8, 5, 3, 6, 2]),
    4: ("GT_QK(2,1)", "FEM_QK(2,1)", "IM_GAUSS_PARALLELEPIPED(2,3)", "IM_GAUSS_PARALLELEPIPED(2,9)", [0, 1, 3, 2]),
    6: ("GT_PK(2,2)", "FEM_PK(2,2)", "IM_TRIANGLE(5)", "IM_TRIANGLE(9)", [0, 3, 1, 5, 4, 2]),
    3: ("GT_PK(2,1)", "FEM_PK(2,1)", "IM_TRIANGLE(3)", "IM_TRIANGLE(9)", [0, 1, 2]),
}  # fmt: skip
CONSTANT = {9: "FEM_QK(2,0)", 4: "FEM_QK(2,0)", 6: "FEM_PK(2,0)", 3: "FEM_PK(2,0)"}
SLIDE = 1e-2  # drum radii, the obstacle's way in the "coulomb" form; far more than the lining moves


class Body:
    """A meshed body with its elastic model; what depends on a shoe's load and friction is set before each solve."""

    UNKNOWNS = ("u", "hold", "turn", "p")

    def __init__(self, points, cells, lame, groups, data, formulation):
        geometry, element, inside, surface, order = KINDS[cells.shape[1]]
        mesh = gf.Mesh("empty", 2)
        numbers = mesh.add_convex(gf.GeoTrans(geometry), points[cells[:, order]].transpose(2, 1, 0))
        for region, nodes in groups.items():
            mesh.set_region(region, mesh.faces_from_pid(mesh.pid_from_coords(points[nodes].T, 1e-12)))
        self.formulation = formulation
        displacement = gf.MeshFem(mesh, 2)
        displacement.set_fem(gf.Fem(element))
        scalar = gf.MeshFem(mesh, 1)
        scalar.set_fem(gf.Fem(element))
        constant = gf.MeshFem(mesh, 1)
        constant.set_fem(gf.Fem(CONSTANT[cells.shape[1]]))
        self.inside = gf.MeshIm(mesh, gf.Integ(inside))
        self.surface = gf.MeshIm(mesh, gf.Integ(surface))
        place = np.empty(len(cells), dtype=int)
        place[constant.basic_dof_from_cvid(numbers)[0]] = np.arange(len(cells))

        self.model = md = gf.Model("real")
        md.add_fem_variable("u", displacement)
        md.add_initialized_fem_data("lam", constant, lame[0][place])
        md.add_initialized_fem_data("shear", constant, lame[1][place])
        md.add_isotropic_linearized_elasticity_brick(self.inside, "u", "lam", "shear")

        held = gf.MeshFem("partial", displacement, displacement.basic_dof_on_region(HINGE))
        md.add_fem_variable("hold", held)  # the traction of the pin's rigid line on the body
        md.add_variable("turn", 1)
        md.add_initialized_data("pin", data["pin"])
        md.add_macro("rigid", "[pin(2) - X(2); X(1) - pin(1)]")
        md.add_linear_term(self.inside, "-hold.Test_u - (u - turn*rigid).Test_hold + (hold.rigid)*Test_turn", HINGE)

        for name in ("force", "centre", "couple", "drag", "augment"):
            md.add_initialized_data(name, np.zeros(2) if name in ("force", "centre") else np.zeros(1))
        md.set_variable("augment", np.array([data["augment"]]))
        if ACTUATION in groups:
            md.add_macro("arm", "[centre(2) - X(2); X(1) - centre(1)]")
            md.set_variable("centre", data["centre"])
            length, polar = self.integral("1", ACTUATION), self.integral("arm.arm", ACTUATION)
            md.add_linear_term(self.inside, f"-(force/{length!r} + couple/{polar!r}*arm).Test_u", ACTUATION)
        else:  # on the rigid shoe itself: its moment about the pin
            md.add_linear_term(self.inside, f"-(couple/{self.integral('1', HINGE)!r})*Test_turn", HINGE)

        md.add_initialized_data("side", np.array([float(data["side"])]))
        md.add_macro("normal", "side*Normalized(X)")
        md.add_macro("along", "[-X(2); X(1)]/Norm(X)")
        self.nodes = scalar.basic_dof_on_region(CONTACT)
        self.xy = scalar.basic_dof_nodes(self.nodes)
        if formulation == "full slip":
            self.pressure = gf.MeshFem("partial", scalar, self.nodes)
            md.add_fem_variable("p", self.pressure)
            md.add_fem_data("gap", self.pressure)
            md.add_nonlinear_term(
                self.surface,
                "p*((normal - drag*along).Test_u) + (p - pos_part(p + augment*(u.normal - gap)))/augment*Test_p",
                CONTACT,
            )
        else:
            vector = displacement.basic_dof_on_region(CONTACT)
            self.pressure = gf.MeshFem("partial", displacement, vector)
            md.add_fem_variable("p", self.pressure)
            self.obstacle = gf.MeshFem(mesh, 1)
            self.obstacle.set_fem(gf.Fem(element.replace("2)", "4)").replace("(4", "(2").replace(",1)", ",4)")))
            md.add_fem_data("obstacle", self.obstacle)
            md.add_fem_data("slid", displacement)
            md.add_initialized_data("mu", np.zeros(1))
            md.add_initialized_data("alpha", np.ones(1))
            md.add_integral_contact_with_rigid_obstacle_brick(
                self.surface, "u", "p", "obstacle", "augment", "mu", CONTACT, 1, "alpha", "slid"
            )
            x = displacement.basic_dof_nodes()[:, ::2]
            r = np.hypot(*x)
            self.sliding = np.array([-x[1], x[0]]) / r

    def integral(self, expression, region, size=0):
        """The integral of an expression of the model over a region: a number, or (size,) component by component."""
        mim = self.surface if region == CONTACT else self.inside
        if not size:
            return float(gf.asm_generic(mim, 0, expression, region, self.model))
        return [float(gf.asm_generic(mim, 0, f"({expression})({k})", region, self.model)) for k in (1, 2)[:size]]

    def solve(self, shoe, friction):
        """What one shoe does: pressure at the contact nodes, torque, hinge reaction, Newton steps."""
        md, drag = self.model, friction * shoe["drag_sense"]
        md.set_variable("force", np.array(shoe["force"]))
        md.set_variable("couple", np.array([shoe["couple"]]))
        md.set_variable("drag", np.array([drag]))
        if self.formulation == "full slip":
            md.set_variable("gap", np.interp(angles(self.xy, shoe), shoe["phi"], shoe["gap"]))
        else:
            x = self.obstacle.basic_dof_nodes()
            r = np.hypot(*x)
            clearance = np.interp(angles(x, shoe), shoe["phi"], shoe["clearance"])
            md.set_variable("obstacle", shoe["side"] * (1 - r) + clearance)
            md.set_variable("slid", (SLIDE * np.sign(drag) * self.sliding).ravel(order="F"))
            md.set_variable("mu", np.array([abs(drag)]))
        for name in self.UNKNOWNS:  # from the shoe's own last state, at first from rest
            md.set_variable(name, shoe.get("state", {}).get(name, np.zeros(len(md.variable(name)))))
        steps, converged = md.solve("max_iter", 60, "max_res", 1e-11, "lsolver", SOLVER, "lsearch", "simplest",
                                    "alpha min", 1.0)  # fmt: skip
        shoe["state"] = {name: md.variable(name) for name in self.UNKNOWNS}
        p = md.variable("p")
        pressed, slipping = "p", "drag*p"
        if self.formulation == "coulomb":
            pressed, slipping = "(-p.normal)", "(p.along)"
            x = self.xy
            p = -shoe["side"] * (p[::2] * x[0] + p[1::2] * x[1]) / np.hypot(*x)
        return {
            "converged": bool(converged) and bool(np.isfinite(p).all()),
            "steps": int(steps),
            "pressure": p.tolist(),
            "turn": float(md.variable("turn")[0]),
            "torque": self.integral(f"{slipping}*Norm(X)", CONTACT),
            "normal": self.integral(f"-{pressed}*normal", CONTACT, 2),
            "tangential": self.integral(f"{slipping}*along", CONTACT, 2),
            "hold": self.integral("hold", HINGE, 2),
        }


def angles(x, shoe):
    """Polar angles of the points x (2, n), within pi of the lining's middle."""
    return shoe["middle"] + np.angle(np.exp(-1j * shoe["middle"]) * (x[0] + 1j * x[1]))


def brake(problem, data, formulation):
    """All shoes at each friction coefficient in turn, bodies made once: answers and seconds of each."""
    bodies, answers, seconds = {}, [], []
    shoes = [dict(shoe) for shoe in data["shoes"]]
    for friction in data["friction"]:
        start = time.perf_counter()
        found = []
        for shoe in shoes:
            k = shoe["body"]
            if k not in bodies:
                groups = {region: problem[f"{name}{k}"] for region, name in
                          ((CONTACT, "contact"), (HINGE, "hinge"), (ACTUATION, "actuation"))
                          if f"{name}{k}" in problem}  # fmt: skip
                bodies[k] = Body(problem[f"points{k}"], problem[f"cells{k}"], problem[f"lame{k}"], groups, data | shoe,
                                 formulation)  # fmt: skip
            body = bodies[k]
            found.append(body.solve(shoe, friction) | {"xy": body.xy.tolist()})
        seconds.append(time.perf_counter() - start)
        answers.append(found)
    unknowns = sum(body.model.nbdof() for body in bodies.values())
    return {"answers": answers, "seconds": seconds, "unknowns": int(unknowns)}


SOLVER = "mumps"


def version():
    """GetFEM's version: it states it only in the files that it writes."""
    with tempfile.NamedTemporaryFile("r") as file:
        gf.Mesh("empty", 2).save(file.name)
        return re.search(r"VERSION:? *(\S+)", file.read())[1]


def main(source, target):
    """Read the problem, solve it `repeats` times from the beginning, write all answers and times."""
    gf.util_trace_level(0)
    gf.util_warning_level(0)
    with np.load(source) as file:
        problem = {name: file[name] for name in file.files}
    data = json.loads(str(problem.pop("data")))
    runs = [brake(problem, data, data["formulation"]) for _ in range(data["repeats"])]
    result = runs[-1] | {
        "seconds": [run["seconds"] for run in runs],
        "version": version(),
        "peak_memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    }
    with open(target, "w", encoding="utf-8") as file:
        json.dump(result, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
