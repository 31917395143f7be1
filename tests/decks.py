"""Decks of a parametric shoe, written in the ways in which people have them."""

import re

import numpy as np

from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.file import write_shoe_mesh_to_file

ELEMENTS = 12


DEFINITIONS = re.compile(r"\*NODE\n.*?(?=\*ELSET)", re.DOTALL)


def deck_of(folder, shoe, radius, kind="quad1"):
    """The text of the parametric mesh as an input file."""
    path = folder / "plain.inp"
    write_shoe_mesh_to_file(path, parametric_mesh_of_shoe(shoe, radius, ELEMENTS, kind), shoe)
    return path.read_text()


def moved_nodes(text, move):
    """The deck with every node's x, y changed by `move`, written with all digits."""
    # The nodes stand between *NODE and the first *ELEMENT.
    head, nodes, rest = re.split(r"(?<=\*NODE\n)(.*?)(?=\*ELEMENT)", text, flags=re.DOTALL)
    lines = []
    for line in nodes.strip().split("\n"):
        label, x, y, _ = line.split(",")
        x, y = move(float(x), float(y))
        lines.append(f"{label}, {float(x)!r}, {float(y)!r}, 0.")
    return head + "\n".join(lines) + "\n" + rest


def back(x, y):
    return x - 0.0004, y


def in_part(text, placed):
    """The deck as a part with its sets, placed by an assembly."""
    return (
        f"*PART, NAME=Shoe\n{text}*END PART\n*ASSEMBLY, NAME=A\n"
        f"*INSTANCE, NAME=Shoe-1, PART=Shoe\n{placed}*END INSTANCE\n*END ASSEMBLY\n"
    )


def turned(text):
    """A part drawn a quarter turn further and moved; its instance turns it back."""
    # The second line of an instance is an axis through two points and an angle [deg].
    drawn = moved_nodes(text, lambda x, y: (-y - 0.1, x))
    return in_part(drawn, "0.1, 0., 0.\n0., 0., 0., 0., 0., 1., -90.\n")


def with_drum(text):
    """A second part whose labels begin at 1, too."""
    drum = "*PART, NAME=Drum\n*NODE\n1, .2, 0.\n2, .3, 0.\n3, .3, .1\n"
    drum += "*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n*END PART\n"
    inside = in_part(text, "").replace(
        "*END ASSEMBLY", "*INSTANCE, NAME=Drum-1, PART=Drum\n*END INSTANCE\n*END ASSEMBLY"
    )
    return drum + inside


def sets_of_the_assembly(text):
    """Sets in the assembly, some with labels as Shoe-1.12, the contact as a surface of nodes."""
    mesh = DEFINITIONS.match(text).group()
    # The name CONTACT is free for the surface that stands for the set.
    sets = text[len(mesh) :].replace("NSET=CONTACT", "NSET=Line")
    sets = re.sub(r"(\*(?:EL|N)SET, .*)", r"\1, instance=Shoe-1", sets)
    sets = re.sub(
        r"(\*NSET, NSET=HINGE), instance=Shoe-1\n(.*)",
        lambda m: f"{m[1]}\n" + ", ".join(f"Shoe-1.{k.strip()}" for k in m[2].split(",")),
        sets,
    )
    surface = "*SURFACE, NAME=Contact, TYPE=NODE\nLine,\n"
    return in_part(mesh, "").replace("*END ASSEMBLY", sets + surface + "*END ASSEMBLY")


def contact_as_faces(text):
    """The deck with the contact as a surface of elements with faces, S1 to S4."""
    on = re.search(r"\*NSET, NSET=CONTACT\n(.*?)(?=\*|$)", text, re.DOTALL)
    nodes = {word.strip() for word in on[1].replace("\n", ",").split(",")}
    kind, rows = re.search(r"\*ELEMENT, TYPE=(\w+)\n(.*?)(?=\*)", text, re.DOTALL).groups()
    count, faces = 3 if kind in ("CPS3", "CPS6") else 4, ""
    for row in rows.strip().split("\n"):
        label, *corners = [word.strip() for word in row.split(",")][: count + 1]
        for side in range(count):
            if {corners[side], corners[(side + 1) % count]} <= nodes:
                faces += f"{label}, S{side + 1}\n"
    return text.replace(on[0], f"*SURFACE, NAME=CONTACT, TYPE=ELEMENT\n{faces}")


