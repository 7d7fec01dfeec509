# SPDX-License-Identifier: Apache-2.0
"""The Python package against closed forms, the program's own output and runs alone."""
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import trimesh

import clray

SOURCE = os.environ["CLRAY_SOURCE_DIR"]
MESHES = os.path.join(SOURCE, "meshes")
BOX_WING = os.path.join(MESHES, "box_wing.obj")
C = 299792458.0


def plate(a=2.0, b=1.0):
    vertices = np.array([[0, 0, 0], [a, 0, 0], [a, b, 0], [0, b, 0]], dtype=float)
    return vertices, np.array([[0, 1, 2], [0, 2, 3]])


def plate_scene(**more):
    return clray.scene(plate(), material={"name": "paint", "model": "lambert", "rho": 0.3}, **more)


@pytest.fixture(scope="module")
def box_wing():
    return clray.trace(clray.load(BOX_WING), device="cpu")


def test_the_readme_digest(box_wing):
    assert box_wing.digest == "4fe1d4473723a94b"


def test_the_numbers_are_those_of_the_program(box_wing, tmp_path):
    out = tmp_path / "out"
    subprocess.run([os.environ["CLRAY_PROGRAM"], "--device", "cpu", "--no-plots", "--out", out, BOX_WING],
                   check=True, capture_output=True)
    summary = json.loads((out / "summary.json").read_text())
    assert summary["digest"] == box_wing.digest == box_wing.summary["digest"]
    assert summary["detectors"] == box_wing.summary["detectors"]
    assert float(box_wing.delay.A) == summary["detectors"]["delay"]["intensity_m2_per_sr"]


def test_the_code_of_the_how_to_prints_what_it_says(tmp_path):
    with open(os.path.join(SOURCE, "docs", "how-to.md"), encoding="utf-8") as file:
        section = file.read().split("## Call the library from Python\n")[1]
    code = section.split("```python\n")[1].split("```")[0]
    printed = subprocess.run([sys.executable, "-c", code], cwd=MESHES, check=True, capture_output=True, text=True)
    assert f"prints `{printed.stdout.strip()}`" in section


def test_a_plate_has_its_closed_form():
    # Lambert's plate from theta: A = rho / pi * a b cos^2(theta); delays of its points are -2 r.s / c.
    theta = 0.6
    s = np.array([math.sin(theta), 0.0, math.cos(theta)])
    result = clray.trace(plate_scene(), device="cpu", source=s)
    delay = result.delay
    assert float(delay.A) == pytest.approx(0.3 / math.pi * 2.0 * math.cos(theta) ** 2, rel=1e-12)
    assert float(delay.A_error) == 0.0
    assert float(delay.mean_delay) == pytest.approx(-2.0 * math.sin(theta) / C, rel=1e-9)
    assert float(delay.A_t.sum()) == pytest.approx(float(delay.A), rel=1e-12)
    assert delay.A.attrs["units"] == "m2 sr-1" and delay.delay_ns.attrs["units"] == "ns"
    assert delay.A_t.dims == ("delay_ns",)
    mean = float((delay.A_t * delay.delay_ns).sum() / delay.A)  # a bin's middle stands for its light
    assert mean == pytest.approx(-2.0 * math.sin(theta) / C * 1e9, abs=delay.attrs["bin_width_ns"])


