# SPDX-License-Identifier: MIT
"""Plots of benchmark results as SVG, without any package."""
import html
import math

# Okabe and Ito 2008: colour-blind people can distinguish them; further series repeat them with other marks.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"]
MARKS = ['<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{c}"/>',
         '<rect x="{l:.1f}" y="{t:.1f}" width="7" height="7" fill="{c}"/>',
         '<path d="M{x:.1f} {t:.1f}l4.5 7.5h-9z" fill="{c}"/>']
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 800, 460, 70, 250, 36, 66


def short(value):
    for size, suffix in ((1e9, "G"), (1e6, "M"), (1e3, "K")):
        if value >= size:
            return f"{value / size:.3g}{suffix}"
    return f"{value:g}"


def fitted_slope(values):
    """Exponent of the power law through the points, by least squares of the logarithms."""
    x = [math.log(v[0]) for v in values]
    y = [math.log(v[1]) for v in values]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - mean_x) ** 2 for a in x)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / spread if spread > 1e-9 else None


def ticks(low, high):
    """1, 2, 5 times powers of ten between two logarithms; powers of ten alone where the range is long."""
    steps = (1, 2, 5) if high - low < 2.5 else (1,)
    marks = [s * 10.0**d for d in range(math.floor(low) - 1, math.ceil(high) + 1) for s in steps]
    return [m for m in marks if low - 1e-9 <= math.log10(m) <= high + 1e-9]


def spread(wanted, least=14):
    """The heights nearest to the wanted ones that lie at least so far apart, in the same order."""
    order = sorted(range(len(wanted)), key=lambda k: wanted[k])
    heights = [0.0] * len(wanted)
    for i, k in enumerate(order):
        heights[k] = max(wanted[k], heights[order[i - 1]] + least) if i else max(wanted[k], TOP + 4)
    over = max(heights, default=0) - (HEIGHT - BOTTOM)
    for i, k in reversed(list(enumerate(order))):
        if over > 0:
            below = heights[order[i + 1]] - least if i + 1 < len(order) else HEIGHT - BOTTOM
            heights[k] = min(heights[k], below)
    return heights


