"""The constants of linear elasticity that stiffnesses and stresses are computed with."""


def plane_stress(E: float, nu: float) -> tuple[float, float]:
    """Lamé's constants of plane stress: E nu/(1 - nu^2), E/(2 (1 + nu)) [Pa]."""
    return E * nu / (1 - nu**2), E / (2 * (1 + nu))
