"""Heat as a load: warm parts grow, and bend if one of their faces is hotter than the other.

Each part has a `temperature_rise` at its face towards the friction surface, and may have another
rise at its far face. The temperature is linear over the thickness of the part. drumlin solves no
heat equation: the temperatures are data. A heated lining or shoe has free strains, which the finite
elements take as a load. A heated drum or ring grows evenly around, so that its growth is a gap.
"""

from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drumlin.brake.components import BeamBody, Drum, DrumRing, Lining
from drumlin.brake.fields import IsotropicOrOrthotropicMaterial, OrthotropicMaterial
from drumlin.brake.units import length_as_text_in_mm

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake, Shoe


def temperature_rises_at_both_faces(part: Any) -> tuple[float, float]:
    """Temperature rises [K] of a part at its face towards the friction surface and at its far face.

    The far face is as warm as the near face if the part has no `back_temperature_rise`.
    """
    near, far = part.temperature_rise, part.back_temperature_rise
    return near, near if far is None else far


def is_part_heated(part: Any) -> bool:
    """Whether a part is warmer or colder than when it was made, on at least one of its faces."""
    return part is not None and any(temperature_rises_at_both_faces(part))


class HeatedLayer(NamedTuple):
    """A heated layer of a shoe: its lining, its backing or its body.

    Attributes
    ----------
    key : key of the part in the shoe, "lining", "backing" or "body"
    part : the part
    depths : distances [m] of the layer's near face and far face from the friction surface
    """

    key: str
    part: Any
    depths: tuple[float, float]

    @property
    def material(self) -> IsotropicOrOrthotropicMaterial | None:
        """The material of the layer; None if the brake file gives none."""
        material: IsotropicOrOrthotropicMaterial | None = self.part.material
        return material

    def free_thermal_strains_at_depths(self, depth: Any) -> Any:
        """Thermal strains (2, ...) along and through the layer if nothing held it.

        `depth` (...) are distances [m] from the friction surface.
        """
        rise = np.interp(depth, self.depths, temperature_rises_at_both_faces(self.part))
        material = self.material
        # `check_thermal_expansion_of_shoes_is_known` has refused heated parts without coefficients.
        assert material is not None
        return np.array([material.expansion_along * rise, material.expansion_through * rise])


def heated_layers_of_shoe(shoe: "Shoe") -> Iterator[HeatedLayer]:
    """Give the heated layers of a shoe, from the friction surface into the shoe."""
    depth = 0.0
    for key, part in (("lining", shoe.lining), ("backing", shoe.backing), ("body", shoe.body)):
        if part is None:
            continue
        thickness = getattr(part, "total_thickness", part.thickness) or 0.0
        if is_part_heated(part):
            yield HeatedLayer(key, part, (depth, depth + thickness))
        depth += thickness


def check_thermal_expansion_of_shoes_is_known(shoes: Sequence["Shoe"]) -> None:
    """Raise ValueError for a heated part whose expansion is not known or cannot be modelled."""
    for i, shoe in enumerate(shoes):
        for layer in heated_layers_of_shoe(shoe):
            _check_thermal_expansion_of_layer_is_known(f"shoe[{i}].{layer.key}", shoe, layer)


def _check_thermal_expansion_of_layer_is_known(key: str, shoe: "Shoe", layer: HeatedLayer) -> None:
    """Raise ValueError if a heated layer lacks a coefficient of expansion, or cannot be modelled.

    `key` is the key of the layer in the brake file, for the message.
    """
    material = layer.material
    near, far = temperature_rises_at_both_faces(layer.part)
    if material is None or material.expansion_along is None or material.expansion_through is None:
        keys = "expansion_along and expansion_through" * isinstance(material, OrthotropicMaterial)
        raise ValueError(
            f"{key}.temperature_rise = {near:g} K: its material needs {keys or 'expansion'}, "
            f'such as "12e-6 1/K"'
        )
    # Temperatures vary with the distance from the friction surface. In a straight beam, or in the
    # web of a mesh, this distance does not tell how far a point is from the near face.
    if layer.key == "body" and near != far and (isinstance(layer.part, BeamBody) or shoe.mesh):
        shape = "the body of a mesh" if shoe.mesh else "a straight beam"
        raise ValueError(
            f"{key}.back_temperature_rise = {far:g} K: {shape} has one temperature; leave it out"
        )
    if layer.key == "backing" and near != far and isinstance(shoe.body, BeamBody) and shoe.mesh:
        raise ValueError(
            f"{key}.back_temperature_rise = {far:g} K: the block of a mesh before a straight beam "
            "has one temperature; leave it out"
        )


