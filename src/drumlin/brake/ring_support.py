"""Find out whether the drum's ring has a support that some models cannot take.

Finite elements take any support of a ring. The closed form of the foundation model, the triangular
elements of the verification and the reduced model take only rings whose far edge is fixed or free
(see `DrumRing.has_fixed_or_free_far_edge`). They all call this module, so that they refuse a ring
in the same words.
"""

from drumlin.brake.brake import Brake


def reason_if_ring_edge_is_not_fixed_or_free(brake: Brake, model: str) -> str | None:
    """Why a model for rings with a fixed or free far edge does not apply; None if it applies.

    `model` is the name of the model in the text.
    """
    if brake.ring is None or brake.ring.has_fixed_or_free_far_edge:
        return None
    return (
        f"drum.ring.support = {brake.ring.support!r}: "
        f"{model} takes rings with a fixed or a free far edge only"
    )