def log_plot(title, x_label, y_label, series, slopes=False, dashed=(), caption=""):
    """series: name -> list of (x, y), all positive. With slopes, each name gets the fitted exponent. Names in `dashed` are
    guides: no dots, no slope. Every series is labelled at its last point. With slopes, a series of one point says nothing
    and is left out, if there are others; the caption counts them."""
    series = {k: sorted((x, y) for x, y in v if x > 0 and y > 0) for k, v in series.items()}
    series = {k: v for k, v in series.items() if v}
    single = [k for k, v in series.items() if slopes and len(v) == 1]
    if single and len(single) < len(series):
        series = {k: v for k, v in series.items() if k not in single}
        caption += ("; " if caption else "") + f"{len(single)} more at one size only: see the tables"
    points = [p for v in series.values() for p in v]
    if not any(k not in dashed for k in series):
        return None
    low_x, high_x = (f(math.log10(p[0]) for p in points) for f in (min, max))
    low_y, high_y = (f(math.log10(p[1]) for p in points) for f in (min, max))
    low_x, high_x = low_x - 0.1, high_x + 0.1
    pad = 0.06 * max(high_y - low_y, 1)
    low_y, high_y = low_y - pad, high_y + pad
    place_x = lambda x: LEFT + (math.log10(x) - low_x) / (high_x - low_x) * (WIDTH - LEFT - RIGHT)
    place_y = lambda y: HEIGHT - BOTTOM - (math.log10(y) - low_y) / (high_y - low_y) * (HEIGHT - TOP - BOTTOM)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{LEFT}" y="20" font-size="15">{html.escape(title)}</text>']
    for x in ticks(low_x, high_x):
        out.append(f'<line x1="{place_x(x):.1f}" x2="{place_x(x):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#eee"/>'
                   f'<text x="{place_x(x):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{short(x)}</text>')
    for value in ticks(low_y, high_y):
        y = place_y(value)
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{short(value)}</text>')
    ends = [(place_x(v[-1][0]), place_y(v[-1][1])) for v in series.values()]
    heights = spread([y for _, y in ends])
    for k, (name, values) in enumerate(series.items()):
        colour = "#777" if name in dashed else COLOURS[k % len(COLOURS)]
        at = [(place_x(x), place_y(y)) for x, y in values]
        dashes = ' stroke-dasharray="6 4"' if name in dashed or k >= len(COLOURS) else ""
        out.append('<polyline fill="none" stroke="%s" stroke-width="2"%s points="%s"/>' %
                   (colour, dashes, " ".join(f"{x:.1f},{y:.1f}" for x, y in at)))
        if name not in dashed:
            mark = MARKS[k // len(COLOURS) % len(MARKS)]
            out += [mark.format(x=x, y=y, l=x - 3.5, t=y - 4, c=colour) for x, y in at]
        label = name
        slope = fitted_slope(values) if slopes and len(values) > 1 and name not in dashed else None
        if slope is not None:
            label += f" (slope {slope:.2f})"
        (x, y), height = ends[k], heights[k]
        out.append(f'<path d="M{x + 6:.1f} {y:.1f}L{WIDTH - RIGHT + 8} {height:.1f}" stroke="{colour}" stroke-width="0.8" stroke-dasharray="1 3" fill="none"/>'
                   f'<text x="{WIDTH - RIGHT + 12}" y="{height + 4:.1f}" font-size="11" fill="{colour}">{html.escape(label)}</text>')
    if caption:
        out.append(f'<text x="{LEFT}" y="{HEIGHT - 10}" font-size="11" fill="#555">{html.escape(caption)}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 30}" text-anchor="middle">{html.escape(x_label)}</text>'
               f'<text transform="translate(16 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
               f'{html.escape(y_label)}</text></svg>')
    return "\n".join(out) + "\n"


def grouped(rows, name, x, y):
    """Series by name(row) of the points (x(row), y(row)) that exist."""
    series = {}
    for r in rows:
        if x(r) and y(r):
            series.setdefault(name(r), []).append((x(r), y(r)))
    return series


def strong_scaling(rows):
    """Speedup over one thread by threads, on the largest mesh that ran on one thread and on more."""
    series = {}
    for phase in dict.fromkeys(r["phase"] for r in rows):
        sizes = {}
        for r in rows:
            if r["phase"] == phase:
                sizes.setdefault(r["size"], {})[r["threads"]] = r["seconds"]
        both = [s for s, t in sizes.items() if 1 in t and len(t) > 1]
        if both:
            times = sizes[max(both)]
            series[f"{phase}, {short(max(both))}"] = [(t, times[1] / times[t]) for t in times]
    most = max((t for v in series.values() for t, _ in v), default=1)
    return {**series, "ideal": [(1, 1), (most, most)]} if series else {}


def weak_scaling(rows):
    """Time of one thread over that of several with as much work each, by that work. Sizes between those that ran on one
    thread are interpolated."""
    series = {}
    for phase in dict.fromkeys(r["phase"] for r in rows):
        here = [r for r in rows if r["phase"] == phase]
        one = sorted((math.log(r.get("faces", r["size"])), math.log(r["seconds"])) for r in here if r["threads"] == 1)
        for r in here:
            work = math.log(r.get("faces", r["size"]) / r["threads"])
            for (x0, y0), (x1, y1) in zip(one, one[1:]):
                if r["threads"] > 1 and x0 <= work <= x1:
                    alone = math.exp(y0 + (y1 - y0) * (work - x0) / (x1 - x0))
                    series.setdefault(f"{phase}, {r['threads']} threads", []).append((math.exp(work), alone / r["seconds"]))
    ends = [x for v in series.values() for x, _ in v]
    return {**series, "ideal": [(min(ends), 1), (max(ends), 1)]} if ends else {}


def roofline(report, threads, rows):
    """Kernels on one thread under the roofs of one thread, phases on all threads under theirs."""
    best = lambda phase, key, t: max(
        (r.get(key, 0) for r in report["results"] if r["phase"] == phase and r["threads"] == t), default=0)
    series, roofs = {}, []
    grid = [2.0 ** (k / 2) for k in range(-7, 13)]
    for t in sorted({1, threads}):
        triad, peak = best("triad", "GB/s", t), best("peak", "GFlop/s", t)
        if triad and peak:
            name = f"roof, {t} thread{'s' if t > 1 else ''} ({triad:.0f} GB/s, {peak:.0f} GFlop/s)"
            series[name] = [(i, min(peak, i * triad)) for i in grid]
            roofs.append(name)
    largest = lambda phase: max((r["size"] for r in rows if r["phase"] == phase), default=None)
    for r in rows:
        if r["threads"] != threads or r["size"] != largest(r["phase"]):
            continue
        if r["phase"] in ("product", "assembly", "connection") and "GFlop/s" in r and r.get("GB/s"):
            label = {"product": "S x, double"}.get(r["phase"], r["phase"])
            series[f"{label}, {short(r['size'])}"] = [(r["GFlop/s"] / r["GB/s"], r["GFlop/s"])]
    for r in report["results"]:
        if r["phase"] == "kernels" and r.get("form") == "series" and r.get("family") == "double":
            series[f"entries, {r['isa']}, 1 thread"] = [(r["GFlop/s"] / r["GB/s"], r["GFlop/s"])]
    return series, roofs


def caption_of(report):
    """Machine, date and load of the run."""
    machine = report.get("machine", {})
    parts = [machine.get("processor"), f"{machine['cores']} cores" if "cores" in machine else None, machine.get("compiler"),
             machine.get("commit"), machine.get("date"), "UNDER LOAD" if report.get("under_load") else None]
    return ", ".join(p for p in parts if p)


def plots(report):
    """Name -> SVG of everything the results allow."""
    results = [r for r in report["results"] if "size" in r]
    bench = [r for r in results if r["phase"] != "tool"]
    threads = max((r["threads"] for r in bench), default=1)
    # The family that reaches the largest size.
    first = max(bench, key=lambda r: r["size"]).get("family") if bench else None
    faces = lambda r: r.get("faces", r["size"])
    seconds = lambda r: r["seconds"]
    kept = ("halfedges", "topology", "geometry", "connection", "assembly", "eigen", "frames", "indices", "write")
    ours = [r for r in bench if r["phase"] in kept and r.get("family") == first and r.get("backend", "auto") == "auto" and
            r.get("n", 4) == 4 and r.get("detail", 1) == 1]
    times = [r for r in ours if r["threads"] == threads]
    tool = [r for r in results if r["phase"] == "tool"]
    eigen = [r for r in bench if r["phase"] == "eigen" and r["threads"] == threads and r["n"] == 4 and r["family"] == first]
    linear = [r for r in bench if r["phase"] in ("linear_setup", "linear_solve") and r["threads"] == threads and
              r["family"] == first]

    def exact(phase):
        """Of the largest mesh that was asked for several tolerances."""
        found = [r for r in bench if r["phase"] == phase and r["threads"] == threads and r["family"] == first and
                 r.get("n", 4) == 4]
        return [r for r in found if r["size"] == max(f["size"] for f in found)]

    at = lambda rows: f", {short(rows[0]['size'])} triangles" if rows else ""
    strong = strong_scaling(ours)
    roof, roofs = roofline(report, threads, [r for r in bench if r.get("family") == first and r.get("detail", 1) == 1])
    memory = {**grouped(tool, lambda r: "alcap field, whole process", faces, lambda r: r["peak_bytes"] / 1e6),
              **grouped(eigen, lambda r: f"eigen {r['backend']}", faces, lambda r: r["bytes/vertex"] * r["vertices"] / 1e6)}
    time_series = {**grouped(times, lambda r: r["phase"], faces, seconds),
                   **grouped(tool, lambda r: "whole alcap field", faces, seconds)}
    draw = lambda *these, **options: log_plot(*these, **options, caption=caption_of(report))
    drawn = {
        "time": draw(f"Time by size, {threads} threads, n = 4", "triangles", "wall seconds", time_series, slopes=True),
        "strong_scaling": draw("Strong scaling", "threads", "speedup over one thread", strong, dashed=("ideal",)),
        "weak_scaling": draw("Weak scaling", "triangles per thread", "time of one thread / time of all",
                                 weak_scaling(ours), dashed=("ideal",)),
        "backends": draw("Eigensolvers by tolerance, n = 4" + at(exact("eigen_tolerance")), "wall seconds", "residual, recomputed",
                             grouped(exact("eigen_tolerance"), lambda r: r["backend"], seconds, lambda r: r["residual"])),
        "linear_backends": draw("Linear backends by tolerance, with setup" + at(exact("linear_tolerance")), "wall seconds",
                                    "residual, recomputed",
                                    grouped(exact("linear_tolerance"), lambda r: r["backend"], seconds,
                                            lambda r: r["residual"])),
        "eigen": draw(f"Eigensolvers by size, n = 4, {threads} threads", "triangles", "wall seconds",
                          grouped(eigen, lambda r: r["backend"], faces, seconds), slopes=True),
        "linear": draw(f"Linear backends by size, {threads} threads", "triangles", "wall seconds",
                           grouped(linear, lambda r: f"{r['phase'][7:]} {r['backend']}", faces, seconds), slopes=True),
        "memory": draw("Memory by size", "triangles", "MB", memory, slopes=True),
        "roofline": draw("Roofline", "operations per byte", "GFlop/s", roof, dashed=roofs),
    }
    return {name: svg for name, svg in drawn.items() if svg}