def check_thermal_expansion_of_drum_is_known(drum: Drum) -> None:
    """Raise ValueError for a heated drum whose expansion is not known, or cannot be modelled."""
    if not is_part_heated(drum):
        return
    near, far = temperature_rises_at_both_faces(drum)
    if drum.ring is None and near != far:
        raise ValueError(
            f"drum.back_temperature_rise = {far:g} K: a rigid drum has one temperature; "
            "give it a ring, or leave the key out"
        )
    if drum.ring is not None and drum.ring.section is None:
        raise ValueError(f"drum.temperature_rise = {near:g} K: needs drum.ring.thickness")
    if isinstance(_ring_material(drum.ring), OrthotropicMaterial):
        raise ValueError(
            f"drum.temperature_rise = {near:g} K: the growth of an orthotropic ring is not modelled"
        )
    if _thermal_expansion_coefficient_of_drum(drum) is None:
        raise ValueError(
            f'drum.temperature_rise = {near:g} K: needs drum.expansion, such as "11e-6 1/K"'
        )


def _ring_material(ring: DrumRing | None) -> IsotropicOrOrthotropicMaterial | None:
    """The material of an elastic ring; None if there is no ring or its material is unknown."""
    return None if ring is None else ring.material


def _thermal_expansion_coefficient_of_drum(drum: Drum) -> float | None:
    """Thermal expansion of the drum [1/K]: the drum's own value, or that of the ring's material."""
    material = _ring_material(drum.ring)
    if drum.expansion is None and material is not None:
        return material.expansion_along
    return drum.expansion


def radial_growth_of_heated_drum(drum: Drum, sign: int) -> float:
    """Growth [m] of the radius of the friction surface by the heat of the drum.

    A rigid drum grows by alpha T R. A ring of the radii a < b in plane stress has the displacement

        u(r) = alpha (1 + nu)/r Int_a^r T s ds + C_1 r + C_2/r

    (Timoshenko & Goodier, Theory of Elasticity, section 150: thermal stresses in a circular disk).
    The constants C_1 and C_2 follow from the two edges: the friction surface has no radial stress,
    and a free far edge has no radial stress either, while a fixed far edge has no displacement.

    Parameters
    ----------
    drum : the drum with its temperatures
    sign : +1 for a drum around its shoes, -1 for a drum within its shoes
    """
    if not is_part_heated(drum):
        return 0.0
    alpha, R = _thermal_expansion_coefficient_of_drum(drum), drum.radius
    near, far = temperature_rises_at_both_faces(drum)
    # `check_thermal_expansion_of_drum_is_known` has refused a heated drum without the coefficient.
    assert alpha is not None
    if drum.ring is None:
        return alpha * near * R
    section = drum.ring.section
    assert section is not None
    edge, nu = R + sign * section.thickness, section.material.nu_along_through
    # `heat` is the integral of T s ds from the friction surface at R to the far edge, T linear.
    span = edge - R
    heat = span * ((near + far) / 2 * R + span * (near + 2 * far) / 6)
    # The integral begins at R, so that the first term of u is zero at the friction surface.
    # The radial stress is E/(1 - nu^2) ((1 + nu) C_1 - (1 - nu) C_2/r^2) - E alpha/r^2 Int T s ds.
    free_face = [1 + nu, -(1 - nu) / R**2]
    if drum.ring.support == "fixed":
        far_edge, right = [edge, 1 / edge], -alpha * (1 + nu) / edge * heat
    else:
        far_edge, right = [1 + nu, -(1 - nu) / edge**2], alpha * (1 - nu**2) / edge**2 * heat
    C_1, C_2 = np.linalg.solve([free_face, far_edge], [0.0, right])
    return float(C_1 * R + C_2 / R)


