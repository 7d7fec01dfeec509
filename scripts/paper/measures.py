# SPDX-License-Identifier: Apache-2.0
"""The numbers behind docs/paper.md: what the paper says of its figures, measured on ours.

Writes numbers.md and brightness.csv. Photons are expected signal photons per shot. Turns and half turns are averaged
without their last orientation, which is the first again.
"""

import math
import statistics

from data import LEVELS, LOBES, RHO, SETS, WIDTHS, rows_of
from figures import FIGURE1_SET, SESSION_SETS, part_rates
from scenes import BODIES, SHARE

TITLES = {"hexprism": "prism", "cylinder": "cylinder", "box_wing": "box-wing"}
NOISE_PER_NS, RATE_HZ = 0.001, 2000.0
NEAR_SIDE_NS = (-8.5, -2.0)  # delays of the prism's near facets
BEGIN, END = "<!-- numbers: begin {} -->", "<!-- numbers: end {} -->"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def signed(percent):
    return f"{percent:+.2f}".replace("-0.00", "0.00").replace("+0.00", "0.00")


def diffuse_photons(body, name, area_m2, cosine):
    """Photons of the diffuse term alone, plate in full view: (R_d of docs/physics.md, section 2) * area * cosine^2."""
    level, lobe, _ = name.split("-")
    rho, d = RHO[level], SHARE[lobe]
    g = 1.0 - (1.0 - cosine / 2.0) ** 5
    brdf = d * 28.0 * rho / (23.0 * math.pi) * (1.0 - (1.0 - d) * rho) * g * g
    return body.photons_per_area * brdf * area_m2 * cosine * cosine


