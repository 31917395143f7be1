"""Code that both peers use: it sets up shoes, makes responses from forces, and runs processes.

A peer is another public finite-element program, CalculiX or GetFEM.
"""

import math
import os
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.resource_use import processor_time_of_ended_child_processes
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.friction import require_friction_independent_of_pressure
from drumlin.brake.further_loads import require_springs_with_constant_pull
from drumlin.brake.heat import reason_if_any_shoe_is_heated
from drumlin.brake.one_sided import require_no_shoe_on_anchors
from drumlin.fem.equilibrium.modes import pin_motions_in_rigid_body_motions
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND, parametric_mesh_of_shoe
from drumlin.fem.preparation.bodies import (
    actuation_factors_and_pin_moment_per_newton,
    moment_of_loads_besides_actuation_about_pin,
    unit_load_factors_of_loads_besides_actuation,
)
from drumlin.fem.preparation.cache import cache_key_of_shoe_shape
from drumlin.fem.preparation.load_places import (
    unit_load_factors_of_forces_at_points_and_mass,
    unit_loads_at_points_and_mass,
)
from drumlin.fem.preparation.meshes import (
    DEFAULT_ELEMENTS_ALONG_LINING,
    AssembledUncondensedShoe,
    Mesher,
    mesh_and_assemble_shoe,
)
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME
from drumlin.laws import rigid
from drumlin.response.balance import (
    largest_imbalance_among_shoes,
    relative_magnitudes_of_force_and_moment_sums,
)
from drumlin.response.response import (
    ForceAndMomentImbalance,
    Response,
    ShoeResponse,
    response_of_pressed_elastic_shoe,
    response_of_shoe_without_contact,
)
from drumlin.response.resultants import contact_arcs_from_nodal_pressures, planar_cross_product

LARGEST_RELATIVE_PRESSURE_WITHOUT_CONTACT = 1e-3
"""Pressure, relative to the peak, below which a lining counts as not touching the drum.

A peer with a contact penalty has small pressures outside the contact, which are ignored in this
way."""

ONE_THREAD_ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "CCX_NPROC_EQUATION_SOLVER": "1",
}
"""Environment variables with which a peer runs on one thread, so that times are comparable."""


class PeerMissing(BadInput):
    """Error: a peer is not installed. The message says how to install it."""


class PeerResult(NamedTuple):
    """A brake solved by a peer: its response, and the cost in processor time on one thread.

    Attributes
    ----------
    name : name of the peer, "calculix" or "getfem"
    version : version of the peer
    response : response of the brake
    seconds : time of the peer's computation [s], without the start of its process if it is known
    process_seconds : time of all processes for one solve [s]
    further_seconds : time [s] of a second load case, which is the same brake with another friction
        coefficient; a peer that can reuse results of the first load case does so
    unknowns : number of unknowns of all systems; equal shoes that share a system count once
    notes : lines of text about the solve
    """

    name: str
    version: str
    response: Response
    seconds: float
    process_seconds: float
    further_seconds: float
    unknowns: int
    notes: tuple[str, ...]


class MeshedShoe(NamedTuple):
    """Mesh and matrices of a shoe, and the number of its shape.

    Shoes of equal shape share mesh and matrices.
    """

    body: int
    parts: AssembledUncondensedShoe


