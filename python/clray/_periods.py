# SPDX-License-Identifier: Apache-2.0
"""Periods of a light curve, by the Lomb-Scargle periodogram of astropy (VanderPlas 2018)."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._units import in_unit, seconds

if TYPE_CHECKING:
    import xarray


def periods(values: Any, times: Any = None, errors: Any = None, *, shortest_s: Any = None, longest_s: Any = None,
            terms: int = 1) -> "xarray.Dataset":
    """The periodogram of a light curve: `power` (0 to 1) over `period_s`, and in attrs the best `period_s` and its
    `false_alarm` probability (of one term alone).

    `values`: a DataArray of a result over its views, such as result.spectrometer.A, whose times are known, or numbers
    with `times` (s, quantities or dates). `errors` are standard errors, such as result.spectrometer.A_error; those of
    exact values are 0, and then all weigh alike. Periods are looked for from `shortest_s` (twice the mean step) to
    `longest_s` (the span). `terms` harmonics are fitted: a body that looks alike from two sides shows half its turn
    with one term, and its turn with two or more.
    """
    try:
        from astropy.timeseries import LombScargle
    except ImportError as error:
        raise ImportError("periods() needs the package astropy: pip install 'clray[astropy]'") from error
    import numpy as np
    import xarray

    if times is None:
        if "time" not in getattr(values, "coords", ()):
            raise ValueError("expected a DataArray with times, such as result.spectrometer.A of a motion, or `times`")
        times = values.coords["time"]
    t = seconds(times)
    y = np.asarray(values, dtype=float)
    if t.ndim != 1 or y.shape != t.shape:
        raise ValueError(f"expected one value a time, found values of shape {y.shape} and times of shape {t.shape}: "
                         "select an observer, a variant and a band")
    dy = None if errors is None else np.asarray(errors, dtype=float)
    if dy is not None and not dy.any():
        dy = None
    good = np.isfinite(t) & np.isfinite(y) & (True if dy is None else np.isfinite(dy) & (dy > 0))
    t, y, dy = t[good], y[good], None if dy is None else dy[good]
    if len(t) < 2 * terms + 2 or np.ptp(t) <= 0:
        raise ValueError(f"expected at least {2 * terms + 2} values at different times, found {len(t)}")
    span = np.ptp(t)
    shortest = float(in_unit("_s", shortest_s)) if shortest_s is not None else 2.0 * span / (len(t) - 1)
    longest = float(in_unit("_s", longest_s)) if longest_s is not None else span
    if not 0.0 < shortest < longest:
        raise ValueError(f"expected 0 < shortest_s < longest_s, found {shortest} and {longest}")
    periodogram = LombScargle(t, y, dy, nterms=terms)
    low, high = 1.0 / longest, 1.0 / shortest
    step = 1.0 / (10.0 * span)  # ten points on a peak
    frequency = np.linspace(low, high, max(2, int(np.ceil((high - low) / step)) + 1))
    power = periodogram.power(frequency)
    best = int(np.argmax(power))
    around = np.linspace(max(low, frequency[best] - step), min(high, frequency[best] + step), 401)
    fine = periodogram.power(around, method="slow" if terms == 1 else "chi2")
    peak = float(around[int(np.argmax(fine))])
    attrs = {"period_s": 1.0 / peak}
    if terms == 1:
        attrs["false_alarm"] = float(periodogram.false_alarm_probability(np.max(fine), method="naive", maximum_frequency=high))
    return xarray.Dataset({"power": ("period_s", power[::-1], {"units": "1"})},
                          {"period_s": ("period_s", 1.0 / frequency[::-1], {"units": "s"})}, attrs)
