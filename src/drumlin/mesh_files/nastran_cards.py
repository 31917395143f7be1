"""The cards of a Nastran bulk data file: names and fields, in all three formats of its lines.

A card is a statement of bulk data. Its fields stand in columns of eight characters (small field
format), in columns of 16 (large field format, a star after the name), or between commas (free
format). A card may continue on further lines.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

COLUMNS_OF_SMALL_FIELD = 8
"""Number of characters of a field in the small field format."""
COLUMNS_OF_LARGE_FIELD = 16
"""Number of characters of a field in the large field format; the name has eight characters."""
FIELDS_OF_CARD_LINE = 8
"""Number of data fields on a line of the small field format.

The first field before them is the name, and the field after them is the name of a continuation.
"""
END_OF_BULK_DATA_PATTERN = re.compile(r"^\s*ENDDATA\b", re.IGNORECASE | re.MULTILINE)
"""Pattern of the line that ends the bulk data."""
BEGIN_OF_BULK_DATA_PATTERN = re.compile(r"^\s*BEGIN\b([^\n$]*).*$", re.IGNORECASE | re.MULTILINE)
"""Pattern of a line BEGIN BULK; group 1 is the rest of the line after BEGIN."""
INCLUDE_STATEMENT_PATTERN = re.compile(r"^\s*INCLUDE\b.*$", re.IGNORECASE | re.MULTILINE)
"""Pattern of a line that includes another file."""
REAL_NUMBER_OF_CARD_PATTERN = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[ED]?([+-]\d+)|[ED](\d+))?", re.IGNORECASE
)
"""Pattern of a real number of Nastran: 1.5-3 is 0.0015, and an exponent may follow a D or an E."""


@dataclass
class NastranBulkCard:
    """A card of a Nastran bulk data file.

    Parameters
    ----------
    name : name of the card in upper case, without the star of the large field format
    fields : data fields after the name, without blanks around them; empty fields are ""
    """

    name: str
    fields: list[str] = field(default_factory=list)

    def text_of_field(self, position: int) -> str:
        """The text of a data field, counted from 0; "" beyond the last field."""
        return self.fields[position] if position < len(self.fields) else ""

    def integer_of_field(self, position: int, default: int | None = None) -> int:
        """The whole number in a data field, counted from 0.

        ValueError is raised for a field that has no whole number. An empty field has the value
        `default`, if that is a number.
        """
        text = self.text_of_field(position)
        if not text and default is not None:
            return default
        if not re.fullmatch(r"\+?\d+", text):
            raise ValueError(
                f"{self.words_of_card()}: field {position + 2} = {text!r} must be a whole number"
            )
        return int(text)

    def real_of_field(self, position: int) -> float:
        """The real number in a data field, counted from 0; an empty field is 0.

        ValueError is raised for a field that has no number.
        """
        text = self.text_of_field(position)
        found = REAL_NUMBER_OF_CARD_PATTERN.fullmatch(text)
        if text and not found:
            raise ValueError(
                f"{self.words_of_card()}: field {position + 2} = {text!r} must be a number"
            )
        if found is None:
            return 0.0
        return float(f"{found[1]}e{found[2] or found[3] or 0}")

    def words_of_card(self) -> str:
        """The name of the card and its first field, such as "GRID 12", for messages."""
        return f"{self.name} {self.text_of_field(0)}".strip()


def bulk_data_of_nastran_file(text: str) -> str:
    """The bulk data in the text of a Nastran file.

    They stand between the lines BEGIN BULK and ENDDATA. A file without BEGIN BULK has bulk data
    alone.

    Raises
    ------
    ValueError
        for a file that includes another one or has superelements, and for a file with BEGIN BULK
        that does not end with ENDDATA
    """
    included = INCLUDE_STATEMENT_PATTERN.search(text)
    if included:
        raise ValueError(
            f"{included.group().strip()}: included files are not read; put all cards into one file"
        )
    begins = list(BEGIN_OF_BULK_DATA_PATTERN.finditer(text))
    for begin in begins:
        words = begin[1].upper().split()
        if words not in ([], ["BULK"]) or len(begins) > 1:
            raise ValueError(
                f"{begin.group().strip()}: parts of a model (superelements) are not read; "
                "write the shoe alone"
            )
    ends = END_OF_BULK_DATA_PATTERN.search(text)
    if begins and not ends:
        raise ValueError("has BEGIN BULK but no ENDDATA: the file was cut off")
    return text[begins[0].end() if begins else 0 : ends.start() if ends else len(text)]


def split_bulk_data_into_cards(bulk: str) -> Iterator[NastranBulkCard]:
    """Yield the cards of bulk data with the fields of all their lines.

    Raises
    ------
    ValueError
        for a continuation without its card, a card that copies fields of the card before it, and a
        line with too many fields
    """
    card, promised = None, ""
    for raw in bulk.splitlines():
        line = raw.split("$", 1)[0].rstrip()
        if not line.strip():
            continue
        name, fields, promise = _name_fields_and_continuation_of_line(line)
        if name.startswith(("=", "/")):
            raise ValueError(
                f"{line.strip()[:40]!r} copies or deletes other cards; write all cards out"
            )
        if name and not name.startswith(("+", "*")):
            if card:
                yield card
            card, promised = NastranBulkCard(name.rstrip("* ").upper(), fields), promise
            continue
        # The line continues a card. Its name must be the one that the line before it announced.
        own, expected = name.lstrip("+*").strip(), promised.lstrip("+*").strip()
        if card is None or (own and expected and own != expected):
            raise ValueError(f"{line.strip()[:40]!r} continues no card before it")
        if not _is_in_large_field_format(name):
            card.fields += [""] * (-len(card.fields) % FIELDS_OF_CARD_LINE)
        card.fields += fields
        promised = promise
    if card:
        yield card


def _is_in_large_field_format(name: str) -> bool:
    """Whether a line with a given first field has the large field format."""
    return name.startswith("*") or name.endswith("*")


def _name_fields_and_continuation_of_line(line: str) -> tuple[str, list[str], str]:
    """The first field of a line, its data fields, and the name of the continuation that follows.

    ValueError is raised for a line with too many fields.
    """
    if "," in line:
        name, *words = [word.strip() for word in line.split(",")]
        count = FIELDS_OF_CARD_LINE // 2 if _is_in_large_field_format(name) else FIELDS_OF_CARD_LINE
        if any(words[count + 1 :]):
            raise ValueError(f"{line.strip()[:40]!r} has more than {count} fields after its name")
    else:
        # Tabs stand for blanks up to the next column of eight.
        line = line.expandtabs(COLUMNS_OF_SMALL_FIELD)
        name = line[:COLUMNS_OF_SMALL_FIELD].strip()
        is_large = _is_in_large_field_format(name)
        width = COLUMNS_OF_LARGE_FIELD if is_large else COLUMNS_OF_SMALL_FIELD
        count = FIELDS_OF_CARD_LINE // 2 if is_large else FIELDS_OF_CARD_LINE
        starts = [COLUMNS_OF_SMALL_FIELD + width * i for i in range(count + 1)]
        words = [line[start : start + width].strip() for start in starts]
    words += [""] * (count + 1 - len(words))
    return name, words[:count], words[count]
