"""Interfaces that deform: what they are made of, their catalogues, and runs that are stopped and go on."""

import pickle
from datetime import timedelta
from pathlib import Path
from typing import Any, Literal

import asperity as asp
import numpy as np
import pytest

CONTACTS = asp.Contacts(thresholds=asp.Gaussian(1.0, 0.1))
WEAK = [0.7] * 6 + [1.0] * 24
OFC = Path(__file__).parents[2] / "scenarios" / "ofc.toml"


def lattice() -> asp.Lattice:
    return asp.Lattice(CONTACTS, [8, 8], asp.Rectangular(0.0, 0.5), neighbours=0.2, connection=0.2, seed=3)


def test_a_drive_of_a_lattice_is_that_of_its_scenario() -> None:
    result = lattice().drive(3.0, 4, maps=[1.0], catalogue_from=0.5)
    scenario = asp.run(
        {
            "contacts": CONTACTS,
            "initial": asp.Rectangular(0.0, 0.5),
            "interface": {
                "cells": [8, 8],
                "contacts": "one",
                "coupling": {"neighbours": {"stiffness": 0.2}},
                "connection": 0.2,
                "catalogue_from": 0.5,
            },
            "drive": {"distance": 3.0, "points": 4, "maps": [1.0]},
            "ensemble": {"seed": 3},
        }
    )
    assert list(result) == list(scenario)
    for name in result:
        np.testing.assert_array_equal(result[name], scenario[name])
    assert result.events is not None
    assert len(result.events) == result.summary["catalogue"]["events"]
    assert result.events["drive"][0] >= 0.5
    assert result.events[0]._fields == tuple(name[6:] for name in result if name.startswith("event_"))
    assert result["cell_force"].shape == (1, 8, 8)


def test_one_cell_is_a_block() -> None:
    cell = asp.Interface(
        CONTACTS, [1], neighbours=1.0, connection=1.0, slip="overdamped", drive_tolerance=1e-10
    )
    events = cell.drive(2.0, 5).events
    block = asp.Block(asp.MasterEquation(CONTACTS), stiffness=1.0, slip="overdamped").drive(2.0)
    assert events is not None
    # Cells and block find the same loss of balance, one on tabulated curves of force.
    np.testing.assert_allclose(events["drive"], block.events["drive"], rtol=0, atol=1e-8)
    np.testing.assert_allclose(events["position_after"], block.events["position_after"], rtol=0, atol=1e-8)


def test_a_cell_of_few_contacts_is_a_block_over_their_ensemble() -> None:
    cell = asp.Interface(
        CONTACTS,
        [1],
        neighbours=1.0,
        connection=0.5,
        slip="overdamped",
        drive_tolerance=1e-12,
        size=20,
        seed=4,
        quenched=True,
    )
    events = cell.drive(8.0, 5).events
    ensemble = asp.Ensemble(CONTACTS, size=20, seed=4, disorder="quenched")
    block = asp.Block(ensemble, stiffness=0.5, slip="overdamped", slip_fraction=0.01).drive(8.0)
    assert events is not None
    assert len(events) > 20
    # Both add the same positions in another order.
    np.testing.assert_allclose(events["drive"], block.events["drive"], rtol=0, atol=1e-10)


@pytest.mark.parametrize("slip", ["reset", "overdamped"])
def test_stretches_of_a_cell_carry_its_force(slip: Any) -> None:
    contacts = asp.Contacts(thresholds=asp.Gaussian(1.0, 0.1), reforming=asp.Rectangular(0.0, 0.2))
    chain = asp.Interface(contacts, [3], neighbours=0.5, connection=0.5, slip=slip, disorder=[1.0, 0.9, 1.2])
    forces = chain.drive(2.7, 2)["cell_force"][-1]
    stretches = np.arange(0.0, 2.0, 1e-4)
    for cell in range(3):
        found = chain.stretch_density(cell, stretches, at=2.7)
        assert not isinstance(found.atoms, list)
        force = np.sum(found.density * stretches) * 1e-4 + np.sum(found.atoms.weight * found.atoms.position)
        # A jump of the density of some 5 that falls between two stretches.
        np.testing.assert_allclose(force, forces[cell], rtol=0, atol=5e-4)
    with pytest.raises(ValueError, match="cell: expected a number below 3, got 3"):
        chain.stretch_density(3, stretches, at=2.7)
    with pytest.raises(ValueError, match="at: expected a finite drive, 0 or above, got -1"):
        chain.stretch_density(0, stretches, at=-1.0)
    assert chain.stretch_density(0, stretches, at=0.0).density.shape == stretches.shape
    with pytest.raises(ValueError, match="edges: expected None where contacts follow the master equation"):
        chain.stretch_density(0, edges=[0.0, 1.0], at=1.0)