SAME = {
    "a surface of faces": contact_as_faces,
    "an instance moves the part": lambda t: in_part(moved_nodes(t, back), "0.0004, 0., 0.\n"),
    "an instance turns the part": turned,
    "a *SYSTEM moves the nodes": lambda t: "*SYSTEM\n0.0004, 0., 0.\n" + moved_nodes(t, back),
    "a *SYSTEM turns the nodes": lambda t: "*SYSTEM\n0., 0., 0., 0., 1., 0.\n-1., 0., 0.\n"
    + moved_nodes(t, lambda x, y: (y, -x)),
    "cylindrical nodes": lambda t: moved_nodes(
        t, lambda x, y: (float(np.hypot(x, y)), float(np.degrees(np.arctan2(y, x))))
    ).replace("*NODE", "*NODE, SYSTEM=C"),
    "two parts": with_drum,
    "sets of the assembly": sets_of_the_assembly,
    "names in quotes": lambda t: t.replace("NSET=CONTACT", 'NSET="Contact"'),
    "exponents of Fortran": lambda t: re.sub(r"(\d)e([+-]\d\d)", r"\1D\2", t),
    "a reference point": lambda t: t.replace("*NODE\n", "*NODE\n99999, 0., 0., 0.05\n"),
    "springs and steps": lambda t: t
    + "*ELEMENT, TYPE=SPRINGA, ELSET=S\n99999, 1, 2\n*STEP\n*STATIC\n*CLOAD\n1, 1, 5.\n*END STEP\n",
    "other axes of loads": lambda t: t + "*TRANSFORM, NSET=HINGE\n1., 1., 0., -1., 1., 0.\n",
}  # fmt: skip


def rounded(text, decimals):
    """The deck with coordinates in mm of few decimals."""
    return moved_nodes(text, lambda x, y: (round(1e3 * x, decimals), round(1e3 * y, decimals)))


def straightened(text):
    """The deck with the middle nodes of all sides in the middle of their chords."""
    elements = re.search(r"\*ELEMENT.*?\n(.*?)(?=\*)", text, re.DOTALL)[1]
    nodes = re.findall(r"^(\d+), (\S+), (\S+), 0\.$", text, re.MULTILINE)
    xy = {int(label): np.array([float(x), float(y)]) for label, x, y in nodes}
    for line in elements.strip().split("\n"):
        cell = list(map(int, line.split(",")))[1:]
        for side in range(4):
            # Node 4 + side of an 8-node element lies on the side that begins at corner `side`.
            xy[cell[4 + side]] = (xy[cell[side]] + xy[cell[(side + 1) % 4]]) / 2
    written = "".join(f"{label}, {x!r}, {y!r}, 0.\n" for label, (x, y) in
                      ((k, v.tolist()) for k, v in xy.items()))  # fmt: skip
    return "*NODE\n" + written + text[text.index("*ELEMENT") :]


def every_fifth_cell_cut(text):
    """The deck with every fifth quadrilateral cut into two triangles, with a new label."""
    head, rows, rest = re.split(r"(?<=CPS4\n)(.*?)(?=\*)", text, maxsplit=1, flags=re.DOTALL)
    cells = [list(map(int, line.split(","))) for line in rows.strip().split("\n")]
    cut = cells[::5]
    quads = "".join(", ".join(map(str, cell)) + "\n" for cell in cells if cell not in cut)
    halves = "".join(f"{e}, {a}, {b}, {c}\n{e + 5000}, {a}, {c}, {d}\n" for e, a, b, c, d in cut)
    named = {name: text.split(f"ELSET={name}\n")[1].split("*")[0] for name in ("LINING", "SHOE")}
    for name, labels in named.items():
        inside = {int(word) for word in labels.replace("\n", ",").split(",") if word.strip()}
        more = ", ".join(str(cell[0] + 5000) for cell in cut if cell[0] in inside)
        rest += f"*ELSET, ELSET={name}\n{more}\n"
    return f"{head}{quads}*ELEMENT, TYPE=CPS3\n{halves}{rest}"


def with_corners_in_sets_alone(text):
    """The deck with sets that leave out the middle nodes of quadratic edges."""
    elements = re.search(r"\*ELEMENT.*?\n(.*?)(?=\*)", text, re.DOTALL)[1]
    corners = {w.strip() for line in elements.strip().split("\n") for w in line.split(",")[1:5]}
    head, sets = text[: text.index("*NSET")], text[text.index("*NSET") :]
    kept = "\n".join(
        line if line.startswith("*") else ", ".join(w for w in line.split(", ") if w in corners)
        for line in sets.split("\n")
    )
    return head + kept