@dataclass(frozen=True)
class MeshedShoeUnderActuation:
    """A meshed shoe under its actuation, in the frame of the shoe.

    Attributes
    ----------
    shoe : the shoe
    parts : mesh and matrices of the shoe
    body : number of the shoe's shape
    force : force (2,) [N] of the actuation
    couple : couple [N m] of the actuation about `parts.application_point_of_actuation_loads`
    drag : friction coefficient, negative if the drum drags the lining towards smaller phi
    is_pressed_on_drum : whether the loads press the shoe on the drum anywhere
    motions : rigid-body modes (k, 3) of the shoe's rigid holder, the part that the support guides:
        dx, dy [m] and rotation at the pin
    tests : test modes (k, 3) in the same form, on which the support reactions do no work
    work : work (k,) of all loads on the test modes
    at_places : nodal forces (nodes, 2) [N] of springs, weight and other forces that act on the body
        at their own points; all other loads are in `force` and `couple`
    tip : displacement (k,) of the force's point of action along the force, for each rigid-body mode
    """

    shoe: Shoe
    parts: AssembledUncondensedShoe
    body: int
    force: Floats
    couple: float
    drag: float
    is_pressed_on_drum: bool
    motions: Floats
    tests: Floats
    work: Floats
    tip: Floats
    at_places: Floats

    @property
    def virtual_work_of_loads_on_rigid_holder(self) -> Floats:
        """Work (k,), on the test modes, of the loads that act on the shoe's rigid holder.

        The rigid holder is the part of the shoe that the support guides.
        """
        if self.does_actuation_act_on_body_end:
            return np.zeros_like(self.work)
        # Springs, weight and other forces at points of the body do not act on the holder, so that
        # their work is subtracted.
        return self.work - self.tests @ self.resultant_about_pin_of_loads_at_places

    @property
    def actuation_resultant_about_pin(self) -> Floats:
        """Resultant (3,) of the actuation about the pin: force x, y [N] and moment [N m]."""
        arm = self.parts.application_point_of_actuation_loads - self.shoe.pin_position_in_shoe_frame
        couple = self.couple + float(planar_cross_product(arm, self.force))
        return np.array([*self.force, couple])

    @property
    def resultant_about_pin_of_loads_at_places(self) -> Floats:
        """The resultant (3,) of `at_places` about the pin: force x, y [N] and moment [N m]."""
        x, y = self.parts.basis.doflocs - self.shoe.pin_position_in_shoe_frame[:, None]
        fx, fy = self.at_places.T
        return np.array([fx.sum(), fy.sum(), x @ fy - y @ fx])

    @property
    def does_actuation_act_on_body_end(self) -> bool:
        """Whether the actuation acts on an end of the shoe's body, and not on its rigid holder."""
        return (
            "actuation" in self.parts.mesh.boundaries and not self.shoe.has_support_on_back_of_body
        )

    @property
    def radius(self) -> float:
        """The mean radius [m] of the lining's face; on a plane, the length of a unit of phi [m]."""
        line = self.parts.line
        if self.shoe.is_on_plane:
            return float(np.ptp(line.xy[0]) / np.ptp(line.phi))
        return float(np.hypot(*line.xy).mean())


def mesh_shoes_for_peer_program(
    brake: Brake,
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
    mesher: Mesher | None = None,
) -> list[MeshedShoe]:
    """Mesh the shoes of a brake by drumlin's mesher; returns their meshes and matrices.

    Parameters
    ----------
    brake : the brake
    elements, kind : number of elements along each lining, and kind of the elements
    mesher : function that meshes a shoe; None: drumlin's mesher with `elements` and `kind`

    Raises
    ------
    BadInput
        for a brake with an elastic ring or without friction, because the drum of the peers is rigid
        and slips; for shoes on anchors, heated shoes, springs with a rate, and friction that
        depends on the pressure
    """
    if brake.ring is not None:
        raise BadInput("drum.ring: the peers get a rigid drum; leave out [drum.ring]")
    require_no_shoe_on_anchors(brake, "the comparison with peers")
    if brake.friction == 0:
        raise BadInput(
            "friction = 0: the peers are given a drum that slips; must be greater than 0"
        )
    for i, shoe in enumerate(brake.shoes):
        if brake.friction_coefficient_of_shoe_at_zero_pressure(shoe) == 0:
            raise BadInput(
                f"shoe[{i}].lining.friction = 0: the peers are given a drum that slips; "
                "must be greater than 0"
            )
    require_springs_with_constant_pull(brake, "a peer")
    require_friction_independent_of_pressure(brake, "a peer")
    heated = reason_if_any_shoe_is_heated(brake, "a peer")
    if heated is not None:
        raise BadInput(heated)
    mesher = mesher or partial(parametric_mesh_of_shoe, elements=elements, kind=kind)
    # Shoes of equal shape share one mesh.
    by_shape: dict[tuple[object, ...], MeshedShoe] = {}
    meshed = []
    for shoe in brake.shoes:
        shape = cache_key_of_shoe_shape(brake, shoe)
        if shape not in by_shape:
            by_shape[shape] = MeshedShoe(
                len(by_shape), mesh_and_assemble_shoe(brake, shoe, mesher, {})
            )
        meshed.append(by_shape[shape])
    return meshed


