# SPDX-License-Identifier: Apache-2.0
"""Devices, traces, prepared scenes and results."""
from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import _clray
from ._clray import Device, Scene
from ._scene import changed, load, scene as make_scene

if TYPE_CHECKING:
    import xarray

_NUMBERS = ("digest", "kept", "left_out", "partial", "rays", "rays_total", "reached_percent", "seconds", "seed",
            "stopped_by", "target_reached", "warnings")  # of the run
_opened: dict[str, Device] = {}
Progress = bool | Callable[[str, float, int, float, float], Any] | None


def _device(choice: Device | str | None) -> Device:
    if isinstance(choice, Device):
        return choice
    name = choice or ""
    if name not in _opened:
        _opened[name] = Device(name)
    return _opened[name]


def _scene(given: Any) -> Scene:
    if isinstance(given, Scene):
        return given
    if isinstance(given, (str, os.PathLike)):
        return load(given)
    return make_scene(given)


class _Bar:
    """Progress by tqdm, where it is installed and someone may look, or by a function."""

    def __init__(self, wanted: Progress) -> None:
        self.bar = None
        self.listener = wanted if callable(wanted) else None
        if self.listener or wanted is False or (wanted is None and not sys.stderr.isatty()):
            return
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return
        self.bar = tqdm(total=100, unit="%", leave=False, bar_format="{l_bar}{bar}| {postfix}")
        self.listener = self._draw

    def _draw(self, phase: str, fraction: float, rays: int, error: float, seconds_left: float) -> None:
        self.bar.set_description(phase)
        self.bar.n = round(100 * min(1.0, fraction), 1)
        self.bar.set_postfix_str(f"±{100 * error:.2g} %" if error == error and error > 0 else "")

    def run(self, trace: Any) -> Any:
        try:
            return trace(self.listener)
        finally:
            if self.bar is not None:
                self.bar.close()


def trace(scene: Any, *, device: Device | str | None = None, progress: Progress = None, stop: Any = None,
          **changes: Any) -> "Result":
    """Traces a scene: a Scene, a path, a dict or a mesh.

    `device` is a Device or what one is chosen by ("cpu", "gpu", "all", part of a name); it stays open for later calls.
    `progress`: a bar by tqdm (None: on a terminal), or a function that is called a few times a second with phase,
    fraction of it, rays, relative error and seconds left. `stop`: a threading.Event (or what else has `is_set()`); once
    another thread sets it, the trace ends with what it has. Changes are those of Prepared.trace(). The interpreter
    lock is free while it runs, and Ctrl-C stops it.
    """
    scene = _changed(_scene(scene), changes)
    opened = _device(device)
    return Result(_Bar(progress).run(lambda tell: _clray.trace(scene, opened, tell, stop)), scene)


def _changed(scene: Scene, changes: dict[str, Any]) -> Scene:
    if not changes:
        return scene
    views = {key: changes.pop(key) for key in ("sources", "attitudes", "observers", "times") if key in changes}
    return changed(scene, views=views, **changes)


class Prepared:
    """A scene whose body and programs stay on the device, to be traced many times; every result has the bits of
    clray.trace()."""

    def __init__(self, scene: Any, *, device: Device | str | None = None) -> None:
        self._scene = _scene(scene)
        self._prepared = _clray.Prepared(self._scene, _device(device))

    @property
    def scene(self) -> Scene:
        """A copy of the scene that it was made of."""
        return self._prepared.scene

    def trace(self, scene: Any = None, *, progress: Progress = False, stop: Any = None, **changes: Any) -> "Result":
        """Traces that scene, or another one of the same body, with changes:

        source=(x, y, z); observer=(x, y, z) or {name: (x, y, z)}; materials={"paint": {"rho": 0.3}}; options of
        [trace], such as rays=2**20 or seed=7. Many views in one call: sources, an array (n, 3) of directions in the
        body frame; attitudes (n, 4), quaternions w, x, y, z from body to space, which turn the scene's own directions;
        observers (n, observers, 3), body frame; times (n).
        """
        given = _changed(self._scene if scene is None else _scene(scene), changes)
        return Result(_Bar(progress).run(lambda tell: self._prepared.trace(given, tell, stop)), given)


class Result:
    """What a trace found. `result.delay`, `result.spectrometer`, `result.pressure` and so on are xarray data sets, by
    the kind of a detector or by its name; `result.summary` is what summary.json holds."""

    def __init__(self, raw: Any, scene: Scene) -> None:
        self._raw = raw
        self.scene = scene

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        sets = self.datasets
        if name in sets:
            return sets[name]
        if name in _NUMBERS:
            return getattr(self._raw, name)
        raise AttributeError(f"there is no detector or number {name!r}; there are {', '.join(sets)}")

    def __getitem__(self, name: str) -> "xarray.Dataset":
        return self.datasets[name]

    def __dir__(self) -> list[str]:
        return sorted([*super().__dir__(), *self.datasets, *_NUMBERS])

    @cached_property
    def datasets(self) -> "dict[str, xarray.Dataset]":
        """All data sets, by the names of the detectors; one of a kind also by its kind."""
        from ._datasets import datasets

        return datasets(self._raw)

    @cached_property
    def views(self) -> "xarray.Dataset":
        """Times, attitudes and directions of the views."""
        from ._datasets import views

        return views(self._raw, self.scene)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of summary.json."""
        import json
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "result")
            self.write(out, plots=False)
            with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
                return json.load(file)

    def write(self, folder: str | os.PathLike, *, plots: bool = True, netcdf: bool = False) -> list[str]:
        """Writes the files that the program writes; returns their names."""
        return self._raw.write(self.scene, os.fspath(folder), plots, netcdf)

    def __str__(self) -> str:
        return self._raw.text().rstrip("\n")

    def __repr__(self) -> str:
        return f"<clray.Result {self.scene.name}: digest {self.digest}>"

    def _repr_html_(self) -> str:
        from ._plot import html

        return html(self)
