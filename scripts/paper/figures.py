# SPDX-License-Identifier: Apache-2.0
"""Draws figures 1-7 with gnuplot from the runs' own files, and writes figure1.csv.

Called by main.py. Axes: delay in ns after a path by way of the body's origin, time in s, photons per ns and shot.
"""

import subprocess
import sys

from data import rows_of
from edges import visible_edges

FIGURE1_SET = "medium-specular-dull"
SESSION_SETS = ("low-diffuse-dull", "low-specular-dull", "medium-diffuse-dull", "medium-specular-dull")
NAMES = {
    "low-diffuse-dull": "low reflectivity, diffuse",
    "low-specular-dull": "low reflectivity, specular",
    "medium-diffuse-dull": "medium reflectivity, diffuse",
    "medium-specular-dull": "medium reflectivity, specular",
}
# figure: body, delays shown
SESSIONS = {3: ("hexprism", (-8, 4)), 5: ("cylinder", (-14, 14)), 7: ("box_wing", (-38, 38))}
INK = "#1f2933"
COLOURS = {"front": "#c2410c", "box": "#6b7280", "wing": "#0b4f94"}


def gnuplot(script):
    done = subprocess.run(["gnuplot", "-d", "-"], input=script, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    if done.returncode != 0:
        sys.exit(f"paper: gnuplot failed:\n{done.stdout}")


def quoted(text):
    return "'" + text.replace("'", "''") + "'"


def terminal(path, width, height, background="#ffffff"):
    return (
        f"set encoding utf8\nset terminal pngcairo noenhanced size {width},{height} font 'DejaVu Sans,15' "
        f"background '{background}'\nset output {quoted(path)}\n"
        f"set border 3 linecolor rgb '{INK}' linewidth 1\nset tics nomirror out textcolor rgb '{INK}'\n"
    )


def part_rates(parts_folder, name):
    """Figure 1's pulse: delay (ns), then photons per ns and shot of front facet, rest of the box, wings."""
    columns = []
    for part in ("front", "box", "wing"):
        rows = list(rows_of(f"{parts_folder}/delay-{name}-{part}.csv"))
        columns.append([float(row["photons_per_ns"]) for row in rows])
    delay = [float(row["delay_ns"]) for row in rows]
    return delay, *columns


def pulse(out, parts_folder):
    table = f"{out}/figure1.csv"
    delay, front, box, wing = part_rates(parts_folder, FIGURE1_SET)
    with open(table, "w", encoding="utf-8") as file:
        file.write(f"# box-wing at 0 degrees, {FIGURE1_SET}: photons per ns and shot\n")
        file.write("delay_ns,total,front_facet,rest_of_box,wings\n")
        for row in zip(delay, front, box, wing):
            file.write(f"{row[0]:.4f},{sum(row[1:]):.6g},{row[1]:.6g},{row[2]:.6g},{row[3]:.6g}\n")
    top = 1.12 * max(map(sum, zip(front, box, wing)))
    wing_top = max(wing)
    plots = ", ".join(
        f"{quoted(table)} using 1:{column} every ::1 with filledcurves y1=0 fillcolor rgb '{COLOURS[part]}' "
        f"fillstyle transparent solid 0.35 noborder title {quoted(title)}"
        for column, part, title in (
            (3, "front", "facet of the box that faces the station"),
            (4, "box", "top of the box"),
            (5, "wing", "wings"),
        )
    )
    gnuplot(
        terminal(f"{out}/figure1.png", 1200, 640)
        + "set datafile separator comma\nset key top right reverse Left spacing 1.25 samplen 2\n"
        + "set xlabel 'delay (ns), zero at the centre of the body'\n"
        + "set ylabel 'received intensity (photons/ns per shot)'\n"
        + f"set xrange [-20:20]\nset yrange [0:{top:.4g}]\nset xtics 5\nset mxtics 5\n"
        + f"set label 'near wing' at -12.5,{2.2 * wing_top:.5g} center textcolor rgb '{COLOURS['wing']}'\n"
        + f"set label 'far wing' at 12.5,{2.2 * wing_top:.5g} center textcolor rgb '{COLOURS['wing']}'\n"
        + f"plot {plots}, {quoted(table)} using 1:2 every ::1 with lines linewidth 1.6 linecolor rgb '{INK}' "
        + "title 'together'\n"
    )


def pictures(out, figure, shots, crop, columns):
    """A strip of pictures on a night-sky ground; `crop` is the share of width and height kept around the middle."""
    width, height = (round(size * share) for size, share in zip(shots[0][2], crop))
    rows = (len(shots) + columns - 1) // columns
    title, ground = 34, "#05070a"
    total = (columns * width, rows * (height + title))
    script = terminal(f"{out}/figure{figure}.png", *total, ground)
    script += "unset border\nunset tics\nunset key\nset multiplot\n"
    for i, (path, degrees, size, mesh, view) in enumerate(shots):
        left, bottom = i % columns * width / total[0], 1 - (i // columns + 1) * (height + title) / total[1]
        x0, y0 = (size[0] - width) / 2 - 0.5, (size[1] - height) / 2 - 0.5
        script += (
            f"set lmargin at screen {left:.6f}\nset rmargin at screen {left + width / total[0]:.6f}\n"
            f"set bmargin at screen {bottom:.6f}\nset tmargin at screen {bottom + height / total[1]:.6f}\n"
            f"unset label\nset label '{degrees}°' at screen {left + 0.5 * width / total[0]:.6f},"
            f"{bottom + (height + 0.5 * title) / total[1]:.6f} center textcolor rgb '#e5e7eb' font ',17'\n"
            f"set xrange [{x0}:{x0 + width}]\nset yrange [{y0}:{y0 + height}]\n"
        )
        middle, scale = ((size[0] - 1) / 2, (size[1] - 1) / 2), 1.0 / view["pixel_m"]
        lines = [
            "\n".join(" ".join(f"{middle[i] + scale * end[i]:.2f}" for i in (0, 1)) for end in piece)
            for piece in visible_edges(mesh, view)
        ]
        script += f"$edges{i} << EOD\n" + "\n\n".join(lines) + "\nEOD\n"
        script += f"plot {quoted(path)} binary filetype=png with rgbalpha, $edges{i} with lines linewidth 1.1 "
        script += "linecolor rgb '#55d5ffd5'\n"
    gnuplot(script + "unset multiplot\n")


def sessions(out, figure, body, delays):
    """Delay against time, a dot for each shot that recorded a photon, signal or noise alike, as a station sees them."""
    last = float(body.totals[SESSION_SETS[0]][-1]["time_s"])
    script = terminal(f"{out}/figure{figure}.png", 1500, 1040)
    script += "set datafile separator comma\nunset key\nset multiplot\n"
    script += f"set xrange [0:{last:g}]\nset yrange [{delays[0]}:{delays[1]}]\nset xtics {last / 4:g}\n"
    script += "set mxtics 5\nset mytics 2\n"
    for i, name in enumerate(SESSION_SETS):
        column, row = i % 2, i // 2
        left, bottom = 0.058 + 0.487 * column, 0.57 - 0.488 * row
        script += (
            f"set lmargin at screen {left}\nset rmargin at screen {left + 0.435}\n"
            f"set bmargin at screen {bottom}\nset tmargin at screen {bottom + 0.385}\n"
            f"set title {quoted(NAMES[name])} font ',17' offset 0,-0.4 textcolor rgb '{INK}'\n"
            + ("set ylabel 'delay (ns)' offset 1\n" if column == 0 else "unset ylabel\n")
            + ("set xlabel 'time (s)' offset 0,0.3\n" if row == 1 else "unset xlabel\n")
            + f"plot {quoted(body.session_file(name))} using 1:3 every ::1 with points pointtype 7 pointsize 0.22 "
            f"linecolor rgb '#800b3a6e'\n"
        )
    gnuplot(script + "unset multiplot\n")


def draw_all(out, bodies, parts_folder, shots):
    pulse(out, parts_folder)
    pictures(out, 2, shots[2], (1.0, 1.0), 3)
    pictures(out, 4, shots[4], (1.0, 1.0), 3)
    pictures(out, 6, shots[6], (1.0, 0.62), 2)
    for figure, (name, delays) in SESSIONS.items():
        sessions(out, figure, bodies[name], delays)
