"""Groups of shoes that must be solved together, and the solutions of their contact problems.

A shoe on a rigid drum is a group by itself. Shoes on an elastic drum ring influence each other and
form one group, and so do shoes that a strut or a cam connects. All analyses of the contact
(sliding, holding, wear, sensitivity, self-locking) start from groups.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.one_sided import (
    ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD,
    LARGEST_ROUND_OFF_CONTACT_FORCE,
    all_choices_of_bearing_supports,
    error_text_on_shoes_without_contact_force,
    first_redundant_supports,
)
from drumlin.contact import active_set, self_locking
from drumlin.fem.equilibrium import reach
from drumlin.fem.equilibrium.problems import ContactProblemsOfShoeGroup
from drumlin.fem.equilibrium.sharing import (
    ERROR_TEXT_ON_CAM_OR_STRUT_THAT_WOULD_PULL,
    LARGEST_STRUT_OR_CAM_FORCE_COUNTED_AS_ZERO,
)
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    actuation_factors_and_pin_moment_per_newton,
    moment_of_loads_besides_actuation_about_pin,
)
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.laws import rigid
from drumlin.laws.anchored import which_supports_of_rigid_shoes_bear

ERROR_TEXT_ON_FOOT_LEAVING_ABUTMENT = "no equilibrium, a foot leaves its abutment"
"""Text of the refusal of a brake in which the foot of a shoe would lift off its abutment."""
WORDS_FOR_ELASTIC_MODEL_IN_LOCKING_MESSAGE = "elastic as it is"
"""Words for the elastic model in the message that a brake locks itself.

The message also states the limit by the law of the rigid shoe.
"""
LARGEST_FRICTION_STEP_BETWEEN_CHECKS = self_locking.LARGEST_STEP_OF_GROWING_FRICTION / 4
"""Largest step of the drum's friction coefficient between two checks of feet, cam and struts.

The checks are made while the friction grows to the limit of self-locking. A check finds in which
direction the feet of the shoes slide on their abutments, and whether the cam and the struts still
push all shoes. Above a friction coefficient of 1 the step is relative to the coefficient. A foot
that leaves its abutment and comes back within a step goes unnoticed; a smaller step costs time.
"""
RELATIVE_DISTANCE_OF_LAST_CHECK_BELOW_LOCKING = 1e-4
"""Relative distance below the limit of self-locking at which feet, cam and struts are last checked.

The limit is the friction coefficient at which the pressures would be infinite. If a foot begins to
slide at a friction coefficient still nearer to the limit, the limit changes by less than this
fraction, which is the last of the four digits that are printed.
"""

MOST_PRESSED_NODES_OF_CONTACT_AT_POINT = 2
"""Number of pressed nodes up to which a contact that shrinks counts as shrunk to a point.

