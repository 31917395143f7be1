"""Random brakes whose stated errors are judged with further loads and measured friction."""

from drumlin.brake.friction import FrictionTable
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
