# SPDX-License-Identifier: Apache-2.0
"""clray traces light on space objects: laser pulses, light curves, radiation pressure, pictures.

    import clray
    result = clray.trace(clray.load("box_wing.obj"))
    result.delay.A_t.plot()

Results are xarray data sets in SI units. docs/python.md tells more.
"""
from ._opencl import offer_pocl
from ._clray import DeviceInfo, Error, Mesh, Scene, TraceOptions, devices, load_mesh
from ._orbits import Orbit, orbit_from_spice, orbit_from_tle
from ._periods import periods
from ._scene import load, mesh, scene
from ._trace import Device, Prepared, Result, trace

offer_pocl()
del offer_pocl

__version__ = "0.1.0"
__all__ = ["Device", "DeviceInfo", "Error", "Mesh", "Orbit", "Prepared", "Result", "Scene", "TraceOptions", "devices", "load",
           "load_mesh", "mesh", "orbit_from_spice", "orbit_from_tle", "periods", "scene", "trace"]
