"""From a rough surface to friction: the contact solver of Tamaas, and a file that SurfaceTopography reads.

Only these tests need both.
"""

from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest

POINTS, LENGTH = 128, 32.0
PIXEL = LENGTH / POINTS
YOUNG, POISSON, STRENGTH = 3.0, 0.4, 0.05


def surface(seed: int = 1) -> Any:
    """Heights of a self-affine surface of Hurst exponent 0.8."""
    tamaas = pytest.importorskip("tamaas")
    spectrum = tamaas.Isopowerlaw2D()
    spectrum.q0, spectrum.q1, spectrum.q2, spectrum.hurst = 4, 4, 32, 0.8
    generator = tamaas.SurfaceGeneratorFilter2D([POINTS, POINTS])
    generator.spectrum = spectrum
    generator.random_seed = seed
    heights = np.array(generator.buildSurface())
    return 0.1 * heights / heights.std()


def pressed(heights: Any, pressure: float) -> Any:
    """The pressure of an elastic half-space on a rigid surface (Polonsky, Keer and Rey)."""
    tamaas = pytest.importorskip("tamaas")
    flat = tamaas.model_type.basic_2d
    model = tamaas.ModelFactory.createModel(flat, [LENGTH, LENGTH], list(heights.shape))
    model.E, model.nu = YOUNG, POISSON
    tamaas.PolonskyKeerRey(model, heights, 1e-10).solve(pressure)
    return np.array(model.traction)


def test_a_sphere_has_the_contact_of_hertz() -> None:
    radius, load = 20.0, 2.0
    x = (np.arange(POINTS) + 0.5) * PIXEL - LENGTH / 2.0
    sphere = -(x[:, None] ** 2 + x**2) / (2.0 * radius)
    found = asp.spots(pressed(sphere, load / LENGTH**2), PIXEL)
    assert len(found) == 1
    # The contact solver stops at this part of the load.
    assert found.load.sum() == pytest.approx(load, rel=1e-6)
    # a³ = 3FR/4E*; pixels at the edge, and the periodic images at eight radii.
    contact = (0.75 * load * radius * (1.0 - POISSON**2) / YOUNG) ** (1.0 / 3.0)
    assert found.area[0] == pytest.approx(np.pi * contact**2, rel=0.05)


@pytest.mark.parametrize("options", [{"shear_strength": STRENGTH}, {"local_friction": 0.3}], ids=str)
def test_a_rough_surface_has_friction(options: dict[str, Any]) -> None:
    found = asp.spots(pressed(surface(), 0.02), PIXEL)
    assert len(found) > 10
    # The contact solver stops at this part of the load.
    assert found.load.sum() + found.dropped.load == pytest.approx(0.02 * LENGTH**2, rel=1e-6)
    contacts = found.contacts(E=YOUNG, nu=POISSON, **options)
    assert contacts.thresholds is not None
    pull = asp.MasterEquation(contacts, tolerance=1e-8).pull(4.0 * contacts.thresholds.mean(), 21)
    strength = STRENGTH * found.area.sum() if "shear_strength" in options else 0.3 * found.load.sum()
    # The smooth distribution of thresholds keeps the mean of spots to this.
    assert pull.kinetic_friction == pytest.approx(0.5 * strength, rel=1e-3)
    # Areas vary less than loads, some of which are near 0: then the force rises to F_k without a maximum.
    assert (pull.static_friction is not None) == ("shear_strength" in options)
    if pull.static_friction is not None:
        assert 0.5 * strength < pull.static_friction.force < strength
        assert 0.0 < pull.critical_stiffness < np.inf
    sample = asp.Ensemble(contacts, size=50_000, seed=3).pull(pull.distance, 21)
    # One of 20 positions exceeds 4 standard errors in 1 of 800 cases; the seed is fixed.
    assert np.all(np.abs(sample.force - pull.force)[1:] < 4.0 * sample.force_error[1:])


def test_a_file_of_a_measured_surface_leads_to_friction(tmp_path: Path) -> None:
    topography = pytest.importorskip("SurfaceTopography")
    path = tmp_path / "scan.xyz"
    heights = surface(seed=2)
    rows, columns = np.indices(heights.shape)
    np.savetxt(path, np.c_[PIXEL * rows.ravel(), PIXEL * columns.ravel(), heights.ravel()])
    scan = topography.read_topography(str(path))
    assert scan.nb_grid_pts == heights.shape
    read = np.asarray(scan.heights())
    # The file has its numbers in decimals.
    np.testing.assert_allclose(read, heights, rtol=1e-9)
    found = asp.spots(pressed(np.ascontiguousarray(read), 0.02), PIXEL)
    contacts = found.contacts(E=YOUNG, nu=POISSON, shear_strength=STRENGTH)
    friction = asp.MasterEquation(contacts).steady_state().kinetic_friction
    # The smooth distribution of thresholds keeps the mean of spots to this.
    assert friction == pytest.approx(0.5 * STRENGTH * found.area.sum(), rel=1e-3)
