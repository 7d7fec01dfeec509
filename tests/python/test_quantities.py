# SPDX-License-Identifier: Apache-2.0
"""astropy: units wherever a quantity is taken, dates, and periods of light curves."""
import math
import os
import re
import subprocess

import astropy.units as u
import numpy as np
import pytest
from astropy.time import Time

import clray
from clray._units import seconds, unit_of

TURN_S = 37.0


def digest(*given, **more):
    return clray.trace(clray.scene(*given, **more), device="cpu").digest


def rows(listed):
    """Keys of a list of the program, with what it says of them."""
    return dict(re.findall(r"^ +([a-z]\w*)  +(.*)$", listed, re.M))


def test_a_scene_with_units_is_the_scene_without():
    plain = {
        "reference_point": [0.01, 0.0, 0.0],
        "material": {"name": "paint", "model": "lambert", "rho": 0.3},
        "component": [{"shape": "sphere", "radius": 0.5, "transform": {"translate": [0.1, 0.2, 0.0], "angle_deg": 90.0}},
                      {"shape": "box", "size": [1.0, 0.2, 0.3],
                       "hinge": {"axis": [0, 0, 1], "point": [0.0, 0.5, 0.0], "angle_deg": 30.0}}],
        "source": {"kind": "sun", "bands": [[400.0, 500.0]], "irradiance_W_m2": 1000.0, "blackbody_K": 5800.0},
        "observer": {"range_m": 8e5, "acceptance_mrad": 1.0, "direction": [0, 0, 1]},
        "detector": [{"kind": "delay", "bin_ps": 200.0}, {"kind": "spectrometer"}],
        "trace": {"rays": 4096, "time_limit_s": 60.0},
    }
    with_units = {
        "reference_point": [1 * u.cm, 0 * u.m, 0 * u.m],
        "material": {"name": "paint", "model": "lambert", "rho": 30 * u.percent},
        "component": [{"shape": "sphere", "radius": 50 * u.cm,
                       "transform": {"translate": [100, 200, 0] * u.mm, "angle_deg": 0.25 * u.cycle}},
                      {"shape": "box", "size": [100, 20, 30] * u.cm,
                       "hinge": {"axis": [0, 0, 1], "point": [0, 0.5, 0] * u.m, "angle_deg": 0.5235987755982988 * u.rad}}],
        "source": {"kind": "sun", "bands": [[0.4, 0.5] * u.um], "irradiance_W_m2": 0.1 * u.W / u.cm**2,
                   "blackbody_K": (5800 - 273.15) * u.deg_C},
        "observer": {"range_m": 800 * u.km, "acceptance_mrad": 1e-3 * u.rad, "direction": [0, 0, 1]},
        "detector": [{"kind": "delay", "bin_ps": 0.2 * u.ns}, {"kind": "spectrometer"}],
        "trace": {"rays": 4096, "time_limit_s": 1 * u.min},
    }
    assert digest(with_units) == digest(plain)
    assert digest(plain, trace={"rays": 8192}) != digest(plain)


def test_units_of_arguments():
    sheet = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    white = {"material": {"name": "paint", "model": "lambert", "rho": 0.3}, "detector": "spectrometer"}
    assert digest(sheet * 100 * u.cm, faces, **white) == digest(sheet, faces, **white)
    body = clray.Prepared(clray.scene(sheet, faces, **white), device="cpu")
    suns = [[0, 0, 1], [0, 0.6, 0.8]]
    minutes = body.trace(sources=suns, times=[0, 1] * u.min, materials={"paint": {"rho": 20 * u.percent}},
                         time_limit_s=1 * u.h)
    np.testing.assert_allclose(minutes.spectrometer.time, [0, 60])
    np.testing.assert_allclose(minutes.spectrometer.A, 0.2 / math.pi * 2.0 * np.array([1.0, 0.64]), rtol=1e-12)
    box = os.path.join(os.environ["CLRAY_SOURCE_DIR"], "meshes", "box_wing.obj")
    in_cm = clray.trace(clray.load(box, length_unit_m=u.cm), device="cpu")
    np.testing.assert_allclose(float(in_cm.delay.A), 3.449119532063e-4, rtol=1e-11)
    scene = clray.load(box)
    scene.trace.time_limit_s = 2 * u.min
    scene.trace.target_error_percent = 1e-3 * u.dimensionless_unscaled
    assert (scene.trace.time_limit_s, scene.trace.target_error_percent) == (120.0, 0.1)


def test_a_wrong_unit_is_named():
    with pytest.raises(ValueError, match="range_m: expected m, found s"):
        clray.scene({"component": {"shape": "sphere"}, "observer": {"range_m": 3 * u.s}})
    with pytest.raises(ValueError, match="rho: expected a number without unit, found m"):
        clray.scene({"component": {"shape": "sphere"}, "material": {"name": "a", "model": "lambert", "rho": 3 * u.m}})


