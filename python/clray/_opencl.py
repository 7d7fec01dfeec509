# SPDX-License-Identifier: Apache-2.0
"""PoCL from pip: the package pocl-binary-distribution brings a driver for CPUs that no OpenCL loader looks for, and
which links kernels as a compiler does: with `ld` and with libraries of gcc's.

The loader reads a folder of files, each with a driver's path: /etc/OpenCL/vendors, or what OCL_ICD_VENDORS names. Where
neither has PoCL, such a folder is made for this process, with the system's drivers and that one. Where no gcc is
installed, an `ld` of its own leaves out its libraries, which kernels need not, and runs the system's `ld` or LLVM's,
which the package ziglang brings."""
from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path

_SYSTEM = "/etc/OpenCL/vendors"
_GCC = ("usr/lib/gcc/*/*/libgcc.a", "usr/lib64/gcc/*/*/libgcc.a")  # in /
_LINKER = """#!/bin/sh
# Links a kernel without the libraries of a compiler: their functions are those of the process that loads it.
for word; do
  shift
  case $word in
    -lgcc | -lgcc_s | -lc | crt*.o | */crt*.o) ;;
    *) set -- "$@" "$word" ;;
  esac
done
exec {linker} "$@"
"""


def _folder_of(package: str) -> Path | None:
    spec = find_spec(package)
    return Path(spec.origin).parent if spec is not None and spec.origin is not None else None


def _pocl_of_pip() -> Path | None:
    package = _folder_of("pocl_binary_distribution")
    found = sorted((package.parent / "pyopencl" / ".libs").glob("libpocl*.so*")) if package else []
    return found[0] if found else None


def _drivers(folder: Path) -> dict[str, str]:
    return {file.name: file.read_text() for file in sorted(folder.glob("*.icd"))}


def _remove_at_exit(folder: Path) -> None:
    import atexit
    import shutil

    process = os.getpid()

    def remove() -> None:
        if os.getpid() == process:  # not where a forked child ends
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)


def _linker() -> str | None:
    """What links in place of `ld`, as words of a shell; "" where that needs no help, None where there is nothing."""
    import shlex
    import shutil

    linker = shutil.which("ld")
    if linker is not None and any(True for pattern in _GCC for _ in Path("/").glob(pattern)):
        return ""
    if linker is not None:
        return shlex.quote(linker)
    zig = _folder_of("ziglang")
    return shlex.quote(str(zig / "zig")) + " ld.lld" if zig is not None else None


def offer_pocl(system: str = _SYSTEM) -> None:
    """Adds PoCL of pip to the drivers of this process, before its first OpenCL call. A choice by the user stands."""
    chosen = os.environ.get("OCL_ICD_VENDORS")
    if (chosen and os.path.exists(chosen)) or os.environ.get("OCL_ICD_FILENAMES"):
        return
    library = _pocl_of_pip()
    if library is None:
        return
    drivers = _drivers(Path(system))
    if any("pocl" in name + path for name, path in drivers.items()):
        return
    import tempfile  # imports take time, and few processes come here
    import warnings

    linker = _linker()
    if linker is None:
        warnings.warn("PoCL of pocl-binary-distribution is left out: it needs a linker, that of the system's package "
                      "binutils or of `pip install ziglang`", stacklevel=3)
        return
    folder = Path(tempfile.mkdtemp(prefix="clray-opencl-"))
    _remove_at_exit(folder)
    for name, path in {**drivers, "pocl.icd": f"{library}\n"}.items():
        (folder / name).write_text(path)
    os.environ["OCL_ICD_VENDORS"] = str(folder)
    if linker:
        script = folder / "ld"
        script.write_text(_LINKER.replace("{linker}", linker))
        script.chmod(0o755)
        os.environ["PATH"] = os.pathsep.join([str(folder), os.environ.get("PATH", os.defpath)])