def test_few_contacts_of_a_cell_are_atoms_or_counted_in_bins() -> None:
    contacts = asp.Contacts(thresholds=asp.Gaussian(1.0, 0.1), reforming=asp.Rectangular(0.0, 0.2))
    chain = asp.Interface(contacts, [2], neighbours=0.5, connection=0.5, slip="overdamped", size=50)
    force = chain.drive(2.7, 2)["cell_force"][-1][1]
    atoms = chain.stretch_density(1, [0.5], at=2.7).atoms
    assert not isinstance(atoms, list)
    np.testing.assert_allclose(np.sum(atoms.weight * atoms.position), force, rtol=0, atol=1e-12)
    edges = np.linspace(0.0, 2.0, 21)
    binned = chain.stretch_density(1, edges=edges, at=2.7)
    counted, _ = np.histogram(atoms.position, edges, weights=atoms.weight)
    np.testing.assert_allclose(binned.density * np.diff(edges), counted, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "interface",
    [
        lattice(),
        asp.Interface(CONTACTS, [4], neighbours=2.0, connection=0.5, disorder=0.1, seed=2, slip="overdamped"),
        asp.Interface(
            CONTACTS, [4, 4], half_space=(2.0, 1.0), connection=0.5, edges="periodic", viscosity=1.0
        ),
        asp.Interface(
            CONTACTS, [3, 4], half_space=(2.0, 1.0), poisson_ratio=0.3, sliding="rows", connection=0.5
        ),
        asp.Interface(CONTACTS, [2], neighbours=2.0, connection=0.5, disorder=[1.0, 0.9], loading="edge"),
        asp.Interface(CONTACTS, [3], neighbours=2.0, connection=0.5, areas=[1.0, 4.0, 0.5]),
        asp.Interface(
            CONTACTS, [4], neighbours=2.0, connection=0.5, slip="overdamped", size=5, seed=3, quenched=True
        ),
    ],
)
def test_interfaces_are_their_descriptions(interface: asp.Deformable) -> None:
    assert pickle.loads(pickle.dumps(interface)) == interface
    assert interface.replace() == interface
    assert type(interface)(**interface.parameters) == interface
    assert interface.replace(connection=3.0) != interface
    assert interface.contacts == CONTACTS


def test_the_direction_of_sliding_turns_with_the_lattice() -> None:
    """Rows and columns may change places; with Poisson's ratio they are not the same."""
    scales = 1.0 + 0.2 * np.sin(np.arange(24.0) ** 2).reshape(4, 6)

    def forces(scales: np.ndarray, sliding: Literal["columns", "rows"]) -> np.ndarray:
        interface = asp.Interface(
            CONTACTS, list(scales.shape), half_space=(2.0, 1.0), poisson_ratio=0.4, sliding=sliding,
            connection=0.3, disorder=scales.ravel(), slip="overdamped",
        )  # fmt: skip
        assert (interface.poisson_ratio, interface.sliding) == (0.4, sliding)
        return interface.drive(4.0, points=41).force

    along, turned, across = forces(scales, "rows"), forces(scales.T, "columns"), forces(scales, "columns")
    # The accuracy of the drive at which cells begin to slip.
    assert np.max(np.abs(along - turned)) < 1e-6 * np.max(along)
    assert np.max(np.abs(along - across)) > 1e-4 * np.max(along)


