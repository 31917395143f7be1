"""The brakes that the tests share."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy is loaded: the dense systems are many and small

from pathlib import Path

import pytest
from hypothesis import settings

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake

ROOT = Path(__file__).resolve().parents[1]
STUDY = ROOT / "studies" / "double_shoe"

# Timings vary on shared machines; examples are derandomised so that a red run can be repeated.
settings.register_profile("drumlin", deadline=None, derandomize=True, max_examples=25)
settings.load_profile("drumlin")


@pytest.fixture(scope="session")
def brake() -> Brake:
    return read_brake(STUDY / "brake.toml")


@pytest.fixture(scope="session")
def flexible() -> Brake:
    return read_brake(STUDY / "flexible.toml")


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT
