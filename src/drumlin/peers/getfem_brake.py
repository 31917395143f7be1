"""A script that solves a brake by GetFEM, in a Python that imports getfem and not drumlin.

    python3 getfem_brake.py PROBLEM.npz RESULT.json

drumlin.peers.getfem writes PROBLEM.npz, which holds the mesh of each body as arrays and, in the
text "data", all other numbers. The model is plane stress. Each shoe has its own frame. Lengths are
divided by the drum's radius, stresses by Young's modulus of the lining, and forces by the width of
the lining, this modulus and the drum's radius. There are two formulations of full slip:

    "full slip"  the drum drags the lining by mu p wherever it touches: a weak form written by
                 hand, with the pressure p as multiplier and the law  p = max(0, p + r (u.n - g));
                 u is the displacement, n the normal towards the drum, g the gap, r a constant
    "coulomb"    GetFEM's own contact with friction on a rigid obstacle, the drum; the obstacle
                 slides so far that the lining slips everywhere

The tangent matrices are unsymmetric; the direct solver MUMPS solves each Newton step. Shoes of
equal shape share one model. A solve with another friction coefficient reuses mesh, model and
elastic stiffness, and starts from the last state of each shoe.
"""

import json
import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import getfem as gf  # type: ignore[import-not-found]
import numpy as np

CONTACT_REGION, HINGE_REGION, ACTUATION_REGION = 1, 2, 3
"""Numbers of three boundaries in GetFEM's mesh of a shoe: the friction surface, the edge at the
hinge (on which the support acts), and the end on which the actuation acts."""

BOUNDARY_NAME_OF_REGION = {
    CONTACT_REGION: "contact",
    HINGE_REGION: "hinge",
    ACTUATION_REGION: "actuation",
}
"""Names of the three boundaries in the problem file, by their numbers in GetFEM's mesh."""

SLIDING_DRUM_DISPLACEMENT_OVER_RADIUS = 1e-2
"""Displacement of the sliding drum in the "coulomb" formulation, in drum radii.

The drum must move much farther than the lining, so that the lining slips everywhere."""

NAMES_OF_GETFEM_UNKNOWNS = ("u", "hold", "p")
"""Unknowns of a GetFEM model: the displacement, the traction of the support on the shoe, and the
pressure or traction of the contact. The coordinates of the rigid-body modes are unknowns, too.
"""

MOST_NEWTON_STEPS_OF_GETFEM = 60
"""Number of Newton steps after which a solve counts as not converged, chosen by judgement."""

NEWTON_RESIDUAL_TOLERANCE_OF_GETFEM = 1e-11
"""Residual of the script's scaled equations at which Newton's method ends.

Smaller residuals are round-off."""


class GetfemCellKind(NamedTuple):
    """GetFEM's names of the elements and integration methods for one kind of cell.

    Attributes
    ----------
    geometry : geometric transformation of the cell
    element : element of the displacement
    constant : element of the elastic constants
    obstacle : element of the distance from the drum in the "coulomb" formulation
    inside : integration method over the cell
    surface : integration method over the cell's edges in contact
    order : for each node of a cell in GetFEM's order, its index in the problem file's order
    """

    geometry: str
    element: str
    constant: str
    obstacle: str
    inside: str
    surface: str
    order: list[int]


