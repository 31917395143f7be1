"""How far the friction of a brake is from self-locking, as data and as lines of text."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from drumlin.base.texts import number_as_text

WARNED_FRACTION_OF_LOCKING_FRICTION = 2 / 3
"""Ratio of friction coefficient mu to self-locking limit mu_lock above which drumlin warns.

The torque grows as mu/(mu_lock - mu): at two thirds, friction that is 10 % higher gives 37 % more
torque. The value is a judgement and changes no result.
"""


class LockedShoesAndLockingFriction(NamedTuple):
    """Shoes that lock together, and the friction coefficient mu_lock at which they lock.

    Attributes
    ----------
    shoes : names of the shoes; on a rigid drum a single shoe
    friction : mu_lock; inf if no limit was found
    pressure_stays_finite : whether the equilibrium ends at finite pressures on the elements of the
        solve, for example where a shoe leaves a support
    shoes_pressed_at_point : names of the shoes whose contact shrinks to a point there. Their
        contact forces stay finite, and their pressures grow without bound.
    """

    shoes: tuple[str, ...]
    friction: float
    pressure_stays_finite: bool = False
    shoes_pressed_at_point: tuple[str, ...] = ()

    def how_equilibrium_ends_as_text(self) -> str:
        """How the equilibrium ends at this friction, as the end of a sentence on the friction."""
        if not self.pressure_stays_finite:
            return "towards which the torque grows without bound"
        text = "at which the equilibrium ends while the torque is finite"
        if self.shoes_pressed_at_point:
            text += f" and the contact of {_shoe_names_as_text(self.shoes_pressed_at_point)}"
            text += " shrinks to a point"
        return text


class SelfLocking(NamedTuple):
    """The friction of a brake and the friction coefficients at which the brake locks itself.

    Attributes
    ----------
    friction : friction coefficient mu of the brake
    law : the shoe that locks first by the rigid-shoe law, and its mu_lock
    elastic : the shoes that lock first by finite elements, and their mu_lock; None if the limit was
        not sought
    sought : friction coefficient up to which the limit by finite elements was sought; 0 if it was
        not sought
    key_of_lining_with_own_friction : key of the first lining with a friction of its own; the limits
        then hold for the friction of the brake, and the frictions of all linings change in
        proportion; "" if all linings have the friction of the brake
    """

    friction: float
    law: LockedShoesAndLockingFriction
    elastic: LockedShoesAndLockingFriction | None = None
    sought: float = 0.0
    key_of_lining_with_own_friction: str = ""

    def __repr__(self) -> str:
        """The line of `line`."""
        return self.line()

    def as_dict(self) -> dict[str, Any]:
        """The limits as plain data for JSON; a limit that was not found is None."""
        elastic = None if self.elastic is None else self.elastic.friction
        return {
            "friction": self.friction,
            "law": _finite_or_none(self.law.friction),
            "elastic": _finite_or_none(elastic),
            "elastic_sought_up_to": self.sought,
        }

    @property
    def is_elastic_known(self) -> bool:
        """Whether the limit of the elastic brake was sought and found."""
        return self.elastic is not None and math.isfinite(self.elastic.friction)

    def line(self) -> str:
        """A line that states the friction relative to the limits mu_lock."""
        known = []
        if self.elastic is not None and math.isfinite(self.elastic.friction):
            known.append(
                self._friction_in_percent_of_limit_as_text(self.elastic, "for the elastic brake")
            )
        if math.isfinite(self.law.friction):
            known.append(
                self._friction_in_percent_of_limit_as_text(self.law, "by the rigid-shoe law")
            )
        if not known:
            known.append("no friction locks the brake by the rigid-shoe law")
        if self.elastic is not None and math.isinf(self.elastic.friction):
            known.append(self._how_far_elastic_limit_was_sought_as_text())
        if self.key_of_lining_with_own_friction:
            known.append(f"all frictions in proportion, {self.key_of_lining_with_own_friction} too")
        return f"self-locking: {'; '.join(known)}"

    def _how_far_elastic_limit_was_sought_as_text(self) -> str:
        """The end of the search that found no limit of the elastic brake, as text.

        The text says that the end of the search is a multiple of the friction mu, and no limit of
        the brake.
        """
        return (
            f"mu_lock of the elastic brake is above {self.sought:.4g} = "
            f"{self.sought / self.friction:.3g} mu, where the search ends"
        )

    def _friction_in_percent_of_limit_as_text(
        self, limit: LockedShoesAndLockingFriction, whose: str
    ) -> str:
        """Text such as "friction 0.3 is 60 % of mu_lock = 0.5 for the elastic brake".

        `whose` are the last words of the text.
        """
        share = number_as_text(self.friction / limit.friction, ".0%")
        return f"friction {self.friction:g} is {share} of mu_lock = {limit.friction:.4g} {whose}"

    def warnings(self) -> Iterator[str]:
        """Yield a warning for each limit mu_lock that is close to the friction coefficient.

        It is close if friction/mu_lock is above WARNED_FRACTION_OF_LOCKING_FRICTION.
        """
        if (
            self.elastic is not None
            and self.friction > WARNED_FRACTION_OF_LOCKING_FRICTION * self.elastic.friction
        ):
            near = self._friction_in_percent_of_limit_as_text(self.elastic, "for the elastic brake")
            end = self.elastic.how_equilibrium_ends_as_text()
            yield f"warning: {_shoe_names_as_text(self.elastic.shoes)}: {near}, {end}"
        shoe = _shoe_names_as_text(self.law.shoes)
        if self.friction >= self.law.friction:
            yield (
                f"warning: {shoe}: friction {self.friction:g} is above "
                f"mu_lock = {self.law.friction:.4g} of the rigid-shoe law, "
                "by which the shoe locks itself"
            )
        elif self.friction > WARNED_FRACTION_OF_LOCKING_FRICTION * self.law.friction:
            yield (
                f"warning: {shoe}: "
                f"{self._friction_in_percent_of_limit_as_text(self.law, 'by the rigid-shoe law')}"
            )


class SelfLockingFactor(NamedTuple):
    """How far friction that depends on the pressure is from locking the brake.

    All friction coefficients of the brake are raised by one factor, at all pressures alike.

    Attributes
    ----------
    key : key of the brake file that makes friction depend on the pressure
    elastic : the shoes that lock first by finite elements, and the factor at which they lock, in
        place of mu_lock; None if the factor was not sought
    sought : factor up to which the limit was sought; 0 if it was not sought
    """

    key: str
    elastic: LockedShoesAndLockingFriction | None = None
    sought: float = 0.0

    def __repr__(self) -> str:
        """The line of `line`."""
        return self.line()

    def as_dict(self) -> dict[str, Any]:
        """The factor as plain data for JSON; a factor that was not found is None."""
        factor = None if self.elastic is None else self.elastic.friction
        return {"factor": _finite_or_none(factor), "factor_sought_up_to": self.sought}

    def line(self) -> str:
        """A line that states the factor on all frictions at which the brake locks itself."""
        if self.elastic is None:
            return f"self-locking: not sought for {self.key}; drumlin.self_locking finds it"
        if math.isinf(self.elastic.friction):
            return (
                f"self-locking: the limit of the elastic brake is above {self.sought:.4g} times "
                f"its friction, where the search ends ({self.key})"
            )
        return (
            f"self-locking: the elastic brake locks at {self.elastic.friction:.4g} times its "
            f"friction ({self.key})"
        )

    def warnings(self) -> Iterator[str]:
        """Yield a warning if the friction is close to the friction at which the brake locks itself.

        It is close above the fraction WARNED_FRACTION_OF_LOCKING_FRICTION of the locking friction.
        """
        if (
            self.elastic is not None
            and WARNED_FRACTION_OF_LOCKING_FRICTION * self.elastic.friction < 1
        ):
            yield (
                f"warning: {_shoe_names_as_text(self.elastic.shoes)}: the elastic brake locks at "
                f"{self.elastic.friction:.4g} times its friction ({self.key}), "
                f"{self.elastic.how_equilibrium_ends_as_text()}"
            )


def first_shoes_to_lock(
    limits: Sequence[LockedShoesAndLockingFriction],
) -> LockedShoesAndLockingFriction:
    """The shoes that lock first: those with the smallest mu_lock among all `limits`."""
    return min(limits, key=lambda limit: limit.friction)


def _shoe_names_as_text(shoes: Sequence[str]) -> str:
    """The names of shoes as text, such as "shoe 'leading', shoe 'trailing'"."""
    return ", ".join(f"shoe {name!r}" for name in shoes)


def _finite_or_none(value: float | None) -> float | None:
    """The value, or None if it is infinite."""
    return None if value is None or math.isinf(value) else value
