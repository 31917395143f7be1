"""A default that a page of the manual or a docstring states is the default of the code."""

import inspect
import math
import re
from collections.abc import Callable, Iterator

import pytest

import drumlin
from conftest import ROOT
from drumlin import sizing
from drumlin.brake.file import vary
from drumlin.brake.support import ShoeWithOptionalMeshFile
from drumlin.contact.self_locking import LARGEST_SOUGHT_SELF_LOCKING_FRICTION
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND

PAGES = ROOT / "studies" / "manual" / "pages"

WORDS_OF_DEFAULT = re.compile(r"\bdefaults?\b|\bif left out\b", re.IGNORECASE)
"""Words by which a sentence of a page states a default."""

WORDS_ABOUT_DEFAULTS_ALONE = re.compile(
    r"\b(the default tolerance|a default solve|an earlier default|found\.setdefault)\b",
    re.IGNORECASE,
)
"""Words that speak of a default without its value."""

QUOTED_VALUE = re.compile(r"\{\{ \w+ \}\}")
"""A value that the manual takes from the code where it is built."""


def default_of(function: str, parameter: str) -> object:
    """The default of a parameter of a public function."""
    return inspect.signature(getattr(drumlin, function)).parameters[parameter].default


def default_of_mesh(key: str) -> object:
    """The default of a key of a shoe with a mesh file."""
    return ShoeWithOptionalMeshFile.model_fields[key].default


def length_held_by_a_pivot_is_the_thickness() -> bool:
    """Whether the thickness of the body is the `grip` of a body that has no `grip` of its own."""
    brake = drumlin.example("crane")
    (thickness,) = {shoe.body.thickness for shoe in brake.shoes}
    answers = [
        drumlin.solve(vary(brake, {"shoe.body.grip": grip}), elements=6)
        for grip in (None, thickness, 2 * thickness)
    ]
    return answers[0] == answers[1] != answers[2]


DEFAULTS_IN_PAGES: dict[str, Callable[[], bool]] = {
    '"mm", "in"; "m" if left out': lambda: default_of_mesh("mesh_unit") == "m",
    'mesh_frame = "shoe" # "brake" if left out': lambda: default_of_mesh("mesh_frame") == "brake",
    "By default each case is solved on two or more divisions into elements": lambda: (
        default_of("sweep", "certify") == "every case"
    ),
    "quadratic quadrilaterals `quad2` (the default)": lambda: DEFAULT_MESH_KIND == "quad2",
    "It is off by default.": lambda: default_of("solve", "finite_width") is False,
    "the length of this part, by default the thickness of the body": (
        length_held_by_a_pivot_is_the_thickness
    ),
}
"""What the code must do, by words of the sentence that states it.

Sentences of pages that quote a value from the code need no entry.
"""

DEFAULTS_IN_DOCSTRINGS: dict[str, Callable[[], bool]] = {
    "None for 1000": lambda: LARGEST_SOUGHT_SELF_LOCKING_FRICTION == 1000,
    "None: a tenth of the value of the file, 30 deg less for an angle, a quarter": lambda: (
        sizing.DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END == 10
        and math.isclose(sizing.DEFAULT_HALF_RANGE_OF_ANGLE, math.radians(30))
        and sizing.DEFAULT_HALF_RANGE_OF_COORDINATE_OVER_BRAKE_SIZE == 0.25
    ),
    "None: ten times the value of the file, 30 deg more for an angle, a quarter": lambda: (
        sizing.DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END == 10
    ),
}
"""What the code must do, by words of the docstrings of the public functions."""

NUMBER_FOR_NONE = re.compile(r"None(?: for|:)[^;.:]*?(?:\d|tenth|quarter|times)[^;.:]*")
"""Words of a docstring by which None means a number."""


def sentences_with_typed_defaults(text: str) -> Iterator[str]:
    """The sentences of a page that state a default, and do not quote it from the code."""
    for sentence in re.split(r"(?<=[.!?]) (?=[A-Z`])", re.sub(r"\s+", " ", text)):
        stated = WORDS_ABOUT_DEFAULTS_ALONE.sub("", sentence)
        if WORDS_OF_DEFAULT.search(stated) and not QUOTED_VALUE.search(stated):
            yield sentence


def docstrings_with_numbers_for_none() -> Iterator[str]:
    """The words of public docstrings by which None means a number."""
    for name in drumlin.__all__:
        text = re.sub(r"\s+", " ", inspect.getdoc(getattr(drumlin, name)) or "")
        yield from NUMBER_FOR_NONE.findall(text)


def defaults_without_check(
    sentences: Iterator[str], checks: dict[str, Callable[[], bool]]
) -> list[str]:
    """The sentences for which no check of the code is listed."""
    return [said for said in sentences if not any(words in said for words in checks)]


def test_every_default_in_a_page_is_quoted_from_the_code_or_checked():
    said = [
        sentence
        for page in sorted(PAGES.rglob("*.md"))
        for sentence in sentences_with_typed_defaults(page.read_text(encoding="utf-8"))
    ]
    assert defaults_without_check(iter(said), DEFAULTS_IN_PAGES) == []
    # A check whose sentence is gone is removed with it.
    assert [words for words in DEFAULTS_IN_PAGES if not any(words in one for one in said)] == []


def test_every_default_in_a_docstring_is_checked():
    said = list(docstrings_with_numbers_for_none())
    assert defaults_without_check(iter(said), DEFAULTS_IN_DOCSTRINGS) == []
    assert [words for words in DEFAULTS_IN_DOCSTRINGS if not any(words in s for s in said)] == []


@pytest.mark.parametrize("words", [*DEFAULTS_IN_PAGES, *DEFAULTS_IN_DOCSTRINGS])
def test_a_stated_default_is_that_of_the_code(words):
    assert (DEFAULTS_IN_PAGES | DEFAULTS_IN_DOCSTRINGS)[words]()


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("The contact is stiff. The default is 1e5. More follows.", ["The default is 1e5."]),
        ("It is `quad1` by default", ["It is `quad1` by default"]),
        ("The default is {{ penalty }}.", []),
        ("The levels end at the default tolerance.", []),
    ],
)
def test_a_default_typed_by_hand_is_noticed(text, found):
    assert list(sentences_with_typed_defaults(text)) == found
    assert defaults_without_check(iter(found), DEFAULTS_IN_PAGES) == found
