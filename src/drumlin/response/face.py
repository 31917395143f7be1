"""The pressure over arc and width of a lining and its peak, from the response of a solid model."""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.response.response import Response, length_of_edge_zone_left_out_of_peak_search
from drumlin.response.resultants import (
    LiningWithoutEndZones,
    length_of_edge_zone_left_out_of_pressure_errors,
)
from drumlin.response.show import BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH


class PressureOnFaceOfLining(NamedTuple):
    """The pressure p(theta, z) on the face of a lining, and its peak.

    Over theta the pressure is a piecewise polynomial of the same degree as in the shoe's response.
    Its mean over z with the weights `widths` is the pressure of the shoe's response.

    Attributes
    ----------
    shoe : name of the shoe
    theta : (n,) growing angles of the nodes [rad], on a plane their places x [m]
    z : (m,) growing coordinates across the width, 0 at the mid-plane [m]
    pressure : (n, m) pressures [Pa]
    widths : (m,) width of the lining that each z stands for [m]
    peak : largest pressure [Pa] at the distances z, without the edge zones at the lining's ends
    peak_theta : angle of the peak [rad], on a plane its place [m]
    peak_z : distance of the peak from the mid-plane [m], which is not negative
    error : estimated relative error of p(theta, z); None, since it is not known
    """

    shoe: str
    theta: Floats
    z: Floats
    pressure: Floats
    widths: Floats
    peak: float
    peak_theta: float
    peak_z: float
    error: float | None = None

    @property
    def mean_pressure_over_width(self) -> Floats:
        """The mean (n,) [Pa] of the pressure over the width, as in the shoe's response."""
        return np.asarray(self.pressure @ self.widths / self.widths.sum())


def pressure_on_face_of_lining(
    brake: Brake, response: Response, index: int
) -> PressureOnFaceOfLining | None:
    """The pressure on the face of the lining of shoe `index`, from the response of a solid model.

    The result is None for a shoe that does not touch, and for a model in plane stress.

    Parameters
    ----------
    brake : the brake
    response : response of the brake by a solid model, whose shoes have widths
    index : position of the shoe in the brake
    """
    answer, shoe = response.shoes[index], brake.shoes[index]
    if answer.surface is None:
        return None
    z, pressure, widths = answer.surface
    theta = answer.theta
    zone = length_of_edge_zone_left_out_of_pressure_errors(
        theta,
        answer.pressure,
        answer.order,
        length_of_edge_zone_left_out_of_peak_search(shoe, brake.length_per_surface_coordinate),
    )
    lining = LiningWithoutEndZones(theta, answer.order, zone)
    half = np.arange(len(z) // 2, len(z))
    peaks = [lining.largest_value_outside_end_zones(pressure[:, column]) for column in half]
    at = int(half[int(np.argmax(peaks))])
    # The angle of the peak is the angle of the highest point on the pressure curve at the z of the
    # peak.
    points, curve = answer.pressure_curve_at_distance_from_mid_plane(at)
    inside = (points >= theta[0] + zone) & (points <= theta[-1] - zone)
    return PressureOnFaceOfLining(
        answer.name,
        theta,
        z,
        pressure,
        widths,
        peak=float(max(peaks)),
        peak_theta=float(points[inside][curve[inside].argmax()]),
        peak_z=float(z[at]),
    )


def peak_pressures_over_width_as_line(brake: Brake, response: Response) -> str:
    """The peak pressures over arc and width as one line of text; "" for a plane-stress model.

    The line has no entry for a shoe that does not touch.
    """
    shown, unit, peaks = brake.surface.si_to_shown_unit_factor, brake.surface.shown_unit, []
    for i in range(len(response.shoes)):
        face = pressure_on_face_of_lining(brake, response, i)
        if face is not None:
            # Adding 0.0 turns a negative zero into a zero without sign.
            at = f"{face.peak_theta * shown + 0.0:.1f} {unit}"
            place = f"at {at}, {face.peak_z * 1e3:.1f} mm from the mid-plane"
            peaks.append(f"{face.shoe} {face.peak * 1e-6:.4g} MPa {place}")
    if not peaks:
        return ""
    return f"{BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH} {'; '.join(peaks)}; its error is not known"
