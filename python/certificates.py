"""Prints the tables of docs/proofs.md for every problem file with `certify: true`, or those given:
uncertainties beside widths of proofs, and times.

    BRAKEWAVE=target/release/brakewave python3 python/certificates.py [problems/relay.ron ...]
"""

import contextlib
import csv
import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from brakewave.check import main as check

ROOT = Path(__file__).resolve().parent.parent
BINARY = os.environ.get("BRAKEWAVE", str(ROOT / "target/release/brakewave"))
given = [Path(name) for name in sys.argv[1:]]
certified = (path for path in sorted(ROOT.glob("problems/*.ron")) if re.search(r"^ *certify: true", path.read_text(), re.M))
widths, times = [], []


def timed(work):
    """Seconds of one core that something takes, on all cores together, and what it gives."""
    spent = lambda: sum(os.times()[:4])
    begin, result = spent(), work()
    return f"{spent() - begin:.1f} s", result


def program(*arguments):
    return subprocess.run([BINARY, *map(str, arguments)], capture_output=True, text=True)


def checked(folder):
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        check(folder)
    return output.getvalue()


def rows(path):
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


with tempfile.TemporaryDirectory() as work:
    for path in given or certified:
        branch, folder = Path(work, path.stem), Path(work, f"{path.stem}_certify")
        program("run", path, "--out", branch)
        proving, _ = timed(lambda: program("certify", path, "--out", folder))
        verifying, verified = timed(lambda: program("certify", "--verify", folder))
        checking, told = timed(lambda: checked(folder))
        proven = {row["label"]: row for row in rows(folder / "certificates.csv")}
        for event in rows(branch / "events.csv"):
            row = proven.get(event["label"])
            if row is None:
                continue
            value = f"{float(event[row['parameter']]):.10g}"
            uncertainty = f"{float(event['uncertainty']):.0e}" if event["uncertainty"] else "–"
            width = f"{float(row['high']) - float(row['low']):.0e}" if row["proven"] == "yes" else row["why"]
            widths.append((path.stem, event["label"], row["type"], f"{row['parameter']} = {value}", uncertainty, width))
        again, said = told.count(": proven again"), len(re.findall(": (?:proven again|not covered|refused)", told))
        points = f"{sum(row['proven'] == 'yes' for row in proven.values())} of {len(proven)}"
        held = verified.stdout.count(": verified")
        times.append((path.stem, points, proving, f"{verifying}, {held} hold", f"{checking}, {again} of {said} proven again"))

for header, lines in [
    (("file", "label", "type", "value", "uncertainty of `run`", "width of the proof"), widths),
    (("file", "points proven", "follow and prove", "verify", "checker"), times),
]:
    for line in (header, ["---"] * len(header), *lines):
        print("|", " | ".join(line), "|")
    print()
