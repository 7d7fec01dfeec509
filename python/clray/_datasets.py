# SPDX-License-Identifier: Apache-2.0
"""Records as xarray data sets. Dimensions are view, observer, variant and band, each only where there are several;
then a record's own (delay_ns, axis, component, y, x). Units stand in attrs."""
from __future__ import annotations

from typing import Any

import numpy as np
import xarray

_KEYS = ("view", "observer", "variant", "band")
_A = "m2 sr-1"
_UNITS = {
    "delay": {"A": _A, "mean_delay": "s", "rms_width": "s", "below": _A, "above": _A, "A_t": _A,
              "A_t_upper_bound": _A, "hits": "1", "resolved": "1"},
    "spectrometer": {"A": _A, "source": "W m-2", "received": "W m-2", "magnitude_AB": "mag", "magnitude": "mag",
                     "magnitude_Vega": "mag", "phase_angle": "rad", "air_mass": "1", "extinction": "mag"},
    "pressure": {"C": "m2", "T": "m3", "absorbed": "m2", "sun": "1", "source": "W m-2", "C_component": "m2",
                 "T_component": "m3"},
}
_NAMES = {
    "A": "intensity over irradiance", "A_t": "the same in each bin of delay", "mean_delay": "mean delay",
    "rms_width": "width of the pulse", "C": "force coefficient F c / E", "T": "torque coefficient",
    "absorbed": "absorbed power over irradiance", "source": "irradiance of the source in the band",
    "received": "irradiance at the observer", "phase_angle": "phase angle",
}
_TAILS = {"delay_ns": ("A_t", "A_t_error", "A_t_upper_bound", "hits", "resolved"),
          "axis": ("C", "C_error", "T", "T_error", "sun")}


def _attrs(kind: str, name: str) -> dict[str, str]:
    bare, error = name, ""
    for end, words in (("_error", "standard error of "), ("_rounding", "bound of the rounding error of ")):
        if name.endswith(end):
            bare, error = name[: -len(end)], words
    attrs = {"units": _UNITS[kind].get(bare, "1")}
    if bare in _NAMES or error:
        attrs["long_name"] = error + _NAMES.get(bare, bare)
    return attrs


def _own_dims(name: str) -> tuple[str, ...]:
    if "_component" in name:
        return ("component", "axis")
    for dim, names in _TAILS.items():
        if name in names:
            return (dim,)
    return ()


class _Layout:
    """Where each record of a detector stands among views, observers, variants and bands."""

    def __init__(self, keys: dict[str, Any], members: np.ndarray) -> None:
        self.members = members
        self.dims: list[str] = []
        self.coords: dict[str, Any] = {}
        self.shape: list[int] = []
        at = np.zeros(len(members), dtype=np.int64)
        for key in _KEYS:
            column = [keys[key][m] for m in members]
            values = list(dict.fromkeys(column))
            if len(values) < 2:
                if values and values[0] not in ("", 0):
                    self.coords[key] = values[0]
                continue
            number = {value: k for k, value in enumerate(values)}
            at = at * len(values) + np.array([number[value] for value in column])
            self.dims.append(key)
            self.coords[key] = (key, values)
            self.shape.append(len(values))
        self.order = at
        self.full = len(set(at.tolist())) == len(members) == int(np.prod(self.shape, dtype=np.int64))
        self.in_order = self.full and bool((np.diff(at) == 1).all())

    def place(self, rows: np.ndarray) -> np.ndarray:
        mine = rows if len(rows) == len(self.members) else rows[self.members]
        if self.in_order:  # as they are, without a copy
            return mine.reshape(tuple(self.shape) + mine.shape[1:])
        if not self.full:  # some records are missing: NaN there
            out = np.full((int(np.prod(self.shape, dtype=np.int64)),) + mine.shape[1:], np.nan)
        else:
            out = np.empty_like(mine)
        out[self.order] = mine
        return out.reshape(tuple(self.shape) + mine.shape[1:])


def _dataset(kind: str, columns: dict[str, Any], members: np.ndarray) -> xarray.Dataset:
    layout = _Layout(columns, members)
    variables: dict[str, Any] = {}
    coords = dict(layout.coords)
    for name, column in columns.items():
        if name in (*_KEYS, "detector", "first_bin_start", "bin_width"):
            continue
        own = _own_dims(name)
        if own and column.shape[1] == 0:
            continue
        if name == "hits" and np.isnan(column[members]).all():  # of exact records
            continue
        values = layout.place(column)
        if name.endswith("_rounding") and np.isnan(values).all():
            continue
        variables[name] = ((*layout.dims, *own), values, _attrs(kind, name))
    attrs: dict[str, Any] = {"detector": columns["detector"][members[0]], "kind": kind}
    if kind == "delay":
        first, width = columns["first_bin_start"][members[0]], columns["bin_width"][members[0]]
        bins = columns["A_t"].shape[1]
        coords["delay_ns"] = ("delay_ns", (first + width * (np.arange(bins) + 0.5)) * 1e9,
                              {"units": "ns", "long_name": "delay, middle of the bin"})
        attrs["bin_width_ns"] = width * 1e9
    if kind == "pressure":
        coords["axis"] = ("axis", ["x", "y", "z"])
    return xarray.Dataset(variables, coords, attrs)