def test_many_views_are_one_dimension_and_have_the_bits_of_runs_alone():
    angles = np.linspace(0.0, 1.2, 7)
    suns = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=1)
    prepared = clray.Prepared(plate_scene(detector=["spectrometer", "pressure"]), device="cpu")
    result = prepared.trace(sources=suns)
    assert result.spectrometer.A.dims == ("view",)
    assert result.pressure.C.dims == ("view", "axis")
    np.testing.assert_allclose(result.spectrometer.A, 0.3 / math.pi * 2.0 * np.cos(angles) ** 2, rtol=1e-12)
    # Lambert's plate, normal z: C = -a b cos (s (1 - 0) + 2/3 rho n), docs/physics.md
    force = -2.0 * np.cos(angles)[:, None] * (suns + 2.0 / 3.0 * 0.3 * np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(result.pressure.C, force, rtol=1e-12, atol=1e-12)
    for k in (0, 3, 6):
        alone = clray.trace(prepared.scene, device="cpu", source=suns[k])
        assert float(result.spectrometer.A[k]) == float(alone.spectrometer.A)
        assert prepared.trace(source=suns[k]).digest == alone.digest
    np.testing.assert_allclose(result.views.source, suns, atol=1e-15)


def test_attitudes_turn_the_scene_s_own_directions():
    angle = 0.5
    quaternion = [[math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0]]  # body to space, about y
    result = clray.Prepared(plate_scene(), device="cpu").trace(attitudes=quaternion)
    np.testing.assert_allclose(result.views.source[0], [-math.sin(angle), 0.0, math.cos(angle)], atol=1e-15)
    assert float(result.delay.A) == pytest.approx(0.6 / math.pi * math.cos(angle) ** 2, rel=1e-12)


def test_dimensions_of_observers_variants_and_bands():
    scene = plate_scene(
        source={"kind": "sun", "bands": [[400, 500], [500, 600]], "direction": [0, 0, 1]},
        observer=[{"name": "a", "direction": [0, 0, 1]}, {"name": "b", "direction": [0, 0.6, 0.8]}],
        variant=[{"name": "dull", "material": [{"name": "paint", "rho": 0.1}]},
                 {"name": "bright", "material": [{"name": "paint", "rho": 0.9}]},
                 {"name": "white", "material": [{"name": "paint", "rho": 1.0}]}],
        detector="spectrometer")
    a = clray.trace(scene, device="cpu").spectrometer.A
    assert a.dims == ("observer", "variant", "band") and a.shape == (2, 3, 2)
    rho = np.array([0.1, 0.9, 1.0])
    for observer, cosine in (("a", 1.0), ("b", 0.8)):
        for band in a.band.values:
            np.testing.assert_allclose(a.sel(observer=observer, band=band), rho / math.pi * 2.0 * cosine, rtol=1e-12)


def test_materials_change_between_traces():
    prepared = clray.Prepared(plate_scene(), device="cpu")
    bright = prepared.trace(materials={"paint": {"rho": 0.6}})
    assert float(bright.delay.A) == pytest.approx(2.0 * float(prepared.trace().delay.A), rel=1e-12)
    assert prepared.scene.materials["paint"]["rho"] == 0.3


def test_a_trimesh_is_its_arrays_and_its_file(tmp_path):
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    box.export(tmp_path / "box.off")
    material = {"model": "lambert", "rho": 0.5}
    options = {"source": {"direction": [1, 1, 1]}}
    found = clray.trace(clray.scene(box, material=material, **options), device="cpu")
    arrays = clray.trace(clray.scene((box.vertices, box.faces), material=material, **options), device="cpu")
    file = clray.scene({"component": {"file": "box.off"}, "material": material, **options}, folder=tmp_path)
    assert found.digest == arrays.digest == clray.trace(file, device="cpu").digest
    # Each face is seen from (1,1,1)/sqrt(3): A = rho/pi * sum of areas * 1/3.
    assert float(found.delay.A) == pytest.approx(0.5 / math.pi * (2 + 3 + 6) / 3.0, rel=1e-12)


def test_pictures():
    result = clray.trace(plate_scene(detector={"kind": "rgb", "width": 16, "height": 12, "samples": 4}), device="cpu")
    picture = result.rgb
    assert picture.radiance.shape == (1, 12, 16)
    # Lambert's radiance over irradiance in normal light is rho / pi, where the plate fills a pixel.
    assert float(picture.radiance.max()) == pytest.approx(0.3 / math.pi, rel=1e-6)
    assert float(picture.coverage.sum()) * picture.attrs["pixel_m"] ** 2 == pytest.approx(2.0, rel=0.02)


@pytest.mark.parametrize("scene, code, place, said", [
    ({"component": {"shape": "sphere", "radius": -1.0}}, "input", "scene:", "radius"),
    ({"component": {"shape": "spher"}}, "input", "scene:", "sphere"),
    ({"detector": "delay"}, "input", "scene:", "component"),
    ({"component": {"shape": "sphere", "radius": 1.0}, "nonsense": 1}, "input", "scene:", "nonsense"),
    ({"component": {"file": "nowhere.obj"}}, "input", "scene:", "nowhere.obj"),
])
def test_bad_scenes_say_what_and_where(scene, code, place, said):
    with pytest.raises(clray.Error) as caught:
        clray.scene(scene)
    assert caught.value.code == code
    assert place in caught.value.context
    assert said in str(caught.value)


def test_bad_arguments():
    with pytest.raises(clray.Error, match="no device|nonesuch"):
        clray.trace(plate_scene(), device="nonesuch")
    with pytest.raises(clray.Error, match="no such file"):
        clray.load("nowhere.toml")
    with pytest.raises(clray.Error, match="not all zero"):
        clray.trace(plate_scene(), device="cpu", source=[0, 0, 0])
    with pytest.raises(clray.Error, match="no material"):
        clray.trace(plate_scene(), device="cpu", materials={"nobody": {"rho": 1}})
    with pytest.raises(TypeError, match="nonsense"):
        clray.trace(plate_scene(), device="cpu", nonsense=1)
    with pytest.raises(ValueError, match="vertex"):
        clray.mesh(np.zeros((3, 3)), np.array([[0, 1, 3]]))
    with pytest.raises(clray.Error, match="as many views"):
        clray.Prepared(plate_scene(), device="cpu").trace(sources=[[0, 0, 1]], attitudes=[[1, 0, 0, 0]] * 2)
    with pytest.raises(AttributeError, match="spectrometer"):
        clray.trace(plate_scene(), device="cpu").spectrometer  # pylint: disable=expression-not-assigned


def test_other_threads_run_while_it_traces():
    scene = plate_scene()
    scene.trace.method, scene.trace.time_limit_s = "points", 0.5
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.005)

    other = threading.Thread(target=count)
    other.start()
    clray.trace(scene, device="cpu")
    stop.set()
    other.join()
    assert counted[0] > 20


