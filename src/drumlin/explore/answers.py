"""Settings -> answers: finite elements beside a law, worn in as far as asked; what is kept is made
once.

The bodies depend on geometry and stiffness alone: another friction, force or clearance costs some
milliseconds on them. The wear of a brake is run once over the whole range of its knob, and read off
from there.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from drumlin.base.errors import DrumlinError, NoAnswer
from drumlin.brake import vary
from drumlin.brake.brake import Brake
from drumlin.explore.knobs import LARGEST_WEAR, Setting, brake_of, knobs_of
from drumlin.fem.analysis.self_locking import limits
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.model import respond
from drumlin.fem.preparation.cache import bare
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import Scene
from drumlin.fem.solve import solve
from drumlin.laws import LAWS, locking_friction
from drumlin.lining_wear.archard import WearLaw, WearState, at
from drumlin.lining_wear.linings import WearSetup, fem_setup
from drumlin.lining_wear.run_in import COEFFICIENT, WORN_OUT, run_in, unit_distance, worn
from drumlin.models import pick
from drumlin.response import Response
from drumlin.response.merit import with_merits
from drumlin.response.norms import pressure_distance, relative

LEVEL = LEVELS[1]  # of the parametric bodies: torque within some 3e-4, bodies in 30 to 100 ms
HIGHEST = 5.0  # friction coefficient up to which self-locking is looked for
WEAR_TOLERANCE = 1e-2  # of p in L2 a step; the torque is then some 1e-4 off


@dataclass(frozen=True)
class Answer:
    """What the models make of a setting.

    `brake`: as it is solved, worn where wear is asked for; None where it is none. `found`, `law`:
    the responses by finite elements and by the law called `law_name`; where there is none,
    `failure` and `law_failure` say why. `law_locking`: mu_lock of the worst shoe by that law on a
    drum, else None. `distance` [m]: the sliding distance.
    """

    setting: Setting
    brake: Brake | None = None
    found: Response | None = None
    failure: str = ""
    law_name: str | None = None
    law: Response | None = None
    law_failure: str = ""
    law_locking: float | None = None
    distance: float = 0.0


class Worn(NamedTuple):
    """A brake run in: its setup, its states, and the unit of the sliding distance [m]."""

    setup: WearSetup
    states: list[WearState]
    unit: float


class Stated(NamedTuple):
    """How far an answer is from that of `solve`: torque and p (L2, the worst shoe's), relative; and
    what that states of its own errors, None of a mesh from a file.
    """

    torque: float
    pressure: float
    own: Mapping[str, float] | None


class Latest:
    """The last value that was made, by its key."""

    def __init__(self) -> None:
        self._key: Any = None
        self._value: Any = None

    def kept(self, key: Any) -> Any:
        """The value, where it has this key, else None."""
        return self._value if key == self._key else None

    def get(self, key: Any, make: Callable[[], Any]) -> Any:
        """The value, made anew where the key is another one."""
        if self._value is None or key != self._key:
            self._value = make()
            self._key = key
        return self._value


class Explorer:
    """Answers for the settings of one brake. What it keeps saves time and never changes an answer.

    Raises BadInput for a brake that finite elements do not cover.
    """

    def __init__(self, brake: Brake) -> None:
        pick("fem", brake)
        self.brake, self.knobs = brake, knobs_of(brake)
        self._scene, self._worn, self._limits, self._stated = Latest(), Latest(), Latest(), Latest()

    def answer(self, setting: Setting) -> Answer:
        """The answer for a setting; what has none is said in its lines."""
        made = Answer(setting, law_name=setting.law)
        try:
            brake = brake_of(self.brake, self.knobs, setting)
            made = replace(made, brake=brake)
            scene, wear = self.scene(brake), setting.values.get("wear", 0.0)
            if wear > 0 and not brake.surface.straight:
                brake, distance = self._worn_brake(scene, brake, wear)
                made = replace(made, brake=brake, distance=distance)
            found = respond(scene, brake)
            # of merits the page shows the braking force on a plane
            made = replace(
                made, found=with_merits(brake, found) if brake.surface.straight else found
            )
        except DrumlinError as error:
            made = replace(made, failure=str(error))
        return _beside(made)

    def scene(self, brake: Brake) -> Scene:
        """The bodies of a brake, prepared with friction, so that they serve every friction."""

        def make() -> Scene:
            dragged = vary(brake, {"friction": 1.0})
            return (
                prepare(dragged)
                if any(shoe.mesh for shoe in dragged.shoes)
                else prepare(dragged, LEVEL)
            )

        return self._scene.get(bare(brake).model_copy(update={"friction": 1.0}), make)

    def _worn_brake(self, scene: Scene, brake: Brake, wear: float) -> tuple[Brake, float]:
        """The brake worn over `wear` times 1/(k K), and that distance [m]. Raises NoAnswer for a
        lining worn out.
        """
        run = self._worn.get(brake, lambda: _run(scene, brake))
        state = at(run.states, wear * run.unit)
        for surface in run.setup.surfaces:
            deepest, lining = state.depth[surface.part].max(), brake.shoes[surface.shoe].lining
            if deepest > WORN_OUT * lining.thickness:
                raise NoAnswer(
                    f"shoe {surface.name!r}: worn out, {deepest * 1e3:.3g} mm would be worn off its lining"
                )
        return worn(run.setup, state), wear * run.unit

    def locking(self, brake: Brake) -> Mapping[tuple[int, ...], float]:
        """mu_lock of each group of shoes that meet the drum together, up to HIGHEST; empty where
        nothing touches.
        """

        def make() -> Mapping[tuple[int, ...], float]:
            dragged = vary(brake, {"friction": 1.0})
            try:
                found = limits(self.scene(brake), dragged, HIGHEST)
            except NoAnswer:
                return {}
            return {members: limit.friction for members, limit in found.items()}

        known: Mapping[tuple[int, ...], float] = self._limits.get(_at_any_friction(brake), make)
        return known

    def known_locking(self, brake: Brake) -> Mapping[tuple[int, ...], float] | None:
        """The same where it is known already, else None: it takes some 30 to 100 ms."""
        known: Mapping[tuple[int, ...], float] | None = self._limits.kept(_at_any_friction(brake))
        return known

    def stated(self, answer: Answer) -> Stated | None:
        """How far an answer on the fixed division is from `solve`, which takes as long as that;
        None without one.
        """
        brake, found = answer.brake, answer.found
        if brake is None or found is None:
            return None

        def make() -> Stated | None:
            try:
                finer = solve(brake)
            except DrumlinError:
                return None
            apart = max(
                pressure_distance(a, b) for a, b in zip(found.shoes, finer.shoes, strict=True)
            )
            return Stated(abs(relative(found.effect, finer.effect)), apart, finer.error)

        known: Stated | None = self._stated.get(brake, make)
        return known


def _at_any_friction(brake: Brake) -> Brake:
    """A key, not a brake: the same for every friction."""
    return brake.model_copy(update={"friction": 1.0})


def _run(scene: Scene, brake: Brake) -> Worn:
    setup, law = fem_setup(scene, brake), WearLaw(COEFFICIENT)
    unit = unit_distance(setup, law)
    return Worn(
        setup, run_in(setup, law, distance=LARGEST_WEAR * unit, tolerance=WEAR_TOLERANCE), unit
    )


def _beside(made: Answer) -> Answer:
    """The answer with that of its law."""
    name, brake = made.law_name, made.brake
    if name is None or brake is None:
        return made
    try:
        if name in LAWS and not brake.surface.straight:
            locking = min(locking_friction(brake, shoe, LAWS[name]) for shoe in brake.shoes)
            made = replace(made, law_locking=locking)
        return replace(made, law=pick(name, brake).solve(brake))
    except DrumlinError as error:
        return replace(made, law_failure=str(error))
