# SPDX-License-Identifier: Apache-2.0
"""Orbits from elsewhere for the `[pass]` of a scene: of two-line elements by SGP4, and of SPICE kernels.

An Orbit is a table of states by time, which the library interpolates and turns to gcrf (docs/physics.md, section 10)."""
from __future__ import annotations

import math
import os
from collections.abc import Sequence
from datetime import datetime, timedelta, timezone
from functools import cache
from typing import TYPE_CHECKING, Any

from ._units import in_unit

if TYPE_CHECKING:
    import numpy as np

_MARGIN = 6  # states before the first and after the last instant, which the interpolation needs
_MOST = 10_000_000  # states


class Orbit:
    """States of a body, for `{"pass": {"ephemeris": orbit, ...}}`.

    `times_utc`: texts of ISO 8601; `position_m` and, if known as its exact derivative, `velocity_m_s`: arrays (n, 3) in
    `frame`, one of gcrf, eme2000, tod, teme, itrf, about the Earth's centre. Between states the library interpolates by
    Hermite's polynomial of degree 7, without velocities by Lagrange's of degree 9."""

    def __init__(self, times_utc: Sequence[str], position_m: "np.ndarray",
                 velocity_m_s: "np.ndarray | None" = None, frame: str = "gcrf") -> None:
        import numpy as np

        self.times_utc = list(times_utc)
        self.position_m = np.array(position_m, float)
        self.velocity_m_s = None if velocity_m_s is None else np.array(velocity_m_s, float)
        self.frame = frame
        shape = (len(self.times_utc), 3)
        for name in ("position_m", "velocity_m_s"):
            array = getattr(self, name)
            if array is not None and array.shape != shape:
                raise ValueError(f"{name}: expected an array of shape {shape}, found {array.shape}")

    def _columns(self) -> "np.ndarray":
        import numpy as np

        return self.position_m if self.velocity_m_s is None else np.hstack([self.position_m, self.velocity_m_s])

    def __repr__(self) -> str:
        return f"<clray.Orbit of {len(self.times_utc)} states in {self.frame}>"

    def write(self, path: str | os.PathLike) -> None:
        """Writes a table of states, as `[pass] ephemeris` reads it; its frame is not in it."""
        with open(path, "w", encoding="ascii") as file:
            file.write("time_utc,x_m,y_m,z_m" + ("" if self.velocity_m_s is None else ",vx_m_s,vy_m_s,vz_m_s") + "\n")
            for time, numbers in zip(self.times_utc, self._columns().tolist()):
                file.write(",".join([time, *map(repr, numbers)]) + "\n")

    def _file(self) -> str:
        """A file of it that lives as long as this process."""
        import hashlib

        digest = hashlib.sha256(repr(self.times_utc).encode())
        digest.update(self._columns().tobytes())
        path = os.path.join(_folder(), f"orbit-{digest.hexdigest()[:16]}.csv")
        if not os.path.exists(path):
            self.write(path)
        return path


@cache
def _folder() -> str:
    import atexit
    import shutil
    import tempfile

    folder = tempfile.mkdtemp(prefix="clray-orbits-")
    process = os.getpid()
    atexit.register(lambda: os.getpid() == process and shutil.rmtree(folder, ignore_errors=True))
    return folder


def date_of(value: Any) -> datetime:
    """A date of UTC: a datetime (UTC where it has no zone), a text of ISO 8601, or an astropy Time."""
    if hasattr(value, "utc") and hasattr(value, "to_datetime"):
        value = value.utc.to_datetime()
    if isinstance(value, str):
        value = datetime.fromisoformat(value)
    if not isinstance(value, datetime):
        raise TypeError(f"expected a date (datetime, text of ISO 8601, astropy Time), found {value!r}")
    return value.astimezone(timezone.utc).replace(tzinfo=None) if value.tzinfo else value


