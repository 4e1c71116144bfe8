"""Computes the charge in open air and the burst in the stadium, and draws them. Called by tools/examples/blast/run: run.py TERACELL FOLDER CELLS"""
import concurrent.futures
import json
import math
import pathlib
import subprocess
import sys
import time

import numpy

import charge
import gas
import open_air
import pictures
import plots
import stadium

SHEET = (5, 15, 30, 50, 75, 110)  # ms
TNT_CELLS = (24, 36, 54)  # along an edge of the octant


def say(text):
    print(text, file=sys.stderr, flush=True)


def check_in_open_air(teracell, folder):
    """The charge on three grids, and along its radius alone."""
    bursts, model = [], open_air.tnt_along_radius()
    for n in TNT_CELLS:
        bursts.append(row := open_air.tnt(teracell, folder / f"tnt-{n}", n))
        errors = (f"{100 * (g['peak'] / m['peak'] - 1):+.0f} % at {g['radius']:g} m" for g, m in zip(row["gauges"], model))
        say(f"  10 t of TNT, cells of {row['cell']:.2f} m: peaks " + ", ".join(errors))
    return bursts, model


def open_air_reference(place):
    """Arrival and peak of the charge's shock in open air."""
    distance = math.dist(place, stadium.CHARGE)
    return gas.kinney_graham_arrival(distance, charge.TNT_MASS), float(gas.kinney_graham(distance, charge.TNT_MASS))


def draw(blast, folder):
    """A picture of each time, by two processes, and a sheet of six of them."""
    frames = folder / "frames"
    frames.mkdir(exist_ok=True)
    for old in frames.glob("*.png"):
        old.unlink()
    global drawn  # for the processes, which are copies of this one
    drawn = blast, pictures.View(blast), frames
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        names = list(pool.map(draw_one, blast.case.times()))
    last = len(names) - 1
    pictures.draw_sheet(folder / "sheet.png", [names[min(last, round(ms / 1e3 / stadium.FRAME) - 1)] for ms in SHEET])
    return len(names)


def draw_one(name):
    blast, view, frames = drawn
    path = frames / f"{round(float(name) * 1e5):05d}.png"  # in hundredths of a millisecond
    pictures.draw_frame(path, blast, view, name)
    return path


def main(teracell, folder, cells):
    folder = pathlib.Path(folder)
    began = time.monotonic()
    say("the charge in open air, on three grids ...")
    bursts, model = check_in_open_air(teracell, folder)
    checked = time.monotonic()
    blast = stadium.Blast(teracell, folder, int(cells))
    say(f"the stadium in cells of {blast.width:g} m: computing {1e3 * stadium.END:g} ms ...")
    blast.compute()
    computed = time.monotonic()
    times, pressures = blast.case.gauges()
    names = ",".join(name.replace(",", "") for name in stadium.GAUGES)
    numpy.savetxt(folder / "gauges.csv", numpy.column_stack([times, pressures]), delimiter=",", header="time_s," + names, comments="", fmt="%.9g")
    references = {name: open_air_reference(place) for name, place in stadium.GAUGES.items() if name.startswith("above the seats")}
    plots.gauges(folder / "gauges.svg", list(stadium.GAUGES), times, pressures, references)
    frames = draw(blast, folder)
    steps, seconds = blast.case.steps_and_seconds()
    rows = {}
    for i, name in enumerate(stadium.GAUGES):
        arrival, peak = open_air.arrival_and_peak(times, pressures[:, i])
        rows[name] = {"arrival": arrival, "peak": peak}
        if name in references:
            rows[name]["arrival_reference"], rows[name]["peak_reference"] = references[name]
    report = {"cells": len(blast.index[0]), "cell": blast.width, "steps": steps, "solver_seconds": seconds, "frames": frames, "gauges": rows,
              "open_air_seconds": checked - began, "stadium_seconds": computed - checked, "picture_seconds": time.monotonic() - computed,
              "burst": bursts, "burst_along_radius": model}
    (folder / "report.json").write_text(json.dumps(report, indent=1) + "\n")
    print(f"""
  cells       {report["cells"]} of {blast.width:g} m, {steps} steps
  time        {checked - began:.0f} s for the charge in open air, {computed - checked:.0f} s for the stadium, {report["picture_seconds"]:.0f} s for pictures
  pictures    {folder}/frames, {frames} of them; {folder}/sheet.png
  gauges      {folder}/gauges.svg  {folder}/gauges.csv
  figures     {folder}/report.json""")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (RuntimeError, subprocess.CalledProcessError) as error:
        sys.exit(f"tools/examples/blast/run: {error}")
