"""Random brakes whose stated errors are judged with further loads and measured friction."""

import json

from drumlin.base.errors import BadInput
from drumlin.brake.friction import FrictionTable
from drumlin_studies.heat_error import (
    judge_brakes_of_seeds_and_print_summary,
    read_rows_of_errors_by_seed,
)
from drumlin_studies.load_error import draw_random_brake_with_loads_and_lining_friction


def test_random_brakes_have_each_feature_and_are_drawn_again_from_their_seed():
    brakes = [
        draw_random_brake_with_loads_and_lining_friction(seed) for seed in range(540000, 540008)
    ]
    assert any(spring.rate > 0 for brake in brakes for spring in brake.springs)
    assert any(brake.shoe_speed for brake in brakes)
    assert any(isinstance(brake.friction_as_written, FrictionTable) for brake in brakes)
    assert any(shoe.anchors for brake in brakes for shoe in brake.shoes)
    assert any(shoe.lining.friction for brake in brakes for shoe in brake.shoes)
    assert draw_random_brake_with_loads_and_lining_friction(540007) == brakes[7]
    assert brakes[6] != brakes[7]


def test_a_file_keeps_the_judged_brakes_for_a_later_run(tmp_path, capsys):
    path, drawn = tmp_path / "rows.jsonl", []

    def draw(seed):
        drawn.append(seed)
        raise BadInput(f"no brake {seed}")

    judge_brakes_of_seeds_and_print_summary(draw, 3, 5, path)
    row = {"tolerance": 0.01, "outcome": "reached", "stated_torque": 2.0, "true_torque": 1.0}
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"seed": 8, "rows": [row | {"unsure_torque": 0.0}]}) + "\n")
    judge_brakes_of_seeds_and_print_summary(draw, 3, 6, path)
    # Brakes in the file are not solved again, and a brake that was not drawn has no rows.
    assert drawn == [3, 4, 5]
    assert set(read_rows_of_errors_by_seed(path)) == {3, 4, 5, 8}
    # The table has the brakes of all runs.
    assert "'quantity': 'torque', 'brakes': 1," in capsys.readouterr().out