def meshed_shoe_with_actuation_and_support(
    brake: Brake, shoe: Shoe, meshed: MeshedShoe, sense: int = 1
) -> MeshedShoeUnderActuation:
    """A meshed shoe with its actuation, its support and the friction of the drum.

    Parameters
    ----------
    brake : the brake
    shoe : the shoe
    meshed : mesh and matrices of the shoe
    sense : sense of the friction at an abutment, see `SupportedShoe.rigid_body_modes_of_support`
    """
    parts = meshed.parts
    factors, moment = actuation_factors_and_pin_moment_per_newton(parts, shoe)
    size, free = abs(shoe.actuation.force), shoe.rigid_body_modes_of_support(sense)
    acting, moment = size * factors, size * moment
    at_places = np.zeros((parts.basis.N, 2))
    if shoe.has_loads_besides_actuation:
        acting = acting + unit_load_factors_of_loads_besides_actuation(parts, shoe)
        moment += moment_of_loads_besides_actuation_about_pin(shoe)
        factors_by_name = unit_load_factors_of_forces_at_points_and_mass(shoe)
        for name, forces in unit_loads_at_points_and_mass(parts.basis, shoe, brake.size).items():
            at_places += (forces @ factors_by_name[name]).reshape(-1, 2)
    load = parts.load_matrix_columns_by_load_name.column_factors_of_one_named_load(
        ACTUATION_LOAD_NAME, acting
    )
    if shoe.kind_of_support == "hinge" and not shoe.is_on_plane:
        # If the shoe turns by 1 rad about the pin at (a, 0), the gap at the point (x, y) of the
        # lining, at the radius r, closes by -sign a y / r.
        closing = -moment * shoe.sign_internal_plus_external_minus * parts.line.xy[1]
        is_pressed_on_drum = shoe.is_any_load_on_shoe and bool((closing > 0).any())
    else:
        sign = rigid.sign_of_pressure_that_balances_actuation
        is_pressed_on_drum = shoe.is_any_load_on_shoe and sign(brake, shoe) >= 0
    return MeshedShoeUnderActuation(
        shoe=shoe,
        parts=parts,
        body=meshed.body,
        force=load[:2],
        couple=float(load[2]),
        drag=brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe),
        is_pressed_on_drum=is_pressed_on_drum,
        motions=pin_motions_in_rigid_body_motions(shoe, free.motions).T,
        tests=pin_motions_in_rigid_body_motions(shoe, free.test_modes).T,
        work=free.work_of_all_loads_on_test_modes,
        tip=free.actuation_point_travel,
        at_places=at_places,
    )


def mesh_hinged_shoes_under_actuation(
    brake: Brake,
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
    mesher: Mesher | None = None,
) -> list[MeshedShoeUnderActuation]:
    """The hinged shoes of a brake, meshed by drumlin's mesher, each under its own actuation.

    `elements` and `kind` are the number of elements along each lining and their kind, and `mesher`
    is a function that meshes a shoe (None for drumlin's mesher). Raises BadInput for a brake on a
    plane, for a shoe without a hinge, and for a brake that `mesh_shoes_for_peer_program` refuses.
    """
    if brake.surface.is_plane_and_not_drum:
        raise BadInput("CalculiX takes brakes on a drum: its shoes press on a plane")
    brake.check_all_shoes_are_hinged("CalculiX")
    meshed = mesh_shoes_for_peer_program(brake, elements, kind, mesher)
    return [
        meshed_shoe_with_actuation_and_support(brake, shoe, own)
        for shoe, own in zip(brake.shoes, meshed, strict=True)
    ]


