"""The plots: gauges in the stadium, and the charges in open air beside what is known."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

import charge  # noqa: E402
import gas  # noqa: E402
import open_air  # noqa: E402
import tables  # noqa: E402

STYLE = {"svg.hashsalt": "teracell", "font.size": 11, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd",
         "grid.linewidth": 0.8, "axes.axisbelow": True}
COLOURS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#222222", "#7f7f7f")


def save(figure, path):
    figure.savefig(path, metadata={"Date": None} if str(path).endswith("svg") else None)  # so that the same numbers give the same bytes
    plt.close(figure)


@matplotlib.rc_context(STYLE)
def gauges(path, names, times, pressures, arrivals):
    """The overpressure of each gauge; `arrivals` says for some of them when the shock would arrive in open air, and with which peak."""
    figure, all_axes = plt.subplots(len(names), 1, sharex=True, figsize=(8.6, 1.15 * len(names) + 0.6), constrained_layout=True)
    for name, colour, axes, pressure in zip(names, COLOURS, all_axes, pressures.T):
        axes.plot(times * 1e3, over := (pressure - gas.P0) / 1e3, color=colour, lw=1.3)
        axes.axhline(0, color="#999999", lw=0.8)
        axes.text(0.995, 0.93, name, transform=axes.transAxes, ha="right", va="top")
        if name in arrivals:
            when, peak = arrivals[name]
            axes.plot([when * 1e3], [peak / 1e3], marker="o", ms=7, mfc="none", mec="#222222")
        highest = max(over.max(), arrivals.get(name, (0, 0))[1] / 1e3)
        axes.set_ylim(1.1 * min(-0.1 * highest, over.min()), 1.3 * highest)
    all_axes[-1].set_xlabel("time, ms")
    figure.supylabel("overpressure, kPa", fontsize=11)
    save(figure, path)


@matplotlib.rc_context(STYLE)
def open_air_plots(path, blasts, bursts, model):
    """Left: the pressure of the point blast on each grid, and Sedov's. Right: peaks of the burst on each grid, of the model along the radius, and the
    curve."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.4, 4.2), constrained_layout=True)
    r, p, _, _ = gas.sedov_profile()
    left.plot(numpy.append(r, [1, 1.15]), numpy.append(p, [0, 0]), color="#222222", lw=1.2, label="Sedov")
    for colour, marker, row in zip(COLOURS, "s^o", blasts):
        label = f"{row['cells']:,} cells, radius {tables.percent(row['radius_error'], 1)}"
        left.plot(row["radii"], row["pressures"], marker=marker, ms=4, lw=0.8, color=colour, label=label)
    left.set(xlim=(0, 1.15), ylim=(0, 1.1), xlabel="radius / radius of the shock", ylabel="pressure / pressure behind the shock", title="a point blast")
    distance = numpy.geomspace(9, 44, 100)
    right.loglog(distance, gas.kinney_graham(distance, charge.TNT_MASS) / 1e3, color="#222222", lw=1.2, label="Kinney and Graham")
    right.loglog([g["radius"] for g in bursts[0]["gauges"]], [m["peak"] / 1e3 for m in model], color="#222222", lw=1.2, ls="--", label="the model, along the radius")
    for colour, marker, row in zip(COLOURS, "s^o", bursts):
        distances, peaks = zip(*((g["radius"], g["peak"] / 1e3) for g in row["gauges"]))
        right.loglog(distances, peaks, ls="", marker=marker, ms=5, color=colour, label=f"cells of {row['cell']:.3g} m")
    right.set(xlabel="distance, m", ylabel="peak overpressure, kPa", title="10 t of TNT", xticks=(ticks := [10, 15, 20, 30, 40]), xticklabels=ticks,
              yticks=(marks := [200, 500, 1000, 2000, 5000]), yticklabels=marks)
    right.minorticks_off()
    for axes in (left, right):
        axes.legend(frameon=False)
    save(figure, path)
