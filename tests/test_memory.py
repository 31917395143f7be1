"""How much memory the solve of a brake takes beyond the modules that it loads."""

import tracemalloc
import weakref

import pytest

import drumlin
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp import shoe as hp_shoe
from drumlin.fem.preparation.prepare import make_prepared_model

MOST_MEMORY = 150e6
"""Peak [bytes] that the default solve of an example may allocate."""


def test_few_columns_of_a_post_wait_for_their_neighbours(monkeypatch):
    """At most three batches of columns live at a time; a post's shoes alone have six and more."""
    condense, alive, most = hp_shoe.condensed_element_column_stiffness, [], []

    def watched(*given):
        K = condense(*given)
        alive.append(weakref.ref(K))
        most.append(sum(batch() is not None for batch in alive))
        return K

    monkeypatch.setattr(hp_shoe, "condensed_element_column_stiffness", watched)
    brake = drumlin.example("post_brake")
    make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2])
    assert len(alive) >= 6
    assert max(most) <= 3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["double_shoe_meshes", "web_shoe"])
def test_the_default_solve_of_the_largest_examples_takes_little_memory(name):
    brake = drumlin.example(name)
    tracemalloc.start()
    try:
        drumlin.solve(brake)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < MOST_MEMORY
