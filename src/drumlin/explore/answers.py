"""The answers for the settings of a brake: finite elements beside a law, worn as far as asked.

The bodies depend on geometry and stiffness alone: another friction, force or clearance costs some
milliseconds on them. The wear of a brake is run once over the whole range of its knob. Each setting
of the knob is then interpolated.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from drumlin.base.errors import DrumlinError, NoAnswer
from drumlin.brake import vary
from drumlin.brake.brake import Brake
from drumlin.explore.knobs import LARGEST_WEAR, KnobSetting, brake_of, knobs_of
from drumlin.fem.analysis.self_locking import friction_limits_of_groups
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.cache import brake_without_loads
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import solve
from drumlin.laws import LAWS, locking_friction
from drumlin.lining_wear.archard import WearLaw, WearState, interpolate_state
from drumlin.lining_wear.linings import WearSetup, fem_wear_setup
from drumlin.lining_wear.run_in import (
    COEFFICIENT,
    WORN_OUT,
    brake_with_worn_linings,
    run_in,
    unit_sliding_distance,
)
from drumlin.models import pick
from drumlin.response import Response
from drumlin.response.merit import with_merits
from drumlin.response.norms import pressure_distance, relative

EXPLORE_LEVEL = LEVELS[1]
"""The fixed division of parametric shoes. On it the torque is known within some 3e-4, and the
bodies take 30 to 100 ms; a finer one would make the sliders lag."""

HIGHEST_FRICTION = 5.0
"""Friction coefficient up to which self-locking is looked for. No lining comes near it."""

WEAR_TOLERANCE = 1e-2
"""Error of p (L2, relative) that a step of the wear may make. The torque is then some 1e-4 off."""

LockingFriction = Mapping[tuple[int, ...], float]
"""The friction coefficient mu_lock of each group of shoes that lock together, by their numbers."""


@dataclass(frozen=True)
class ExploredAnswer:
    """The answers of finite elements and of a law for a setting of the knobs.

    Attributes
    ----------
    setting : setting of the knobs
    brake : the brake as it is solved, worn where wear is asked for; None where its parts do not fit
        together
    found : response of the finite elements; None where they have no answer
    failure : reason why the finite elements have no answer; "" where they have one
    law_name : name of the law beside the finite elements
    law : response of the law; None where the law has no answer
    law_failure : reason why the law has no answer; "" where it has one
    law_locking : smallest friction at which a shoe locks itself by the law; None on a plane
    distance : sliding distance [m] over which the linings are worn
    """

    setting: KnobSetting
    brake: Brake | None = None
    found: Response | None = None
    failure: str = ""
    law_name: str | None = None
    law: Response | None = None
    law_failure: str = ""
    law_locking: float | None = None
    distance: float = 0.0


class _WearRun(NamedTuple):
    """A brake run in: its setup, its states, and the unit 1/(k K) of the sliding distance [m]."""

    setup: WearSetup
    states: list[WearState]
    unit: float


class _WornBrake(NamedTuple):
    """A brake with worn linings, and its sliding distance [m]."""

    brake: Brake
    distance: float


class StatedError(NamedTuple):
    """The distance of an answer from the answer of `solve`, which estimates its own errors.

    Attributes
    ----------
    torque : relative distance of the torque
    pressure : relative distance of p (L2), the worst shoe's
    own : errors that `solve` states; None on a mesh from a file
    """

    torque: float
    pressure: float
    own: Mapping[str, float] | None


class Latest:
    """A store for one value: the value that was made last, with its key."""

    def __init__(self) -> None:
        self._key: Any = None
        self._value: Any = None

    def kept(self, key: Any) -> Any:
        """The stored value if its key is `key`, else None."""
        return self._value if key == self._key else None

    def get(self, key: Any, make: Callable[[], Any]) -> Any:
        """The stored value; for another key than the stored one `make` makes a new value."""
        if self._value is None or key != self._key:
            self._value = make()
            self._key = key
        return self._value


class Explorer:
    """Answers for the settings of one brake.

    It keeps bodies, wear and limits to save time; no kept value changes an answer. Raises BadInput
    for a brake that finite elements do not cover.
    """

    def __init__(self, brake: Brake) -> None:
        pick("fem", brake)
        self.brake, self.knobs = brake, knobs_of(brake)
        self._scene, self._worn, self._limits, self._stated = Latest(), Latest(), Latest(), Latest()

    def answer(self, setting: KnobSetting) -> ExploredAnswer:
        """The answer for a setting; where a model has no answer, the result says why."""
        answer = ExploredAnswer(setting, law_name=setting.law)
        try:
            brake = brake_of(self.brake, self.knobs, setting)
            answer = replace(answer, brake=brake)
            scene, wear = self.scene(brake), setting.values.get("wear", 0.0)
            if wear > 0 and not brake.surface.straight:
                brake, distance = self._worn_brake(scene, brake, wear)
                answer = replace(answer, brake=brake, distance=distance)
            found = solve_prepared_model(scene, brake)
            # On a plane the page shows the braking force, which is a figure of merit.
            if brake.surface.straight:
                found = with_merits(brake, found)
            answer = replace(answer, found=found)
        except DrumlinError as error:
            answer = replace(answer, failure=str(error))
        return _with_law(answer)

    def scene(self, brake: Brake) -> PreparedModel:
        """The prepared model of a brake, which serves every friction coefficient."""

        def make() -> PreparedModel:
            """The prepared model of the brake with a friction coefficient of 1."""
            rough = vary(brake, {"friction": 1.0})
            if any(shoe.mesh for shoe in rough.shoes):
                return prepare(rough)
            return prepare(rough, EXPLORE_LEVEL)

        return self._scene.get(
            brake_without_loads(brake).model_copy(update={"friction": 1.0}), make
        )

    def _worn_brake(self, scene: PreparedModel, brake: Brake, wear: float) -> _WornBrake:
        """The brake worn over the sliding distance `wear` times 1/(k K).

        Raises NoAnswer for a worn-out lining.
        """
        run = self._worn.get(brake, lambda: _run(scene, brake))
        state = interpolate_state(run.states, wear * run.unit)
        for surface in run.setup.surfaces:
            # A lining worn below the allowed thickness has no answer.
            deepest, lining = state.depth[surface.part].max(), brake.shoes[surface.shoe].lining
            if deepest > WORN_OUT * lining.thickness:
                raise NoAnswer(
                    f"shoe {surface.name!r}: worn out, "
                    f"{deepest * 1e3:.3g} mm would be worn off its lining"
                )
        return _WornBrake(brake_with_worn_linings(run.setup, state), wear * run.unit)

    def locking(self, brake: Brake) -> LockingFriction:
        """The friction mu_lock at which shoes lock, if it is at most HIGHEST_FRICTION.

        The result is empty where no shoe touches the drum.
        """

        def make() -> LockingFriction:
            """The limits of self-locking, found from a friction coefficient of 1."""
            rough = vary(brake, {"friction": 1.0})
            try:
                found = friction_limits_of_groups(self.scene(brake), rough, HIGHEST_FRICTION)
            except NoAnswer:
                return {}
            return {members: limit.friction for members, limit in found.items()}

        known: LockingFriction = self._limits.get(_at_any_friction(brake), make)
        return known

    def known_locking(self, brake: Brake) -> LockingFriction | None:
        """The friction mu_lock if it is known already, else None: finding it takes 30 to 100 ms."""
        known: LockingFriction | None = self._limits.kept(_at_any_friction(brake))
        return known

    def stated(self, answer: ExploredAnswer) -> StatedError | None:
        """The distance of an answer from that of `solve`, which takes seconds to minutes.

        It is None where one of both has no answer.
        """
        brake, found = answer.brake, answer.found
        if brake is None or found is None:
            return None

        def make() -> StatedError | None:
            """The distance of the answer from the answer of `solve`."""
            try:
                finer = solve(brake)
            except DrumlinError:
                return None
            # The worst shoe counts.
            apart = max(map(pressure_distance, found.shoes, finer.shoes))
            return StatedError(abs(relative(found.effect, finer.effect)), apart, finer.error)

        known: StatedError | None = self._stated.get(brake, make)
        return known


def _at_any_friction(brake: Brake) -> Brake:
    """The brake with a friction coefficient of 1: a key that is the same for every friction."""
    return brake.model_copy(update={"friction": 1.0})


def _run(scene: PreparedModel, brake: Brake) -> _WearRun:
    """The wear of a brake up to the largest sliding distance that the page offers."""
    setup, law = fem_wear_setup(scene, brake), WearLaw(COEFFICIENT)
    unit = unit_sliding_distance(setup, law)
    states = run_in(setup, law, distance=LARGEST_WEAR * unit, tolerance=WEAR_TOLERANCE)
    return _WearRun(setup, states, unit)


def _with_law(answer: ExploredAnswer) -> ExploredAnswer:
    """The answer of finite elements, completed by the response and the self-locking of its law."""
    name, brake = answer.law_name, answer.brake
    if name is None or brake is None:
        return answer
    try:
        # The formula for self-locking holds on a drum, for the worst shoe.
        if name in LAWS and not brake.surface.straight:
            locking = min(locking_friction(brake, shoe, LAWS[name]) for shoe in brake.shoes)
            answer = replace(answer, law_locking=locking)
        return replace(answer, law=pick(name, brake).solve(brake))
    except DrumlinError as error:
        return replace(answer, law_failure=str(error))
