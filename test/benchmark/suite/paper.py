"""Table 1 and Figures 6 to 10 of Zwicker and Gotsman (2004), made again."""

import json

from .programs import PAPER, Failure, in_turn, median_seconds, stage_seconds

WEIGHTS = ("uniform", "inverse", "adaptive")
PAPER_SECONDS = {"tweety": 125, "max": 424, "igea": 843}

TABLE1 = [("model", "scan"), ("points", "points"), ("paper", "paper, 2004 [s]"),
          ("iteration", "its iteration here [s]", 2), ("default", "default [s]", 2),
          ("converged", "default, converged map [s]", 2),
          ("iteration_intersections", "self-intersections, iteration"),
          ("default_intersections", "default")]  # fmt: skip
FIGURE8 = [("method", "method"), ("residual", "Laplacian left"),
           ("outside", "edges outside the graph [%]", 2), ("intersections", "self-intersections"),
           ("rms", "RMS distance [%]", 4), ("angle", "angle distortion, mean", 3),
           ("area", "area distortion, rms log2", 2),
           ("inverted", "inverted triangles of the map [%]", 2)]  # fmt: skip
FIGURE9 = FIGURE8[:4]
FIGURE10 = [("noise", "noise b"), ("method", "method"), ("intersections", "self-intersections"),
            ("rms", "RMS distance [%]", 4), ("smooth_intersections", "after 5 steps of smoothing"),
            ("smooth_rms", "RMS distance then [%]", 4)]  # fmt: skip

# Table 1: the columns and the options of their runs.
VARIANTS = {"iteration": PAPER, "default": (), "converged": ("-tolerance", "1e-8")}
# Figures 6 and 7: scan and iterations, quick and in full; title; curves with their options.
BY_WEIGHTS = {f"iteration, {weights}": (*PAPER, "-weights", weights) for weights in WEIGHTS}
NEWTON = {"default method": ("-tolerance", "1e-12")}
RESIDUALS = {
    "figure6": (("head_2000", 100), ("max", 1600), "Figure 6: uniform weights", {
        **{f"iteration, k = {k}": (*PAPER, "-weights", "uniform", "-k", k) for k in (100, 25, 9)},
        **NEWTON}),
    "figure7": (("head_2000", 100), ("max", 1600), "Figure 7: k = 25", {**BY_WEIGHTS, **NEWTON}),
    "figure6_long": (("head_1000", 400), ("head_5000", 10000), "more iterations",
                     {**BY_WEIGHTS, **NEWTON}),
}  # fmt: skip
# Figure 10: rows of pictures by method, smoothing, caption and options.
NOISE_ROWS = [
    ("default", "", "b = {}", {"edges": True, "zoom": [(2.5,)]}),
    ("default", "", "b = {}, flat shaded", {}),
    ("default", "smooth_", "b = {}, 5 steps of smoothing", {}),
    ("paper's iteration", "smooth_", "b = {}, the paper's way, 5 steps", {}),
]


def table1(context):
    """Times of 1600 iterations, k = 25, beside ours."""
    rows = []
    for name in context.choose((), PAPER_SECONDS):
        cloud = context.programs.scan(name)
        runs = in_turn(
            [[context.programs.reconstruction, cloud.points, context.work / "table1.ply",
              "-quiet", "-json", "-", *options] for options in VARIANTS.values()], 3)  # fmt: skip
        row = {"model": name, "paper": PAPER_SECONDS[name]}
        for variant, done in zip(VARIANTS, runs):
            if done[-1].problem:
                raise Failure(f"{name}, {variant}: {done[-1].problem}", "run the tool alone")
            report = json.loads(done[-1].output)
            row["points"] = report["points"]
            row[variant] = median_seconds(done)
            row[f"{variant}_residual"] = report["embedding"]["residual"]
            row[f"{variant}_intersections"] = report["self_intersections"]
        rows.append(row)
    context.report.facts["paper_options"] = " ".join(PAPER)
    context.report.add("table1", TABLE1, rows)


def figures6_and_7(context):
    """The mean tangential Laplacian over the iterations, and over time."""
    from .drawing import Plot

    mesh = context.work / "residuals.ply"
    for name, (quick, full, title, curves) in RESIDUALS.items():
        scan, iterations = context.choose(quick, full)
        cloud = context.programs.scan(scan)
        plot = Plot(panels=1 if name == "figure6_long" else 2)
        reports = []
        for color, (label, options) in enumerate(curves.items()):
            is_paper = options[: len(PAPER)] == PAPER
            limit = ("-max-iterations", iterations) if is_paper else ()
            report = context.programs.reconstruct(cloud, mesh, *options, *limit)[1]
            reports.append(report)
            residuals = report["embedding"]["residuals"]
            count = len(residuals)
            seconds = stage_seconds(report)["embedding"]
            style = () if is_paper else ("--", "o")
            plot.curve(0, range(1, count + 1), residuals, label, color, *style)
            if len(plot.axes) == 1:
                continue
            if is_paper:
                times = [seconds * (i + 1) / count for i in range(count)]
                plot.curve(1, times, residuals, label, color)
            else:  # of which only the end is known
                plot.curve(1, [seconds], [report["embedding"]["residual"]], label, color, "", "o")
        plot.label(0, "iteration + 1", "mean tangential Laplacian [radius]", f"{title}, {scan}")
        if len(plot.axes) > 1:
            plot.label(1, "seconds in the embedding", "", "the same over time")
        plot.save(context.out / f"{name}.svg")
        context.report.facts[f"{name}_cloud"] = scan
    # Of the last figure: the iteration with adaptive weights, and the default method.
    iteration, newton = (report["embedding"] for report in reports[-2:])
    context.report.facts.update(figure6_long_count=iterations, settled=iteration["residual"],
                                centroid=newton["centroid_norm"])  # fmt: skip