def test_cells_with_a_mass_carry_waves_and_slip() -> None:
    """Fronts are slower than waves, cells swing back, and energies add up."""
    chain = asp.Interface(
        CONTACTS, [30], neighbours=25.0, connection=0.2, mass=0.25, viscosity=0.15, disorder=WEAK
    )
    assert (chain.mass, chain.wave_speed, chain.slip) == (0.25, 10.0, None)
    result = chain.drive(4.5, velocity=1e-3, slip_rates=2000)
    assert result.events is not None
    assert result.events["cells"].max() == 30
    assert result.summary["catalogue"]["wave_speed"] == 10.0
    assert 0.0 < result.summary["catalogue"]["front_speed"] < 10.0
    assert result["slip_rate"].min() < 0.0
    followed = chain.follow([asp.Step(1e-3, distance=4.5)])
    assert followed.events is not None
    # Steps end at other points of output, and are right to 1e-4.
    assert followed.events["drive"] == pytest.approx(result.events["drive"], abs=1e-4)
    simulation = chain.simulation(velocity=1e-3)
    simulation.advance(4.5)
    energy = simulation.energy
    assert energy.kinetic >= 0.0
    assert abs(energy.imbalance) < 1e-3 * energy.work
    with pytest.raises(ValueError, match=r"drive\.velocity: expected a velocity above 0"):
        chain.drive(4.5)
    with pytest.raises(ValueError, match=r"interface\.slip: expected none beside interface\.mass"):
        asp.Interface(CONTACTS, [30], neighbours=25.0, connection=0.2, mass=0.25, slip="overdamped")


def test_cells_of_contacts_that_age_slip_as_a_block_does() -> None:
    ageing = asp.Logarithmic(growth=0.02, time=1.0)
    contacts = asp.Contacts(thresholds=asp.Gaussian(1.0, 0.2), ageing=ageing)
    aged = asp.Interface(contacts, [3], neighbours=1e5, connection=0.2, slip="overdamped", viscosity=0.1)
    result = aged.drive(8.0, points=9, velocity=1e-2)
    block = asp.Block(asp.Transport(contacts, tolerance=1e-4), 0.2, asp.Damped(0.1))
    slips = block.drive(8.0, points=9, velocity=1e-2).events
    assert result.events is not None
    assert len(result.events) == len(slips) > 0
    np.testing.assert_array_equal(result.events["cells"], 3)
    # Both to the accuracy of a step, and the cells to their distances of some 1e-5.
    np.testing.assert_allclose(result.events["drive"], slips["drive"], atol=4e-4)
    np.testing.assert_allclose(result.events["drop"], 3 * slips["drop"], atol=1.2e-3)
    np.testing.assert_allclose(result["time"], 100 * result["drive"])
    with pytest.raises(ValueError, match="velocity: expected a velocity above 0"):
        aged.drive(8.0)
    with pytest.raises(ValueError, match=r"interface\.viscosity: expected a viscosity above 0"):
        asp.Interface(contacts, [3], neighbours=1.0, connection=0.2, slip="overdamped")


