"""The report of `tools/bench` as Markdown."""

COMPARISON = (
    "scene",
    "triangles",
    "peer",
    "étendue Mpath/s",
    "peer Mpath/s",
    "speed ratio",
    "equal-time error ratio",
    "peer's sampler for it",
    "agreement",
)
START = ("scene", "étendue load", "build", "upload", "compile", "peer", "load and build", "first render's extra")


def table(headers, rows):
    """The lines of a Markdown table."""
    line = lambda cells: "| " + " | ".join(str(cell) for cell in cells) + " |"  # noqa: E731
    return [line(headers), "|---" * len(headers) + "|", *map(line, rows)]


def rate(value):
    """Millions a second."""
    return f"{value / 1e6:.3g}"


def ratio(entry):
    return f"**{entry['median']:.2f}** ({entry['low']:.2f} to {entry['high']:.2f})"


def comparison(report):
    """All of it."""
    good = [row for row in report["rows"] if "error" not in row]
    lines = [about(report), "", *table(COMPARISON, map(compared, report["rows"]))]
    if report["left_out"]:
        lines += ["", f"Left out, for want of the folder of assets (ETENDUE_SHARED): {', '.join(report['left_out'])}."]
    lines += ["", "Before the first sample, seconds:", "", *table(START, map(started, good))]
    return "\n".join(lines) + "\n"


def compared(row):
    head = [row["scene"], row["triangles"], row["peer"]]
    if "error" in row:
        return [*head, "", "", "", "", "", row["error"]]
    verdict = row["agreement"]
    agrees = f"p {verdict['smallest_p']:.1e} ≥ {verdict['p_limit']:.1e}; sees "
    return [
        *head,
        rate(row["etendue_paths_per_second"]),
        rate(row["peer_paths_per_second"]),
        ratio(row["speed"]),
        ratio(row["efficiency"]),
        row["peer_sampler"],
        agrees + f"{100 * verdict['smallest_bias_seen_picture']:.2g}%",
    ]


def started(row):
    ours, other = row["etendue"], row["other"]
    phases = [f"{ours[key]:.2f}" for key in ("load", "accel", "upload", "compile")]
    return [row["scene"], *phases, row["peer"], f"{other['load']:.2f}", f"{other['first_render_extra']:.2f}"]


def about(report):
    s = report["settings"]
    roulette = "" if s["guiding"] == "off" else " (étendue: learnt)"
    return (
        f"{s['size']}×{s['size']}, at most {s['max_depth']} edges a path, roulette from bounce 5{roulette}, box filter, "
        f"{s['spp']} samples a pixel, {s['threads']} threads; medians of {s['rounds']} interleaved rounds, ratios "
        f"étendue over peer with an order-statistic interval. Driver: {report['driver']}. "
        f"Peers: {', '.join(report['peers'])}."
    )
