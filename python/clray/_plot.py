# SPDX-License-Identifier: Apache-2.0
"""Plots with matplotlib, as `.clray.plot()` of data sets, and what notebooks show of a result."""
from __future__ import annotations

import base64
import html as _html
import io
from typing import Any

import xarray


@xarray.register_dataset_accessor("clray")
class Plots:
    """`dataset.clray.plot()`."""

    def __init__(self, data: xarray.Dataset) -> None:
        self._data = data

    def plot(self, ax: Any = None, **selection: Any) -> Any:
        """Draws the pulse, the light curve, the coefficients or the picture; returns the axes. Of dimensions beside
        the drawn one the first member is taken, or what `selection` says, such as observer="b"."""
        from matplotlib import pyplot

        ax = ax if ax is not None else pyplot.subplots()[1]
        data = self._data.sel(**selection)
        kind = data.attrs.get("kind", "")
        draw = {"delay": _pulse, "spectrometer": _curve, "pressure": _push, "image": _picture}.get(kind)
        if draw is None:
            raise ValueError(f"there is no plot of {kind or 'this data set'}")
        draw(data, ax)
        return ax


def _first(data: xarray.Dataset, keep: tuple[str, ...]) -> xarray.Dataset:
    for dim in list(data.sizes):
        if dim not in keep:
            data = data.isel({dim: 0})
    return data


def _pulse(data: xarray.Dataset, ax: Any) -> None:
    one = _first(data, ("delay_ns",))
    ax.step(one.delay_ns, one.A_t, where="mid")
    ax.fill_between(one.delay_ns, one.A_t - one.A_t_error, one.A_t + one.A_t_error, step="mid", alpha=0.3)
    ax.set(xlabel="delay (ns)", ylabel="A per bin (m²/sr)")


def _curve(data: xarray.Dataset, ax: Any) -> None:
    across = "view" if "view" in data.sizes else "band"
    one = _first(data, (across,))
    if across in one.sizes:
        ax.errorbar(one[across], one.A, one.A_error, fmt=".-")
    else:
        ax.errorbar([0], [float(one.A)], [float(one.A_error)], fmt="o")
    ax.set(xlabel=across, ylabel="A (m²/sr)")


def _push(data: xarray.Dataset, ax: Any) -> None:
    one = _first(data, ("view", "axis"))
    for axis in one.axis.values:
        part = one.sel(axis=axis)
        if "view" in one.sizes:
            ax.plot(one.view, part.C, label=f"C{axis}")
        else:
            ax.bar(f"C{axis}", float(part.C), yerr=float(part.C_error))
    if "view" in one.sizes:
        ax.legend()
    ax.set(ylabel="C (m²)")


def _picture(data: xarray.Dataset, ax: Any) -> None:
    one = _first(data, ("band", "y", "x"))
    red_to_blue = one.radiance.isel(band=slice(None, None, -1)) if one.sizes["band"] == 3 else one.radiance.mean("band")
    peak = float(one.radiance.max()) or 1.0
    image = (red_to_blue / peak).clip(0, 1) ** (1 / 2.2)
    extent = (float(one.x[0]), float(one.x[-1]), float(one.y[-1]), float(one.y[0]))
    if "band" in image.dims:
        image = image.transpose("y", "x", "band")
    ax.imshow(image.values, extent=extent, cmap="gray")
    ax.set(xlabel="m", ylabel="m")


def html(result: Any) -> str:
    """Totals as text, and the first plot where matplotlib is there."""
    text = f"<pre>{_html.escape(str(result))}\ndigest {result.digest}</pre>"
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return text
    for data in result.datasets.values():
        figure = Figure(figsize=(5, 3), layout="tight")
        try:
            data.clray.plot(figure.subplots())
        except ValueError:
            continue
        png = io.BytesIO()
        figure.savefig(png, format="png")
        return text + f'<img alt="" src="data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}">'
    return text