@pytest.mark.parametrize("size", [None, 500])
def test_stretches_of_a_cell_in_time_carry_its_force(size: int | None) -> None:
    contacts = asp.Contacts(thresholds=asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.05, time=1.0))
    chain = asp.Interface(
        contacts,
        [3],
        neighbours=0.5,
        connection=0.5,
        slip="overdamped",
        viscosity=0.5,
        disorder=[1.0, 0.9, 1.2],
        size=size,
    )
    force = chain.drive(2.7, 2, velocity=1e-2)["cell_force"][-1, 2]
    at: dict[str, Any] = {"at": 2.7, "velocity": 1e-2}
    edges = np.linspace(0.0, 2.4, 481)
    binned = chain.stretch_density(2, edges=edges, **at)
    np.testing.assert_allclose(binned.stretch, 0.5 * (edges[1:] + edges[:-1]))
    np.testing.assert_allclose(np.sum(binned.density) * 0.005, 1.0, rtol=1e-12)
    # Stretches are known to half a bin, and to the way of a cohort's birth.
    np.testing.assert_allclose(np.sum(binned.density * binned.stretch) * 0.005, force, rtol=0, atol=5e-3)
    found = chain.stretch_density(2, edges, **at)
    assert not isinstance(found.atoms, list)
    if size is None:
        np.testing.assert_allclose(np.sum(found.density) * 0.005 + found.atoms.weight.sum(), 1.0, atol=5e-3)
    else:
        assert found.atoms.weight.size == size
        np.testing.assert_array_equal(found.density, 0.0)
        np.testing.assert_allclose(np.sum(found.atoms.weight * found.atoms.position), force, rtol=1e-12)
    refused: list[tuple[dict[str, Any], str]] = [
        ({"cell": 3, "edges": edges}, "cell: expected a number below 3, got 3"),
        ({"cell": 0}, "stretches: expected either stretches or edges, got neither"),
        ({"cell": 0, "edges": [1.0]}, "edges: expected two finite edges of bins or more"),
        ({"cell": 0, "edges": edges, "velocity": None}, "drive.velocity: expected a velocity above 0"),
    ]
    for arguments, message in refused:
        with pytest.raises(ValueError, match=message):
            chain.stretch_density(**{**at, "at": 0.1, **arguments})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"cells": [0]}, "interface.cells: expected .length."),
        ({"connection": 0.0}, "interface.connection: expected a number above 0"),
        ({"half_space": (1.0, 1.0)}, "neighbours: expected either neighbours or half_space, got both"),
        (
            {"neighbours": None, "half_space": (1.0, 1.0), "poisson_ratio": 0.5},
            "interface.coupling.half_space.poisson_ratio: expected a number from -0.9 to 0.48, got 0.5",
        ),
        ({"poisson_ratio": 0.3}, "neighbours: expected half_space beside poisson_ratio and sliding"),
        (
            {"neighbours": None, "half_space": (1.0, 1.0), "sliding": "up"},
            "sliding: expected one of columns and rows",
        ),
        ({"edges": "loose"}, "edges: expected one of open and periodic"),
        ({"disorder": [1.0, -1.0]}, "interface.disorder.scale.1: expected a number above 0, got -1"),
        (
            {"cells": [200], "disorder": 5.0},
            "interface.disorder.std: expected scales that leave all thresholds above 0",
        ),
        ({"areas": [1.0]}, "interface.areas: expected 2 areas, one for each cell, got 1"),
        ({"areas": [1.0, 0.0]}, "interface.areas.1: expected a number above 0, got 0"),
        ({"areas": [np.nan, 1.0]}, "interface.areas.0: expected a number above 0, got NaN"),
        (
            {"neighbours": None, "half_space": (1.0, 1.0), "areas": [1.0, 2.0]},
            "interface.areas: expected none beside coupling.half_space",
        ),
        ({"viscosity": 0.0}, "interface.viscosity: expected a number above 0"),
        ({"size": 10}, "interface.slip: expected .overdamped. beside .ensemble."),
        ({"quenched": True}, "quenched: expected False without a size"),
    ],
)
def test_what_makes_no_interface_is_refused(arguments: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"cells": [2], "neighbours": 1.0, "connection": 1.0}
    with pytest.raises(ValueError, match=message):
        asp.Interface(CONTACTS, **(good | arguments))


def test_areas_multiply_the_forces_of_cells_and_are_relative_to_their_mean() -> None:
    areas = np.array([6.0, 2.0, 1.0])
    chain = asp.Interface(CONTACTS, [3], neighbours=0.5, connection=0.5, areas=areas, slip="overdamped")
    assert chain.areas is not None
    np.testing.assert_array_equal(chain.areas, areas)
    assert asp.Interface(CONTACTS, [3], neighbours=0.5, connection=0.5).areas is None
    record = chain.drive(8.0, 81)
    # Springs and contacts of all cells are proportional to their areas, so that they move together, as a
    # cell of mean area.
    single = asp.Interface(CONTACTS, [1], neighbours=0.5, connection=0.5, slip="overdamped").drive(8.0, 81)
    expected = np.outer(single["cell_force"][:, 0], areas / areas.mean())
    # To the accuracy of the drive at which balance is lost, as forces fall there.
    np.testing.assert_allclose(record["cell_force"], expected, rtol=0, atol=1e-5)
    np.testing.assert_allclose(record["event_area"], 3.0, rtol=1e-12)
    np.testing.assert_allclose(record["event_moment"], 3.0 * record["event_slip"], rtol=1e-9)