def test_ctrl_c_stops_a_trace_and_the_device_stays_good():
    scene = plate_scene()
    scene.trace.method, scene.trace.time_limit_s = "points", 60.0
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        clray.trace(scene, device="cpu")
    assert time.monotonic() - start < 30.0
    assert clray.trace(plate_scene(), device="cpu").digest == clray.trace(plate_scene(), device="cpu").digest


def test_an_error_in_a_callback_comes_back():
    from clray import _clray

    def bad(*_):
        raise ZeroDivisionError("mine")

    scene = plate_scene()
    scene.trace.method, scene.trace.rays = "points", 1 << 22
    with pytest.raises(ZeroDivisionError, match="mine"):
        _clray.trace(scene, _clray.Device("cpu"), bad)


def test_plots_and_notebooks(box_wing):
    import matplotlib

    matplotlib.use("Agg")
    axes = box_wing.delay.clray.plot()
    assert axes.get_xlabel() == "delay (ns)"
    many = clray.Prepared(plate_scene(detector=["spectrometer", "pressure"]), device="cpu").trace(
        sources=[[0, 0, 1], [0, 0.6, 0.8]])
    assert many.spectrometer.clray.plot().get_ylabel() == "A (m²/sr)"
    assert many.pressure.clray.plot().get_ylabel() == "C (m²)"
    html = box_wing._repr_html_()
    assert "4fe1d4473723a94b" in html and "data:image/png;base64," in html


def test_results_are_written_as_the_program_writes_them(box_wing, tmp_path):
    names = box_wing.write(tmp_path / "out", plots=False)
    assert {"summary.json", "delay.csv"} <= set(names)


def test_the_import_is_quick():
    # Of the processor's time, as other tests run beside it.
    code = "import time; t = time.process_time(); import clray; print(time.process_time() - t)"
    best = min(float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
               for _ in range(3))
    assert best < 0.3


def test_options_that_are_words():
    scene = plate_scene()
    assert (scene.trace.method, scene.trace.sampler) == ("auto", "strata")
    scene.trace.method, scene.trace.sampler = "points", "random"
    assert (scene.trace.method, scene.trace.sampler) == ("points", "random")
    with pytest.raises(clray.Error, match="sampler: expected one of random, sobol, strata"):
        scene.trace.sampler = "halton"
