"""Shoes whose cross-section has several parts, such as a table and a web."""

from drumlin.brake.file import vary


def t_section(brake):
    """A T-shaped shoe: its table, as wide as the lining, is the backing; its web is the body."""
    table = {"thickness": 4e-3, "material": {"E": 210e9, "nu": 0.3}}
    return vary(
        brake, {"shoe.backing": table, "shoe.body.thickness": 20e-3, "shoe.body.width": 5e-3}
    )


def widths(brake, width):
    """The brake with all parts of one width [m]."""
    both = {"shoe.lining.width": width}
    if any(shoe.body is not None for shoe in brake.shoes):
        both["shoe.body.width"] = width
    return vary(brake, both)


def without_contraction(brake):
    """The brake with Poisson's ratios of zero, and one width."""
    none = {"shoe.lining.material.nu": 0.0}
    if brake.shoes[0].body is not None:
        none["shoe.body.material.nu"] = 0.0
    if brake.shoes[0].backing is not None:
        none["shoe.backing.material.nu"] = 0.0
    return widths(vary(brake, none), brake.shoes[0].lining.width)