def _images(images: list[dict[str, Any]]) -> dict[str, xarray.Dataset]:
    groups: dict[str, list[dict[str, Any]]] = {}
    for image in images:
        groups.setdefault(image["detector"], []).append(image)
    sets = {}
    for name, members in groups.items():
        keys = {key: [m.get(key, "") for m in members] for key in ("view", "observer", "variant")}
        keys["band"] = [""] * len(members)
        layout = _Layout(keys, np.arange(len(members)))
        band, height, width = members[0]["radiance"].shape
        pixel = members[0]["pixel_m"]
        coords = dict(layout.coords)
        coords["band"] = ("band", members[0]["bands"])
        coords["y"] = ("y", (0.5 * (height - 1) - np.arange(height)) * pixel, {"units": "m"})
        coords["x"] = ("x", (np.arange(width) - 0.5 * (width - 1)) * pixel, {"units": "m"})
        variables = {}
        for key, dims in (("radiance", ("band", "y", "x")), ("radiance_error", ("band", "y", "x")),
                          ("coverage", ("y", "x"))):
            if all(key in m for m in members):
                stack = layout.place(np.stack([m[key] for m in members]))
                units = "1" if key == "coverage" else "sr-1"
                variables[key] = ((*layout.dims, *dims), stack, {"units": units})
        sets[name] = xarray.Dataset(variables, coords, {"detector": name, "kind": "image", "pixel_m": pixel})
    return sets


def _tables(columns: dict[str, Any]) -> dict[str, xarray.Dataset]:
    sets: dict[str, dict[str, Any]] = {}
    for detector in dict.fromkeys(columns["detector"]):
        mine = [k for k, name in enumerate(columns["detector"]) if name == detector]
        variables = {}
        for name in dict.fromkeys(columns["name"][k] for k in mine):
            members = np.array([k for k in mine if columns["name"][k] == name])
            layout = _Layout(columns, members)
            attrs = {"units": columns["unit"][members[0]]}
            for suffix, key in (("", "value"), ("_error", "error")):
                variables[name + suffix] = ((*layout.dims, "number"), layout.place(columns[key]), attrs)
        sets[detector] = xarray.Dataset(variables, layout.coords, {"detector": detector, "kind": "table"})
    return sets


def datasets(raw: Any) -> dict[str, xarray.Dataset]:
    """Every data set of a result, by the name of its detector, and by its kind where there is one of it."""
    from . import _plot  # noqa: F401 (makes .clray known to xarray)

    sets: dict[str, xarray.Dataset] = {}
    kinds: dict[str, list[str]] = {}
    for kind in ("delay", "spectrometer", "pressure"):
        columns = getattr(raw, kind)()
        names = columns["detector"]
        for name in dict.fromkeys(names):
            members = np.array([k for k, each in enumerate(names) if each == name])
            sets[name] = _dataset(kind, columns, members)
            kinds.setdefault(kind, []).append(name)
    sets.update(_images(raw.image()))
    table = raw.table()
    if table["detector"]:
        sets.update(_tables(table))
    times = raw.views()["time"]
    if len(times) > 1 and np.ptp(times) > 0:
        for name, data in sets.items():
            if "view" in data.sizes:
                sets[name] = data.assign_coords(time=("view", times[data.view.values], {"units": "s"}))
    for kind, names in kinds.items():
        if len(names) == 1:
            sets.setdefault(kind, sets[names[0]])
    return sets


def views(raw: Any, scene: Any) -> xarray.Dataset:
    """Times, attitudes, directions."""
    found = raw.views()
    variables = {
        "time": ("view", found["time"], {"units": "s"}),
        "source": (("view", "axis"), found["source"], {"long_name": "toward the source, body frame"}),
        "body_to_space": (("view", "part"), found["body_to_space"], {"long_name": "quaternion from body to space"}),
        "observers": (("view", "observer", "axis"), found["observers"],
                      {"long_name": "toward the observers, body frame"}),
    }
    coords: dict[str, Any] = {"axis": ["x", "y", "z"], "part": ["w", "x", "y", "z"]}
    if found["observers"].shape[1] == len(scene.observers):
        coords["observer"] = scene.observers
    return xarray.Dataset(variables, coords)
