"""Find rings with a support of their own kind, for models that know plain rings only.

Finite elements take any support of a ring. The closed form of the foundation model, the triangles
of the verification and the reduced model take plain rings, see `Ring.is_plain`. They ask here, so
that a further kind of support is refused by all of them in one line.
"""

from drumlin.brake.brake import Brake


def plain_ring_only(brake: Brake, model: str) -> str | None:
    """Reason why a `model` that takes plain rings only does not apply, or None."""
    if brake.ring is None or brake.ring.is_plain:
        return None
    return (
        f"drum.ring.support = {brake.ring.support!r}: "
        f"{model} takes rings with a fixed or a free far edge only"
    )