def amplitudes(values):
    """Amplitude of each harmonic of a turn, the mean left out: [0] is one a turn."""
    n, mean = len(values), sum(values) / len(values)
    result = []
    for k in range(1, n // 2):
        c = sum((v - mean) * math.cos(2 * math.pi * k * i / n) for i, v in enumerate(values))
        s = sum((v - mean) * math.sin(2 * math.pi * k * i / n) for i, v in enumerate(values))
        result.append(2.0 * math.hypot(c, s) / n)
    return result


def peaks(values, reach):
    """Local maxima on a ring, after a running mean over 2 reach + 1 values."""
    n = len(values)
    smooth = [sum(values[(i + j) % n] for j in range(-reach, reach + 1)) / (2 * reach + 1) for i in range(n)]
    return sum(
        all(smooth[i] > smooth[(i + j) % n] or j == 0 for j in range(-reach, reach + 1)) for i in range(n)
    )


def median_delay(row, first_ns, bin_ns, low, high):
    """Delay at which half of the light between `low` and `high` has come, linear inside its bin."""
    inside = [(first_ns + i * bin_ns, value) for i, value in enumerate(row) if low < first_ns + i * bin_ns < high]
    half = 0.5 * sum(value for _, value in inside)
    for centre, value in inside:
        if value >= half > 0.0:
            return centre + (half / value - 0.5) * bin_ns
        half -= value
    raise ValueError("empty histogram")


def brightness(out, bodies):
    rows = []
    with open(f"{out}/brightness.csv", "w", encoding="utf-8") as file:
        file.write("# expected signal photons per shot over the motion; recorded: shots of the session with a photon\n")
        file.write("body,set,mean,min,max,shots,signal,noise,none\n")
        for name in BODIES:
            for which in SETS:
                values, session = bodies[name].photons[which], bodies[name].summary["session"][which]
                counts = [session[key] for key in ("shots", "signal", "noise", "none")]
                mean = bodies[name].mean_photons(which)
                file.write(f"{name},{which},{mean:.6g},{min(values):.6g},{max(values):.6g},")
                file.write(",".join(map(str, counts)) + "\n")
    for which in SETS:
        cells = []
        for name in BODIES:
            body = bodies[name]
            values, session = body.photons[which], body.summary["session"][which]
            cells += [
                f"{body.mean_photons(which):.3g} ({min(values):.3g} … {max(values):.3g})",
                f"{100 * (session['signal'] + session['noise']) / session['shots']:.0f} %",
            ]
        rows.append([which.replace("-", ", "), *cells])
    header = ["surface"] + [text for name in BODIES for text in (f"{TITLES[name]}: photons per shot", "recorded")]
    return table(header, rows)


def specular_against_diffuse(bodies):
    rows = []
    for level in LEVELS:
        for width in WIDTHS:
            cells = []
            for name in BODIES:
                body = bodies[name]
                diffuse, specular = (f"{level}-{lobe}-{width}" for lobe in LOBES)
                ratio = [s / d for s, d in zip(body.photons[specular], body.photons[diffuse])]
                less = 100 * sum(r < 1 for r in ratio[:-1]) / (len(ratio) - 1)
                mean = body.mean_photons(specular) / body.mean_photons(diffuse)
                cells.append(f"{mean:.3f} ({min(ratio):.3f} … {max(ratio):.3f}; below 1 in {less:.0f} %)")
            rows.append([f"{level}, {width}", *cells])
    return table(["ρ, n", *(TITLES[name] for name in BODIES)], rows)


def dull_against_sharp(bodies):
    rows = []
    for level in LEVELS:
        for lobe in LOBES:
            cells = []
            for name in BODIES:
                body = bodies[name]
                dull, sharp = (f"{level}-{lobe}-{width}" for width in WIDTHS)
                difference = [100 * (s / d - 1) for s, d in zip(body.photons[sharp], body.photons[dull])]
                mean = 100 * (body.mean_photons(sharp) / body.mean_photons(dull) - 1)
                cells.append(f"{signed(mean)} % ({signed(min(difference))} … {signed(max(difference))} %)")
            rows.append([f"{level}, {lobe}", *cells])
    return table(["ρ, d", *(TITLES[name] for name in BODIES)], rows)


def figure1(bodies, parts_folder):
    body, rows = bodies["box_wing"], []
    lean, turn = math.cos(math.radians(20)), math.cos(math.radians(30))
    for name in SETS:
        delay, front, box, wing = part_rates(parts_folder, name)
        bin_ns = delay[1] - delay[0]
        facet, wings = sum(front) * bin_ns, sum(wing) * bin_ns
        facet_lobe = 1 - diffuse_photons(body, name, 4.0, lean) / facet
        wing_lobe = 1 - diffuse_photons(body, name, 7.2, lean * turn) / wings
        text = name.replace("-", ", ")
        rows.append(
            [
                f"**{text}**" if name == FIGURE1_SET else text,
                f"{facet:.3g}",
                f"{wings / 2:.3g}",
                f"{2 * facet / wings:.2f}",
                f"{max(front) / max(wing):.1f}",
                f"{abs(100 * facet_lobe):.1f} %",
                f"{abs(100 * wing_lobe):.2f} %",
            ]
        )
    header = ["surface", "facet, photons per shot", "each wing", "facet / wing", "per ns, facet / wing"]
    return table(header + ["specular share, facet", "specular share, wings"], rows)


def session_harmonics(body, name):
    """From the recorded shots, signal or noise: median delay in the window of figure 3 for 72 parts of the turn."""
    session, last = body.session(name), float(body.totals[name][-1]["time_s"])
    parts = [[] for _ in range(72)]
    for time_s, delay_ns in zip(session.time_s, session.delay_ns):
        if time_s < last and NEAR_SIDE_NS[0] < delay_ns < NEAR_SIDE_NS[1]:
            parts[int(72 * time_s / last)].append(delay_ns)
    return amplitudes([statistics.median(values) for values in parts])[:24]


def figure3(bodies):
    body, rows = bodies["hexprism"], []
    for name in SESSION_SETS:
        photons = body.photons[name][:-1]
        histogram = body.histogram(name)
        delay = [median_delay(row, histogram.first_ns, histogram.bin_ns, *NEAR_SIDE_NS) for row in histogram.rows[:-1]]
        waves, seen = amplitudes(delay), session_harmonics(body, name)
        others = sorted(value for k, value in enumerate(seen, 1) if k % 6)
        rows.append(
            [
                name.replace("-", ", "),
                f"{peaks(photons, 7)}",
                f"{100 * (max(photons) / min(photons) - 1):.1f} %",
                f"{peaks(delay, 7)} (wave {1 + waves.index(max(waves))})",
                f"{max(delay) - min(delay):.2f} ns",
                f"wave {1 + seen.index(max(seen))}",
                f"{seen[5]:.2f} ns, {seen[5] / others[len(others) // 2]:.1f} ×",
            ]
        )
    header = ["surface", "peaks of the signal in a turn", "brightest over faintest", "peaks of the median delay"]
    header += ["its swing", "strongest wave in the shots", "their sixth wave, and over the others' median"]
    return table(header, rows)


def figure5(bodies):
    body, rows = bodies["cylinder"], []
    step_s = float(body.totals[SETS[0]][1]["time_s"])
    for name in SETS:
        histogram, photons, rms = body.histogram(name), body.photons[name], body.column(name, "rms_width_ns")
        end_on = histogram.rows[45]
        lobe = 1 - diffuse_photons(body, name, 128 * math.sin(2 * math.pi / 256), 1.0) / photons[45]
        low = sum(
            value
            for i, value in enumerate(histogram.rows[0])
            if abs(histogram.first_ns + i * histogram.bin_ns + 2e9 / 299792458.0) < 0.5
        ) / sum(histogram.rows[0])
        session = body.session(name)
        shots = [d for t, d in zip(session.time_s, session.delay_ns) if 45 * step_s - 1e-9 <= t < 46 * step_s - 1e-9]
        same = sum(abs(d + 3e9 / 299792458.0) < histogram.bin_ns for d in shots)
        rows.append(
            [
                name.replace("-", ", "),
                f"{100 * max(end_on) / sum(end_on):.1f} %",
                f"{same} of {len(shots)} ({100 * same / len(shots):.1f} %)",
                f"{100 * lobe:.0f} %",
                f"{photons[45] / photons[0]:.2f}, {photons[45] / photons[22]:.1f}",
                f"{100 * low:.0f} %",
                f"{rms[0]:.2f}, {max(rms):.2f} at {2 * rms.index(max(rms))}°, {rms[45]:.3f}",
            ]
        )
    header = ["surface", "bottom-on: light in one bin", "recorded photons within a bin of the bottom", "specular share"]
    header += ["brighter than at 0°, 44°", "side-on: light within 0.5 ns of the ridge"]
    header += ["rms width (ns): 0°, widest, 90°"]
    return table(header, rows)


def figure7(bodies):
    body, rows = bodies["box_wing"], []
    windows = (("near wing", -18.3, -8.6), ("box", -8.6, -3.9), ("far wing", 6.1, 18.3))
    step_s = float(body.totals[SETS[0]][1]["time_s"])
    for name in SESSION_SETS:
        session, cells = body.session(name), []
        for _, low, high in windows:
            found = sum(low < d < high for t, d in zip(session.time_s, session.delay_ns) if t < step_s - 1e-9)
            noise = NOISE_PER_NS * (high - low) * RATE_HZ * step_s
            cells.append(f"{found} ({noise:.1f})")
        rows.append([name.replace("-", ", "), *cells])
    return table(["surface", *(f"{text}, {low} … {high} ns" for text, low, high in windows)], rows)


def bin_noise(bodies):
    """Relative standard error of a bin, weighted by the bin's light, medium reflectivity, diffuse, dull."""
    rows = []
    for name in BODIES:
        light = error = 0.0
        for row in rows_of(f"{bodies[name].folder}/delay-medium-diffuse-dull.csv"):
            light += float(row["intensity_m2_per_sr_per_ns"])
            error += float(row["standard_error"])
        summary = bodies[name].summary
        rays, orientations = f"{summary['rays']:,}", str(summary["orientations"])
        rows.append([TITLES[name], rays, orientations, f"{100 * error / light:.1f} %"])
    return table(["body", "rays per orientation", "orientations", "standard error of a bin, mean over the light"], rows)


def write_all(out, bodies, parts_folder):
    """Writes numbers.md and brightness.csv; returns the named tables."""
    for name in BODIES:  # a number of orientations would do; the summary's form is not this script's business
        bodies[name].summary["orientations"] = len(bodies[name].totals[SETS[0]])
    text = {
        "brightness": brightness(out, bodies),
        "specular": specular_against_diffuse(bodies),
        "width": dull_against_sharp(bodies),
        "figure1": figure1(bodies, parts_folder),
        "figure3": figure3(bodies),
        "figure5": figure5(bodies),
        "figure7": figure7(bodies),
        "noise": bin_noise(bodies),
    }
    with open(f"{out}/numbers.md", "w", encoding="utf-8") as file:
        file.write("\n".join(f"## {name}\n\n{part}" for name, part in text.items()))
    return text


def update_docs(path, text):
    """Replaces what stands between the number marks of docs/paper.md."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    for name, part in text.items():
        begin, end = BEGIN.format(name), END.format(name)
        if begin not in page or end not in page:
            raise ValueError(f"{path}: no marks for {name}")
        page = page[: page.index(begin) + len(begin)] + "\n" + part + page[page.index(end) :]
    with open(path, "w", encoding="utf-8") as file:
        file.write(page)