def _measured(context, cloud, name, methods, columns):
    """Meshes and maps by some methods, and a table of them."""
    meshes, spheres, rows = [], [], []
    for index, (method, options) in enumerate(methods.items()):
        mesh = context.work / f"{name}_{index}.ply"
        sphere = context.work / f"{name}_{index}_sphere.ply"
        report = context.programs.reconstruct(cloud, mesh, *options, sphere=sphere)[1]
        rows.append({"method": method, **context.programs.measure(mesh, cloud, sphere),
                     "residual": f"{report['embedding']['residual']:.1e}",
                     "outside": 100.0 * report["diagnosis"]["edges_outside_graph"]})  # fmt: skip
        meshes.append(mesh)
        spheres.append(sphere)
    context.report.facts[f"{name}_cloud"] = cloud.name
    context.report.add(name, columns, rows)
    return meshes, spheres


def _draw_maps(pictures, cloud, spheres, caption, tip, factor):
    """Close-ups of the maps where a point of the cloud is."""
    from .drawing import close_up, vertices

    # The vertices of all meshes are the points, in their order.
    places = [vertices(sphere)[tip] for sphere in spheres]
    pictures.row(spheres, [caption] * len(spheres), edges=True, colors=cloud.points,
                 **close_up(places, factor, places))  # fmt: skip


def figure8(context):
    """Meshes and maps for the three weights, and ours."""
    from .drawing import Pictures, close_up, vertices

    cloud = context.programs.scan(context.choose("head_2000", "max"))
    points = vertices(cloud.points)
    tip = points[:, 0].argmax()  # of the nose
    methods = {weights: (*PAPER, "-weights", weights) for weights in WEIGHTS}
    methods["default"] = ()
    meshes, spheres = _measured(context, cloud, "figure8", methods, FIGURE8)
    pictures = Pictures(context.out / "figure8.png")
    pictures.row(meshes, methods, view=[(35, 10)])
    pictures.row(meshes, ["nose"] * len(meshes), edges=True,
                 **close_up([points[tip]], 5, [points[tip] - points.mean(axis=0)]))  # fmt: skip
    pictures.row(spheres, ["map"] * len(meshes), view=[(35, 10)], colors=cloud.points)
    _draw_maps(pictures, cloud, spheres, "map of the nose", tip, 5)
    pictures.save()


def figure9(context):
    """The folded tail, over the iterations."""
    from .drawing import Pictures, vertices

    cloud = context.programs.scan(context.choose("bird_2000", "tweety"))
    points = vertices(cloud.points)
    tip = (points[:, 2] - 0.2 * points[:, 0]).argmax()
    methods = {"default": ()}
    for weights in ("uniform", "adaptive"):
        for count in (0, 100, 200, 800):
            methods[f"{weights}, {count} iterations"] = (
                *PAPER, "-max-iterations", count, "-weights", weights)  # fmt: skip
    meshes, spheres = _measured(context, cloud, "figure9", methods, FIGURE9)
    pictures = Pictures(context.out / "figure9.png")
    for half in (slice(0, 5), slice(5, 9)):
        pictures.row(meshes[half], list(methods)[half], view=[(15, 15)])
        _draw_maps(pictures, cloud, spheres[half], "map of the tail", tip, 4)
    pictures.save()


def figure10(context):
    """Noise of b = 0, 1, 3 mean distances to the 25 nearest neighbours."""
    from .drawing import Pictures, vertices

    name = context.choose("head_2000", "head_10000")
    noises = context.choose((0, 1), (0, 1, 3))
    truth = context.programs.scan(name)
    points = vertices(truth.points)
    nose = points[points[:, 0].argmax()]
    files, rows = {}, []
    for noise in noises:
        cloud = context.programs.scan(name, noise=noise) if noise else truth
        for method, options in (("paper's iteration", PAPER), ("default", ())):
            row = {"noise": noise, "method": method}
            for prefix, smoothing in (("", ()), ("smooth_", ("-smoothing", "5"))):
                mesh = context.work / f"figure10_{noise}_{method[:5]}_{prefix}.ply"
                context.programs.reconstruct(cloud, mesh, *options, *smoothing)
                files[noise, method, prefix] = mesh
                quality = context.programs.measure(mesh, cloud)
                row.update({prefix + key: quality[key] for key in ("intersections", "rms")})
            rows.append(row)
    pictures = Pictures(context.out / "figure10.png")
    for method, prefix, caption, options in NOISE_ROWS:
        focus = {"focus": [nose]} if "zoom" in options else {}
        pictures.row([files[noise, method, prefix] for noise in noises],
                     [caption.format(noise) for noise in noises], view=[(35, 10)], **focus,
                     **options)  # fmt: skip
    pictures.save()
    context.report.facts["figure10_cloud"] = name
    context.report.add("figure10", FIGURE10, rows)


def section(context):
    for make in (table1, figures6_and_7, figure8, figure9, figure10):
        context.say(f"the paper: {make.__name__.replace('_', ' ')}")
        make(context)
