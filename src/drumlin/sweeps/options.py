"""The options of models in a sweep file; the command line's options have the same names."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drumlin.brake.fields import PartOfInputFile
from drumlin.fem.preparation.meshes import MOST_ELEMENTS_ALONG_LINING
from drumlin.fem.width.ladder import LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR


class ContactOptions(PartOfInputFile):
    """Options of models that may use a penalty stiffness in contact, as on the command line."""

    # An infinite penalty stiffness means contact without penetration.
    model_config = PartOfInputFile.model_config | {"allow_inf_nan": True}

    penalty: Annotated[float, Field(gt=0)] | None = None


class FemOptions(ContactOptions):
    """Options of the finite elements, as on the command line."""

    elements: Annotated[int, Field(ge=1, le=MOST_ELEMENTS_ALONG_LINING)] | None = None
    kind: Literal["quad2", "quad1", "tri2", "tri1"] | None = None
    tolerance: Annotated[float, Field(gt=0, lt=1)] | None = None
    finite_width: bool | None = None
    model_error: bool | None = None

    @model_validator(mode="after")
    def _require_not_both_elements_and_tolerance(self) -> Self:
        """Raise ValueError if both a tolerance and the elements or their kind are given."""
        if self.tolerance is not None and (self.elements is not None or self.kind is not None):
            raise ValueError("tolerance chooses the elements; leave out elements and kind")
        return self


class SolidOptions(ContactOptions):
    """Options of solid shoes, as on the command line."""

    across: Annotated[int, Field(ge=1, le=LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR)] | None = None
    tolerance: Annotated[float, Field(gt=0, lt=1)] | None = None

    @model_validator(mode="after")
    def _require_not_both_degree_and_tolerance(self) -> Self:
        """Raise ValueError if both a tolerance and a degree across the width are given."""
        if self.tolerance is not None and self.across is not None:
            raise ValueError("tolerance chooses the degree across the width; leave out across")
        return self


class FoundationOptions(PartOfInputFile):
    """Options of the foundation model, as on the command line."""

    sections: Annotated[int, Field(ge=2)] | None = None
    lift: list[str] | None = None


OPTION_CLASSES_BY_MODEL_NAME: Mapping[str, type[PartOfInputFile]] = {
    "fem": FemOptions,
    "solid": SolidOptions,
    "foundation": FoundationOptions,
}
"""The class that reads the options of each model. Models that are not listed have no options."""