GETFEM_CELL_KINDS = {
    9: GetfemCellKind(
        geometry="GT_QK(2,2)",
        element="FEM_QK(2,2)",
        constant="FEM_QK(2,0)",
        obstacle="FEM_QK(2,4)",
        inside="IM_GAUSS_PARALLELEPIPED(2,5)",
        surface="IM_GAUSS_PARALLELEPIPED(2,9)",
        order=[0, 4, 1, 7, 8, 5, 3, 6, 2],
    ),
    4: GetfemCellKind(
        geometry="GT_QK(2,1)",
        element="FEM_QK(2,1)",
        constant="FEM_QK(2,0)",
        obstacle="FEM_QK(2,4)",
        inside="IM_GAUSS_PARALLELEPIPED(2,3)",
        surface="IM_GAUSS_PARALLELEPIPED(2,9)",
        order=[0, 1, 3, 2],
    ),
    6: GetfemCellKind(
        geometry="GT_PK(2,2)",
        element="FEM_PK(2,2)",
        constant="FEM_PK(2,0)",
        obstacle="FEM_PK(2,4)",
        inside="IM_TRIANGLE(5)",
        surface="IM_TRIANGLE(9)",
        order=[0, 3, 1, 5, 4, 2],
    ),
    3: GetfemCellKind(
        geometry="GT_PK(2,1)",
        element="FEM_PK(2,1)",
        constant="FEM_PK(2,0)",
        obstacle="FEM_PK(2,4)",
        inside="IM_TRIANGLE(3)",
        surface="IM_TRIANGLE(9)",
        order=[0, 1, 2],
    ),
}
"""GetFEM's names for each kind of cell, by the number of nodes of a cell."""