@pytest.mark.parametrize("every", ["0.01s", timedelta(milliseconds=10)])
def test_checkpoints_come_by_time_too(tmp_path: Path, every: str | timedelta) -> None:
    seen = False

    def look(fraction: float) -> None:
        nonlocal seen
        seen = seen or (tmp_path / "ofc.checkpoint.0").exists()

    # Longer than many times the time between checkpoints, and than that between two calls of look.
    asp.run(OFC, folder=tmp_path / "ofc", checkpoint=every, progress=look)
    assert seen
    assert [path.name for path in tmp_path.iterdir()] == ["ofc"]


@pytest.mark.parametrize(
    "every", [0, -1, 2**64, "0", "10m", "", timedelta(0), timedelta(seconds=-1), timedelta.max]
)
def test_what_is_no_interval_of_checkpoints_is_refused(tmp_path: Path, every: int | str | timedelta) -> None:
    with pytest.raises(
        ValueError, match="checkpoint: expected a number of events above 0, or a time such as 90s, 10min"
    ):
        asp.run(OFC, folder=tmp_path / "ofc", checkpoint=every)
    with pytest.raises(
        TypeError, match="checkpoint: expected a number of events, a timedelta or text, got float"
    ):
        asp.run(OFC, folder=tmp_path / "ofc", checkpoint=2.5)  # type: ignore[arg-type]


def ageing_chain(start: Any = "conditional", **more: Any) -> asp.Interface:
    contacts = asp.Contacts(thresholds=asp.Gaussian(1.0, 0.25), ageing=asp.Logarithmic(growth=0.04, time=1.0))
    return asp.Interface(
        contacts,
        [3],
        neighbours=1.0,
        connection=200.0,
        slip="overdamped",
        viscosity=1.0,
        start=start,
        **more,
    )


def test_an_interface_slides_steadily_from_the_start_and_heals_in_a_hold() -> None:
    steps = [asp.Step(0.1, distance=0.2, points=3), asp.Step(hold=1e3, points=3), asp.Step(0.1, distance=1.5)]
    result = ageing_chain("steady").follow(steps, slip_rates=50)
    steady = asp.MasterEquation(ageing_chain().contacts, velocity=0.1).steady_state().kinetic_friction
    # The tolerance, 1e-4 by default, for three cells.
    np.testing.assert_allclose(result["force"][:3], 3 * steady, atol=3e-4)
    assert result["drive"][0] == pytest.approx((steady + 0.1) / 200, abs=1e-4)
    # A rigid slider over the same contacts, but for the stiffness of the machine.
    rigid = asp.Transport(ageing_chain().contacts, start="steady", velocity=0.1).follow(steps)
    assert result["force"].max() / 3 == pytest.approx(rigid["force"].max(), abs=2e-3)
    assert result["force"].max() / 3 > steady + 0.1
    assert result["slip_rate"].shape == (len(result["slip_rate_time"]), 3)
    assert 25 <= len(result["slip_rate_time"]) <= 50
    assert result["slip_rate"][0] == pytest.approx([0.1, 0.1, 0.1])
    assert result["map_time"].tolist() == result["time"].tolist()


def test_the_drive_of_an_interface_starts_in_steady_sliding() -> None:
    result = ageing_chain("steady", disorder=[0.9, 1.0, 1.2]).drive(0.5, 6, velocity=0.1, tolerance=1e-4)
    # The tolerance of the solution, for a difference of two forces of cells, with a factor for scales.
    np.testing.assert_allclose(result["cell_force"] - result["cell_force"][0], 0.0, atol=4e-4)
    np.testing.assert_allclose(np.diff(result["drive"]), 0.1)
    simulation = ageing_chain("steady").simulation(velocity=0.1)
    assert simulation.drive > 0.0
    # The tolerance of the solution for each of three cells.
    assert simulation.force == pytest.approx(3 * 0.58699, abs=1e-3)


