"""The answers that the page with sliders shows: a brake solved by finite elements and by a law.

The condensed stiffness of the shoes depends on geometry and moduli alone. The page keeps it, so
that the answer for another friction, force or clearance takes some milliseconds. The wear of the
linings is computed once over the whole range of its slider and interpolated at each position of the
slider.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from drumlin.base.errors import DrumlinError, NoAnswer
from drumlin.brake import vary
from drumlin.brake.brake import Brake
from drumlin.brake.friction import require_friction_independent_of_pressure
from drumlin.explore.knobs import SliderSetting, brake_at_slider_setting, sliders_for_brake
from drumlin.fem.analysis.self_locking import self_locking_friction_of_shoe_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.cache import brake_without_loads_and_clearances
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.laws import LAWS_OF_HINGED_SHOES_BY_NAME, self_locking_friction_of_hinged_shoe
from drumlin.lining_wear.archard import WearLaw, WearState, interpolate_wear_state_at_distance
from drumlin.lining_wear.linings import WearSetup, wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    WORN_OUT_FRACTION_OF_LINING_THICKNESS,
    brake_with_worn_linings,
    wear_brake_linings_until_worn_in,
)
from drumlin.models import MODELS, model_with_name_that_applies_to_brake
from drumlin.response import Response
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.norms import relative_distance_of_pressures, relative_error_of_number
from drumlin.response.response import EstimatedErrorOfPlaneStress

REFINEMENT_LEVEL_OF_EXPLORE_PAGE = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]
"""The fixed division of the shoes into hp elements, for shoes without a mesh file.

Its torque is accurate to some 0.03 %, and the stiffness of the shoes takes 30 to 100 ms to compute.
With a finer division the page would follow its sliders too slowly.
"""

WIDTH_EXPLORE_LEVEL, WIDTH_EXPLORE_DEGREE = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2
"""The fixed division of solid shoes into hp elements, and the polynomial degree across the width.

For 14 example brakes the torque differs by up to 0.04 % from the torque by the next finer division.
The stiffness of their shoes takes 9 to 50 ms and the contact 4 to 40 ms. With the finer division
the stiffness takes up to 180 ms.
"""

TOLERANCE_OF_ACCURATE_SOLID_SOLUTION = 5e-3
"""Relative tolerance of the pressure (L2) and of the torque in the accurate solution.

The accurate solution has solid shoes with their widths. The page shows how far its own, coarser
answer by solid shoes is from this solution.
"""

HIGHEST_SOUGHT_LOCKING_FRICTION = 5.0
"""Friction coefficient up to which self-locking is searched; no real lining comes near it."""

PRESSURE_ERROR_OF_ONE_WEAR_INCREMENT = 1e-2
"""Relative error of the pressure (L2) that the wear of one increment of sliding distance may have.

The error of the torque is then some 0.01 %.
"""

LockingFrictionByShoeGroup = Mapping[tuple[int, ...], float]
"""The friction coefficient mu_lock at which a group of shoes locks itself, for each group.

