# SPDX-License-Identifier: Apache-2.0
"""Quantities of astropy as plain numbers, in the unit that a scene's key names. Other numbers pass as they are."""
from __future__ import annotations

from typing import Any

# What the end of a key says of its unit, as astropy writes it.
_ENDS = {"_ns": "ns", "_ps": "ps", "_s": "s", "_m": "m", "_nm": "nm", "_deg": "deg", "_rad": "rad", "_mrad": "mrad",
         "_urad": "urad", "_arcsec": "arcsec", "_J": "J", "_Hz": "Hz", "_K": "K", "_hPa": "hPa", "_W_m2": "W/m2",
         "_percent": "percent", "_mag": "mag", "_per_ns": "1/ns", "_mjd": "d"}
_KEYS = {"bands": "nm", **dict.fromkeys(
    ("radius", "inner_radius", "top_radius", "height", "depth", "size", "translate", "point", "reference_point",
     "vertices", "length_unit"), "m")}


def unit_of(key: str) -> str:
    """The unit of a key's numbers, as astropy writes it."""
    if key in _KEYS:
        return _KEYS[key]
    ends = [end for end in _ENDS if key.endswith(end)]
    return _ENDS[max(ends, key=len)] if ends else ""


def in_unit(key: str, value: Any) -> Any:
    """A number or array without its unit, in that of the key."""
    unit = unit_of(key)
    if hasattr(value, "physical_type") and not hasattr(value, "unit"):  # a unit itself, such as u.mm of a length_unit
        value = 1.0 * value
    if not hasattr(value, "unit") or not hasattr(value, "to_value"):
        return value
    try:
        if unit == "K" and value.unit.physical_type == "temperature":
            from astropy.units import temperature

            return value.to_value(unit, equivalencies=temperature())
        return value.to_value(unit)
    except ValueError as error:  # astropy's UnitConversionError
        raise ValueError(f"{key}: expected {unit or 'a number without unit'}, found {value.unit}") from error


def seconds(times: Any) -> Any:
    """Times as an array of seconds: numbers and quantities as they are, dates (astropy's Time, numpy's datetime64) from
    the first of them."""
    import numpy as np

    if hasattr(times, "mjd") and hasattr(times, "to_datetime"):
        return np.atleast_1d((times - times.flatten()[0]).to_value("s"))
    array = np.asarray(in_unit("_s", times))
    if array.dtype.kind == "M":
        array = (array - array.flat[0]) / np.timedelta64(1, "s")
    return array.astype(float)
