"""Broken brake files and meshes end as one line or as a sound answer: no traceback, no hang, no
wrong number.
"""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drumlin.studies import load
from drumlin_studies import bad_input, broken_meshes

SOUND = load("stability")[0].sound()


@pytest.mark.parametrize("maker", bad_input.MAKERS, ids=lambda maker: maker.__name__)
@settings(suppress_health_check=list(HealthCheck))
@given(rng=st.randoms(use_true_random=False))
def test_no_input_is_a_fault(maker, rng):
    verdict = bad_input.judge(maker(rng, SOUND))
    assert verdict.outcome not in bad_input.FAULTS, verdict


def test_a_sound_mesh_is_answered():
    """The broken meshes are made from meshes that drumlin takes: else their refusal would prove
    nothing.
    """
    for suffix in (".msh", ".inp", ".vtu"):
        sound = broken_meshes.meshed(
            "sound", broken_meshes.mesh_files(SOUND.meshed)[suffix], suffix, False, SOUND
        )
        assert bad_input.judge(sound).outcome == "answer"


def test_faults_are_seen(monkeypatch):
    """The judge knows a traceback, a number for what has none, and a run that takes too long."""
    brake = {"brake.toml": SOUND.brakes[0]}
    assert bad_input.judge(bad_input.Input("sound", brake, True)).outcome == "wrong number"

    def broken(_):
        raise ZeroDivisionError

    monkeypatch.setattr(bad_input, "read_any", broken)
    assert bad_input.judge(bad_input.Input("any", brake, False)).outcome == "traceback"

    def slow(_):
        while True:
            pass

    monkeypatch.setattr(bad_input, "read_any", slow)
    monkeypatch.setattr(bad_input, "LONGEST", 0.2)
    assert bad_input.judge(bad_input.Input("any", brake, False)).outcome == "hang"