The key is a tuple with the indices of the shoes that lock together.
"""


@dataclass(frozen=True)
class FemAndLawAnswerAtSliderSetting:
    """The answers of finite elements and of a law for a setting of the sliders.

    Attributes
    ----------
    setting : positions of the sliders
    brake : the brake as it is solved, with worn linings if the slider of wear is not at 0; None
        where the parts of the brake do not fit together
    fem_response : response of the finite elements; None where they have no answer
    failure : reason why the finite elements have no answer; "" where they have one
    law_name : name of the rigid-shoe law whose answer is shown beside the finite elements
    law_response : response of the law; None where the law has no answer
    law_failure : reason why the law has no answer; "" where it has one
    locking_friction_by_law : smallest friction at which a shoe locks itself by the law; None on a
        plane
    distance : sliding distance [m] over which the linings have been worn
    """

    setting: SliderSetting
    brake: Brake | None = None
    fem_response: Response | None = None
    failure: str = ""
    law_name: str | None = None
    law_response: Response | None = None
    law_failure: str = ""
    locking_friction_by_law: float | None = None
    distance: float = 0.0


class _WearUpToLargestSlidingDistance(NamedTuple):
    """The wear of a brake's linings, from new linings to the largest sliding distance of the page.

    Attributes
    ----------
    setup : the brake prepared for the computation of wear
    states : worn depths and pressures at increasing sliding distances
    """

    setup: WearSetup
    states: list[WearState]


class _WornBrake(NamedTuple):
    """A brake with worn linings, and the sliding distance [m] over which they are worn."""

    brake: Brake
    distance: float


class DifferenceFromAccurateAnswer(NamedTuple):
    """The difference between the page's answer and the accurate answer of `drumlin.solve`.

    Attributes
    ----------
    torque : relative difference of the torque
    pressure : relative difference of the pressure (L2) on the shoe where it is largest
    errors_stated_by_accurate_answer : estimated errors that `drumlin.solve` states for its accurate
        answer; None if it states none
    plane_stress : estimated errors that the assumption of plane stress causes; None for solid shoes
    """

    torque: float
    pressure: float
    errors_stated_by_accurate_answer: Mapping[str, float] | None
    plane_stress: EstimatedErrorOfPlaneStress | None


class LatestValueCache:
    """A cache for one value: it holds the value that was made last, and the key of this value."""

    def __init__(self) -> None:
        self._key: Any = None
        self._value: Any = None

    def cached_value_for_key_or_none(self, key: Any) -> Any:
        """The stored value if it was made for `key`, else None."""
        return self._value if key == self._key else None

    def stored_or_new_value(self, key: Any, make: Callable[[], Any]) -> Any:
        """The stored value if it was made for `key`, else a new value that `make` returns."""
        if self._value is None or key != self._key:
            self._value = make()
            self._key = key
        return self._value


class SliderSolver:
    """A solver for one brake at all positions of the page's sliders.

    To save time it keeps the prepared model, the wear and the limits of self-locking that it
    computed last. The answers are the same as without this cache. Raises BadInput for a brake that
    finite elements do not cover.
    """

    def __init__(self, brake: Brake) -> None:
        model_with_name_that_applies_to_brake("fem", brake)
        require_friction_independent_of_pressure(brake, "explore")
        self.brake, self.knobs = brake, sliders_for_brake(brake)
        self._scene = LatestValueCache()
        self._worn = LatestValueCache()
        self._limits = LatestValueCache()
        self._stated = LatestValueCache()

    def fem_and_law_answer_at_slider_setting(
        self, setting: SliderSetting
    ) -> FemAndLawAnswerAtSliderSetting:
        """The answer for a setting of the sliders; where a model fails, it holds the reason."""
        answer = FemAndLawAnswerAtSliderSetting(setting, law_name=setting.law)
        # The answer is completed step by step. After a failure it keeps what it has so far.
        try:
            brake = brake_at_slider_setting(self.brake, self.knobs, setting)
            answer = replace(answer, brake=brake)
            # Wear changes the shape of the linings; it is not computed on a plane.
            scene = self.prepared_model_of_brake(brake, setting.model)
            wear = setting.values.get("wear", 0.0)
            if wear > 0 and setting.model == "solid":
                raise NoAnswer("wear: the page wears linings in plane stress only")
            if wear > 0 and not brake.surface.is_plane_and_not_drum:
                brake, distance = self._brake_worn_over_distance(scene, brake, wear)
                answer = replace(answer, brake=brake, distance=distance)
            found = solve_prepared_model(scene, brake)
            # On a plane the page shows the braking force, which is a figure of merit.
            if brake.surface.is_plane_and_not_drum:
                found = response_with_figures_of_merit(brake, found)
            answer = replace(answer, fem_response=found)
        except DrumlinError as error:
            answer = replace(answer, failure=str(error))
        return _fem_answer_with_results_of_pressure_law(answer)

    def prepared_model_of_brake(self, brake: Brake, model: str = "fem") -> PreparedModel:
        """The prepared finite-element model: meshes and condensed stiffness of a brake's shoes.

        The same model serves every friction coefficient, force and clearance. `model` is "fem" for
        plane stress and "solid" for shoes with their widths.
        """

        def prepare_model_with_friction() -> PreparedModel:
            """Prepare the model with a friction coefficient of 1, so that it serves any friction.

            A model that is prepared without friction serves no other friction.
            """
            rough = vary(brake, {"friction": 1.0})
            if model == "solid":
                return prepare_model_with_shoe_widths(
                    rough, WIDTH_EXPLORE_LEVEL, WIDTH_EXPLORE_DEGREE
                )
            if any(shoe.mesh for shoe in rough.shoes):
                return make_prepared_model(rough)
            return make_prepared_model(rough, REFINEMENT_LEVEL_OF_EXPLORE_PAGE)

        # Brakes that differ only in loads, clearances or friction need the same prepared model, so
        # that they share one key in the cache.
        with_friction = {"friction_as_written": 1.0}
        key = brake_without_loads_and_clearances(brake).model_copy(update=with_friction)
        return self._scene.stored_or_new_value((key, model), prepare_model_with_friction)

    def _brake_worn_over_distance(
        self, scene: PreparedModel, brake: Brake, wear: float
    ) -> _WornBrake:
        """The brake with linings that are worn over the sliding distance `wear` [km].

        Raises NoAnswer where a lining is worn out before.
        """
        (slider,) = (knob for knob in self.knobs if knob.name == "wear")
        run = self._worn.stored_or_new_value(
            brake, lambda: _wear_linings_over_distance(scene, brake, 1e3 * slider.high)
        )
        state = interpolate_wear_state_at_distance(run.states, 1e3 * wear)
        for surface in run.setup.surfaces:
            # A lining that has lost more than the allowed part of its thickness has no answer.
            deepest, lining = state.depth[surface.part].max(), brake.shoes[surface.shoe].lining
            if deepest > WORN_OUT_FRACTION_OF_LINING_THICKNESS * lining.thickness:
                raise NoAnswer(
                    f"shoe {surface.name!r}: worn out, "
                    f"{deepest * 1e3:.3g} mm would be worn off its lining"
                )
        return _WornBrake(brake_with_worn_linings(run.setup, state), 1e3 * wear)

    def cached_self_locking_friction_of_shoe_groups(
        self, brake: Brake, model: str = "fem"
    ) -> LockingFrictionByShoeGroup:
        """The friction coefficient at which each group of shoes locks itself, by finite elements.

        The keys are the indices of the shoes that lock together. Shoes that do not lock up to
        HIGHEST_SOUGHT_LOCKING_FRICTION have no entry. The result is empty where no
        shoe touches the drum. `model` is "fem" for plane stress and "solid" for solid shoes.
        """

        def find_self_locking_friction_with_unit_friction() -> LockingFrictionByShoeGroup:
            """Find the friction at which groups of shoes lock.

            The brake's own friction does not matter and is set to 1.
            """
            rough = brake.brake_with_new_friction_coefficient(1.0)
            try:
                found = self_locking_friction_of_shoe_groups(
                    self.prepared_model_of_brake(brake, model),
                    rough,
                    HIGHEST_SOUGHT_LOCKING_FRICTION,
                )
            except NoAnswer:
                return {}
            return {members: limit.friction for members, limit in found.items()}

        known: LockingFrictionByShoeGroup = self._limits.stored_or_new_value(
            (_brake_with_unit_friction(brake), model), find_self_locking_friction_with_unit_friction
        )
        return known

    def self_locking_friction_if_already_computed(
        self, brake: Brake, model: str = "fem"
    ) -> LockingFrictionByShoeGroup | None:
        """The friction at which each group of shoes locks itself, if it is known; else None.

        Nothing is computed here. `cached_self_locking_friction_of_shoe_groups` computes these
        values in 30 to 100 ms.
        """
        known: LockingFrictionByShoeGroup | None = self._limits.cached_value_for_key_or_none(
            (_brake_with_unit_friction(brake), model)
        )
        return known

    def difference_from_accurate_answer(
        self, answer: FemAndLawAnswerAtSliderSetting
    ) -> DifferenceFromAccurateAnswer | None:
        """The difference between an answer of the page and the accurate answer of `drumlin.solve`.

        The accurate answer takes seconds to minutes. The result is None where the page or
        `drumlin.solve` has no answer.
        """
        brake, found, model = answer.brake, answer.fem_response, answer.setting.model
        if brake is None or found is None:
            return None
        options: dict[str, Any] = {"model_error": True}
        if model == "solid":
            options = {"tolerance": TOLERANCE_OF_ACCURATE_SOLID_SOLUTION}

        def solve_accurately_and_compare() -> DifferenceFromAccurateAnswer | None:
            """Solve the brake accurately and compare; None if the accurate solution fails."""
            try:
                finer = MODELS[model].solve(brake, **options)
            except DrumlinError:
                return None
            # The shoe with the largest pressure difference stands for the brake.
            apart = max(map(relative_distance_of_pressures, found.shoes, finer.shoes))
            return DifferenceFromAccurateAnswer(
                abs(relative_error_of_number(found.effect, finer.effect)),
                apart,
                finer.error,
                finer.plane_stress_error,
            )

        known: DifferenceFromAccurateAnswer | None = self._stated.stored_or_new_value(
            (brake, model), solve_accurately_and_compare
        )
        return known


def _brake_with_unit_friction(brake: Brake) -> Brake:
    """The brake with a friction coefficient of 1: a cache key that does not depend on friction."""
    return brake.brake_with_new_friction_coefficient(1.0)


def _wear_linings_over_distance(
    scene: PreparedModel, brake: Brake, distance: float
) -> _WearUpToLargestSlidingDistance:
    """The wear of a brake's linings up to a sliding distance [m]."""
    setup, law = wear_setup_by_finite_elements(scene, brake), WearLaw(DEFAULT_WEAR_COEFFICIENT)
    states = wear_brake_linings_until_worn_in(
        setup, law, distance=distance, tolerance=PRESSURE_ERROR_OF_ONE_WEAR_INCREMENT
    )
    return _WearUpToLargestSlidingDistance(setup, states)


def _fem_answer_with_results_of_pressure_law(
    answer: FemAndLawAnswerAtSliderSetting,
) -> FemAndLawAnswerAtSliderSetting:
    """A copy of the finite elements' answer, with the rigid-shoe pressure law's answer added."""
    name, brake = answer.law_name, answer.brake
    if name is None or brake is None:
        return answer
    try:
        # On a drum a formula of the law gives the friction at which each shoe locks itself. The
        # smallest of these frictions is taken.
        if name in LAWS_OF_HINGED_SHOES_BY_NAME and not brake.surface.is_plane_and_not_drum:
            limits = []
            for shoe in brake.shoes:
                own = self_locking_friction_of_hinged_shoe(
                    brake, shoe, LAWS_OF_HINGED_SHOES_BY_NAME[name]
                )
                limits.append(brake.brake_friction_that_gives_shoe_friction(shoe, own))
            answer = replace(answer, locking_friction_by_law=min(limits))
        return replace(
            answer, law_response=model_with_name_that_applies_to_brake(name, brake).solve(brake)
        )
    except DrumlinError as error:
        return replace(answer, law_failure=str(error))