The resultant of a contact moves towards its point continuously. It passes from one node to the next
one, so that at most two nodes press in the end. The mesh cannot tell their pressure: without
elements the pressure grows without bound under the finite force.
"""


class CamOrStrutWouldPullError(NoAnswer):
    """The error that a cam or a strut would have to pull a shoe, while it can only push."""


class DrumFrictionLimitOfShoeGroup(NamedTuple):
    """The friction coefficient of the drum up to which a group of shoes has an equilibrium.

    Attributes
    ----------
    limit : the limit of the friction coefficient
    text_on_part_that_would_pull : text that names the cam, strut or foot that would have to pull at
        the limit; empty if the equilibrium ends for another reason
    """

    limit: self_locking.LargestFrictionWithEquilibrium
    text_on_part_that_would_pull: str


class SolvedGroup(NamedTuple):
    """A group of shoes and the solution of its contact.

    `group` has the friction directions at its abutments that agree with the solution `contact`.
    """

    group: "ShoeGroup"
    contact: active_set.ContactSolution


class ShoeGroup(ContactProblemsOfShoeGroup):
    """A group of shoes that are solved together; its methods solve its contact problems."""

    def copy_of_group_with_other_drum_friction(self, friction: float) -> "ShoeGroup":
        """A copy of the group with another friction coefficient of the drum.

        The friction of linings with a coefficient of their own changes in proportion. The
        directions of friction at the abutments stay.
        """
        return replace(
            self,
            brake=self.brake.brake_with_new_friction_coefficient(friction),
            shoe_frictions_over_brake_friction=self.friction_of_each_shoe_over_brake_friction,
        )

    # These methods solve the contact under given directions of friction at the abutments.

    def solve_contact_for_given_abutment_friction(
        self, first_contact_set: Bools | None = None
    ) -> active_set.ContactSolution:
        """Solve the contact for the group's present directions of friction at the abutments.

        Returns pressures and motions per newton of `largest_actuation_force`. `first_contact_set`
        (n,) is a contact set to start from. Raises NoAnswer if the brake locks itself, has no
        equilibrium or does not converge, and if a shoe turns too far for small displacements.
        """
        for k, shoe in enumerate(self.shoes):
            xy = self.substructures_of_shoes[k].line.xy
            reach.require_small_turn_of_hinged_shoe(
                shoe,
                xy,
                self.gaps_of_unloaded_linings[k],
                self.moment_of_all_loads_about_shoe_pin(k),
            )
        law = min(map(self.locking_friction_of_group_shoe_by_rigid_law, range(len(self.members))))
        try:
            contact = self_locking.solve_contact_reached_from_zero_friction(
                self.contact_problem_of_group_at_friction,
                self.brake.friction,
                first_contact_set,
                self.contact_node_areas,
                rigid_law_limit=law,
                brake_words=WORDS_FOR_ELASTIC_MODEL_IN_LOCKING_MESSAGE,
            )
        except NoAnswer as error:
            # If the solution ends where the force of a strut or cam falls to zero, the brake does
            # not lock: a shoe leaves the drum.
            if isinstance(error, self_locking.FrictionBeyondSelfLockingError) and (
                refusal := self._error_text_if_force_pulls_at_friction_limit(error.limit)
            ):
                raise CamOrStrutWouldPullError(refusal) from error
            raise NoAnswer(f"{self.names_of_shoes_as_text}: {error}") from error
        self._require_small_turns_of_shoes(contact)
        return contact

    def _require_small_turns_of_shoes(self, contact: active_set.ContactSolution) -> None:
        """Raise NoAnswer if a shoe turns too far for small displacements, unless it may."""
        if self.are_large_turns_allowed:
            return
        for k, coordinates in enumerate(self.rigid_body_coordinates_of_each_shoe(contact)):
            turns = self.largest_actuation_force * coordinates
            reach.require_small_shoe_turns_in_contact_solution(
                self.shoes[k],
                self.known_abutment_friction_directions[k],
                self.gaps_of_unloaded_linings[k],
                turns,
            )

    def locking_friction_of_group_shoe_by_rigid_law(self, k: int) -> float:
        """The friction coefficient of the brake at which shoe `k` locks by the rigid-shoe law."""
        ratio = self.friction_of_each_shoe_over_brake_friction[k]
        own = self.locking_friction_of_brake_shoe_by_rigid_law(self.members[k])
        return own / ratio if ratio else math.inf

    def moment_of_all_loads_about_shoe_pin(self, k: int) -> float:
        """The moment of all loads on shoe `k` about its pin, in the sense of the shoe's frame.

        The moment is per newton of the actuation force [m]. If springs, weight or additional forces
        act on the shoe, the moment is that of the full loads [N m].
        """
        shoe = self.shoes[k]
        per_newton = self.actuation_of_each_shoe_by_one_newton[k].moment_about_pin
        if not shoe.has_loads_besides_actuation:
            return per_newton
        return abs(shoe.actuation.force) * per_newton + moment_of_loads_besides_actuation_about_pin(
            shoe
        )

    def locking_friction_of_brake_shoe_by_rigid_law(self, i: int) -> float:
        """The friction at which shoe `i` of the brake locks itself by the rigid-shoe law.

        For a shoe on anchors, and for a hinged shoe that the drum drags the same way as in the
        prepared model, the value is taken from the model.
        """
        shoe, known = self.brake.shoes[i], self.prepared_model.brake.shoes[i]
        kinds = {shoe.kind_of_support, known.kind_of_support}
        limits = self.prepared_model.locking_frictions_of_rigid_shoes
        drag = self.brake.sign_of_motion * shoe.frame.sense
        same = drag == self.prepared_model.brake.sign_of_motion * known.frame.sense
        if same and kinds in ({"hinge"}, {"anchor"}):
            return limits.with_motion_of_file[i]
        if kinds == {"anchor"}:
            return limits.with_reversed_motion[i]
        return rigid.self_locking_friction_of_rigid_shoe(self.brake, shoe)

    def _error_text_if_force_pulls_at_friction_limit(
        self, limit: self_locking.LargestFrictionWithEquilibrium
    ) -> str:
        """The error text if a strut or cam ceases to push at a limit of friction; otherwise empty.

        The limit is the friction coefficient of the drum up to which the contact has a solution.
        """
        sharing = self._strut_and_cam_contact_problem_at_friction(limit.last_friction)
        return (
            ""
            if sharing is None
            else self._error_text_if_actuation_force_pulls(
                sharing.actuation_forces_under_contact_pressures(limit.last_contact.p)
            )
        )

    def _error_text_if_actuation_force_pulls(self, forces: Floats) -> str:
        """The error text if one of the actuation forces (shoes,) does not push; otherwise empty."""
        i = int(forces.argmin())
        if forces[i] <= LARGEST_STRUT_OR_CAM_FORCE_COUNTED_AS_ZERO * forces.max():
            return f"shoe {self.shoes[i].name!r}: {ERROR_TEXT_ON_CAM_OR_STRUT_THAT_WOULD_PULL}"
        return ""

    # These methods find the directions of friction at the abutments that agree with the solution.

    def solve_contact_and_abutment_friction(
        self, first_contact_set: Bools | None = None
    ) -> SolvedGroup:
        """Solve the contact of the group, and find the directions of friction at its abutments.

        The directions must agree with the solution that they lead to. The drum already turns when
        the actuation force is applied. The foot of a shoe slides on its abutment, and friction
        opposes the whole slide from the unloaded position; or friction holds the foot in this
        position. The directions for rigid shoes are tried first. The order of trials does not
        matter: no brake is known in which two choices of directions agree with their solutions.
        `first_contact_set` (n,) is a contact set to start from. Raises NoAnswer as
        `solve_contact_for_given_abutment_friction` does, and if a foot would leave its abutment.
        """
        try:
            return self._solve_contact_with_confirmed_abutment_friction(first_contact_set)
        except NoAnswer as error:
            refusal = self._error_text_if_shoe_on_abutment_locks()
            if not refusal:
                raise
            raise NoAnswer(refusal) from error

    def _solve_contact_with_confirmed_abutment_friction(
        self, first_contact_set: Bools | None = None
    ) -> SolvedGroup:
        """Solve the contact, with directions of abutment friction that agree with its solution.

        Each choice of directions, and of bearing one-sided supports, is tried. If no choice agrees
        with its own solution, the error of the first trial is raised. NoAnswer is also raised if
        one-sided supports hold all shoes of the group without any contact force.
        """
        failure = NoAnswer(
            f"{self.names_of_shoes_as_text}: {self._error_text_that_shoes_are_not_held}"
        )
        for number, group in enumerate(self.groups_with_each_abutment_friction_direction()):
            try:
                contact = group.solve_contact_for_given_abutment_friction(first_contact_set)
            except NoAnswer as error:
                if number == 0:
                    failure = error
                continue
            if group.does_contact_confirm_support_assumptions(contact):
                return SolvedGroup(group, group._contact_without_round_off_pressures(contact))
        raise failure

    def _contact_without_round_off_pressures(
        self, contact: active_set.ContactSolution
    ) -> active_set.ContactSolution:
        """The contact with zero pressures on each shoe that one-sided supports hold off the drum.

        The contact set stays. Raises NoAnswer if no shoe of the group has a contact force.
        """
        if not self.one_sided_supports:
            return contact
        areas, p = self.contact_node_areas, contact.p.copy()
        for k, part in enumerate(self.contact_node_slices_of_shoes):
            supports = self.support_forces_on_shoe(contact.p, k)
            largest = max(
                self.shoes[k].largest_force_of_any_load, *(each.push.force for each in supports)
            )
            force = self.largest_actuation_force * float(areas[part] @ p[part])
            if force <= LARGEST_ROUND_OFF_CONTACT_FORCE * largest:
                p[part] = 0.0
        if not p.any():
            raise NoAnswer(error_text_on_shoes_without_contact_force(self.brake, self.members))
        return contact if np.array_equal(p, contact.p) else replace(contact, p=p)

    @property
    def _error_text_that_shoes_are_not_held(self) -> str:
        """The error text for a group that no choice of supports and friction directions holds."""
        if not self.one_sided_supports:
            return ERROR_TEXT_ON_FOOT_LEAVING_ABUTMENT
        matrices = self.one_sided_support_matrices_at_friction(self.brake.friction)
        names = [
            self.one_sided_supports[i].name
            for i in first_redundant_supports(matrices.opening_by_motion, matrices.sizes)
        ]
        # An elastic shoe may press on both supports, and is then statically indeterminate.
        wedged = f"; it may be wedged between {' and '.join(names)}: give one of them a clearance"
        return ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD + (wedged if names else "")

    def groups_with_each_abutment_friction_direction(self) -> Iterator["ShoeGroup"]:
        """Yield the group with each possible choice of friction directions at its abutments.

        The present directions come first; if they are unknown, the directions for rigid shoes. For
        each choice of directions, each choice of bearing one-sided supports follows.
        """
        begin = self.abutment_friction_directions_of_shoes or tuple(
            _abutment_friction_direction_of_rigid_shoe(self.brake, shoe) for shoe in self.shoes
        )
        choices = []
        for own, shoe in zip(begin, self.shoes, strict=True):
            others = [sense for sense in shoe.senses_of_abutment_friction_to_try if sense != own]
            choices.append((own, *others))
        for senses in product(*choices):
            group = self
            if senses != self.abutment_friction_directions_of_shoes:
                group = replace(self, abutment_friction_directions_of_shoes=senses)
            yield from group._groups_with_each_choice_of_supports()

    def _groups_with_each_choice_of_supports(self) -> Iterator["ShoeGroup"]:
        """Yield the group with each choice of bearing one-sided supports that holds the shoes.

        The present choice comes first; if it is unknown, the choice for rigid shoes. A group
        without one-sided supports is yielded as it is.
        """
        count = len(self.one_sided_supports)
        if not count:
            yield self
            return
        first = self.bearing or which_supports_of_rigid_shoes_bear(self.brake, self.members)
        for bearing in all_choices_of_bearing_supports(count, first):
            if (
                self.contact_problem_on_given_supports_or_none(bearing, self.brake.friction)
                is not None
            ):
                yield self if bearing == self.bearing else replace(self, bearing=bearing)

    def does_contact_confirm_support_assumptions(self, contact: active_set.ContactSolution) -> bool:
        """Whether a solution agrees with what was assumed to solve it.

        Assumed are the directions of friction at the abutments, and which one-sided supports bear.
        """
        if not all(
            self.can_abutment_exert_computed_reaction(contact, k) for k in range(len(self.members))
        ):
            return False
        supports = self.contact_problem_on_bearing_supports_or_none
        return supports is None or supports.do_supports_bear_as_assumed(contact.p, contact.y)

    def can_abutment_exert_computed_reaction(
        self, contact: active_set.ContactSolution, k: int
    ) -> bool:
        """Whether the abutment can exert the computed reaction on the foot of shoe `k`.

        It can if it presses on the foot, and if its friction has the direction assumed for the
        solve: against the slide of the foot, or large enough to hold it.
        """
        shoe = self.shoes[k]
        if shoe.abutment is None or shoe.anchors:
            return True
        slide = float(self.rigid_body_coordinates_of_each_shoe(contact)[k][-1])
        return shoe.can_abutment_exert_reaction_on_shoe(
            self.abutment_force_on_shoe(contact, k),
            self.known_abutment_friction_directions[k],
            slide,
        )

    def abutment_force_on_shoe(self, contact: active_set.ContactSolution, k: int) -> Floats:
        """The force (2,) of the abutment on the foot of shoe `k`, in the frame of the brake.

        The force is relative to `largest_actuation_force`.
        """
        shoe, body = self.shoes[k], self.substructures_of_shoes[k]
        drag, p = (
            self.brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe),
            contact.p[self.contact_node_slices_of_shoes[k]],
        )
        # The reaction balances the contact forces, the actuation, springs, weight and additional
        # forces.
        normal, dragged = body.resultants_of_unit_nodal_pressures_and_tractions
        normal, dragged = (
            normal @ p,
            dragged @ self.friction_stress_over_friction_coefficient_of_shoe(k, p),
        )
        push = (
            self.actuation_forces_under_contact_pressures(contact.p)[k]
            * shoe.actuation.unit_vector_of_force
        )
        if shoe.has_loads_besides_actuation:
            push = (
                push + shoe.resultant_of_loads_besides_actuation[:2] / self.largest_actuation_force
            )
        return np.asarray(
            -shoe.frame.convert_vectors_from_shoe_to_brake_frame((drag * dragged - normal)[:2])
            - push
        )

    def _error_text_if_shoe_on_abutment_locks(self) -> str:
        """The error text if a group with rough abutments has no equilibrium at the drum's friction.

        The text names a cam, strut or foot that would have to pull, or it states the limit of
        self-locking, which is then below the drum's friction. The text is empty without friction at
        an abutment, and if the equilibrium does not end below the drum's friction.
        """
        if not self.has_abutment_with_friction:
            return ""
        friction = self.brake.friction
        try:
            end = self.find_friction_limit_by_following_contact(friction)
        except NoAnswer:
            return ""
        if not end.limit.friction < friction:
            return ""
        law = min(map(self.locking_friction_of_group_shoe_by_rigid_law, range(len(self.members))))
        locked = self_locking.self_locking_error_text(
            friction,
            end.limit.friction,
            rigid_law_limit=law,
            brake_words=WORDS_FOR_ELASTIC_MODEL_IN_LOCKING_MESSAGE,
        )
        return end.text_on_part_that_would_pull or f"{self.names_of_shoes_as_text}: {locked}"

    # These methods follow the solution as the friction coefficient of the drum grows.

    @property
    def has_neither_strut_cam_nor_abutment(self) -> bool:
        """Whether the group has no strut, cam, abutment or other support that a shoe can leave."""
        return (
            not self.one_sided_supports
            and not self.indices_of_pushing_and_pushed_shoe_of_struts
            and not self.indices_of_shoes_under_cam
            and all(shoe.abutment is None for shoe in self.shoes)
        )

    def find_friction_limit_by_following_contact(
        self, largest_friction: float
    ) -> DrumFrictionLimitOfShoeGroup:
        """Find the friction coefficient of the drum up to which the group has an equilibrium.

        The friction grows in steps from the least friction that has a solution, until the solution
        ends or `largest_friction` is reached. Between two steps a foot may begin to slide on its
        abutment, stop, or slide the other way. The next steps then have the new direction of
        friction at the abutment. How far the shoes turn does not matter. Raises NoAnswer if there
        is no solution at any friction.
        """
        # Without struts, cam and abutments there is nothing to check while the friction grows.
        if self.has_neither_strut_cam_nor_abutment:
            limit = self_locking.find_largest_friction_with_equilibrium(
                self.contact_problem_as_function_of_friction,
                largest_friction,
                areas=self.contact_node_areas,
            )
            return DrumFrictionLimitOfShoeGroup(limit, text_on_part_that_would_pull="")
        group = replace(self, are_large_turns_allowed=True)
        low, at = group._find_least_friction_with_equilibrium_and_its_solution(largest_friction)
        end = at.self_locking_limit_with_present_supports(low, largest_friction)
        return _friction_limit_followed_from_solution(at, low, largest_friction, end)

    def find_friction_limit_above_solution(
        self, contact: active_set.ContactSolution, largest_friction: float
    ) -> DrumFrictionLimitOfShoeGroup:
        """Find the limit of the drum's friction from a solution at the friction of the brake.

        If the present directions and supports hold at `largest_friction` too, the limit is inf. A
        foot that leaves its support and comes back in between goes unnoticed. Otherwise the
        friction grows in steps as in `find_friction_limit_by_following_contact`.

        Parameters
        ----------
        contact : solution of the group with its present directions of friction at the abutments
            and its present supports, as `solve_contact_and_abutment_friction` finds them
        largest_friction : friction coefficient at which the search ends without a limit
        """
        group = replace(self, are_large_turns_allowed=True)
        friction = self.brake.friction
        at = _followed_solution_of_settled_group(SolvedGroup(group, contact))
        if at.is_equilibrium_certain_up_to_friction(largest_friction):
            end = self_locking.LargestFrictionWithEquilibrium(
                math.inf, False, contact, friction, steps=1
            )
            return DrumFrictionLimitOfShoeGroup(end, text_on_part_that_would_pull="")
        end = at.self_locking_limit_with_present_supports(friction, largest_friction)
        if math.isinf(end.friction):
            last = group.copy_of_group_with_other_drum_friction(end.last_friction)
            if last.is_contact_solution_physically_possible(end.last_contact):
                return DrumFrictionLimitOfShoeGroup(end, text_on_part_that_would_pull="")
        return _friction_limit_followed_from_solution(at, friction, largest_friction, end)

    def names_of_shoes_whose_contact_shrinks_to_point(
        self, limit: self_locking.LargestFrictionWithEquilibrium
    ) -> tuple[str, ...]:
        """The names of the shoes that press at a point alone as friction grows to a limit.

        Such a shoe has a finite contact force at the limit, but presses on at most
        MOST_PRESSED_NODES_OF_CONTACT_AT_POINT nodes, and on more nodes at half of the friction.
        """
        if not limit.pressure_stays_finite or math.isinf(limit.friction):
            return ()
        pressed = self._numbers_of_pressed_nodes_of_shoes(limit.last_contact)
        few = [0 < number <= MOST_PRESSED_NODES_OF_CONTACT_AT_POINT for number in pressed]
        if not any(few):
            return ()
        half = self.copy_of_group_with_other_drum_friction(0.5 * limit.friction)
        try:
            settled = half.solve_contact_and_abutment_friction()
        except NoAnswer:
            return ()
        before = self._numbers_of_pressed_nodes_of_shoes(settled.contact)
        return tuple(
            shoe.name
            for shoe, is_few, at_limit, at_half in zip(
                self.shoes, few, pressed, before, strict=True
            )
            if is_few and at_half > at_limit
        )

    def _numbers_of_pressed_nodes_of_shoes(
        self, contact: active_set.ContactSolution
    ) -> tuple[int, ...]:
        """For each shoe the number of contact nodes that press on the drum."""
        return tuple(int((contact.p[part] > 0).sum()) for part in self.contact_node_slices_of_shoes)

    def _find_least_friction_with_equilibrium_and_its_solution(
        self, largest_friction: float
    ) -> tuple[float, "_FollowedSolution"]:
        """Find the least friction coefficient of the drum with an equilibrium, and the equilibrium.

        The friction grows from 0 in steps of LARGEST_FRICTION_STEP_BETWEEN_CHECKS. The least
        friction need not be 0: a shoe may need the friction of the drum to press its foot on the
        abutment.
        """
        friction = 0.0
        while friction < largest_friction:
            found = self._solve_if_struts_and_cam_push(friction)
            if found is not None:
                return friction, _followed_solution_of_settled_group(found)
            friction += LARGEST_FRICTION_STEP_BETWEEN_CHECKS * max(1.0, friction)
        # The group has no solution at any friction. The next line raises an error with the reason
        # at friction 0.
        found = self.copy_of_group_with_other_drum_friction(
            0.0
        )._solve_contact_with_confirmed_abutment_friction()
        return 0.0, _followed_solution_of_settled_group(found)

    def _solve_if_struts_and_cam_push(self, friction: float) -> SolvedGroup | None:
        """Solve the group at a friction coefficient of the drum, if struts and cam then push.

        Returns None if there is no solution, or if a cam or a strut would have to pull.
        """
        try:
            found = self.copy_of_group_with_other_drum_friction(
                friction
            )._solve_contact_with_confirmed_abutment_friction()
        except NoAnswer:
            return None
        return found if found.group._do_struts_and_cam_push(found.contact) else None

    def _do_struts_and_cam_push(self, contact: active_set.ContactSolution) -> bool:
        """Whether the struts and the cam push all shoes in a solution of the contact."""
        forces = self.actuation_forces_under_contact_pressures(contact.p)
        return not self._error_text_if_actuation_force_pulls(forces)

    def is_contact_solution_physically_possible(self, contact: active_set.ContactSolution) -> bool:
        """Whether supports, struts, the cam and the turns of the shoes allow a contact solution.

        Supports, struts and the cam must be able to exert the computed forces. No shoe may turn
        farther than is allowed for small displacements.
        """
        if not (
            self.does_contact_confirm_support_assumptions(contact)
            and self._do_struts_and_cam_push(contact)
        ):
            return False
        try:
            self._require_small_turns_of_shoes(contact)
        except NoAnswer:
            return False
        return True

    def _error_text_on_cam_strut_or_support_that_pulls(self) -> str:
        """The error text that names a cam, strut or support that would have to pull a shoe.

        The text is empty if all of them push, or if the contact has no solution for another reason.
        """
        try:
            contact = self.solve_contact_for_given_abutment_friction()
        except CamOrStrutWouldPullError as error:
            return str(error)
        except NoAnswer:
            return ""
        pull = self._error_text_if_actuation_force_pulls(
            self.actuation_forces_under_contact_pressures(contact.p)
        )
        if pull:
            return pull
        if (
            self.contact_problem_on_bearing_supports_or_none is not None
            and not self.does_contact_confirm_support_assumptions(contact)
        ):
            return f"{self.names_of_shoes_as_text}: {ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD}"
        for k, shoe in enumerate(self.shoes):
            if (
                shoe.kind_of_support == "abutment"
                and not self.abutment_force_on_shoe(contact, k)
                @ shoe.unit_vector_of_smooth_abutment_force
                > 0
            ):
                return f"{self.names_of_shoes_as_text}: {ERROR_TEXT_ON_FOOT_LEAVING_ABUTMENT}"
        return ""


class _FollowedSolution(NamedTuple):
    """A solution of a group whose contact is followed as the friction of the drum grows.

    Attributes
    ----------
    solved_group : the group with its directions of friction and bearing supports, and its contact
    problem : the contact problem under these directions and supports, at every friction
    """

    solved_group: SolvedGroup
    problem: self_locking.FrictionDependentProblem

    @property
    def friction_directions_and_bearing_supports(self) -> tuple[object, ...]:
        """The directions of friction at the abutments, and which one-sided supports bear."""
        return (
            self.solved_group.group.abutment_friction_directions_of_shoes,
            self.solved_group.group.bearing,
        )

    def self_locking_limit_with_present_supports(
        self, friction: float, largest: float
    ) -> self_locking.LargestFrictionWithEquilibrium:
        """The limit of self-locking if directions and supports stay; inf if above `largest`.

        `friction` is the friction coefficient of the solution.
        """
        return self_locking.find_largest_friction_with_equilibrium(
            self.problem,
            largest,
            (friction, self.solved_group.contact),
            self.solved_group.group.contact_node_areas,
        )

    def friction_of_pole_with_present_supports(self, friction: float) -> float:
        """The friction at which the pressures of the present contact set would be infinite.

        `friction` is the friction coefficient of the solution. The result is inf if there is none
        above it. It may be the friction of the solution itself, where the search would lose the
        pole in round-off. The search therefore starts a little below.
        """
        return self_locking.next_friction_with_singular_contact_equations(
            self.problem,
            (1 - RELATIVE_DISTANCE_OF_LAST_CHECK_BELOW_LOCKING) * friction,
            self.solved_group.contact.active,
        )

    def is_equilibrium_certain_up_to_friction(self, friction: float) -> bool:
        """Whether a single step shows that the solution continues up to a higher friction.

        The contact force must grow by little, and the present directions and supports must hold at
        the higher friction. If the result is False, only small steps of friction can tell.
        """
        contact = self.solved_group.contact
        areas = self.solved_group.group.contact_node_areas
        return (
            self_locking.is_equilibrium_certain_up_to_friction(
                self.problem.contact_problem_at_friction_coefficient, contact, friction, areas
            )
            and self.solution_continued_with_present_supports_or_none(friction) is not None
        )

    def solution_continued_with_present_supports_or_none(
        self, friction: float
    ) -> "_FollowedSolution | None":
        """The solution at a higher friction with the present directions and supports, or None."""
        group = self.solved_group.group.copy_of_group_with_other_drum_friction(friction)
        contact = self_locking.stable_contact_continued_to_higher_friction_or_none(
            self.problem, friction, self.solved_group.contact, group.contact_node_areas
        )
        if contact is None or not group.is_contact_solution_physically_possible(contact):
            return None
        return self._replace(solved_group=SolvedGroup(group, contact))

    def solution_at_higher_friction_or_none(self, friction: float) -> "_FollowedSolution | None":
        """The solution at a higher friction coefficient; None if there is none.

        The search first keeps the present directions and supports, and starts from the present
        contact set. If these directions and supports fail, it tries all others.
        """
        continued = self.solution_continued_with_present_supports_or_none(friction)
        if continued is not None:
            return continued
        found = self.solved_group.group._solve_if_struts_and_cam_push(friction)
        if found is None:
            return None
        other = self._replace(solved_group=found)
        return (
            other
            if other.friction_directions_and_bearing_supports
            == self.friction_directions_and_bearing_supports
            else _followed_solution_of_settled_group(found)
        )


def _followed_solution_of_settled_group(settled: SolvedGroup) -> _FollowedSolution:
    """The solution of a group, with its contact problem at every friction coefficient."""
    return _FollowedSolution(settled, settled.group.contact_problem_as_function_of_friction)


def _friction_limit_followed_from_solution(
    at: _FollowedSolution,
    low: float,
    largest_friction: float,
    end: self_locking.LargestFrictionWithEquilibrium,
) -> DrumFrictionLimitOfShoeGroup:
    """Find the friction coefficient of the drum at which a followed solution ends.

    Parameters
    ----------
    at : the solution at the friction coefficient `low`
    low : friction coefficient from which the friction grows
    largest_friction : friction coefficient at which the search ends without a limit
    end : the limit if the present directions and supports stay
    """
    while low < (
        last := min(
            end.friction * (1 - RELATIVE_DISTANCE_OF_LAST_CHECK_BELOW_LOCKING), largest_friction
        )
    ):
        high = min(low + LARGEST_FRICTION_STEP_BETWEEN_CHECKS * max(1.0, low), last)
        after = at.solution_at_higher_friction_or_none(high)
        # Under more friction the group may have a solution again, but the solution that is
        # followed ends between `low` and `high`.
        if after is None:
            return _friction_limit_by_bisection(at, end, low, high)
        low, before, at = high, at, after
        if at.problem is not before.problem:
            end = at.self_locking_limit_with_present_supports(low, largest_friction)
    group = at.solved_group.group
    return DrumFrictionLimitOfShoeGroup(
        end,
        text_on_part_that_would_pull=group._error_text_if_force_pulls_at_friction_limit(end),
    )


def _friction_limit_by_bisection(
    at: _FollowedSolution,
    limit_before: self_locking.LargestFrictionWithEquilibrium,
    low: float,
    high: float,
) -> DrumFrictionLimitOfShoeGroup:
    """Find by bisection the friction coefficient of the drum at which a solution ends.

    Parameters
    ----------
    at : the solution at the friction coefficient `low`
    limit_before : limit of the friction under the directions of friction of this solution
    low : friction coefficient with a solution
    high : friction coefficient without a solution
    """
    tried: set[tuple[object, ...]] = set()
    further = self_locking.TEST_DISTANCE_BELOW_SINGULAR_FRICTION * high
    while high - low > self_locking.TEST_DISTANCE_BELOW_SINGULAR_FRICTION * high:
        if at.friction_directions_and_bearing_supports not in tried:
            # The solution mostly ends where its directions of friction and its supports cease to
            # hold. Each step of the search for this friction takes one contact solve.
            tried.add(at.friction_directions_and_bearing_supports)
            at, low, end = _bisect_friction_at_which_supports_change(at, low, high)
        else:
            # Where one choice of directions and supports takes over from another choice, both hold
            # up to round-off, and an earlier choice may come back. The end of the solution is then
            # near. It is sought in growing steps.
            end = low + min(further, 0.5 * (high - low))
            further *= 2
        before, after = at, at.solution_at_higher_friction_or_none(end)
        if after is None:
            high = end
            continue
        low, at = end, after
        # New directions or supports mostly hold up to the limit, which is then their pole.
        if (
            at.friction_directions_and_bearing_supports
            != before.friction_directions_and_bearing_supports
        ):
            near_pole = _solution_followed_to_pole_or_none(at, low, high)
            if near_pole is not None:
                return near_pole.limit_at_pole(limit_before)
    # The search ends a little below a pole of the pressures. The pole is the limit if the solution
    # holds up to it.
    pole = at.friction_of_pole_with_present_supports(low)
    if pole <= (1 + RELATIVE_DISTANCE_OF_LAST_CHECK_BELOW_LOCKING) * high:
        near_pole = _solution_followed_to_pole_or_none(at, low, math.nextafter(pole, math.inf))
        if near_pole is not None:
            return near_pole.limit_at_pole(limit_before)
    limit = limit_before._replace(
        friction=low,
        pressure_stays_finite=True,
        last_contact=at.solved_group.contact,
        last_friction=low,
    )
    beyond = at.solved_group.group.copy_of_group_with_other_drum_friction(high)
    return DrumFrictionLimitOfShoeGroup(
        limit, beyond._error_text_on_cam_strut_or_support_that_pulls()
    )


class _SolutionNearPole(NamedTuple):
    """A solution a little below the friction coefficient of infinite pressures.

    Attributes
    ----------
    pole : friction coefficient of infinite pressures
    friction : friction coefficient of the solution, mostly at the relative distance
        TEST_DISTANCE_BELOW_SINGULAR_FRICTION below the pole
    solution : the solution
    """

    pole: float
    friction: float
    solution: _FollowedSolution

    def limit_at_pole(
        self, limit_before: self_locking.LargestFrictionWithEquilibrium
    ) -> DrumFrictionLimitOfShoeGroup:
        """The pole as the limit of friction, with the count of steps of an earlier limit."""
        limit = limit_before._replace(
            friction=self.pole,
            pressure_stays_finite=False,
            last_contact=self.solution.solved_group.contact,
            last_friction=self.friction,
        )
        return DrumFrictionLimitOfShoeGroup(limit, text_on_part_that_would_pull="")


def _solution_followed_to_pole_or_none(
    at: _FollowedSolution, low: float, high: float
) -> _SolutionNearPole | None:
    """Follow a solution with its present directions and supports to infinite pressures.

    Returns None if the solution ends before, or if its pressures stay finite up to `high`.

    Parameters
    ----------
    at : the solution at the friction coefficient `low`
    low : friction coefficient with a solution
    high : friction coefficient without a solution
    """
    while True:
        pole = at.friction_of_pole_with_present_supports(low)
        if not low < pole < high:
            return None
        last = (1 - self_locking.TEST_DISTANCE_BELOW_SINGULAR_FRICTION) * pole
        if last <= low:
            return _SolutionNearPole(pole, low, at)
        # If the contact set holds up to the pole, the solution near the pole continues this one.
        at_last = at.solution_continued_with_present_supports_or_none(last)
        if at_last is not None:
            return _SolutionNearPole(pole, last, at_last)
        # Over a quarter of the distance the contact force grows by a third. A solution that grows
        # by more than LARGEST_CONTACT_FORCE_GROWTH_PER_STEP would not count as its continuation.
        low += 0.25 * (pole - low)
        after = at.solution_continued_with_present_supports_or_none(low)
        if after is None:
            return None
        at = after


def _bisect_friction_at_which_supports_change(
    at: _FollowedSolution, low: float, high: float
) -> tuple[_FollowedSolution, float, float]:
    """Find the last solution with the present directions and supports, between two frictions.

    Returns the solution, its friction coefficient, and the next friction coefficient, at which the
    present directions and supports have no solution.

    Parameters
    ----------
    at : the solution at the friction coefficient `low`
    low : friction coefficient with a solution
    high : friction coefficient above `low`, at which a solution may be missing
    """
    # If the present choice of directions and supports fails at every friction above 0, the search
    # ends at a friction that is practically 0.
    while high - low > self_locking.TEST_DISTANCE_BELOW_SINGULAR_FRICTION * max(
        high, self_locking.RELATIVE_RESOLUTION_OF_FRICTION_LIMIT
    ):
        middle = 0.5 * (low + high)
        after = at.solution_continued_with_present_supports_or_none(middle)
        if after is None:
            high = middle
        else:
            low, at = middle, after
    return at, low, high


def divide_pressed_shoes_into_groups(
    scene: PreparedModel, brake: Brake, penalty: float = math.inf, *, springs_join: bool = False
) -> list[ShoeGroup]:
    """Divide the shoes that are pressed on the drum into groups that must be solved together.

    `springs_join` is whether springs with a rate join all shoes to one group. Raises NoAnswer if a
    cam presses only one of its shoes.
    """
    touching = indices_of_pressed_shoes_in_brake(scene, brake)
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        lacking = [shoe.name for i, shoe in enumerate(brake.shoes) if i not in touching]
        if lacking:
            raise NoAnswer(f"shoe {lacking[0]!r}: the cam does not press it")
    return divide_shoes_into_groups(scene, brake, touching, penalty, springs_join=springs_join)


def indices_of_pressed_shoes_in_brake(scene: PreparedModel, brake: Brake) -> list[int]:
    """The indices, in the brake, of the shoes that a force or a strut presses on the drum."""
    touching = {
        i
        for i, shoe in enumerate(brake.shoes)
        if is_shoe_pressed_on_drum(scene.bodies[i], brake, shoe)
    }
    names = [shoe.name for shoe in brake.shoes]
    # A strut presses the shoe that it pushes. The struts of a chain are listed from the actuated
    # shoe on.
    for link in brake.links:
        if names.index(link.source) in touching:
            touching.add(names.index(link.to))
    return sorted(touching)


def divide_shoes_into_groups(
    scene: PreparedModel,
    brake: Brake,
    pressed_shoes: list[int],
    penalty: float = math.inf,
    *,
    springs_join: bool = False,
) -> list[ShoeGroup]:
    """Return a group for each pressed shoe, or one group of all pressed shoes.

    Shoes that act on each other through an elastic ring, a strut or a cam are one group.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    pressed_shoes : indices of the shoes that are pressed on the drum
    penalty : factor alpha of the contact stiffness alpha E/t
    springs_join : whether springs with a rate join all shoes to one group
    """
    alone = (
        (scene.ring is None or scene.apart)
        and brake.reason_why_cam_or_strut_sets_forces is None
        and not (springs_join and any(spring.rate for spring in brake.springs))
    )
    members: list[tuple[int, ...]]
    members = [(i,) for i in pressed_shoes] if alone else [tuple(pressed_shoes)]
    groups = []
    for each in filter(None, members):
        group = ShoeGroup(scene, brake, each, penalty)
        # Without friction at abutments there are no directions of this friction to be found.
        if not group.has_abutment_with_friction:
            group = replace(
                group,
                abutment_friction_directions_of_shoes=group.known_abutment_friction_directions,
            )
        groups.append(group)
    return groups


def have_groups_equal_friction_limits(one: ShoeGroup, other: ShoeGroup) -> bool:
    """Whether two groups differ by the place of their shoes around the drum alone.

    Their limits of self-locking are then the same. The friction of both groups must not depend on
    the pressure. The result is False for groups with one-sided supports, which are not compared.
    """
    bodies, others = one.substructures_of_shoes, other.substructures_of_shoes
    if (
        len(bodies) != len(others)
        or any(a is not b for a, b in zip(bodies, others, strict=True))
        or any(a.frame.sense != b.frame.sense for a, b in zip(one.shoes, other.shoes, strict=True))
        or one.one_sided_supports
        or other.one_sided_supports
    ):
        return False
    # The directions of friction at the abutments need not be known: if both groups have equal
    # problems under one direction, they have them under each.
    alike = (1,) * len(bodies)
    first, second = (
        group
        if group.abutment_friction_directions_of_shoes == alike
        else replace(group, abutment_friction_directions_of_shoes=alike)
        for group in (one, other)
    )
    return first.contact_problem_as_function_of_friction.is_equal_up_to_round_off(
        second.contact_problem_as_function_of_friction
    )


def _abutment_friction_direction_of_rigid_shoe(brake: Brake, shoe: Shoe) -> int:
    """The direction of the friction at the abutment of a shoe, by the law of the rigid shoe.

    It is +1 or -1 along the face, or 0 for a foot that sticks; it is +1 if the law has no solution.
    """
    if len(shoe.senses_of_abutment_friction_to_try) == 1:
        return 1
    try:
        footing = rigid.find_contact_of_rigid_shoe(brake, shoe)
    except NoAnswer:
        return 1
    return 1 if footing is None else footing.sense


def is_shoe_pressed_on_drum(body: ShoeSubstructure, brake: Brake, shoe: Shoe) -> bool:
    """Whether the loads on a shoe press at least one point of its lining on the drum."""
    # A strut between two shoes may press a shoe that has no actuation force.
    if shoe.anchors:
        on_strut = any(shoe.name in {link.source, link.to} for link in brake.links)
        return shoe.is_any_load_on_shoe or on_strut
    if not shoe.is_any_load_on_shoe:
        return False
    if shoe.kind_of_support != "hinge":
        return rigid.sign_of_pressure_that_balances_actuation(brake, shoe) >= 0
    _, moment = actuation_factors_and_pin_moment_per_newton(body, shoe)
    if shoe.has_loads_besides_actuation:
        pushed = abs(shoe.actuation.force) * moment + moment_of_loads_besides_actuation_about_pin(
            shoe
        )
        moment = pushed / shoe.largest_force_of_any_load
    approach, _ = body.gap_closure_and_slip_per_turn_about_pin
    # The moment per newton is a lever arm. Below 1e-14 of the lining's distance from the drum's
    # centre it is round-off.
    turns = abs(moment) > 1e-14 * np.abs(body.line.xy).max()
    return bool(turns and (moment * approach > 0).any())