class GetfemBody:
    """GetFEM's mesh and model of a body, which is used for all shoes of this shape.

    Load, gap and friction of a shoe are set before each solve.

    Parameters
    ----------
    problem : arrays of the problem file
    number : number of the body
    shoe : data of the first shoe with this body
    formulation : "full slip" or "coulomb"
    """

    def __init__(
        self, problem: dict[str, Any], number: int, shoe: dict[str, Any], formulation: str
    ) -> None:
        points, cells = problem[f"points{number}"], problem[f"cells{number}"]
        self.formulation, self.kind = formulation, GETFEM_CELL_KINDS[cells.shape[1]]
        self.mesh = gf.Mesh("empty", 2)
        corners = points[cells[:, self.kind.order]].transpose(2, 1, 0)
        numbers = self.mesh.add_convex(gf.GeoTrans(self.kind.geometry), corners)
        self.loaded = shoe["on_body"]
        self.amounts = [f"amount{k}" for k in range(len(shoe["motions"]))]
        for region, name in BOUNDARY_NAME_OF_REGION.items():
            if region != ACTUATION_REGION or self.loaded:
                self._assign_region_number_to_edges_between_points(
                    region, points[problem[f"{name}{number}"]]
                )
        self.displacement = self.finite_element_space(self.kind.element, 2)
        self.scalar = self.finite_element_space(self.kind.element)
        self.inside = gf.MeshIm(self.mesh, gf.Integ(self.kind.inside))
        self.surface = gf.MeshIm(self.mesh, gf.Integ(self.kind.surface))
        self.model = gf.Model("real")
        self._add_elastic_stiffness(
            problem[f"constants{number}"], problem[f"straight{number}"], numbers
        )
        self._add_shoe_support_to_model(shoe)
        self._add_shoe_actuation_to_model(shoe)
        self._add_forces_at_places_to_model(cells, numbers)
        self.nodes = self.scalar.basic_dof_on_region(CONTACT_REGION)
        self.xy = self.scalar.basic_dof_nodes(self.nodes)
        self._add_contact_with_drum(shoe)

    def _assign_region_number_to_edges_between_points(self, region: int, points: Any) -> None:
        """Give the edges between the nodes at `points` (n, 2) the number `region`."""
        ids = self.mesh.pid_from_coords(points.T, 1e-12)
        self.mesh.set_region(region, self.mesh.faces_from_pid(ids))

    def finite_element_space(self, element: str, components: int = 1) -> Any:
        """A finite element space on the mesh, for a scalar or for a vector of `components`."""
        space = gf.MeshFem(self.mesh, components)
        space.set_fem(gf.Fem(element))
        return space

    def _add_elastic_stiffness(self, constants: Any, straight: Any, numbers: Any) -> None:
        """Add the elastic stiffness to the model: plane stress, isotropic or orthotropic.

        It is an isotropic stiffness with the Lame constants lambda and mu. An orthotropic layer has
        two additional stiffnesses: one against strain along the layer, one against strain through
        the layer.

        Parameters
        ----------
        constants : lambda, mu and the two additional stiffnesses of each cell (4, cells), as
            drumlin.fem.substructure.elasticity.isotropic_and_orthotropic_elastic_constants returns
            them
        straight : direction along the layer of each cell (2, cells); (0, 0) in a layer that is
            curved around the origin
        numbers : GetFEM's numbers of the cells
        """
        constant = self.finite_element_space(self.kind.constant)
        place = np.empty(constants.shape[1], dtype=int)
        place[constant.basic_dof_from_cvid(numbers)[0]] = np.arange(constants.shape[1])
        self.model.add_fem_variable("u", self.displacement)
        self.model.add_initialized_fem_data("lam", constant, constants[0][place])
        self.model.add_initialized_fem_data("shear", constant, constants[1][place])
        self.model.add_isotropic_linearized_elasticity_brick(self.inside, "u", "lam", "shear")
        # If all layers are isotropic, the two additional stiffnesses are zero.
        if not constants[2:].any():
            return
        # `straight` holds unit vectors along straight layers, and zeros in curved layers. The
        # larger component of a unit vector is at least 0.7 and is rounded to 1, so that `around` is
        # 1 in cells of curved layers and 0 in cells of straight layers.
        around = 1.0 - np.abs(straight).max(axis=0).round()
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
            stretch = f"(along{k}.(Grad_u*along{k}))"
            tested = f"(along{k}.(Grad_Test_u*along{k}))"
            self.model.add_linear_term(self.inside, f"stiff{k}*{stretch}*{tested}")

    def _add_shoe_support_to_model(self, shoe: dict[str, Any]) -> None:
        """Add the support to the model: the edge at the hinge moves only in the rigid-body modes.

        The unknown traction `hold` acts on this edge. A rigid holder, the part that the support
        guides, moves with the edge. It is in equilibrium if `hold` and the loads on the holder do
        the same work on each test mode.
        """
        dofs = self.displacement.basic_dof_on_region(HINGE_REGION)
        self.model.add_fem_variable("hold", gf.MeshFem("partial", self.displacement, dofs))
        self.model.add_initialized_data("pin", shoe["pin"])
        self.model.add_macro(
            "moved(m)", "[m(1) + m(3)*(pin(2) - X(2)); m(2) + m(3)*(X(1) - pin(1))]"
        )
        self.model.add_linear_term(self.inside, "-hold.Test_u - u.Test_hold", HINGE_REGION)
        length = self.integral_over_boundary("1", HINGE_REGION)
        for k, amount in enumerate(self.amounts):
            self.model.add_variable(amount, 1)
            for name, size in (("motion", 3), ("test", 3), ("work", 1)):
                self.model.add_initialized_data(f"{name}{k}", np.zeros(size))
            motion = f"{amount}*(moved(motion{k}).Test_hold)"
            balance = f"(hold.moved(test{k}) - work{k}/{length!r})*Test_{amount}"
            self.model.add_linear_term(self.inside, f"{motion} + {balance}", HINGE_REGION)

    def _add_shoe_actuation_to_model(self, shoe: dict[str, Any]) -> None:
        """Add the actuation to the model: tractions on the loaded end of the shoe.

        The resultant of the tractions is a force and a couple about the point `centre`. A shoe
        whose force acts on its rigid holder has no loaded end.
        """
        for name, size in (("force", 2), ("couple", 1), ("drag", 1)):
            self.model.add_initialized_data(name, np.zeros(size))
        self.model.add_initialized_data("centre", shoe["centre"])
        self.model.add_macro("arm", "[centre(2) - X(2); X(1) - centre(1)]")
        if self.loaded:
            length = self.integral_over_boundary("1", ACTUATION_REGION)
            polar = self.integral_over_boundary("arm.arm", ACTUATION_REGION)
            self.push = f"(force/{length!r} + couple/{polar!r}*arm)"
            self.model.add_linear_term(self.inside, f"-{self.push}.Test_u", ACTUATION_REGION)

    def _add_forces_at_places_to_model(self, cells: Any, numbers: Any) -> None:
        """Add nodal forces of springs, weight and other forces; each solve sets their values.

        Parameters
        ----------
        cells : numbers of the nodes of each cell (cells, nodes of a cell) in the problem file
        numbers : GetFEM's numbers of the cells
        """
        dofs, _ = self.displacement.basic_dof_from_cvid(numbers)
        ordered = cells[:, self.kind.order].ravel()
        self.place = np.zeros((cells.max() + 1, 2), dtype=int)
        self.place[ordered] = dofs.reshape(-1, 2)
        none = np.zeros(self.displacement.nbdof())
        self.at_places = self.model.add_explicit_rhs("u", none)

    def _add_contact_with_drum(self, shoe: dict[str, Any]) -> None:
        """Add the contact with the drum, or with a plane surface, to the model."""
        md = self.model
        md.add_initialized_data("side", [float(shoe["side"])])
        md.add_initialized_data("augment", [shoe["augment"]])
        md.add_macro("normal", "[0; -1]" if shoe["flat"] else "side*Normalized(X)")
        md.add_macro("along", "[1; 0]" if shoe["flat"] else "[-X(2); X(1)]/Norm(X)")
        md.add_macro("lever", "1" if shoe["flat"] else "Norm(X)")
        self.normals = unit_normals_of_lining(self.xy, shoe)
        if self.formulation == "full slip":
            self._add_full_slip_contact()
        else:
            self._add_coulomb_contact(shoe)

    def _add_full_slip_contact(self) -> None:
        """Add a contact in which the friction is mu p wherever the lining touches the drum."""
        pressure = gf.MeshFem("partial", self.scalar, self.nodes)
        self.model.add_fem_variable("p", pressure)
        self.model.add_fem_data("gap", pressure)
        work = "p*((normal - drag*along).Test_u)"
        law = "(p - pos_part(p + augment*(u.normal - gap)))/augment*Test_p"
        self.model.add_nonlinear_term(self.surface, f"{work} + {law}", CONTACT_REGION)

    def _add_coulomb_contact(self, shoe: dict[str, Any]) -> None:
        """Add GetFEM's own contact with Coulomb friction, on the drum as a sliding obstacle."""
        md = self.model
        dofs = self.displacement.basic_dof_on_region(CONTACT_REGION)
        traction = gf.MeshFem("partial", self.displacement, dofs)
        self.obstacle = self.finite_element_space(self.kind.obstacle)
        md.add_fem_variable("p", traction)
        md.add_fem_data("obstacle", self.obstacle)
        md.add_fem_data("slid", self.displacement)
        md.add_initialized_data("mu", [0.0])
        md.add_initialized_data("alpha", [1.0])
        md.add_integral_contact_with_rigid_obstacle_brick(
            self.surface, "u", "p", "obstacle", "augment", "mu", CONTACT_REGION, 1, "alpha", "slid"
        )
        x, y = (
            unit_normals_of_lining(self.displacement.basic_dof_nodes()[:, ::2], shoe) * shoe["side"]
        )
        self.sliding = np.array([-y, x])

    def integral_over_boundary(self, expression: str, region: int) -> float:
        """Integrate an expression of the model's variables over the boundary `region`."""
        mim = self.surface if region == CONTACT_REGION else self.inside
        return float(gf.asm_generic(mim, 0, expression, region, self.model))

    def vector_integrals_over_boundary(self, expression: str, region: int) -> list[float]:
        """Integrate both components of a vector expression over the boundary `region`."""
        return [self.integral_over_boundary(f"({expression})({k})", region) for k in (1, 2)]

    def initial_unknowns_of_newton_method(self, shoe: dict[str, Any]) -> dict[str, Any]:
        """The unknowns with which Newton's method starts: no displacement, all nodes touch."""
        values = {}
        for name in (*NAMES_OF_GETFEM_UNKNOWNS, *self.amounts):
            values[name] = np.zeros(len(self.model.variable(name)))
        force = np.add(shoe["force"], np.sum(shoe["at_places"], axis=0))
        pressure = shoe["augment"] * max(shoe["gap"]) + float(np.hypot(*force))
        if self.formulation == "full slip":
            values["p"] += pressure
        else:
            values["p"] -= pressure * self.normals.ravel(order="F")
        return values

    def solve(self, shoe: dict[str, Any], friction: float) -> dict[str, Any]:
        """Solve one shoe at a friction coefficient; returns its pressure, torque and forces.

        The shoe keeps its state under "state", from which its next solve starts.
        """
        # `drag` is the shoe's friction coefficient, negative if the drum drags the lining clockwise
        # in the shoe's frame, or a plane drags it towards smaller x.
        md, drag = self.model, friction * shoe["drag_sense"]
        self._set_loads_and_rigid_body_modes_of_shoe(shoe, drag)
        self._set_gap_between_lining_and_drum(shoe, drag)
        for name, value in (
            shoe.get("state") or self.initial_unknowns_of_newton_method(shoe)
        ).items():
            md.set_variable(name, value)
        options = {
            "max_iter": MOST_NEWTON_STEPS_OF_GETFEM,
            "max_res": NEWTON_RESIDUAL_TOLERANCE_OF_GETFEM,
            "lsolver": "mumps",
        }
        options |= {"lsearch": "simplest", "alpha min": 1.0}
        # GetFEM takes options as a list of names and values in turn.
        arguments: list[Any] = []
        for option in options.items():
            arguments += option
        steps, converged = md.solve(*arguments)
        shoe["state"] = {
            name: md.variable(name) for name in (*NAMES_OF_GETFEM_UNKNOWNS, *self.amounts)
        }
        return self._results_of_solved_shoe_as_plain_numbers(int(steps), bool(converged), drag)

    def _set_loads_and_rigid_body_modes_of_shoe(self, shoe: dict[str, Any], drag: float) -> None:
        """Set force, couple, friction and rigid-body modes of a shoe in the model."""
        md = self.model
        md.set_variable("force", np.array(shoe["force"]))
        md.set_variable("couple", np.array([shoe["couple"]]))
        md.set_variable("drag", np.array([drag]))
        at_places = np.zeros(self.displacement.nbdof())
        at_places[self.place] = shoe["at_places"]
        md.set_private_rhs(self.at_places, at_places)
        for k in range(len(shoe["motions"])):
            md.set_variable(f"motion{k}", np.atleast_1d(shoe["motions"][k]))
            md.set_variable(f"test{k}", np.atleast_1d(shoe["tests"][k]))
            md.set_variable(f"work{k}", np.atleast_1d(shoe["work"][k]))

    def _set_gap_between_lining_and_drum(self, shoe: dict[str, Any], drag: float) -> None:
        """Set the gap between lining and drum in the model.

        The "coulomb" formulation needs the distance of each node from the drum instead.
        """
        md = self.model
        if self.formulation == "full slip":
            md.set_variable(
                "gap", np.interp(polar_angles_of_points(self.xy, shoe), shoe["phi"], shoe["gap"])
            )
            return
        # The distance from the obstacle is the distance from the round drum (or the plane), plus
        # the clearance.
        x = self.obstacle.basic_dof_nodes()
        clearance = np.interp(polar_angles_of_points(x, shoe), shoe["phi"], shoe["clearance"])
        off = x[1] if shoe["flat"] else shoe["side"] * (1 - np.hypot(*x))
        md.set_variable("obstacle", off + clearance)
        md.set_variable(
            "slid",
            (SLIDING_DRUM_DISPLACEMENT_OVER_RADIUS * np.sign(drag) * self.sliding).ravel(order="F"),
        )
        md.set_variable("mu", np.array([abs(drag)]))

    def _results_of_solved_shoe_as_plain_numbers(
        self, steps: int, converged: bool, drag: float
    ) -> dict[str, Any]:
        """The results of a solved shoe as plain numbers for the result file.

        The value "slipping" is the torque of the shear stress divided by the torque of mu p; it is
        1 in full slip.
        """
        md = self.model
        p = md.variable("p")
        # Pressure and shear as GetFEM's expressions of the model's unknowns.
        pressure, shear = "p", "drag*p"
        if self.formulation == "coulomb":
            pressure, shear = "(-p.normal)", "(p.along)"
            p = -(p[::2] * self.normals[0] + p[1::2] * self.normals[1])
        torque = self.integral_over_boundary(f"{shear}*lever", CONTACT_REGION)
        full = self.integral_over_boundary(f"drag*{pressure}*lever", CONTACT_REGION)
        traction = f"({shear}*along - {pressure}*normal)"
        turning = self.integral_over_boundary("hold.[pin(2) - X(2); X(1) - pin(1)]", HINGE_REGION)
        return {
            "converged": converged and bool(np.isfinite(p).all()),
            "steps": steps,
            "slipping": torque / full if full else 0.0,
            "xy": self.xy.tolist(),
            "pressure": p.tolist(),
            "amounts": [float(md.variable(name)[0]) for name in self.amounts],
            "load_work": self.integral_over_boundary(f"{self.push}.u", ACTUATION_REGION)
            if self.loaded
            else 0.0,
            "torque": torque,
            "normal": self.vector_integrals_over_boundary(f"-{pressure}*normal", CONTACT_REGION),
            "tangential": self.vector_integrals_over_boundary(f"{shear}*along", CONTACT_REGION),
            "moment": self.integral_over_boundary(
                f"X(1)*{traction}(2) - X(2)*{traction}(1)", CONTACT_REGION
            ),
            "hold": [*self.vector_integrals_over_boundary("hold", HINGE_REGION), turning],
        }


