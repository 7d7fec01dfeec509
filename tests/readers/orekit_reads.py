# SPDX-License-Identifier: Apache-2.0
# Reads the CRD files of a clray result with Orekit's parser and compares each record 10 with its row of the CSV file
# beside it: time of flight to 1e-12 s, time of fire to 1e-9 s (Orekit keeps attoseconds, a double of seconds of a day
# does not). Times are read as TAI, which needs no table of leap seconds: a session of minutes has none.
# Normal points, angles and statistics must be those that stand in the files.
import csv
import math
import sys
from decimal import Decimal
from pathlib import Path

import orekit_jpype

orekit_jpype.initVM()
from org.orekit.data import DataSource  # noqa: E402
from org.orekit.files.ilrs import CRDParser  # noqa: E402
from org.orekit.time import AbsoluteDate, DateComponents, TimeComponents, TimeScalesFactory  # noqa: E402


def fail(words):
    sys.exit(f"orekit_reads: {words}")


def zero_of(head):
    """MJD and seconds of the CSV file's epoch 0, from its head."""
    words = head.split("MJD ")[1].split()
    return int(words[0]), Decimal(words[3])


def check(crd, table):
    tai = TimeScalesFactory.getTAI()
    lines = table.read_text().splitlines()
    heads = [line for line in lines if line.startswith("#")]
    mjd, zero_s = zero_of(next(line for line in heads if "MJD " in line))
    zero = AbsoluteDate(DateComponents(DateComponents.MODIFIED_JULIAN_EPOCH, mjd), TimeComponents.H00, tai)
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    blocks = CRDParser(tai).parse(DataSource(str(crd))).getDataBlocks()
    if blocks.size() != 1:
        fail(f"{crd}: {blocks.size()} blocks, expected 1")
    block = blocks.get(0)
    ranges = block.getRangeData()
    if ranges.size() != len(rows) or not rows:
        fail(f"{crd}: {ranges.size()} ranges, the table has {len(rows)}")
    for i, row in enumerate(rows):
        found = ranges.get(i)
        flight = abs(found.getTimeOfFlight() - float(row["flight_time_s"]))
        fire = abs(Decimal(found.getDate().durationFrom(zero)) - zero_s - Decimal(row["epoch_s"]))
        if not flight <= 1e-12 or not fire <= Decimal("1e-9"):
            fail(f"{crd}: range {i}: off by {flight} s in flight and {fire} s in fire time")
    header = block.getHeader()
    weather = block.getMeteoData().getMeteo(ranges.get(0).getDate())
    if weather is None:
        fail(f"{crd}: no weather")
    if not header.isTroposphericRefractionApplied():
        fail(f"{crd}: the ranges hold no refraction, so its correction is applied")
    calibration = block.getCalibrationData()
    if calibration.size() != 1 or calibration.get(0).getSystemDelay() != 0.0:
        fail(f"{crd}: expected one calibration without delay")
    print(f"{crd.name}: {len(rows)} ranges of {header.getStationName()}, pad {header.getSystemIdentifier()}: all equal")


def records(crd, kind):
    return [line.split() for line in crd.read_text().splitlines() if line.startswith(kind + " ")]


def close(found, written, unit=1.0):
    return written == "na" if math.isnan(found) else abs(found / unit - float(written)) <= 1e-9 * abs(float(written))


def check_points(crd):
    block = CRDParser(TimeScalesFactory.getTAI()).parse(DataSource(str(crd))).getDataBlocks().get(0)
    points, written = block.getRangeData(), records(crd, "11")
    if points.size() != len(written) or not written:
        fail(f"{crd}: {points.size()} normal points of {len(written)}")
    for i, record in enumerate(written):
        p = points.get(i)
        if abs(p.getTimeOfFlight() - float(record[2])) > 1e-12 or p.getNumberOfRawRanges() != int(record[6]) \
                or p.getWindowLength() != float(record[5]) or not close(p.getBinRms(), record[7], 1e-12):
            fail(f"{crd}: normal point {i} is not {' '.join(record)}")
    print(f"{crd.name}: {len(written)} normal points: all equal")


def check_rest(crd):
    block = CRDParser(TimeScalesFactory.getTAI()).parse(DataSource(str(crd))).getDataBlocks().get(0)
    angles, written = block.getAnglesData(), records(crd, "30")
    if angles.size() != len(written):
        fail(f"{crd}: {angles.size()} angles of {len(written)}")
    for i, record in enumerate(written):
        a = angles.get(i)
        if not close(math.degrees(a.getAzimuth()), record[2]) or not close(math.degrees(a.getElevation()), record[3]):
            fail(f"{crd}: angles {i} are not {' '.join(record)}")
    statistics, written = block.getSessionStatisticsRecord(), records(crd, "50")
    if len(written) > 1 or (statistics is None) != (not written):
        fail(f"{crd}: {len(written)} records 50, of which it reads {statistics}")
    if written and not close(statistics.getRms(), written[0][2], 1e-12):
        fail(f"{crd}: rms {statistics.getRms()} s is not {' '.join(written[0])}")


results = sorted(Path(sys.argv[1]).glob("*.crd"))
if not results:
    fail(f"{sys.argv[1]} holds no CRD file")
for crd in results:
    check(crd, crd.with_suffix(".csv"))
    check_rest(crd)
    if crd.with_suffix(".npt").exists():
        check_points(crd.with_suffix(".npt"))
        check_rest(crd.with_suffix(".npt"))
