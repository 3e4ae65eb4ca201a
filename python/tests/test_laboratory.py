"""Records of experiments: files, motions of the load point, and what is read from them."""

import csv
import os
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest
from scipy.optimize import curve_fit

TEXT = """# made up
Time (s),Displ (µm),Shear stress [MPa],Normal stress [MPa]
0,0,0.5,1
1,2,0.6,1
2,4,0.7,1
"""


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
def test_columns_and_units(tmp_path: Path, separator: str) -> None:
    text = TEXT if separator != " " else TEXT.replace(" (", "(").replace(" [", "[").replace(" s", "_s")
    path = tmp_path / "record.txt"
    path.write_text(text.replace(",", separator), encoding="utf-8")
    record = asp.read_laboratory(path)
    np.testing.assert_array_equal(record.displacement, [0.0, 2.0, 4.0])
    np.testing.assert_array_equal(record.force, [0.5, 0.6, 0.7])
    assert record.normal is not None
    np.testing.assert_array_equal(record.normal, 1.0)
    assert [record.units[record.roles[role]] for role in ("time", "displacement", "force")] == [
        "s",
        "µm",
        "MPa",
    ]
    assert "displacement 0 to 4 µm" in repr(record)
    np.testing.assert_array_equal(record[1:].time, [1.0, 2.0])
    np.testing.assert_array_equal(record.average(2).force, [0.55])