def brake_with_heat_only_in_given_parts(brake: "Brake", keys: Collection[str]) -> "Brake":
    """A copy of a brake in which only some parts are heated.

    All other parts are as warm as when they were made.

    Parameters
    ----------
    brake : the brake
    keys : the parts that keep their temperatures: "drum", and "lining", "backing" and "body" of all
        shoes; without keys the whole brake is cold
    """
    cold = {"temperature_rise": 0.0, "back_temperature_rise": None}
    shoes = []
    for shoe in brake.shoes:
        parts = {}
        for layer in heated_layers_of_shoe(shoe):
            if layer.key not in keys:
                # A shoe with several linings has one part "lining" here. The copy is cold in all of
                # them.
                part = layer.part
                is_lining = isinstance(part, Lining)
                changed = (
                    part.copy_of_lining_with_changed_fields(cold)
                    if is_lining
                    else part.model_copy(update=cold)
                )
                parts[layer.key] = changed
        shoes.append(shoe.model_copy(update=parts))
    changes: dict[str, Any] = {"shoes": tuple(shoes)}
    drum = getattr(brake, "drum", None)
    if drum is not None and "drum" not in keys:
        changes["drum"] = drum.model_copy(update=cold)
    return brake.model_copy(update=changes)


def names_of_heated_parts(brake: "Brake") -> list[str]:
    """The names of the heated parts of a brake, as "drum" or "lining of shoes 'left', 'right'"."""
    drum = ["drum"] if is_part_heated(getattr(brake, "drum", None)) else []
    shoes: dict[str, list[str]] = {}
    for shoe in brake.shoes:
        for layer in heated_layers_of_shoe(shoe):
            shoes.setdefault(layer.key, []).append(repr(shoe.name))
    return drum + [
        f"{key} of shoe{'s' * (len(names) > 1)} {', '.join(names)}" for key, names in shoes.items()
    ]


def note_on_heated_parts_of_brake(brake: "Brake") -> str | None:
    """Note on the heated parts and the drum's growth, for results that include heat.

    It is None for a brake without heated parts.
    """
    names = names_of_heated_parts(brake)
    if not names:
        return None
    line = f"note: heated: {'; '.join(names)}"
    if names[0] == "drum":
        growth = brake.out_of_round_harmonics[-1].amplitude
        line += f"; the drum's radius grows by {length_as_text_in_mm(growth)}"
    return line


def warning_that_law_neglects_heat(brake: "Brake") -> str | None:
    """Warning that names the heated parts, for results of closed-form laws, which neglect heat.

    It is None for a brake without heated parts.
    """
    names = "; ".join(names_of_heated_parts(brake))
    return f"warning: left out is the heat of {names}; --model fem has it" if names else None


def is_any_shoe_heated(brake: "Brake") -> bool:
    """Whether the lining, backing or body of any shoe is heated."""
    return any(True for shoe in brake.shoes for _ in heated_layers_of_shoe(shoe))


def reason_if_any_shoe_is_heated(brake: "Brake", model: str) -> str | None:
    """Why a model that takes no heated shoes does not apply to a brake; None if it applies."""
    for shoe in brake.shoes:
        for layer in heated_layers_of_shoe(shoe):
            rise = next(filter(None, temperature_rises_at_both_faces(layer.part)))
            return (
                f"shoe {shoe.name!r}: {layer.key}.temperature_rise = {rise:g} K; "
                f"{model} takes no heated shoes"
            )
    return None
