"""Table 1 and Figures 6 to 10 of Zwicker and Gotsman (2004), made again."""

import json

from .drawing import Pictures, close_up, plot, vertices
from .programs import PAPER, Failure, in_turn, median_seconds

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
           ("inverted", "inverted or collapsed triangles of the map [%]", 2)]  # fmt: skip
FIGURE9 = FIGURE8[:4]
FIGURE10 = [("noise", "noise b"), ("method", "method"), ("intersections", "self-intersections"),
            ("rms", "RMS distance [%]", 4), ("smooth_intersections", "after 5 steps of smoothing"),
            ("smooth_rms", "RMS distance then [%]", 4)]  # fmt: skip

# Table 1: the columns and the options of their runs.
VARIANTS = {"iteration": PAPER, "default": (), "converged": ("-tolerance", "1e-8")}
# Figures 6 and 7: scan and iterations, quick and in full; title; curves with their options; what they show.
BY_WEIGHTS = {f"iteration, {weights}": (*PAPER, "-weights", weights) for weights in WEIGHTS}
NEWTON = {"default method": ("-tolerance", "1e-12")}
RESIDUALS = [
    ("figure6", ("head_2000", 100), ("max", 1600), "Figure 6: uniform weights, k = 100, 25, 9", {
        **{f"iteration, k = {k}": (*PAPER, "-weights", "uniform", "-k", k) for k in (100, 25, 9)}, **NEWTON},
     """The iteration slows down and does not vanish, as in the paper. The paper does not have the dashed curve:
     Newton's method of the default, from the smoothed map of the coarser graphs, reaches the rounding of double in a
     few steps, on its own graph and with adaptive weights."""),
    ("figure7", ("head_2000", 100), ("max", 1600), "Figure 7: k = 25, three weights", {**BY_WEIGHTS, **NEWTON},
     "The iteration slows down and stays above zero with each of the weights, as in the paper."),
    ("figure6_long", ("head_1000", 400), ("head_5000", 10000), "More iterations than the paper's",
     {**BY_WEIGHTS, **NEWTON},
     """Why the paper's residuals never vanish: each iteration first moves all points so that their mean is the centre
     of the sphere. A map whose tangential Laplacian vanishes mostly has its mean elsewhere (here at a distance of
     {centroid:.2f} radii), so that the iteration settles where this shift and its steps cancel, at {settled:.1e} for
     adaptive weights. Newton's method has no such shift: the energy itself keeps the sphere from collapsing."""),
]  # fmt: skip
# Figure 10: rows of pictures by method, smoothing, caption and options.
NOISE_ROWS = [
    ("default", "", "b = {}", {"switches": ["--edges"], "zoom": [(2.5,)]}),
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
    if not rows:
        return
    context.report.text(f"""
        ### Table 1: time

        Whole runs, from file to file. The paper's times are for 1600 iterations with k = 25 on the machine of its
        authors; *its iteration here* is the same on this machine (`{" ".join(PAPER)}`). *Default* is the whole product:
        an unfolded map, the mesh optimised until no triangles intersect, checked and measured. *Converged* also
        reduces the tangential Laplacian to 1e-8.""")
    context.report.table("table1", TABLE1, rows)


def figures6_and_7(context):
    """The mean tangential Laplacian over the iterations."""
    context.report.text("### Figures 6 and 7: does the tangential Laplacian vanish?")
    for name, quick, full, title, methods, text in RESIDUALS:
        scan, iterations = context.choose(quick, full)
        cloud, ends = context.programs.scan(scan), {}
        for label, options in methods.items():
            limit = ("-max-iterations", iterations) if options[: len(PAPER)] == PAPER else ()
            report = context.programs.reconstruct(cloud, context.work / "residuals.ply", *options, *limit)[1]
            ends[label] = report["embedding"]
        picture = plot(context.out / f"{name}.svg", {label: end["residuals"] for label, end in ends.items()},
                       "iteration + 1", "mean tangential Laplacian [radius]", f"{title}, {scan}")  # fmt: skip
        context.report.picture(picture, title)
        *_, iteration, default = ends.values()
        text = text.format(settled=iteration["residual"], centroid=default["centroid_norm"])
        context.report.text(f"**{title}, {scan}.** {' '.join(text.split())}")


def _maps_by_methods(context, name, cloud, tip, methods, columns, view):
    """Meshes and maps by some methods, as a table and as pictures, also close up where a point of the cloud is."""
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
    context.report.table(name, columns, rows)
    pictures = Pictures(context.out / f"{name}.png")
    points = vertices(cloud.points)
    for begin in range(0, len(meshes), 5):
        some, maps, names = (every[begin : begin + 5] for every in (meshes, spheres, list(methods)))
        # The vertices of all meshes are the points, in their order.
        places = [vertices(sphere)[tip] for sphere in maps]
        pictures.row(some, names, view=[view])
        pictures.row(some, [""] * len(some), switches=["--edges"],
                     **close_up([points[tip]], 5, [points[tip] - points.mean(axis=0)]))  # fmt: skip
        pictures.row(maps, ["map"] * len(maps), view=[view], colors=cloud.points)
        pictures.row(maps, [""] * len(maps), switches=["--edges"], colors=cloud.points, **close_up(places, 5, places))
    context.report.picture(pictures.save(), name)


def figure8(context):
    """Meshes and maps for the three weights, and ours."""
    cloud = context.programs.scan(context.choose("head_2000", "max"))
    context.report.text(f"""
        ### Figure 8: three weights

        {cloud.name}, k = 25 and 1600 iterations for each weight, and the default. Of the paper's weights the adaptive
        ones leave the parts that stick out most room on the sphere. Colours are directions on the object. On the right
        is the default, whose triangles are optimised in space. Close up: the nose.""")
    methods = {weights: (*PAPER, "-weights", weights) for weights in WEIGHTS}
    nose = vertices(cloud.points)[:, 0].argmax()
    _maps_by_methods(context, "figure8", cloud, nose, {**methods, "default": ()}, FIGURE8, (35, 10))


def figure9(context):
    """The folded tail, over the iterations."""
    cloud = context.programs.scan(context.choose("bird_2000", "tweety"))
    context.report.text(f"""
        ### Figure 9: the folded tail

        {cloud.name}: the tail after 0, 100, 200 and 800 iterations. The projection from the centroid puts the tail on
        the back. The iteration moves the folded layers slowly; on this tail it squeezes them into a line on the sphere
        and does not separate them, with either weight. The default, first, begins with a coarse graph that is embedded
        without folds, and has none at any time. Close up: the tail.""")
    methods = {f"{weights}, {count} iterations": (*PAPER, "-max-iterations", count, "-weights", weights)
               for weights in ("uniform", "adaptive") for count in (0, 100, 200, 800)}  # fmt: skip
    points = vertices(cloud.points)
    tail = (points[:, 2] - 0.2 * points[:, 0]).argmax()
    _maps_by_methods(context, "figure9", cloud, tail, {"default": (), **methods}, FIGURE9, (15, 15))


def figure10(context):
    """Noise of b = 0, 1, 3 mean distances to the 25 nearest neighbours."""
    name = context.choose("head_2000", "head_10000")
    noises = context.choose((0, 1), (0, 1, 3))
    context.report.text(f"""
        ### Figure 10: noise

        {name} with noise of b mean distances to the 25 nearest neighbours. As in the paper, every mesh is a closed
        sphere through all points, however noisy, and a few steps of smoothing recover a surface. The last row of
        pictures shows what the same smoothing makes of the connectivity of the paper's way. The table has the
        self-intersections, and the distance from the surface without noise. For noise larger than the distance of
        neighbours, larger neighbourhoods help: there the paper's graph does better than the default.""")
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
    context.report.picture(pictures.save(), "Figure 10")
    context.report.table("figure10", FIGURE10, rows)


def section(context):
    context.report.text("""
        Zwicker and Gotsman (2004). The paper's scans are not free to distribute: generated ones of the same sizes stand
        for them.""")
    for make in (table1, figures6_and_7, figure8, figure9, figure10):
        context.say(f"the paper: {make.__name__.replace('_', ' ')}")
        make(context)