def test_what_does_not_follow_steps_is_refused() -> None:
    steps = [asp.Step(0.1, distance=0.2)]
    with pytest.raises(ValueError, match=r"protocol: expected \[drive\] where contacts are not"):
        lattice().follow(steps)
    with pytest.raises(ValueError, match="velocity: expected a velocity above 0 in the first step"):
        ageing_chain("steady").follow([asp.Step(hold=1.0)])
    with pytest.raises(ValueError, match="ensemble: expected no ensemble of time-dependent contacts"):
        ageing_chain("steady", size=100).follow(steps)
    with pytest.raises(ValueError, match="steps: expected at least one step"):
        ageing_chain().follow([])
    with pytest.raises(ValueError, match="slip_rates"):
        ageing_chain().follow(steps, slip_rates=1)


def test_a_run_that_was_stopped_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "ofc"

    def stop(fraction: float) -> None:
        if fraction > 0.5:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        asp.run(OFC, folder=folder, checkpoint=1000, progress=stop)
    assert not folder.exists()
    with pytest.raises(FileExistsError, match="unfinished"):
        asp.run(OFC, folder=folder, checkpoint=1000)
    with pytest.raises(ValueError, match=r"interface.connection = 0.3.*interface.connection = 0.2"):
        asp.run(OFC, {"interface.connection": 0.3}, folder=folder, resume=True)
    resumed, whole = asp.run(OFC, folder=folder, checkpoint=1000, resume=True), asp.run(OFC)
    for name in whole:
        np.testing.assert_array_equal(resumed[name].view(np.uint64), whole[name].view(np.uint64))
    assert [path.name for path in tmp_path.iterdir()] == ["ofc"]
    with pytest.raises(ValueError, match="folder: expected one"):
        asp.run(OFC, resume=True)
    with pytest.raises(
        ValueError,
        match=r"checkpoint: expected a scenario of \[drive\] or \[\[protocol\]\] with \[interface\]",
    ):
        asp.run(OFC.with_name("fig2.toml"), folder=tmp_path / "pull", checkpoint=10)


def warm_lattice() -> asp.Lattice:
    contacts = asp.Contacts(
        asp.Gaussian(1.0, 0.1),
        temperature=asp.Temperature(0.02, 1.0, barrier="bell"),
        ageing=asp.Logarithmic(growth=0.02, time=1.0),
        count=400,
    )
    return asp.Lattice(contacts, [20, 20], asp.Rectangular(0.0, 0.5), neighbours=0.23, connection=0.08)


def test_a_lattice_in_time_has_times_and_ages() -> None:
    result = warm_lattice().drive(5.0, 51, velocity=1e-3, main_shocks=(20, 100.0, 5))
    events = result.events
    assert events is not None
    # X = vt, to rounding.
    np.testing.assert_allclose(events["drive"], 1e-3 * events["time"], rtol=1e-12)
    np.testing.assert_allclose(result["drive"], 1e-3 * result["time"], rtol=1e-12, atol=1e-15)
    assert (events["age"] <= events["time"]).all()
    shocks = result.summary["catalogue"]["main_shocks"]
    assert shocks["count"] > 0
    assert shocks["size"] == 20
    assert len(result["aftershock_rate"]) == len(result["foreshock_rate"]) == len(result["shock_time"])
    with pytest.raises(ValueError, match="velocity"):
        warm_lattice().drive(5.0)
    with pytest.raises(TypeError, match="main_shocks: expected a tuple"):
        warm_lattice().drive(5.0, velocity=1.0, main_shocks=20)  # type: ignore[arg-type]


def test_a_lattice_in_time_follows_protocols_and_rests() -> None:
    followed = warm_lattice().follow([asp.Step(1e-2, distance=2.0), asp.Step(hold=1e3)])
    simulation = warm_lattice().simulation(velocity=1e-2)
    simulation.advance(2.0)
    kept = simulation.state()
    simulation.hold(1e3)
    # Sums of a base and what follows it.
    np.testing.assert_allclose(simulation.drive, 2.0, rtol=1e-15)
    np.testing.assert_allclose(simulation.time, 1200.0, rtol=1e-12)
    events = followed.events
    assert events is not None
    # Contacts break thermally at rest, too.
    assert (events["time"] > 200.0).any()
    np.testing.assert_allclose(simulation.force, followed["force"][-1], rtol=1e-9)
    simulation.restore(kept)
    np.testing.assert_allclose([simulation.time, simulation.velocity], [200.0, 1e-2], rtol=1e-12)
    assert simulation.velocities.shape == (20, 20)
