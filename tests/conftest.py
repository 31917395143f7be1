"""Brakes and study results that several tests share, and the treatment of skipped tests."""

import os
import signal
import sys
from collections.abc import Container, Generator, Iterable

# This is set before numpy is loaded, since the dense systems are many and small.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake
from drumlin.contact import self_locking
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.equations import ContactProblem
from drumlin.studies import import_study_and_find_folder_above_studies

# A job in the background ignores these signals, and the processes that it starts would, too.
for number in (signal.SIGINT, signal.SIGHUP):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, signal.SIG_DFL)

ROOT = Path(__file__).resolve().parents[1]
STUDY = ROOT / "studies" / "double_shoe"

# Timings vary on shared machines; examples are derandomised so that a red run can be repeated.
settings.register_profile("all", deadline=None, derandomize=True, max_examples=25)
settings.register_profile("quick", settings.get_profile("all"), max_examples=8)


def partly(cases: Iterable[Any], quick: Container[Any]) -> list[Any]:
    """Cases for `pytest.mark.parametrize`. Cases that are not quick get the mark `slow`."""
    return [
        pytest.param(
            *(case if isinstance(case, tuple) else (case,)),
            marks=() if case in quick else pytest.mark.slow,
        )
        for case in cases
    ]


@pytest.fixture(scope="session")
def brake() -> Brake:
    return read_brake(STUDY / "brake.toml")


@pytest.fixture(scope="session")
def flexible() -> Brake:
    return read_brake(STUDY / "flexible.toml")


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="module")
def module(request: pytest.FixtureRequest) -> Any:
    """The module of the study that a test module names in STUDY_NAME."""
    return import_study_and_find_folder_above_studies(request.module.STUDY_NAME)[0]


@pytest.fixture(scope="module")
def result(module: Any) -> Any:
    """The study's result of a trial run (option --short)."""
    return module.study(short=True)


def settled_sizes(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """A list that grows by the number of nodes of each contact problem of `self_locking`."""
    sizes: list[int] = []
    settle = self_locking.solve_contact_by_block_pivoting

    def counted(problem: ContactProblem, *rest: Any, **more: Any) -> ContactSolution:
        sizes.append(len(problem.q))
        return settle(problem, *rest, **more)

    monkeypatch.setattr(self_locking, "solve_contact_by_block_pivoting", counted)
    return sizes


# A test that is skipped for want of a program is noted, so that another run, which has the program,
# can make it up.


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--no-skips", action="store_true", help="a test that is skipped has failed")
    parser.addoption(
        "--skipped",
        action="store_true",
        help="run what the last run skipped; who skips again has failed",
    )


def pytest_configure(config: pytest.Config) -> None:
    skips = Skips(config)
    config.pluginmanager.register(skips)
    # The profile must be loaded before pytest reads a test module.
    settings.load_profile("all" if skips.failed else "quick")


class Skips:
    """Records the skipped tests in pytest's cache; with several workers, in the main process."""

    KEY = "drumlin/skipped"

    def __init__(self, config: pytest.Config) -> None:
        # With -p no:cacheprovider pytest has no cache.
        self.cache: Any = getattr(config, "cache", None)
        self.again, self.found = config.getoption("--skipped"), list[str]()
        self.failed = self.again or config.getoption("--no-skips")
        self.notes = (
            self.cache and not hasattr(config, "workerinput") and not config.option.collectonly
        )

    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        if not self.failed:
            for item in items:
                if item.get_closest_marker("slow"):
                    item.add_marker(pytest.mark.skip(reason="slow; make test-all runs it"))
        if self.again:
            # A module that is skipped as a whole is noted by its own name.
            last = tuple(self.cache.get(self.KEY, []))
            config.hook.pytest_deselected(
                items=[item for item in items if not item.nodeid.startswith(last)]
            )
            items[:] = [item for item in items if item.nodeid.startswith(last)]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        return self.judged((yield))

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(
        self,
    ) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
        return self.judged((yield))

    def judged(self, report: Any) -> Any:
        if report.skipped and self.failed:
            report.outcome, report.longrepr = "failed", f"skipped: {report.longrepr}"
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.found += [report.nodeid] if report.skipped else []

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        self.found += [report.nodeid] if report.skipped else []

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if self.again and session.exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED:
            # Nothing was skipped in the last run, so that no test is left to run.
            session.exitstatus = pytest.ExitCode.OK
        if self.notes and not self.failed:
            self.cache.set(self.KEY, sorted(set(self.found)))


@pytest.fixture(autouse=True)
def no_law_of_a_test_stays():
    """Laws that a test registers, as the example of `drumlin.law` does, end with the test."""
    yield
    models = sys.modules.get("drumlin.models")
    for name in set(models.MODELS) - models.NAMES_OF_BUILT_IN_MODELS if models else ():
        del models.MODELS[name]