class ForcesOnShoeByPeer(NamedTuple):
    """The forces on one shoe by a peer's computation, in the shoe's frame.

    Attributes
    ----------
    normal : resultant of the pressure (2,) [N]
    friction : resultant of the friction (2,) [N]
    moment : moment of pressure and friction about the origin [N m]
    held : (3,) force x, y [N] of the holder on the shoe, and its moment about the pin [N m]
    torque : braking torque on the drum [N m], positive; on a plane the braking force [N]
    """

    normal: Floats
    friction: Floats
    moment: float
    held: Floats
    torque: float


def shoe_response_and_imbalance_from_peer_forces(
    loaded: MeshedShoeUnderActuation,
    phi: Floats,
    pressure: Floats,
    order: int,
    forces: ForcesOnShoeByPeer,
    amounts: Floats,
) -> tuple[ShoeResponse, ForceAndMomentImbalance]:
    """A shoe's response from a peer's pressure and forces, and the imbalance of these forces.

    Parameters
    ----------
    loaded : the shoe under its actuation
    phi : growing angles (n,) [rad] of the nodes of the pressure
    pressure : pressure (n,) [Pa] at the nodes
    order : polynomial degree of the pressure between the nodes
    forces : forces on the shoe as the peer has computed them
    amounts : generalised coordinates (k,) of the rigid-body modes
    """
    shoe, frame, tests = loaded.shoe, loaded.shoe.frame, loaded.tests
    load = loaded.actuation_resultant_about_pin
    reaction = forces.held if loaded.does_actuation_act_on_body_end else forces.held - load
    drag = _friction_force_and_moment_about_pin_from_peer_forces(loaded, forces)
    response = response_of_pressed_elastic_shoe(
        shoe,
        loaded.radius / frame.surface_coordinate_per_phi,
        frame.surface_coordinates_of_phi(phi),
        pressure,
        order=order,
        torque=forces.torque,
        normal_force=float(np.linalg.norm(forces.normal)),
        self_energising=float(tests[0] @ drag) * float(loaded.work[0]) > 0,
        hinge_reaction=frame.convert_vectors_from_shoe_to_brake_frame(reaction[:2]),
        turn=frame.sense * float(amounts @ loaded.motions[:, 2]),
        pivot_reaction=frame.convert_vectors_from_shoe_to_brake_frame(forces.held[:2])
        if shoe.pivot is not None
        else None,
        reaction_moment=frame.sense * float(reaction[2]) if shoe.guide is not None else 0.0,
        # Small pressures outside the contact, which a peer has, would hide the ends of the contact.
        # The ends are located below, without these pressures.
        located=False,
    )
    p = response.pressure
    touching = np.where(p > LARGEST_RELATIVE_PRESSURE_WITHOUT_CONTACT * p.max(), p, 0.0)
    arcs = contact_arcs_from_nodal_pressures(response.theta, touching, order)
    return replace(response, contact_arcs=arcs), _imbalance_of_peer_forces(loaded, forces, load)


def _friction_force_and_moment_about_pin_from_peer_forces(
    loaded: MeshedShoeUnderActuation, forces: ForcesOnShoeByPeer
) -> Floats:
    """The friction force x, y [N] on a shoe, and its moment about the pin [N m], as (3,).

    On a drum the moment follows from the torque about the drum's centre.
    """
    pin = loaded.shoe.pin_position_in_shoe_frame
    drag = np.array([*forces.friction, -float(planar_cross_product(pin, forces.friction))])
    if not loaded.shoe.is_on_plane:
        drag[2] += math.copysign(forces.torque, loaded.drag)
    return drag


def _imbalance_of_peer_forces(
    loaded: MeshedShoeUnderActuation, forces: ForcesOnShoeByPeer, load: Floats
) -> ForceAndMomentImbalance:
    """The relative imbalance of a peer's forces on a shoe.

    `force` of the result is the magnitude of the sum of all forces, relative to the largest force.
    `moment` is the sum of all moments about the origin, or the imbalance of the shoe's rigid
    holder, whichever is larger; both are relative, too. The holder is in balance if its forces on
    the shoe and the loads on the holder do the same work on each test mode. `load` (3,) is the
    force of the actuation [N] and its moment about the pin [N m].
    """
    pin, tests = loaded.shoe.pin_position_in_shoe_frame, loaded.tests
    push = loaded.resultant_about_pin_of_loads_at_places
    if loaded.does_actuation_act_on_body_end:
        push = push + load
    normal_force = float(np.linalg.norm(forces.normal))
    moments = [
        float(planar_cross_product(pin, forces.held[:2])),
        float(planar_cross_product(pin, push[:2])),
    ]
    moments += [float(forces.held[2]), float(push[2])]
    # The list of moments also gets the normal force times the radius, with both signs. These two
    # entries enlarge the moment to which the sum is relative, but not the sum.
    size = loaded.radius * normal_force
    balance = relative_magnitudes_of_force_and_moment_sums(
        [forces.normal, forces.friction, forces.held[:2], push[:2]],
        [forces.moment, *moments, size, -size],
    )
    work = loaded.virtual_work_of_loads_on_rigid_holder
    lengths = np.hypot(*tests.T[:2]) + loaded.radius * np.abs(tests[:, 2])
    unbalanced = np.abs(tests @ forces.held - work) / lengths
    moment = max(balance.moment, float(unbalanced.max()) / normal_force)
    return ForceAndMomentImbalance(balance.force, moment)


def zero_response_and_imbalance_of_shoe_turned_from_drum(
    loaded: MeshedShoeUnderActuation,
) -> tuple[ShoeResponse, ForceAndMomentImbalance]:
    """The response, without pressure, of a shoe that its loads turn away from the drum."""
    return response_of_shoe_without_contact(
        loaded.shoe, -loaded.shoe.sum_of_forces_of_all_loads
    ), ForceAndMomentImbalance(0.0, 0.0)


class EndedProcess(NamedTuple):
    """A process that has ended: its exit status, the text it printed, its processor time [s]."""

    status: int
    output: str
    seconds: float


def run_command_of_peer_program(
    command: Sequence[str], folder: Path, longest: float
) -> EndedProcess:
    """Run a peer's command in a folder, on one thread.

    PYTHONPATH and PYTHONHOME of this process are not passed on. Raises NoAnswer if the command
    still runs after `longest` seconds.
    """
    environment = dict(os.environ)
    for name in ("PYTHONPATH", "PYTHONHOME"):
        environment.pop(name, None)
    # The processor time of the command is the growth of the time of all child processes.
    before = processor_time_of_ended_child_processes()
    try:
        done = subprocess.run(
            command,
            env=environment | ONE_THREAD_ENVIRONMENT,
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=longest,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise NoAnswer(f"{command[0]}: still running after {longest:g} s") from error
    spent = processor_time_of_ended_child_processes() - before
    return EndedProcess(done.returncode, done.stdout, spent)


def brake_response_from_shoe_responses(
    model: str,
    answers: Sequence[tuple[ShoeResponse, ForceAndMomentImbalance]],
    iterations: int,
    seconds: dict[str, float],
) -> Response:
    """The response of the whole brake, put together from the responses of its shoes.

    Parameters
    ----------
    model : name of the peer
    answers : response of each shoe, and imbalance of its forces
    iterations : number of iterations of the peer
    seconds : processor time [s], by the name of the program or step that took it
    """
    return Response(
        model=model,
        shoes=tuple(response for response, _ in answers),
        balance=largest_imbalance_among_shoes([balance for _, balance in answers]),
        iterations=iterations,
        seconds=seconds,
    )
