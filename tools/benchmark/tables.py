"""The report as Markdown."""


def rate(value):
    return f"{value / 1e6:.3g}"


def ratio(entry):
    return f"**{entry['median']:.2f}** ({entry['low']:.2f} to {entry['high']:.2f})"


def comparison(report):
    """The table of `tools/bench`."""
    lines = [about(report), "", "| scene | triangles | peer | étendue Mpath/s | peer Mpath/s | speed ratio | equal-time error ratio | agreement |",
             "|---|---|---|---|---|---|---|---|"]
    for row in report["rows"]:
        head = f"| {row['scene']} | {row.get('triangles', '')} | {row['peer']} |"
        if "error" in row:
            lines.append(f"{head} | | | | {row['error']} |")
            continue
        verdict = row["agreement"]
        lines.append(
            f"{head} {rate(row['etendue_paths_per_second'])} | {rate(row['peer_paths_per_second'])} | "
            f"{ratio(row['speed'])} | {ratio(row['efficiency'])} ({row['peer_sampler']}) | "
            f"p {verdict['smallest_p']:.1e} ≥ {verdict['p_limit']:.1e}; sees "
            f"{100 * verdict['smallest_bias_seen_picture']:.2g}% |"
        )
    if report["left_out"]:
        lines += ["", f"Left out, for want of the folder of assets (ETENDUE_SHARED): {', '.join(report['left_out'])}."]
    lines += ["", "Before the first sample, seconds:", "", "| scene | étendue load | build | upload | compile | peer | load and build | first render's extra |", "|---|---|---|---|---|---|---|---|"]
    for row in report["rows"]:
        if "error" not in row:
            ours, other = row["etendue"], row["other"]
            phases = " | ".join(f"{ours[key]:.2f}" for key in ("load", "accel", "upload", "compile"))
            lines.append(f"| {row['scene']} | {phases} | {row['peer']} | {other['load']:.2f} | {other['first_render_extra']:.2f} |")
    return "\n".join(lines) + "\n"


def about(report):
    s = report["settings"]
    return (
        f"{s['size']}×{s['size']}, at most {s['max_depth']} edges a path, roulette from bounce 5, box filter, "
        f"{s['spp']} samples a pixel, {s['threads']} threads; medians of {s['rounds']} interleaved rounds, ratios étendue over "
        f"peer with an order-statistic interval. Driver: {report['driver']}. Peers: {', '.join(report['peers'])}."
    )