def _times(start: Any, stop: Any, step_s: Any) -> list[datetime]:
    first, last = date_of(start), date_of(stop)
    step = float(in_unit("step_s", step_s))
    if not step > 0.0 or not math.isfinite(step):
        raise ValueError(f"step_s: expected a number above 0, found {step}")
    if last < first:
        raise ValueError(f"stop: expected a date after {first}, found {last}")
    count = math.ceil((last - first).total_seconds() / step) + 1 + 2 * _MARGIN
    if count > _MOST:
        raise ValueError(f"expected at most {_MOST} states, found {count}: take a longer step_s")
    return [first + timedelta(seconds=step * (k - _MARGIN)) for k in range(count)]


def orbit_from_tle(lines: str | Sequence[str], start: Any, stop: Any, step_s: Any = 30.0) -> Orbit:
    """The orbit of two-line elements by SGP4 (the package sgp4), in the frame teme.

    `lines`: a text or a list of the two lines, a name before them or not. States are computed from some steps before
    `start` to some after `stop`, positions alone: the velocities of SGP4 are not quite their derivatives. Between them
    the library interpolates. The elements themselves are good to a kilometre or so near their epoch.
    """
    try:
        from sgp4.api import SGP4_ERRORS, Satrec, jday
        from sgp4.io import verify_checksum
    except ImportError as error:
        raise ImportError("orbit_from_tle() needs the package sgp4: pip install 'clray[orbit]'") from error
    import numpy as np

    rows = [row.rstrip() for row in (lines.splitlines() if isinstance(lines, str) else lines) if row.strip()]
    if len(rows) not in (2, 3) or not rows[-2].startswith("1 ") or not rows[-1].startswith("2 "):
        raise ValueError("expected the two lines of an element set, the first of which begins with 1, the second with 2")
    verify_checksum(*rows[-2:])
    times = _times(start, stop, step_s)
    days = [jday(t.year, t.month, t.day, t.hour, t.minute, t.second + 1e-6 * t.microsecond) for t in times]
    whole, part = (np.array(column) for column in zip(*days))
    errors, position_km, _ = Satrec.twoline2rv(*rows[-2:]).sgp4_array(whole, part)
    for time, code in zip(times, errors):
        if code:
            raise ValueError(f"{time.isoformat()}: {SGP4_ERRORS[int(code)]}")
    return Orbit([t.isoformat(timespec="microseconds") for t in times], 1e3 * position_km, None, "teme")


def orbit_from_spice(target: str, start: Any, stop: Any, step_s: Any = 30.0,
                     kernels: Sequence[str | os.PathLike] = ()) -> Orbit:
    """The orbit of a body in SPICE kernels (the package spiceypy), seen from the Earth's centre, in the frame gcrf.

    `target`: a name or number of NAIF. `kernels` are loaded for this call, beside those that are loaded already; leap
    seconds (an LSK) must be among them. Positions are geometric, along SPICE's J2000, whose axes are the ICRF's.
    """
    try:
        import spiceypy
    except ImportError as error:
        raise ImportError("orbit_from_spice() needs the package spiceypy: pip install 'clray[spice]'") from error
    import numpy as np

    loaded = [os.fspath(kernel) for kernel in kernels]
    try:
        for kernel in loaded:
            spiceypy.furnsh(kernel)
        span = _times(start, stop, step_s)
        step = float(in_unit("step_s", step_s))
        first = spiceypy.str2et(span[_MARGIN].isoformat())
        seconds = first + step * (np.arange(len(span)) - _MARGIN)  # SI seconds, over leap seconds, too
        states, texts = [], []
        for k, et in enumerate(seconds):
            try:
                states.append(spiceypy.spkezr(str(target), et, "J2000", "NONE", "EARTH")[0])
            except spiceypy.utils.exceptions.SpiceSPKINSUFFDATA:
                if _MARGIN <= k < len(span) - _MARGIN:
                    raise
                continue  # kernels may end where the span does
            texts.append(spiceypy.et2utc(et, "ISOC", 9))
    finally:
        for kernel in loaded:
            spiceypy.unload(kernel)
    si = 1e3 * np.array(states)
    return Orbit(texts, si[:, :3], si[:, 3:], "gcrf")