def unit_normals_of_lining(x: Any, shoe: dict[str, Any]) -> Any:
    """Unit normals (2, n) of the lining's face at the points x (2, n), towards the drum."""
    if shoe["flat"]:
        return np.array([np.zeros(x.shape[1]), -np.ones(x.shape[1])])
    return shoe["side"] * x / np.hypot(*x)


def polar_angles_of_points(x: Any, shoe: dict[str, Any]) -> Any:
    """Polar angles (n,) [rad] of the points x (2, n), within pi of the lining's middle.

    On a plane surface the result has the coordinates of the points along the plane.
    """
    if shoe["flat"]:
        return x[0]
    return shoe["middle"] + np.angle(np.exp(-1j * shoe["middle"]) * (x[0] + 1j * x[1]))


def solve_brake_by_getfem(problem: dict[str, Any], data: dict[str, Any]) -> dict[str, Any]:
    """Solve all shoes of a brake at each friction coefficient in turn.

    Returns a dictionary. "answers" has, for each friction coefficient, a list of the results of all
    shoes. "seconds" has the processor time for each coefficient. "unknowns" is the number of
    unknowns of all models together.
    """
    # Shoes with the same body, kind of load and number of rigid-body modes share one model.
    bodies: dict[tuple[int, bool, int], GetfemBody] = {}
    shoes = [dict(shoe) for shoe in data["shoes"]]
    answers, seconds = [], []
    for friction in data["friction"]:
        start = time.process_time()
        found = []
        for shoe in shoes:
            key = (shoe["body"], shoe["on_body"], len(shoe["motions"]))
            if key not in bodies:
                bodies[key] = GetfemBody(problem, shoe["body"], shoe, data["formulation"])
            found.append(bodies[key].solve(shoe, friction))
        seconds.append(time.process_time() - start)
        answers.append(found)
    unknowns = sum(int(body.model.nbdof()) for body in bodies.values())
    return {"answers": answers, "seconds": seconds, "unknowns": unknowns}


def getfem_version() -> str:
    """The version of GetFEM, read from a mesh file, since no function of GetFEM returns it."""
    with tempfile.NamedTemporaryFile("r") as file:
        gf.Mesh("empty", 2).save(file.name)
        found = re.search(r"VERSION:? *(\S+)", file.read())
        return found[1] if found else "unknown"


def main(source: str, target: str) -> None:
    """Read a problem file, solve its shoes `repeats` times, and write the result file.

    Each solve builds its models anew. The result file has the answers of the last solve and the
    times of all solves.
    """
    gf.util_trace_level(0)
    gf.util_warning_level(0)
    with np.load(source) as file:
        problem = {name: file[name] for name in file.files}
    data = json.loads(str(problem.pop("data")))
    runs = [solve_brake_by_getfem(problem, data) for _ in range(data["repeats"])]
    result = runs[-1] | {
        "seconds": [run["seconds"] for run in runs],
        "version": getfem_version(),
    }
    Path(target).write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
