# SPDX-License-Identifier: Apache-2.0
"""Reads what clray writes: FITS images of delay histograms, tables of totals, sessions, summaries.

Used by main.py, figures.py and measures.py. Units as in the files: m^2/sr, ns, s. Standard library only.
"""

import array
import csv
import json
import sys

LEVELS = ("low", "medium", "high")
LOBES = ("diffuse", "specular")
WIDTHS = ("dull", "sharp")
SETS = [f"{level}-{lobe}-{width}" for level in LEVELS for lobe in LOBES for width in WIDTHS]
RHO = {"low": 0.1, "medium": 0.5, "high": 0.9}


def rows_of(path):
    """Rows of a clray CSV file as dictionaries of text."""
    with open(path, newline="", encoding="utf-8") as file:
        yield from csv.DictReader(line for line in file if not line.startswith("#"))


def read_summary(folder):
    with open(f"{folder}/summary.json", encoding="utf-8") as file:
        return json.load(file)


class Histogram:
    """A(t): rows[orientation][bin] in m^2/sr per ns; `first_ns` is the centre of bin 0."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        cards = {}
        position = 0
        while True:
            card = data[position : position + 80].decode("ascii")
            position += 80
            if card.startswith("END"):
                break
            if card[8:10] == "= ":
                cards[card[:8].strip()] = card[10:].split("/")[0].strip().strip("'").strip()
        position = (position + 2879) // 2880 * 2880
        if cards["BITPIX"] != "-64":
            raise ValueError(f"{path}: expected doubles")
        bins, orientations = int(cards["NAXIS1"]), int(cards["NAXIS2"])
        values = array.array("d")
        values.frombytes(data[position : position + 8 * bins * orientations])
        if sys.byteorder == "little":
            values.byteswap()
        self.first_ns, self.bin_ns = float(cards["CRVAL1"]), float(cards["CDELT1"])
        self.rows = [values[i * bins : (i + 1) * bins] for i in range(orientations)]


class Session:
    """Shots that recorded a photon: time s, delay ns (residual), and whether it was a signal photon."""

    def __init__(self, path):
        self.time_s, self.delay_ns, self.signal = [], [], []
        for row in rows_of(path):
            self.time_s.append(float(row["epoch_s"]))
            self.delay_ns.append(float(row["residual_ns"]))
            self.signal.append(row["kind"] == "signal")


class Body:
    """One body's run over its motion, with all twelve surfaces."""

    def __init__(self, folder):
        self.folder = folder
        self.summary = read_summary(folder)
        link = self.summary["session"][SETS[0]]["link"]
        square_metre = link["received"]["value"] / link["cross-section"]["value"]
        self.photons_per_area = 4.0 * 3.141592653589793 * square_metre  # photons a shot for A = 1 m^2/sr
        self.totals = {name: list(rows_of(f"{folder}/delay-{name}-totals.csv")) for name in SETS}
        self.photons = {
            name: [self.photons_per_area * float(row["intensity_m2_per_sr"]) for row in rows]
            for name, rows in self.totals.items()
        }

    def mean_photons(self, name):
        """Mean over the motion; the last orientation of a whole or half turn is the first again."""
        values = self.photons[name][:-1]
        return sum(values) / len(values)

    def column(self, name, key):
        return [float(row[key]) for row in self.totals[name]]

    def histogram(self, name):
        return Histogram(f"{self.folder}/delay-{name}.fits")

    def session_file(self, name):
        return f"{self.folder}/observations-{name}.csv"

    def session(self, name):
        return Session(self.session_file(name))
