"""Contact spots from maps of pressure, and the contacts made of them."""

from typing import Any, Literal

import asperity as asp
import numpy as np
import pytest


def sphere(points: int, radius: float, at: tuple[float, float]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Hertz's pressure √(1 - r²/a²) under a sphere, on a periodic map of pixels of side 1."""
    x, y = (np.arange(points) + 0.5 - place for place in at)
    x, y = ((d + points / 2) % points - points / 2 for d in (x, y))
    return np.sqrt(np.maximum(1.0 - (x[:, None] ** 2 + y**2) / radius**2, 0.0))


def test_a_hertz_contact() -> None:
    found = asp.spots(3.0 * sphere(256, 60.0, (128.0, 128.0)), pixel=0.5)
    # πa² and (2/3)πa²p_0; the error is that of the pixels at the edge.
    assert found.area == pytest.approx([np.pi * 30.0**2], rel=2e-3)
    assert found.load == pytest.approx([2.0 * np.pi * 30.0**2], rel=1e-3)
    assert found.centre == pytest.approx(np.array([[64.0, 64.0]]), abs=1e-9)
    assert found.dropped == (0, 0.0, 0.0)
    contacts = found.contacts(E=2.0, nu=0.3, shear_strength=0.1)
    # Mindlin: k = 8Ga/(2 - ν); all spots are one, so that the threshold is a point.
    shear = 2.0 / (2.0 * 1.3)
    stiffness = 8.0 * shear * 30.0 / 1.7
    assert contacts.thresholds is not None
    # The pixels at the edge.
    assert contacts.thresholds.mean() == pytest.approx(0.1 * np.pi * 30.0**2 / stiffness, rel=2e-3)
    assert contacts.thresholds.std() == 0.0
    assert contacts.normal_load == pytest.approx(2.0 * np.pi * 30.0**2, rel=1e-3)


def test_a_spot_across_edges_is_one() -> None:
    corner = sphere(64, 10.0, (0.0, 0.0)) + sphere(64, 6.0, (32.0, 63.0))
    found = asp.spots(corner, pixel=1.0)
    assert len(found) == 2
    # Pixels at the edge of a circle of radius 6: an area of some per cent.
    assert found.area == pytest.approx([np.pi * 100.0, np.pi * 36.0], rel=0.03)
    # The angle of the first is 0, or 2π but for rounding.
    folded = np.minimum(found.centre, 64.0 - found.centre)
    assert folded == pytest.approx(np.array([[0.0, 0.0], [32.0, 1.0]]), abs=1e-6)
    assert len(asp.spots(corner, pixel=1.0, periodic=False)) == 6
    assert sorted(np.unique(found.labels)) == [0, 1, 2]


@pytest.mark.parametrize("moved", [(0, 0), (0, 12), (-6, 3), (-8, -5)])
def test_the_centre_is_that_of_pressure_on_a_periodic_map(moved: tuple[int, int]) -> None:
    pressure = np.zeros((16, 16))
    pressure[4, 0:9] = np.arange(1.0, 10.0)
    # A hook, whose parts are connected through two edges and within the map.
    pressure[5, 8] = pressure[6, 8] = pressure[6, 7] = 20.0
    (expected,) = asp.spots(pressure, 0.5, periodic=False).centre
    (found,) = asp.spots(np.roll(pressure, moved, (0, 1)), 0.5).centre
    assert found == pytest.approx((expected + 0.5 * np.array(moved)) % 8.0, abs=1e-12)


def test_a_row_has_its_centre_of_pressure() -> None:
    pressure = np.zeros((16, 16))
    pressure[4, 0:9] = np.arange(1.0, 10.0)
    assert asp.spots(pressure, 1.0).centre[0] == pytest.approx([4.5, 35.0 / 6.0], abs=1e-12)


def test_a_spot_in_many_parts_has_one_centre() -> None:
    # A comb, cut by the edges into its teeth and its back when it is moved.
    pressure = np.zeros((24, 24))
    pressure[6:8, 3:20] = 2.0
    pressure[8:17, 3:20:4] = 1.0
    pressure[16, 11:15] = 3.0
    (expected,) = asp.spots(pressure, 1.0, periodic=False).centre
    for rows in range(24):
        for columns in range(24):
            (found,) = asp.spots(np.roll(pressure, (rows, columns), (0, 1)), 1.0).centre
            off = (found - expected - (rows, columns) + 12.0) % 24.0 - 12.0
            assert off == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_spot_around_the_map_has_no_centre_there() -> None:
    pressure = np.zeros((16, 16))
    pressure[3:5] = 1.0
    pressure[5, 2] = 4.0
    pressure[8:10, 15] = pressure[8:10, 0] = 1.0
    found = asp.spots(pressure, 1.0)
    assert found.centre == pytest.approx(np.array([[4.0 + 6.0 / 36.0, np.nan], [9.0, 0.0]]), nan_ok=True)
    # A band along the diagonal goes around along both axes.
    diagonal = np.eye(16) + np.roll(np.eye(16), 1, 0)
    assert np.isnan(asp.spots(diagonal, 1.0).centre).all()
    # A spot with a hole, across all edges, does not go around.
    ring = np.zeros((16, 16))
    ring[4:9, 4:9] = 1.0
    ring[6, 6] = 0.0
    assert asp.spots(np.roll(ring, (-6, -7), (0, 1)), 1.0).centre == pytest.approx(np.array([[0.5, 15.5]]))


def rough(points: int = 256, seed: int = 1) -> Any:
    """The part of a random self-affine surface above a height, as if it were a pressure."""
    wave = 2 * np.pi * np.hypot(*np.meshgrid(*2 * [np.fft.fftfreq(points)]))
    amplitude = np.maximum(wave, 0.1) ** -1.8
    noise = np.fft.fft2(np.random.default_rng(seed).standard_normal((points, points)))
    surface = np.fft.ifft2(amplitude * noise).real
    return np.maximum(surface - np.quantile(surface, 0.93), 0.0)


def test_kinetic_friction_is_half_of_what_spots_bear() -> None:
    found = asp.spots(rough(), pixel=0.25)
    assert found.dropped.number > 0
    total = found.area.sum() + found.dropped.area
    assert total == pytest.approx(0.25**2 * np.count_nonzero(rough()), rel=1e-12)
    for options, forces in (
        ({"shear_strength": 0.05}, 0.05 * found.area),
        ({"shear_strength": 0.05, "stiffness": "equal"}, 0.05 * found.area),
        ({"local_friction": 0.4}, 0.4 * found.load),
        ({"local_friction": 0.4, "stiffness": "area"}, 0.4 * found.load),
    ):
        contacts = found.contacts(E=2.0, nu=0.4, **options)
        steady = asp.MasterEquation(contacts).steady_state()
        # Moments of the estimate are those of the spots to the truncation of its series.
        assert steady.kinetic_friction == pytest.approx(0.5 * forces.sum(), rel=1e-8)


def test_spots_as_an_ensemble() -> None:
    contacts = asp.spots(rough(), pixel=0.25).contacts(E=2.0, nu=0.4, shear_strength=0.05)
    assert contacts.thresholds is not None
    distance = 3.0 * contacts.thresholds.mean()
    exact = asp.MasterEquation(contacts, tolerance=1e-8).pull(distance, points=21)
    sample = asp.Ensemble(contacts, size=100_000, seed=3).pull(distance, points=21)
    # Deviations of 16 seeds are standard normal (rms 0.98); one of 20 points is beyond 4 in 10⁻³ of runs.
    assert np.all(np.abs(sample.force - exact.force)[1:] < 4.0 * sample.force_error[1:])


def test_large_spots_are_stiffer_than_small_ones_of_the_same_threshold() -> None:
    found = asp.spots(rough(), pixel=0.25)
    contacts = found.contacts(E=2.0, nu=0.4, local_friction=0.4, stiffness="area", spots="present")
    assert contacts.stiffness_of_threshold is not None
    threshold, stiffness = contacts.stiffness_of_threshold
    each = 8.0 * (2.0 / 2.8) * np.sqrt(found.area / np.pi) / 1.6
    sample = 0.4 * found.load / each
    # Some ten spots: kernels are wide, and the factor that keeps kinetic friction is 1.05.
    assert np.interp(sample, threshold, stiffness).mean() == pytest.approx(each.mean(), rel=0.1)
    assert min(threshold) == pytest.approx(sample.min())
    assert max(threshold) == pytest.approx(sample.max())
    quenched = asp.Ensemble(contacts, size=2000, seed=1, disorder="quenched").pull(5.0, points=6)
    assert np.all(np.isfinite(quenched.force))
    # Where all spots have one threshold, as one spot has, stiffnesses are equal.
    one = asp.spots(sphere(64, 10.0, (32.0, 32.0)), 1.0)
    assert one.contacts(E=1.0, nu=0.3, local_friction=1.0, stiffness="area").stiffness is not None


WHICH: tuple[Literal["new", "present"], ...] = ("new", "present")


def test_present_spots_are_larger_than_new_ones() -> None:
    found = asp.spots(rough(), pixel=0.25)
    new, present = (
        found.contacts(E=2.0, nu=0.4, shear_strength=0.05, spots=which).thresholds for which in WHICH
    )
    assert new is not None
    assert present is not None
    # ⟨x⟩ of present spots is ⟨x²⟩/⟨x⟩ of new ones.
    assert present.mean() == pytest.approx(new.moment(2) / new.mean(), rel=1e-8)


@pytest.mark.parametrize(
    ("pressure", "message"),
    [
        (np.ones(9), r"two dimensions, got the shape \(9,\)"),
        (np.array([[0.0, np.nan], [1.0, 1.0]]), "got nan"),
        (np.array([[0.0, -1.0], [1.0, 1.0]]), "got -1"),
        (np.zeros((8, 8)), "contact in some pixels, got it in no pixel"),
        (np.ones((8, 8)), "contact in some pixels, got it in all pixels"),
        (np.eye(8), "a spot of 4 pixels or more, got 1 at most"),
    ],
)
def test_bad_maps_are_refused(pressure: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        asp.spots(pressure, 1.0, periodic=False)


def test_bad_materials_are_refused() -> None:
    found = asp.spots(sphere(64, 10.0, (32.0, 32.0)), 1.0)
    with pytest.raises(TypeError, match="either shear_strength or local_friction, got neither"):
        found.contacts(E=1.0, nu=0.3)
    with pytest.raises(TypeError, match="got both"):
        found.contacts(E=1.0, nu=0.3, shear_strength=1.0, local_friction=1.0)
    with pytest.raises(ValueError, match="nu: expected a Poisson's ratio"):
        found.contacts(E=1.0, nu=0.6, shear_strength=1.0)
    with pytest.raises(ValueError, match="E: expected a number above 0"):
        found.contacts(E=0.0, nu=0.3, shear_strength=1.0)
    with pytest.raises(ValueError, match='stiffness: expected "area" or "equal"'):
        found.contacts(E=1.0, nu=0.3, local_friction=1.0, stiffness="load")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="pressure: expected an array of numbers, got str"):
        asp.spots("x", 1.0)
    with pytest.raises(ValueError, match="pixel"):
        asp.spots(sphere(64, 10.0, (32.0, 32.0)), 0.0)


@pytest.mark.parametrize("kind", [complex, np.complex64])
def test_complex_pressures_are_refused(kind: Any) -> None:
    pressure = sphere(64, 10.0, (32.0, 32.0)).astype(kind)
    with pytest.raises(
        TypeError, match="pressure: expected an array of numbers, got ndarray of dtype complex"
    ):
        asp.spots(pressure, 1.0)
    with pytest.raises(TypeError, match="pressure: expected an array of numbers, got list"):
        asp.spots(pressure.tolist(), 1.0)


@pytest.mark.parametrize("pixel", [True, np.True_])
def test_a_pixel_is_a_number(pixel: Any) -> None:
    with pytest.raises(TypeError, match="pixel: expected a number, got bool"):
        asp.spots(sphere(64, 10.0, (32.0, 32.0)), pixel)


@pytest.mark.parametrize(
    ("pixel", "pressure"),
    # Squares beyond the largest and below the smallest number, loads and sums that are.
    [(1e200, 1.0), (1e-200, 1.0), (1e150, 1e100), (1e-150, 1e-100), (1e153, 1.0)],
)
def test_areas_and_loads_are_finite_and_above_0(pixel: float, pressure: float) -> None:
    values = pressure * sphere(64, 10.0, (32.0, 32.0))
    with pytest.raises(ValueError, match=r"pixel: expected a length for which areas and loads are finite"):
        asp.spots(values, pixel)


def test_a_pixel_beyond_all_numbers_is_refused() -> None:
    with pytest.raises(ValueError, match="pixel: expected a number in range"):
        asp.spots(sphere(64, 10.0, (32.0, 32.0)), 10**400)


@pytest.mark.parametrize("pixel", [1e140, 1e-140])
def test_extreme_pixels_scale_areas_and_loads(pixel: float) -> None:
    values = sphere(64, 10.0, (32.0, 32.0))
    one, found = asp.spots(values, 1.0), asp.spots(values, pixel)
    # A square and a product are rounded.
    assert found.area / pixel / pixel == pytest.approx(one.area, rel=1e-14)
    assert found.load / pixel / pixel == pytest.approx(one.load, rel=1e-14)
