# SPDX-License-Identifier: Apache-2.0
"""Scenes from files, dicts and meshes in memory, and changes of them.

A dict has the keys of a scene file (docs/scene-file.md). It is written as TOML and read like one, so that both have
the same rules and the same messages. Numbers may carry astropy units, and the orbit of a pass may be an Orbit.
"""
from __future__ import annotations

import math
import os
from collections.abc import Mapping
from datetime import datetime
from typing import Any

from . import _clray
from ._clray import Mesh, Scene
from ._orbits import Orbit, date_of
from ._units import in_unit, seconds, unit_of

def load(path: str | os.PathLike, *, length_unit_m: Any = 0.0, detectors: list[str] | None = None) -> Scene:
    """Reads a scene file (.toml) or a mesh (.obj .ply .stl .off).

    `length_unit_m` is the unit of mesh files; 0 takes what the scene file says, or metres. `detectors` (kinds) stand
    instead of the scene's.
    """
    return _clray.load_scene(os.fspath(path), float(in_unit("length_unit_m", length_unit_m)), detectors or [])


def mesh(shape: Any, faces: Any = None) -> Mesh:
    """A mesh in metres: of a trimesh.Trimesh (or anything with `vertices` and `faces`), or of two arrays."""
    import numpy as np

    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, tuple) and faces is None:
        shape, faces = shape
    vertices = shape if faces is not None else shape.vertices
    triangles = np.asarray(faces if faces is not None else shape.faces)
    if triangles.ndim != 2 or triangles.shape[1] != 3:
        raise ValueError(f"expected triangles, an array of shape (n, 3), found {triangles.shape}")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
        raise ValueError("a face names a vertex that there is not")
    points = np.ascontiguousarray(in_unit("vertices", vertices), dtype=np.float64)
    return _clray.make_mesh(points, np.ascontiguousarray(triangles, dtype=np.uint32))


def scene(content: Mapping[str, Any] | Any, faces: Any = None, *, folder: str | os.PathLike = ".",
          **more: Any) -> Scene:
    """A scene of a dict, or of a mesh with `more` keys, such as `material`, `source`, `detector`.

    The keys are those of scene files; a list of tables may be given as one table. A component's `mesh` is a mesh in
    memory (trimesh, or a pair of arrays) instead of its `file`. Files are looked for in `folder`.

        clray.scene({"component": {"shape": "sphere", "radius": 0.5}, "detector": {"kind": "delay"}})
        clray.scene(trimesh.creation.box(), material={"model": "lambert", "rho": 0.3})
    """
    if not isinstance(content, Mapping):
        content = {"component": {"mesh": mesh(content, faces)}}
    tables = {**content, **more}
    tables = {key: _as_list(key, value) for key, value in tables.items()}
    meshes: dict[str, Mesh] = {}
    materials = tables.get("material", [])
    for number, each in enumerate(materials):
        each.setdefault("name", f"material-{number}" if number else "material")
    files: dict[str, str] = {}
    if isinstance(tables.get("pass"), Mapping) and isinstance(tables["pass"].get("ephemeris"), Orbit):
        orbit = tables["pass"]["ephemeris"]
        files["orbit"] = orbit._file()
        tables["pass"] = {**tables["pass"], "ephemeris": "orbit", "frame": orbit.frame}
    components = tables.get("component", [])
    for number, component in enumerate(components):
        if "mesh" in component:
            name = f"mesh-{number}"
            given = component.pop("mesh")
            meshes[name] = mesh(given)
            component["file"] = name
        if len(materials) == 1 and "material" not in component and "materials" not in component:
            component["material"] = materials[0]["name"]
    return _clray.parse_scene(_toml(tables), os.path.join(os.fspath(folder), "scene"), meshes, files)


def _as_list(key: str, value: Any) -> Any:
    if key in ("material", "component", "variant", "observer", "detector"):
        tables = [value] if isinstance(value, (Mapping, str)) else list(value)
        return [{"kind": t} if isinstance(t, str) else dict(t) for t in tables]
    return value


def _text(text: str) -> str:
    out = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}" for c in out) + '"'


def _value(key: str, value: Any) -> str:
    value = in_unit(key, value)
    if hasattr(value, "tolist"):  # numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, (str, os.PathLike)):
        return _text(os.fspath(value))
    if isinstance(value, Mapping):
        pairs = [(k, _value(k if unit_of(k) else key, v)) for k, v in value.items() if v is not None]
        return "{ " + ", ".join(f"{_text(k)} = {v}" for k, v in pairs) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(key, each) for each in value) + "]"
    if isinstance(value, datetime) or hasattr(value, "to_datetime"):
        return _text(date_of(value).isoformat(timespec="microseconds"))
    raise TypeError(f"{key}: a scene has no {type(value).__name__}")


def _toml(tables: Mapping[str, Any]) -> str:
    single, several = [], []
    for key, value in tables.items():
        if value is None:
            continue
        if isinstance(value, list) and value and all(isinstance(each, Mapping) for each in value):
            for table in value:
                several.append(f"[[{key}]]")
                several += [f"{_text(k)} = {_value(k, v)}" for k, v in table.items() if v is not None]
        elif isinstance(value, Mapping):
            several.append(f"[{key}]")
            several += [f"{_text(k)} = {_value(k, v)}" for k, v in value.items() if v is not None]
        else:
            single.append(f"{key} = {_value(key, value)}")
    return "\n".join(single + several) + "\n"


def _direction(value: Any) -> tuple[float, float, float]:
    x, y, z = value
    return float(x), float(y), float(z)


def changed(scene: Scene, *, source: Any = None, observer: Any = None, materials: Mapping | None = None,
            views: Mapping | None = None, **options: Any) -> Scene:
    """A copy with a new direction of the light, of observers (one direction, or a dict by name), numbers of materials
    ({"paint": {"rho": 0.3}}), views, and options of [trace]."""
    import numpy as np

    scene = scene.copy()
    if source is not None:
        scene._set_source(*_direction(source))
    if observer is not None:
        if not isinstance(observer, Mapping):
            observer = {name: observer for name in scene.observers[:1]}
        for name, direction in observer.items():
            scene._set_observer(name, *_direction(direction))
    for name, numbers in (materials or {}).items():
        for key, value in numbers.items():
            scene._set_material(name, key, float(in_unit(key, value)))
    for key, value in options.items():
        if not hasattr(scene.trace, key):
            raise TypeError(f"[trace] has no key {key}")
        setattr(scene.trace, key, in_unit(key, value))
    if views:
        rows = {}
        for key in ("sources", "attitudes", "observers"):
            given = views.get(key)
            if given is None:
                rows[key] = None
                continue
            array = np.asarray(given, dtype=np.float64)
            rows[key] = np.ascontiguousarray(array.reshape(len(array), -1))
        scene._set_views(rows["sources"], rows["attitudes"], rows["observers"], seconds(views.get("times", ())).tolist())
    return scene
