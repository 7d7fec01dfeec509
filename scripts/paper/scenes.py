# SPDX-License-Identifier: Apache-2.0
"""Derives the scenes of figures 1, 2, 4 and 6 from meshes/*.toml, so that both describe the same bodies.

Written into the output's `scenes` folder beside copies of the meshes (scene files reach no other folder).
"""

import os
import re
import shutil

from data import LEVELS, LOBES, RHO, WIDTHS

BODIES = ("hexprism", "cylinder", "box_wing")
SHARE = {"diffuse": 0.8, "specular": 0.2}  # d of the paper's equation 9
EXPONENT = {"dull": 50, "sharp": 500}  # n of its equation 10
PARTS = ("front", "box", "wing")  # figure 1: the facet at the station, the rest of the box, the wings


def without_variants(text):
    return text[: text.index("[[variant]]")]


def set_keys(text, section, keys):
    """`text` with the lines of a section ("[motion]") replaced where a key is named, or added; None drops it."""
    match = re.search(rf"^{re.escape(section)}\n(?:(?!\[).*\n?)*", text, re.M)
    if not match:
        raise ValueError(f"no section {section}")
    if keys is None:
        return text[: match.start()] + text[match.end() :]
    kept = [line for line in match.group(0).rstrip("\n").split("\n") if line.split(" = ")[0] not in keys]
    lines = kept + [f"{key} = {value}" for key, value in keys.items() if value is not None]
    return text[: match.start()] + "\n".join(lines) + "\n\n" + text[match.end() :]


def copy_meshes(meshes, scenes):
    os.makedirs(scenes, exist_ok=True)
    for body in BODIES:
        for ending in ("obj", "mtl"):
            shutil.copyfile(f"{meshes}/{body}.{ending}", f"{scenes}/{body}.{ending}")


def picture_scene(meshes, scenes, body, step_deg, count, size, exposure_ev, lambert=False):
    """A scene that paints the body at 0, step, 2 step ... as the station lights and sees it; returns its path."""
    with open(f"{meshes}/{body}.toml", encoding="utf-8") as file:
        text = without_variants(file.read())
    period_s = float(re.search(r"^period_s = (\S+)", text, re.M).group(1))
    stop_s = ((count - 1) + 0.5) * step_deg / 360.0 * period_s
    text = set_keys(text, "[motion]", {"step_deg": step_deg, "stop_s": f"{stop_s:.6f}"})
    text = set_keys(text, "[station]", None)
    text = set_keys(
        text,
        "[[detector]]",
        {"kind": '"rgb"', "bins": None, "width": size[0], "height": size[1], "samples": 64, "exposure_ev": exposure_ev},
    )
    if lambert:
        text = set_keys(text, "[[material]]", {"model": '"lambert"', "rho": 0.5, "d": None, "n": None})
    path = f"{scenes}/{body}_picture.toml"
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def split_front(scenes):
    """Gives the box's facet at +z a material name of its own in the copied mesh."""
    with open(f"{scenes}/box_wing.obj", encoding="utf-8") as file:
        lines = file.read().split("\n")
    height = [float(line.split()[3]) for line in lines if line.startswith("v ")]
    out, split = [], 0
    for line in lines:
        corners = [int(word) for word in line.split()[1:]] if line.startswith("f ") else []
        if corners and split == 0 and all(height[corner - 1] == 1.0 for corner in corners):
            out += ["usemtl front", line, "usemtl box"]
            split += 1
        else:
            out.append(line)
    if split != 1:
        raise ValueError("box_wing.obj has no facet at z = 1")
    with open(f"{scenes}/box_wing_parts.obj", "w", encoding="utf-8") as file:
        file.write("\n".join(out).replace("box_wing.mtl", "box_wing_parts.mtl"))
    with open(f"{scenes}/box_wing.mtl", encoding="utf-8") as file:
        text = file.read()
    with open(f"{scenes}/box_wing_parts.mtl", "w", encoding="utf-8") as file:
        file.write(text + "\nnewmtl front\nKd 0.1 0.1 0.1\nKs 0.4 0.4 0.4\nNs 50\nillum 2\n")


def parts_scene(meshes, scenes):
    """Figure 1: the box-wing at 0 degrees, each part in turn with each surface, the others black; returns its path."""
    split_front(scenes)
    with open(f"{meshes}/box_wing.toml", encoding="utf-8") as file:
        text = without_variants(file.read())
    text = set_keys(text, "[motion]", None)
    text = set_keys(text, "[[detector]]", {"bins": 800, "start_ns": -20, "stop_ns": 20})
    material = re.search(r"^\[\[material\]\]\n(?:(?!\[).*\n)*", text, re.M).group(0)
    text = text.replace(material, "".join(material.replace('"surface"', f'"{part}"') for part in PARTS))
    text = set_keys(
        text,
        "[[component]]",
        {"file": '"box_wing_parts.obj"', "material": None,
         "materials": '{ front = "front", box = "box", wing = "wing" }'},
    )
    for level in LEVELS:
        for lobe in LOBES:
            for width in WIDTHS:
                for part in PARTS:
                    surface = f"d = {SHARE[lobe]}, n = {EXPONENT[width]}"
                    entries = [
                        f'{{ name = "{other}", rho = {RHO[level] if other == part else 0.0}, {surface} }}'
                        for other in PARTS
                    ]
                    text += f'\n[[variant]]\nname = "{level}-{lobe}-{width}-{part}"\n'
                    text += f'material = [{", ".join(entries)}]\n'
    path = f"{scenes}/box_wing_parts.toml"
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path