def test_every_key_of_a_scene_that_names_a_unit_takes_it():
    listed = "".join(subprocess.run([os.environ["CLRAY_PROGRAM"], "--list", table], check=True, capture_output=True,
                                    text=True).stdout for table in ("keys", "shape", "detector"))
    keys = rows(listed)
    assert len(keys) > 60
    for key in keys:
        unit = re.search(r"_([a-zA-Z]+|W_m2|per_ns)$", key)
        if unit and unit[1] not in ("bounces", "rays", "signal", "q", "r", "t", "ev", "steps", "point", "radius", "x",
                                    "y", "z", "time"):
            assert u.Unit(unit_of(key)) != u.dimensionless_unscaled, key
    for key, said in keys.items():
        if re.search(r"\)  +m\b", said):
            assert unit_of(key if not key.startswith("size_") else "size") == "m", key


def test_dates_of_astropy(tmp_path):
    states = tmp_path / "states.csv"
    states.write_text("time_utc,x_m,y_m,z_m\n" + "".join(f"2026-01-01T00:{m:02d}:00,7e6,{m}e5,0\n" for m in range(20)))
    span = {"ephemeris": "states.csv", "step_s": 1 * u.min, "min_elevation_deg": -90 * u.deg}
    scene = {"component": {"shape": "sphere"}, "detector": "spectrometer", "source": {"kind": "sun"},
             "observer": {"ecef_m": [6378.137, 0, 0] * u.km}, "trace": {"rays": 1024}}
    start, stop = Time("2026-01-01T00:05:00", scale="utc"), Time("2026-01-01T00:08:00", scale="utc")
    texts = digest({**scene, "pass": {**span, "start": "2026-01-01T00:05:00Z", "stop": "2026-01-01T00:08:00Z"}},
                   folder=tmp_path)
    assert digest({**scene, "pass": {**span, "start": start, "stop": stop}}, folder=tmp_path) == texts
    assert digest({**scene, "pass": {**span, "start": start.tai, "stop": stop.to_datetime()}},
                  folder=tmp_path) == texts


@pytest.fixture(scope="module")
def spinning():
    """A plate that turns about y: its front is lit and seen once a turn, its back, less white, once."""
    sheet = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=float)
    scene = clray.scene(sheet, np.array([[0, 1, 2], [0, 2, 3]]), detector="spectrometer",
                        material={"name": "paint", "model": "lambert", "rho": 0.3, "two_sided": False},
                        motion={"axis": [0, 1, 0], "period_s": TURN_S, "stop_s": 5 * TURN_S, "step_deg": 7.0})
    return clray.trace(scene, device="cpu").spectrometer


def test_the_period_of_a_light_curve(spinning):
    found = clray.periods(spinning.A)
    # Five turns make a peak a fifth of the period wide. The curve is no sinusoid, and dark half of the time, so that one
    # term meets it within a twentieth of that; six follow it.
    assert found.attrs["period_s"] == pytest.approx(TURN_S, rel=0.01)
    assert clray.periods(spinning.A, errors=spinning.A_error).attrs == found.attrs  # exact: all weigh alike
    fitted = clray.periods(spinning.A, terms=6, shortest_s=20, longest_s=60)
    assert fitted.attrs["period_s"] == pytest.approx(TURN_S, rel=1e-3)
    assert found.attrs["false_alarm"] < 1e-6 and found.power.dims == ("period_s",)
    assert float(found.period_s[int(np.argmax(found.power.values))]) == pytest.approx(TURN_S, rel=0.05)


def test_periods_of_numbers():
    rng = np.random.default_rng(7)
    times = np.sort(rng.uniform(0.0, 600.0, 300))
    turn = 2 * np.pi * times / TURN_S
    values = 2.0 + np.cos(2 * turn) + 0.3 * np.cos(turn - 1.0) + rng.normal(0.0, 0.05, 300)  # alike from two sides
    errors = np.full(300, 0.05)
    # The error of a frequency is sqrt(6 / N) sigma / (pi T A): 1e-5 of 1/s here, 1e-4 of the period; four of them.
    assert clray.periods(values, times * u.s, errors).attrs["period_s"] == pytest.approx(TURN_S / 2, rel=5e-4)
    both = clray.periods(values, times / 60 * u.min, errors, terms=2, shortest_s=20, longest_s=1 * u.min)
    assert both.attrs["period_s"] == pytest.approx(TURN_S, rel=5e-4)


def test_times_are_numbers_quantities_or_dates():
    numbers = [0.0, 1.5, 600.0]
    dates = Time("2026-11-26T00:00:00", scale="utc") + numbers * u.s
    for times in (numbers, numbers * u.s, np.array(numbers) / 60 * u.min, dates, dates.datetime64):
        np.testing.assert_allclose(seconds(times), numbers, atol=1e-6)


@pytest.mark.parametrize("given, said", [
    (([1.0, 2.0, 3.0],), "times"),
    (([[1.0, 2.0]], [1.0, 2.0]), "one value a time"),
    (([1.0, 2.0], [1.0, 2.0]), "at least 4"),
    ((np.arange(9.0), np.ones(9)), "different times"),
])
def test_bad_curves_say_what_is_wrong(given, said):
    with pytest.raises(ValueError, match=said):
        clray.periods(*given)