def test_columns_by_name(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text("t,a,b\n0,1,2\n1,2,3\n", encoding="utf-8")
    record = asp.read_laboratory(path, displacement="a", force="b")
    np.testing.assert_array_equal(record.force, [2.0, 3.0])
    assert record.normal is None


@pytest.mark.parametrize(
    ("options", "newtons", "name"),
    [
        ({}, 1.0, "Force"),
        ({"force": "Force"}, 1.0, "Force"),
        ({"force": "Force (N)"}, 1.0, "Force"),
        ({"force": "Force (lbf)"}, 0.2248, "Force 2"),
    ],
)
def test_columns_of_one_name(tmp_path: Path, options: dict[str, Any], newtons: float, name: str) -> None:
    path = tmp_path / "record.csv"
    path.write_text("Time (s),Displ (mm),Force (N),Force (lbf)\n0,0,1,0.2248\n1,1,1,0.2248\n")
    record = asp.read_laboratory(path, **options)
    np.testing.assert_array_equal(record.force, newtons)
    assert record.roles["force"] == name
    assert record.units == {"Time": "s", "Displ": "mm", "Force": "N", "Force 2": "lbf"}
    np.testing.assert_array_equal(record.columns["Force 2"], 0.2248)


def test_equal_headings_and_numbered_ones(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text("t,slip,force,force,force 2\n0,1,2,3,4\n")
    record = asp.read_laboratory(path)
    found = {name: float(values[0]) for name, values in record.columns.items()}
    assert found == {"t": 0.0, "slip": 1.0, "force": 2.0, "force 3": 3.0, "force 2": 4.0}


@pytest.mark.parametrize(
    ("heading", "options", "expected"),
    [
        (
            "Time,Normal displacement,Shear displacement,Shear stress,Normal stress",
            {},
            {"displacement": 2, "force": 3, "normal": 4},
        ),
        ("Time (s),Slip rate (um/s),Slip (um),Shear rate,Mu", {}, {"displacement": 2, "force": 4}),
        ("time,slip (mm s-1),slip (µm/s),slip (mm),force", {}, {"displacement": 3, "force": 4}),
        ("time,Load point velocity,LP_Disp,Shear strain,Shear stress", {}, {"displacement": 2, "force": 4}),
        ("time,slip,Normal force,Normalised shear stress", {}, {"displacement": 1, "force": 3, "normal": 2}),
        # What is asked for has the role, and no other one.
        (
            "time,Normal displacement,slip,force",
            {"displacement": "Normal displacement"},
            {"displacement": 1, "force": 3},
        ),
        ("time,slip,Normal force,force", {"force": "Normal force"}, {"displacement": 1, "force": 2}),
        ("time,slip rate,force", {"displacement": "slip rate"}, {"displacement": 1, "force": 2}),
    ],
)
def test_roles_exclude_each_other(
    tmp_path: Path, heading: str, options: dict[str, Any], expected: dict[str, int]
) -> None:
    path = tmp_path / "record.csv"
    number = ",".join(str(place) for place in range(heading.count(",") + 1))
    path.write_text(f"{heading}\n{number}\n{number}\n", encoding="utf-8")
    record = asp.read_laboratory(path, **options)
    places = {role: int(record.columns[name][0]) for role, name in record.roles.items()}
    assert places == {"time": 0, **expected}


def test_a_normal_displacement_is_no_displacement_of_the_load_point(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text("time,Normal displacement,force\n0,1,2\n1,1,2\n")
    with pytest.raises(ValueError, match=r"expected a column for displacement \(displacement=...\), got"):
        asp.read_laboratory(path)


def test_files_of_other_programs(tmp_path: Path) -> None:
    text = "Machine 3\nrun;7\nZeit (s);Displ (µm);Shear stress (MPa)\n0,5;1;-2,5e-1\n1,5;3;0,75\n"
    path = tmp_path / "record.txt"
    path.write_text(text, encoding="latin-1")
    options: dict[str, Any] = {"skip": 2, "decimal": ",", "time": "Zeit"}
    with pytest.raises(ValueError, match=r"expected text in UTF-8, got a byte that is none at .*; encoding"):
        asp.read_laboratory(path, **options)
    record = asp.read_laboratory(path, **options, encoding="latin-1")
    np.testing.assert_array_equal(record.time, [0.5, 1.5])
    np.testing.assert_array_equal(record.displacement, [1.0, 3.0])
    np.testing.assert_array_equal(record.force, [-0.25, 0.75])
    assert record.units["Displ"] == "µm"


@pytest.mark.parametrize(
    ("line", "units"),
    [
        ("s,[mm],(kN)", {"Time": "s", "Displ": "mm", "Force": "kN"}),
        ("s,nanometre,", {"Time": "s", "Displ": "nanometre"}),
    ],
)
def test_units_in_a_line_of_their_own(tmp_path: Path, line: str, units: dict[str, str]) -> None:
    path = tmp_path / "record.csv"
    path.write_text(f"Time,Displ,Force\n{line}\n0,1,2\n1,2,3\n", encoding="utf-8")
    record = asp.read_laboratory(path)
    np.testing.assert_array_equal(record.force, [2.0, 3.0])
    assert record.units == units


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("", {}, "expected a heading and readings, got 0 lines"),
        ("1,2\n3,4\n", {}, "expected a heading that names the columns, got numbers"),
        ("time,slip\n0,1\n", {}, r"expected a column for force \(force=...\), got time, slip"),
        ("time,slip,force\n0,1\n", {}, "line 2: expected 3 values, got 2"),
        ("time,slip,force\n0,1,x\n", {}, "line 2: expected a finite number, got 'x'"),
        ("time,slip,force\n\n0,1,nan\n", {}, "line 3: expected a finite number, got 'nan'"),
        ("time;slip;force\n0;1;0,5\n", {}, "line 2: expected a finite .* '0,5'; decimal=\",\" reads decimal"),
        ("time;slip;force\n0;1;1.000,5\n", {"decimal": ","}, "line 2: expected a finite .* got '1.000,5'"),
        ("time,slip,force\ns,mm,N\n", {}, "expected a heading and readings, got no readings"),
        ("a\ntime,slip,force\n0,1,2\n", {}, "line 1: expected a heading of several columns, got 'a'; skip"),
        (TEXT, {"decimal": "x"}, r"decimal: expected '.' or ',', got 'x'"),
        (TEXT, {"skip": -1}, "skip: expected a number of lines, 0 or above, got -1"),
        (TEXT, {"encoding": "none"}, "encoding: expected one such as 'latin-1', got 'none'"),
        (TEXT, {"force": "torque"}, "force: expected one of the columns Time .*, got 'torque'"),
    ],
)
def test_bad_files_are_refused(tmp_path: Path, text: str, options: dict[str, Any], message: str) -> None:
    path = tmp_path / "record.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        asp.read_laboratory(path, **options)


@pytest.mark.parametrize(
    ("heading", "time"),
    [("T (°C),Time (s)", "Time"), ("T,Time (s)", "Time"), ("T (°C),t (s)", "t"), ("other,T", "T")],
)
def test_a_temperature_is_no_time(tmp_path: Path, heading: str, time: str) -> None:
    path = tmp_path / "record.csv"
    path.write_text(f"{heading},slip,force\n20,0,1,2\n21,1,2,2\n", encoding="utf-8")
    read = asp.read_laboratory(path)
    assert read.roles["time"] == time
    np.testing.assert_array_equal(read.time, [0.0, 1.0])


def test_a_file_that_is_no_text_in_utf_8_is_named(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_bytes("time,slip (µm),force\n0,1,2\n".encode("latin-1"))
    with pytest.raises(ValueError, match=r"record.csv: expected text in UTF-8, got a byte that is none at"):
        asp.read_laboratory(path)


def test_a_record_without_readings_is_shown() -> None:
    short = record([(1.0, 10)])
    assert "no readings" in repr(short[5:5])
    with pytest.raises(ValueError, match="count: expected a number of readings from 1 to 10, got 11"):
        short.average(11)


def record(pieces: list[tuple[float, int]], force: Any = None) -> asp.LaboratoryRecord:
    """A record of ten readings a second at these velocities, with noise of the displacement."""
    velocities = np.concatenate([np.full(count, velocity) for velocity, count in pieces])
    displacement = 100.0 + np.cumsum(0.1 * velocities)
    noise = 0.05 * np.random.default_rng(1).normal(size=displacement.size)
    time = 50.0 + 0.1 * np.arange(displacement.size)
    columns: dict[str, Any] = {
        "time": time,
        "displacement": displacement + noise,
        "force": np.ones_like(time) if force is None else force(displacement - 100.0),
    }
    return asp.LaboratoryRecord(columns, roles={name: name for name in columns})


def test_a_hold_is_one_hold(tmp_path: Path) -> None:
    # Without noise, roundings of a position at rest differ from those of the last one before it moves again.
    time = np.arange(0.0, 60.0, 0.05)
    place = np.where(time < 20.0, time, np.where(time < 40.0, 20.0, 20.0 + 2.0 * (time - 40.0)))
    rows = np.c_[time, place, np.ones_like(time)]
    names = "time (s),displacement (um),force (N)"
    np.savetxt(tmp_path / "rest.csv", rows, delimiter=",", header=names, comments="")
    motions = asp.read_laboratory(tmp_path / "rest.csv").motions()
    assert [motion.kind for motion in motions] == ["forward", "hold", "forward"]
    assert [motion.stop for motion in motions[:-1]] == [motion.start for motion in motions[1:]]
    # Lines of the parts meet at the true times, to the rounding of the readings in the file.
    assert [motion.begin for motion in motions] == pytest.approx([0.0, 20.0, 40.0], abs=1e-6)
    assert motions[1].velocity == pytest.approx(0.0, abs=1e-9)


def test_motions_cycles_and_protocols() -> None:
    made = record([(1.0, 400), (0.0, 600), (10.0, 300), (-5.0, 300), (5.0, 300)])
    motions = made.motions()
    assert [motion.kind for motion in motions] == ["forward", "hold", "forward", "backward", "forward"]
    for motion, velocity in zip(motions, [1.0, 0.0, 10.0, -5.0, 5.0], strict=True):
        assert motion.velocity == pytest.approx(velocity, abs=5.0 * motion.error)
    # Lines meet where the velocity changes, to the noise over the change of velocity.
    assert [motion.begin for motion in motions] == pytest.approx([50.0, 89.9, 149.9, 179.9, 209.9], abs=0.03)
    # Boundaries are known to some readings.
    assert [len(cycle) for cycle in made.cycles()] == pytest.approx([1600, 300], abs=5)
    with pytest.raises(ValueError, match=r"moves forwards, got -[45]"):
        made.protocol()
    steps = made[:1300].protocol()
    assert [sorted(step) for step in steps] == [["duration", "velocity"], ["hold"], ["duration", "velocity"]]
    assert steps[1]["hold"] == pytest.approx(60.0, abs=1.0)
    asp.run(
        {
            "contacts": {
                "thresholds": {"gaussian": {"mean": 20.0, "std": 2.0}},
                "ageing": {"logarithmic": {"growth": 0.02, "time": 1.0}},
            },
            "protocol": steps,
        }
    )


def test_a_velocity_step_is_read_from_a_record() -> None:
    a, b, distance = 0.008, 0.012, 8.0

    def force(x: Any) -> Any:
        x = x - 80.0
        follows = 1.0 - np.exp(-np.maximum(x, 0.0) / distance)
        step = 0.6 + np.log(10.0) * np.where(x < 0.0, 0.0, a - b * follows)
        return step + 1e-4 * np.random.default_rng(2).normal(size=x.size)

    made = record([(1.0, 800), (10.0, 200)], force)
    found = made.velocity_step(peak=0.0, noise="white")
    for one, truth in ((found.a, a), (found.b, b), (found.distance, distance)):
        # Five times the usual error, besides that of the place of the step, 0.05 of 8.
        assert one.value == pytest.approx(truth, abs=5.0 * one.error + 0.02 * truth)
    with pytest.raises(ValueError, match="one of the 1 velocity steps, from 0 on, got 1"):
        made.velocity_step(1)
    with pytest.raises(
        ValueError, match="motions: expected two forward motions, one after the other, got forward"
    ):
        made.velocity_step(motions=made.motions()[:1])


@pytest.mark.skipif(not os.environ.get("ASPERITY_LAB_DATA"), reason="ASPERITY_LAB_DATA is not set")
@pytest.mark.parametrize(
    ("name", "velocities", "average", "weakens"),
    [
        ("velstep3_TR2_exp013_sepiolite.txt", (0.2, 2.0), 20, False),
        ("velstep4_BRAVA_expb819_basalt.txt", (3.0, 10.0), 10, True),
    ],
)
def test_steps_of_a_laboratory(
    name: str, velocities: tuple[float, float], average: int, weakens: bool
) -> None:
    path = Path(os.environ["ASPERITY_LAB_DATA"]) / "velocity-steps-giacomel-2024" / name
    made = asp.read_laboratory(path)
    motions = made.motions()
    assert [motion.kind for motion in motions] == ["forward", "forward"]
    # Of the nominal velocities, as the README of the data gives them.
    assert [motion.velocity for motion in motions] == pytest.approx(velocities, rel=0.03)
    found = made.velocity_step(before=100.0, after=300.0, average=average)
    # The numbers of docs/time.md, to the digits that it shows.
    if weakens:
        assert [round(one.value, 4) for one in (found.a, found.b, found.a_minus_b)] == [
            0.0075,
            0.0075,
            -0.0001,
        ]
        assert [round(found.distance.value, 1), round(found.distance.error, 1)] == [6.6, 0.5]
        assert round(found.peak, 1) == 7.6
    else:
        assert [round(found.a_minus_b.value, 3), round(found.a_minus_b.error, 3)] == [0.015, 0.001]
        white = made.velocity_step(before=100.0, after=300.0, average=average, noise="white")
        assert [round(one.distance.value) for one in (found, white)] == [15, 47]


def loadings() -> tuple[list[list[float]], list[list[float]]]:
    """Times since an event and stresses (MPa) at both ends of each loading between events of a catalogue."""
    folder = Path(os.environ["ASPERITY_LAB_DATA"]) / "stick-slip-events-okubo-2025"
    with (folder / "Macroscopic_stats_FB03_087.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    time, before, after = (
        [float(row[name]) for row in rows]
        for name in (
            "event_starttime[s]",
            "macroshearstress_beforeevent[MPa]",
            "macroshearstress_afterevent[MPa]",
        )
    )
    events = range(len(rows) - 1)
    return (
        [[0.0, time[i + 1] - time[i]] for i in events],
        [[after[i], before[i + 1]] for i in events],
    )


@pytest.mark.skipif(not os.environ.get("ASPERITY_LAB_DATA"), reason="ASPERITY_LAB_DATA is not set")
def test_loadings_between_events_of_a_laboratory_are_fitted_together() -> None:
    """55 curves of two readings each: the stress that the last event has left is a number of each of them,
    the loading is common. Against least squares on the rises, in which the stresses left cancel.
    """
    times, stresses = loadings()
    wait, rise = np.diff(times)[:, 0], np.diff(stresses)[:, 0]
    left = [f"curve.{cycle}.offset" for cycle in range(len(times))]
    # Contacts that hold throughout: a loading in proportion to the time.
    holding = asp.Contacts(asp.Gaussian(1e3, 10.0), stiffness=0.01)
    line = asp.fit(holding, times, stresses, free=["stiffness", *left], noise="white")
    slope = float(wait @ rise / (wait @ wait))
    error = float(np.sqrt(np.sum((rise - slope * wait) ** 2) / (len(wait) - 1) / (wait @ wait)))
    rate = line.params["stiffness"]
    # The search ends within a thousandth of an error; errors are those of its end, of a logarithm.
    assert rate.value == pytest.approx(slope, abs=1e-2 * error)
    assert rate.error == pytest.approx(error, rel=1e-2)
    # Contacts that break: exponential thresholds of mean m, and stretches 0 after an event, so that
    # F = k m (1 - exp(-x/m)).
    breaking = asp.Contacts(asp.Exponential(2.0), stiffness=0.01)
    names = ["stiffness", "thresholds.mean"]
    found = asp.fit(breaking, times, stresses, free=[*names, *left], noise="white")
    values, covariance = curve_fit(lambda x, k, m: k * m * (1.0 - np.exp(-x / m)), wait, rise, p0=(0.01, 2.0))
    for name, value, width in zip(names, values, np.sqrt(np.diag(covariance)), strict=True):
        assert found.params[name].value == pytest.approx(value, abs=1e-2 * width), name
        assert found.params[name].error == pytest.approx(width, rel=1e-2), name
    # The stress left is that at both ends less the fitted rise, on the mean.
    k, m = values
    stress = np.mean(stresses, axis=1) - 0.5 * k * m * (1.0 - np.exp(-wait / m))
    estimates = [found.params[name].value for name in left]
    assert estimates == pytest.approx(stress, abs=1e-2 * found.reading)
    assert line.misfit is not None
    assert found.misfit is not None
    # Numbers of the page "What a curve cannot tell", to half of their last digits.
    reported = [*rate[:2], *found.params["stiffness"][:2], *found.params["thresholds.mean"][:2]]
    digits = [1e-5, 1e-5, 1e-4, 1e-4, 1e-2, 1e-2]
    for number, page, digit in zip(
        reported, [0.00445, 0.00021, 0.0188, 0.0018, 1.12, 0.12], digits, strict=True
    ):
        assert number == pytest.approx(page, abs=0.5 * digit)
    assert line.misfit.akaike - found.misfit.akaike == pytest.approx(308, abs=0.5)
    # Two readings with an offset of their own have opposite residuals, which show nothing of the errors.
    assert found.misfit.whiteness == 1.0
    assert not found.misfit.unlikely
    # The same by the scenario.
    result = asp.run(
        {
            "contacts": {"thresholds": {"exponential": {"mean": 2.0}}, "stiffness": 0.01},
            "fit": {
                "noise": "white",
                "free": [
                    "contacts.stiffness",
                    "contacts.thresholds.exponential.mean",
                    *(f"fit.{name}" for name in left),
                ],
                "curve": [
                    {"position": at, "force": stress} for at, stress in zip(times, stresses, strict=True)
                ],
            },
        }
    )
    keyed = [number["value"] for number in result.summary["fit"]["numbers"]]
    assert keyed == [one.value for one in found.params.values()]
