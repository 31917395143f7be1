"""Docstrings of drumlin in the form that the extension napoleon of Sphinx reads."""

import re
from typing import Any

_PARAMETER = re.compile(r"(\*{0,2}\w+(?:, \*{0,2}\w+)*) : (.+)")
"""A parameter with its meaning: "elements : number of elements along each lining"."""

_HEADING_OF_RESULT = re.compile("Returns|Yields")


def prepare_docstring(
    app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Put the meaning of each parameter below its name, and mark formulas as formulas.

    numpydoc has the type of a parameter behind the colon. drumlin's docstrings have the meaning
    there, because the annotations have the types. Formulas are indented lines before the first
    heading. `lines` are changed in place; the other arguments are those that Sphinx passes.
    """
    lines[:] = _with_returned_value_as_field(lines)
    changed: list[str] = []
    heading, formula = "", False
    for here, line in enumerate(lines):
        below = lines[here + 1] if here + 1 < len(lines) else ""
        if line and below and set(below) == {"-"}:
            heading = line
        begins = not heading and line.startswith("    ") and here > 0 and not lines[here - 1]
        if begins and not formula:
            changed += ["::", ""]
        formula = begins or (formula and (not line or line.startswith("    ")))
        parameters = heading in {"Parameters", "Attributes", "Other Parameters"}
        found = _PARAMETER.fullmatch(line) if parameters else None
        if found:
            changed += [found[1], f"    {_without_marks(found[2])}"]
        else:
            changed.append(line if formula else _without_marks(line))
    if what in {"attribute", "data", "property"} and changed:
        # napoleon takes the words before a colon in the first line of a property as its type,
        # unless the line ends with the colon.
        changed[:1] = changed[0].replace(": ", ":\n", 1).split("\n")
    lines[:] = changed


def is_field_of_named_tuple(
    app: Any, what: str, name: str, obj: Any, skip: bool, options: Any
) -> bool | None:
    """True for a field of a named tuple, which the page of its class lists as a variable.

    Python gives such a field the text "Alias for field number 0". None leaves the choice to Sphinx.
    """
    return True if (getattr(obj, "__doc__", None) or "").startswith("Alias for field") else None


def _with_returned_value_as_field(lines: list[str]) -> list[str]:
    """The lines of a docstring with a field `:returns:` in place of the section "Returns".

    napoleon would take the words of the section's first line as names of types, and link them. A
    line with the type alone is left out, because the annotation has the type.
    """
    start = next((i for i, line in enumerate(lines) if _HEADING_OF_RESULT.fullmatch(line)), None)
    if start is None or set(lines[start + 1]) != {"-"}:
        return lines
    end = start + 2
    while end < len(lines) and not (end + 1 < len(lines) and set(lines[end + 1]) == {"-"}):
        end += 1
    told = lines[start + 2 : end]
    names = [line for line in told if line and not line.startswith(" ")]
    if len(names) < len([line for line in told if line]):
        # One name is the type, with its meaning below. Several names are a list of definitions.
        told = [line.removeprefix("    ") for line in told[1:]] if len(names) == 1 else ["", *told]
    # Two empty lines end the section before.
    field = ["", "", f":returns: {told[0]}", *(f"    {line}".rstrip() for line in told[1:]), ""]
    return [*lines[:start], *field, *lines[end:]]


def _without_marks(line: str) -> str:
    """The line with its stars and bars outside of back quotes and examples as plain signs."""
    if line.lstrip().startswith(">>>"):
        return line
    parts = line.split("`")
    parts[::2] = [re.sub(r"([*|])", r"\\\1", part) for part in parts[::2]]
    # A name in back quotes ends before the sign of a power.
    return re.sub(r"`\^", r"`\\ ^", "`".join(parts))
