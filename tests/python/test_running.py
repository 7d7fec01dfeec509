# SPDX-License-Identifier: Apache-2.0
"""Traces that run: progress, threads, ends from outside; and what a package has beside its functions."""
import ast
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import clray

SPHERE = {"component": {"shape": "sphere", "radius": 0.5}, "detector": "spectrometer"}


def sampled(rho=0.3, **trace):
    return clray.scene({**SPHERE, "material": {"name": "paint", "model": "lambert", "rho": rho}, "trace": trace})


def test_progress_is_told_to_a_function():
    told = []
    clray.trace(sampled(rays=1 << 22), device="cpu", progress=lambda *now: told.append(now))
    assert told and {phase for phase, *_ in told} <= {"search", "confirm", "trace"}
    fractions = [fraction for _, fraction, *_ in told]
    assert fractions == sorted(fractions) and 0.0 <= fractions[0] and fractions[-1] <= 1.0
    assert [rays for _, _, rays, *_ in told] == sorted(rays for _, _, rays, *_ in told)


def test_progress_is_drawn_by_tqdm(capsys):
    clray.trace(sampled(rays=1 << 22), device="cpu", progress=True)
    assert "%|" in capsys.readouterr().err
    clray.trace(sampled(rays=1 << 20), device="cpu")  # no terminal
    clray.trace(sampled(rays=1 << 20), device="cpu", progress=False)
    assert capsys.readouterr().err == ""


def test_another_thread_ends_a_trace():
    stop = threading.Event()
    threading.Timer(0.4, stop.set).start()
    start = time.monotonic()
    result = clray.trace(sampled(time_limit_s=60.0), device="cpu", stop=stop)
    assert time.monotonic() - start < 30.0
    assert result.partial and result.stopped_by == "interrupt"
    assert float(result.spectrometer.A) == pytest.approx(0.05, rel=1e-3)  # 2/3 rho r^2
    assert not clray.trace(sampled(rays=4096), device="cpu", stop=threading.Event()).partial


def test_threads_share_a_device_or_have_their_own():
    scenes = [sampled(rho=0.1 * k, rays=1 << 14) for k in range(1, 6)]
    alone = [clray.trace(scene, device="cpu").digest for scene in scenes]
    shared = clray.Device("cpu")
    for device in (lambda: shared, lambda: clray.Device("cpu")):
        found = [None] * len(scenes)

        def run(k):
            found[k] = clray.Prepared(scenes[k], device=device()).trace().digest

        threads = [threading.Thread(target=run, args=(k,)) for k in range(len(scenes))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert found == alone and len(set(alone)) == len(alone)


def test_the_package_has_its_types():
    package = Path(clray.__file__).parent
    assert (package / "py.typed").exists()
    stub = ast.parse((package / "_clray.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    assert {"Scene", "Device", "Prepared", "Mesh", "TraceOptions", "Result"} <= set(classes)
    names = {node.name for node in classes["TraceOptions"].body if isinstance(node, ast.FunctionDef)}
    assert {"rays", "seed", "time_limit_s", "method"} <= names
    for name in clray.__all__:
        assert getattr(clray, name).__doc__, name


def driver_files(tmp_path, monkeypatch, system=(), has=("ld", "gcc"),
                 packages=("pocl_binary_distribution", "ziglang")):
    """What offer_pocl() makes of made-up packages and a made-up system; the folder's files, or nothing."""
    from clray import _opencl

    monkeypatch.setattr(_opencl, "_GCC", ("*",) if "gcc" in has else ())

    for package in packages:
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").write_text("")
    library = tmp_path / "pyopencl" / ".libs" / "libpocl-1.so"
    library.parent.mkdir(parents=True)
    library.write_text("")
    (tmp_path / "vendors").mkdir()
    for name, path in system:
        (tmp_path / "vendors" / name).write_text(path)
    (tmp_path / "bin").mkdir()
    if "ld" in has:
        (tmp_path / "bin" / "ld").write_text("#!/bin/sh\necho linked $*\n")
        (tmp_path / "bin" / "ld").chmod(0o755)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("OCL_ICD_VENDORS", "")  # what comes instead goes with the test
    _opencl.offer_pocl(str(tmp_path / "vendors"))
    made = os.environ["OCL_ICD_VENDORS"]
    return {file.name: file.read_text().strip() for file in Path(made).iterdir()} if made else {}


def test_pocl_of_pip_joins_the_drivers_of_the_system(tmp_path, monkeypatch):
    files = driver_files(tmp_path, monkeypatch, system=[("nvidia.icd", "libnvidia-opencl.so.1")])
    assert files == {"nvidia.icd": "libnvidia-opencl.so.1", "pocl.icd": str(tmp_path / "pyopencl/.libs/libpocl-1.so")}


def test_pocl_of_the_system_comes_first(tmp_path, monkeypatch):
    assert driver_files(tmp_path, monkeypatch, system=[("pocl.icd", "libpocl.so.2")]) == {}


def test_pocl_of_pip_gets_a_linker(tmp_path, monkeypatch):
    files = driver_files(tmp_path, monkeypatch, has=())
    assert str(tmp_path / "ziglang" / "zig") + ' ld.lld "$@"' in files["ld"]
    folder = os.environ["PATH"].split(os.pathsep)[0]
    assert os.access(os.path.join(folder, "ld"), os.X_OK)


def test_the_linker_does_without_the_libraries_of_gcc(tmp_path, monkeypatch):
    driver_files(tmp_path, monkeypatch, has=("ld",))
    words = ["ld", "-shared", "-o", "a b.so", "crti.o", "/usr/lib/crtn.o", "k.o", "-lgcc", "--as-needed", "-lgcc_s", "-lc"]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    assert done.stdout == "linked -shared -o a b.so k.o --as-needed\n"


def test_pocl_of_pip_without_a_linker_is_left_out(tmp_path, monkeypatch):
    with pytest.warns(UserWarning, match="binutils"):
        assert driver_files(tmp_path, monkeypatch, has=(), packages=("pocl_binary_distribution",)) == {}


def test_the_code_of_the_readme_runs(tmp_path):
    with open(os.path.join(os.environ["CLRAY_SOURCE_DIR"], "README.md"), encoding="utf-8") as file:
        code = file.read().split("**From Python**")[1].split("```python\n")[1].split("```")[0]
    os.symlink(os.path.join(os.environ["CLRAY_SOURCE_DIR"], "meshes"), tmp_path / "meshes")
    code += "\nfrom matplotlib import pyplot\npyplot.savefig('pulse.png')\n"
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, env={**os.environ, "MPLBACKEND": "Agg"})
    assert (tmp_path / "pulse.png").read_bytes()[:4] == b"\x89PNG"
