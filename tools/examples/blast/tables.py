"""The tables of README.md, from the figures of a run."""


def table(head, rows):
    """Markdown; all columns but the first have numbers."""
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---:"] * len(head), *rows]) + "\n"


def percent(part, digits=0):
    return f"{100 * part:+.{digits}f} %".replace("-", "−")


def point_blast(rows):
    return table(["cells", "radius of the shock", "pressure, mean error", "peak"],
                 [[f"{r['cells']:,}", percent(r["radius_error"], 1), f"{100 * r['profile_error']:.0f} %", percent(r["peak_error"])] for r in rows])


def burst(rows, model):
    """The model against the curve, and the grids against the model."""
    cells = [f"{r['cell']:.2f} m" for r in rows]
    head = ["distance", "peak by the curve", "the model", *(f"cells of {width}" for width in cells), "arrival by the curve", "the model", *cells]
    unit = {"peak": lambda p: f"{p / 1e3:,.0f} kPa", "arrival": lambda t: f"{t * 1e3:.1f} ms"}
    lines, sums = [], {}
    for i, m in enumerate(model):
        grids = [r["gauges"][i] for r in rows]
        line = [f"{grids[0]['radius']:g} m"]
        for key in ("peak", "arrival"):
            curve = grids[0][key + "_reference"]
            errors = [m[key] / curve - 1, *(g[key] / m[key] - 1 for g in grids)]
            sums[key] = [s + abs(e) for s, e in zip(sums.get(key, [0] * len(errors)), errors)]
            line += [unit[key](curve), *map(percent, errors)]
        lines.append(line)
    means = {key: [f"{100 * s / len(model):.0f} %" for s in sums[key]] for key in sums}
    return table(head, [*lines, ["mean error", "", *means["peak"], "", *means["arrival"]]])


def gauges(rows):
    pair = lambda when, peak: f"{1e3 * when:.1f} ms, {peak / 1e3:,.{0 if peak > 5e4 else 1}f} kPa"  # noqa: E731
    curve = lambda g: pair(g["arrival_reference"], g["peak_reference"]) if "peak_reference" in g else ""  # noqa: E731
    return table(["gauge", "computed", "the curve"], [[name, pair(g["arrival"], g["peak"]), curve(g)] for name, g in rows.items()])
