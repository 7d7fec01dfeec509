# SPDX-License-Identifier: Apache-2.0
"""Traces what the paper's figures need, then draws them and works out the numbers; called by scripts/paper/run.

Order: sessions of the three bodies (figures 3, 5, 7), the parts of the box-wing (figure 1), pictures (2, 4, 6).
"""

import argparse
import os
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import figures  # noqa: E402
import measures  # noqa: E402
import scenes  # noqa: E402
from data import Body, read_summary  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PARTS_RAYS = 1 << 22  # figure 1 shows single bins of faint wings

# figure: body, step in degrees, orientations, pixels of one picture, exposure in stops, Lambert instead of the
# scene's surface
PICTURES = {
    2: ("hexprism", 15, 3, (480, 480), 0.5, False),
    4: ("cylinder", 45, 3, (480, 480), 0.0, True),
    6: ("box_wing", 45, 4, (700, 525), 0.3, False),
}


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/paper/run")
    parser.add_argument("--out", default="clray-out/paper")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--rays", type=int, default=131072)
    parser.add_argument("--clray", default=f"{ROOT}/build/release/clray")
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--reuse", action="store_true")
    return parser.parse_args()


class Runner:
    """Calls clray, says what runs and how long it took, and ends at the first failure."""

    def __init__(self, options):
        self.options = options
        self.start = time.monotonic()

    def say(self, text):
        print(f"paper: {time.monotonic() - self.start:6.1f} s  {text}", flush=True)

    def clray(self, scene, name, more):
        folder = f"{self.options.out}/runs/{name}"
        if self.options.reuse and os.path.exists(f"{folder}/summary.json"):
            return folder
        self.say(f"tracing {name}")
        command = [self.options.clray, "--device", self.options.device, "--no-plots", "--quiet", "--out", folder]
        done = subprocess.run([*command, *more, scene], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            sys.exit(f"paper: clray failed on {scene}:\n{done.stdout}")
        return folder


def main():
    options = arguments()
    runner = Runner(options)
    os.makedirs(f"{options.out}/runs", exist_ok=True)
    folder_of_scenes, meshes = f"{options.out}/scenes", f"{ROOT}/meshes"
    scenes.copy_meshes(meshes, folder_of_scenes)
    bodies = {}
    for name in scenes.BODIES:
        # A relative path keeps the digests' and tables' headers free of this machine's folders.
        scene = os.path.relpath(f"{meshes}/{name}.toml")
        bodies[name] = Body(runner.clray(scene, name, ["--rays", str(options.rays)]))
    parts = runner.clray(scenes.parts_scene(meshes, folder_of_scenes), "box_wing_parts", ["--rays", str(PARTS_RAYS)])
    pictures = {}
    for figure, (name, step, count, size, exposure, lambert) in PICTURES.items():
        scene = scenes.picture_scene(meshes, folder_of_scenes, name, step, count, size, exposure, lambert)
        folder = runner.clray(scene, f"{name}_picture", [])
        views = read_summary(folder)["detectors"]["rgb"]["orientations"]
        pictures[figure] = [
            (f"{folder}/rgb-{i:04d}.png", step * i, size, f"{meshes}/{name}.obj", views[i]) for i in range(count)
        ]
    runner.say("drawing")
    figures.draw_all(options.out, bodies, parts, pictures)
    runner.say("working out the numbers")
    text = measures.write_all(options.out, bodies, parts)
    if options.docs:
        measures.update_docs(f"{ROOT}/docs/paper.md", text)
        os.makedirs(f"{ROOT}/docs/paper", exist_ok=True)
        for figure in range(1, 8):
            shutil.copyfile(f"{options.out}/figure{figure}.png", f"{ROOT}/docs/paper/figure{figure}.png")
    runner.say(f"done: figures 1-7, tables and numbers.md are in {options.out}")


if __name__ == "__main__":
    main()
