"""Shoes with a section of their own."""

from drumlin.brake.file import vary


def t_section(brake):
    """Table and web: the table is the backing, as wide as the lining, and the body is the web."""
    table = {"thickness": 4e-3, "material": {"E": 210e9, "nu": 0.3}}
    return vary(
        brake, {"shoe.backing": table, "shoe.body.thickness": 20e-3, "shoe.body.width": 5e-3}
    )
