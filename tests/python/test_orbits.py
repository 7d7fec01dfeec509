# SPDX-License-Identifier: Apache-2.0
"""Orbits of two-line elements and of SPICE kernels: passes against astropy and against closed forms."""
import csv
import math
import sys
from datetime import datetime, timedelta, timezone

import numpy as np
import pytest

import clray

# Vallado's test case 00005 (AIAA 2006-6753) with its printed positions in TEME at 0 and 360 minutes.
VANGUARD = ("1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753\n"
            "2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667")
EPOCH = datetime(2000, 6, 27, 18, 50, 19, 733568)
PRINTED_km = {0: (7022.46529266, -1400.08296755, 0.03995155),
              360: (-7154.03120202, -3783.17682504, -3536.19412294)}


def states_of(orbit, start, stop, step_s, tmp_path, **more):
    """Positions of the body in gcrf, m, as pass.csv has them, with their times from the start, s."""
    scene = clray.scene({"component": {"shape": "sphere"}, "detector": "spectrometer", "source": {"kind": "sun"},
                         "observer": {"name": "site", "ecef_m": [6378137.0, 0.0, 0.0]},
                         "pass": {"ephemeris": orbit, "start": start, "stop": stop, "step_s": step_s,
                                  "min_elevation_deg": -90}, "trace": {"rays": 1024}, **more})
    clray.trace(scene, device="cpu").write(tmp_path / "out", plots=False)
    with open(tmp_path / "out" / "pass.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return (np.array([float(r["time_s"]) for r in rows]),
            np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in rows]))


def test_sgp4_gives_the_printed_states():
    start = EPOCH.replace(tzinfo=timezone.utc)
    orbit = clray.orbit_from_tle(VANGUARD, start, start + timedelta(minutes=360), 60.0)
    assert orbit.frame == "teme"
    for minutes, position_km in PRINTED_km.items():
        k = orbit.times_utc.index((EPOCH + timedelta(minutes=minutes)).isoformat(timespec="microseconds"))
        # The last printed digit is worth 1e-5 m; the epoch has whole microseconds.
        np.testing.assert_allclose(orbit.position_m[k], 1e3 * np.array(position_km), rtol=0, atol=6e-6)


def test_a_pass_of_elements_is_where_astropy_has_it(tmp_path):
    import astropy.units as u
    from astropy.coordinates import GCRS, TEME, CartesianRepresentation
    from astropy.time import Time
    from sgp4.api import Satrec

    start, stop = Time("2000-06-27T20:00:00", scale="utc"), Time("2000-06-27T20:30:00", scale="utc")
    orbit = clray.orbit_from_tle(VANGUARD.splitlines(), start, stop, 0.5 * u.min)
    # Instants of the pass do not meet those of the table, so that it must interpolate.
    times, found = states_of(orbit, start, stop, 7.0, tmp_path)
    satellite = Satrec.twoline2rv(*VANGUARD.splitlines())
    dates = start + times * u.s
    _, position_km, _ = satellite.sgp4_array(dates.jd1, dates.jd2)
    expected = TEME(CartesianRepresentation(position_km.T * u.km), obstime=dates).transform_to(GCRS(obstime=dates))
    miss = np.linalg.norm(found - expected.cartesian.xyz.to_value("m").T, axis=1)
    # astropy goes by way of the Earth, with UT1 and the pole of the date; on the way back both leave again. Times have
    # microseconds in the table: 7 mm. Interpolation leaves far less, Lagrange's of degree 9 in steps of 30 s.
    assert len(times) > 200 and miss.max() < 7e-3


def test_a_pass_of_spice_kernels(tmp_path):
    import spiceypy

    (tmp_path / "leaps.tls").write_text("KPL/LSK\n\\begindata\nDELTET/DELTA_T_A = 32.184\nDELTET/K = 1.657D-3\n"
                                        "DELTET/EB = 1.671D-2\nDELTET/M = ( 6.239996 1.99096871D-7 )\n"
                                        "DELTET/DELTA_AT = ( 36, @2015-JUL-1 37, @2017-JAN-1 )\n\\begintext\n")
    radius, rate = 7.2e6, math.sqrt(3.986004418e14 / 7.2e6**3)
    tt = 58849 * 86400.0  # 2020-01-01, counted from J2000 below: et is TDB, within 2 ms of TT

    def circle(seconds):
        a = rate * seconds
        return np.stack([radius * np.cos(a), radius * np.sin(a) * 0.6, radius * np.sin(a) * 0.8], axis=-1)

    spiceypy.furnsh(str(tmp_path / "leaps.tls"))
    first = spiceypy.str2et("2020-01-01T00:00:00")
    # UTC to TT: 37 + 32.184 s; TT to TDB: at most 1.7 ms, of Kepler's equation of the Earth.
    assert first == pytest.approx(tt - 51544.5 * 86400.0 + 37 + 32.184, abs=2e-3)
    grid = np.arange(-600.0, 2400.0, 60.0)
    rates = np.stack([-radius * rate * np.sin(rate * grid), radius * rate * 0.6 * np.cos(rate * grid),
                      radius * rate * 0.8 * np.cos(rate * grid)], axis=-1)
    kernel = str(tmp_path / "body.bsp")
    handle = spiceypy.spkopn(kernel, "test", 0)
    spiceypy.spkw13(handle, -999, 399, "J2000", first + grid[0], first + grid[-1], "circle", 7, len(grid),
                    1e-3 * np.hstack([circle(grid), rates]), first + grid)
    spiceypy.spkcls(handle)
    spiceypy.unload(str(tmp_path / "leaps.tls"))

    kernels = [tmp_path / "leaps.tls", kernel]
    orbit = clray.orbit_from_spice("-999", "2020-01-01T00:00:00", "2020-01-01T00:30:00Z", 30.0, kernels=kernels)
    times, found = states_of(orbit, "2020-01-01T00:00:00Z", "2020-01-01T00:30:00Z", 11.0, tmp_path)
    # et is 2e-6 s coarse where TDB goes by the year's rate: 7.5 km/s make 15 mm.
    np.testing.assert_allclose(found, circle(times), atol=0.02)
    with pytest.raises(Exception, match="SPKINSUFFDATA|Insufficient"):
        clray.orbit_from_spice("-999", "2020-01-01T00:00:00", "2020-01-01T02:00:00", 30.0, kernels=kernels)


@pytest.mark.parametrize("change, error, said", [
    ({"lines": "nonsense"}, ValueError, "two lines"),
    ({"lines": VANGUARD.replace("34.2682", "34.2683")}, ValueError, "checksum"),
    ({"step_s": 0.0}, ValueError, "step_s"),
    ({"step_s": 1e-6}, ValueError, "longer step_s"),
    ({"start": 3.0}, TypeError, "expected a date"),
    ({"start": datetime(2001, 1, 1)}, ValueError, "stop"),
])
def test_bad_orbits_say_what_is_wrong(change, error, said):
    given = {"lines": VANGUARD, "start": EPOCH, "stop": EPOCH + timedelta(hours=1), "step_s": 30.0, **change}
    with pytest.raises(error, match=said):
        clray.orbit_from_tle(**given)


@pytest.mark.parametrize("package, call", [
    ("sgp4.api", lambda: clray.orbit_from_tle(VANGUARD, EPOCH, EPOCH)),
    ("spiceypy", lambda: clray.orbit_from_spice("MOON", EPOCH, EPOCH)),
    ("astropy.timeseries", lambda: clray.periods([1, 2], times=[1, 2])),
])
def test_a_missing_package_is_named(monkeypatch, package, call):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match="pip install 'clray"):
        call()
