"""Table 1 and Figures 6 to 10 of Zwicker and Gotsman (2004), made again.

The paper's scans are not free to distribute: generated ones of the same sizes stand for them.
"""

import json

from .programs import ITERATIVE, PAPER, Failure, in_turn, median_seconds, stage_seconds
from .report import Figure, Section, Table

WEIGHTS = ("uniform", "inverse", "adaptive")
RAW = ("-optimization", "none")
CONVERGED = ("-tolerance", "1e-12", *RAW)
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

TEXT1 = f"""Whole runs, from file to file. The paper's times are for 1600 iterations with k = 25 on
the machine of its authors; *its iteration here* is the same on this machine (`{' '.join(PAPER)}`).
*Default* is the whole product: an unfolded map, the mesh optimised until no triangles intersect,
checked and measured. *Converged* also reduces the tangential Laplacian to 1e-8.
"""
TEXT6 = """The iteration slows down and does not vanish, as in the paper. The paper does not have the
dashed curves: Newton's method, from the smoothed map of the coarser graphs, reaches the rounding of
double in a few steps. For uniform weights the curve is the Laplacian together with the force of the
barrier against collapse; the right panel shows the Laplacian alone. Adaptive weights need no barrier."""
TEXT7 = """The iteration slows down and stays above zero with each of the weights, as in the paper. On
the same graph of 25 neighbours, with adaptive weights, Newton's method makes the residual vanish."""
TEXT_LONG = """**Why the paper's residuals never vanish:** each iteration first moves all points so that
their mean is the centre of the sphere. A map whose tangential Laplacian vanishes mostly has its mean
elsewhere (here at a distance of {centroid:.2f} radii), so that the iteration settles where this shift
and its steps cancel, at {settled:.1e} for adaptive weights. Newton's method has no such shift: for
p > 2 the energy itself keeps the sphere from collapsing."""
TEXT8 = """Of the paper's weights the adaptive ones leave the parts that stick out most room on the
sphere. Colours are directions on the object. The column on the right is the default before the mesh
is optimised."""
TEXT9 = """The projection from the centroid puts the tail on the back. The iteration moves the folded
layers slowly; on this tail it squeezes them into a line on the sphere and does not separate them, with
either weight. The map on the right, for the same weights, begins with a coarse graph that is embedded
without folds, and has none at any time."""
TEXT10 = """As in the paper, every mesh is a closed sphere through all points, however noisy, and a few
steps of smoothing recover a surface. The last row shows what the same smoothing makes of the
connectivity of the paper's way. The table has the self-intersections, and the distance from the
surface without noise. For noise larger than the distance of neighbours, larger neighbourhoods help:
there the paper's graph does better than the default."""


def table1(context):
    """Times of 1600 iterations, k = 25, beside ours."""
    table = Table("table1", TABLE1)
    variants = {"iteration": PAPER, "default": (), "converged": ("-tolerance", "1e-8")}
    for name in context.choose((), PAPER_SECONDS):
        cloud = context.programs.scan(name)
        runs = in_turn(
            [[context.programs.reconstruction, cloud.points, context.work / "table1.ply",
              "-quiet", "-json", "-", *options] for options in variants.values()], 3)  # fmt: skip
        row = {"model": name, "paper": PAPER_SECONDS[name]}
        for variant, done in zip(variants, runs):
            if done[-1].problem:
                raise Failure(f"{name}, {variant}: {done[-1].problem}", "run the tool alone")
            report = json.loads(done[-1].output)
            row["points"] = report["points"]
            row[variant] = median_seconds(done)
            row[f"{variant}_residual"] = report["residual"]
            row[f"{variant}_intersections"] = report["self_intersections"]
        table.rows.append(row)
    return ["### Table 1: time\n", TEXT1, table] if table.rows else []


def _residuals(context, cloud, label, *options, ours=False):
    """(label, report, whether it is ours) of a run whose residuals are to be drawn."""
    mesh = context.work / "residuals.ply"
    return label, context.programs.reconstruct(cloud, mesh, *options)[1], ours


def _draw_residuals(context, name, title, histories, over_time=True):
    """The mean tangential Laplacian over the iterations, and over time."""
    from .drawing import Plot

    plot = Plot(panels=2 if over_time else 1)
    for color, (label, report, ours) in enumerate(histories):
        residuals = report["residuals"]
        count = len(residuals)
        plot.curve(0, range(1, count + 1), residuals, label, color,
                   *(("--", "o") if ours else ()))  # fmt: skip
        if not over_time:
            continue
        seconds = stage_seconds(report)["embedding"]
        if ours:  # of which only the end is known
            plot.curve(1, [seconds], [report["residual"]], label, color, "", "o")
        else:
            times = [seconds * (i + 1) / count for i in range(count)]
            plot.curve(1, times, residuals, label, color)
    plot.label(0, "iteration + 1", "mean tangential Laplacian [radius]", title)
    if over_time:
        plot.label(1, "seconds in the embedding", "", "the same over time")
    return plot.save(context.out / f"{name}.svg")


def figures6_and_7(context):
    cloud = context.programs.scan(context.choose("head_2000", "max"))
    count, long = context.choose((100, 400), (1600, 10000))
    knn = ("-graph", "knn", "-k", 25)

    def history(label, *options, ours=False):
        return _residuals(context, cloud, label, *options, ours=ours)

    def iteration(label, weights, k):
        return history(f"iteration, {label}", *ITERATIVE, "-weights", weights, "-k", k,
                       "-max_iterations", count)  # fmt: skip

    default = history("default graph and weights", *CONVERGED, ours=True)
    uniform = history("Newton, k = 25, uniform (with barrier)", *knn, "-weights", "uniform",
                      *CONVERGED, ours=True)  # fmt: skip
    adaptive = history("Newton, k = 25, adaptive", *knn, *CONVERGED, ours=True)
    figure6 = _draw_residuals(
        context, "figure6", f"Figure 6: uniform weights, {cloud.name}",
        [*(iteration(f"k = {k}", "uniform", k) for k in (100, 25, 9)), uniform, default])  # fmt: skip
    figure7 = _draw_residuals(
        context, "figure7", f"Figure 7: k = 25, {cloud.name}",
        [*(iteration(weights, weights, 25) for weights in WEIGHTS), adaptive, default])  # fmt: skip
    cloud, count = context.programs.scan(context.choose("head_1000", "head_5000")), long
    histories = [iteration(weights, weights, 25) for weights in WEIGHTS]
    newton = history("Newton, adaptive, the same graph", *knn, *CONVERGED, ours=True)
    carried_on = _draw_residuals(context, "figure6_long", f"{long:,} iterations, {cloud.name}",
                                 [*histories, newton], over_time=False)  # fmt: skip
    text = TEXT_LONG.format(centroid=newton[1]["embedding"]["centroid_norm"],
                            settled=histories[-1][1]["residual"])  # fmt: skip
    return ["### Figures 6 and 7: does the tangential Laplacian vanish?\n",
            Figure(figure6, "Figure 6, uniform weights, k = 100, 25, 9", TEXT6),
            Figure(figure7, "Figure 7, k = 25, three weights", TEXT7),
            Figure(carried_on, "More iterations than the paper's", text)]  # fmt: skip


def _measured(context, cloud, name, *options):
    """Mesh and map for options, and their row of FIGURE8."""
    mesh, sphere = context.work / f"{name}.ply", context.work / f"{name}_sphere.ply"
    _, report = context.programs.reconstruct(cloud, mesh, *options, sphere=sphere)
    row = {**context.programs.measure(mesh, cloud, sphere),
           "residual": f"{report['residual']:.1e}",
           "outside": 100.0 * report["edges_outside_graph"]}  # fmt: skip
    return mesh, sphere, row


def figure8(context):
    """Meshes and maps for the three weights, and ours."""
    from .drawing import Pictures, close_up, vertices

    cloud = context.programs.scan(context.choose("head_2000", "max"))
    points = vertices(cloud.points)
    tip = points[:, 0].argmax()  # of the nose
    methods = {weights: (*PAPER, "-weights", weights) for weights in WEIGHTS}
    methods["default, raw"] = RAW
    table = Table("figure8", FIGURE8)
    pictures = Pictures(context.out / "figure8.png")
    meshes, spheres = [], []
    for index, (name, options) in enumerate(methods.items()):
        mesh, sphere, row = _measured(context, cloud, f"figure8_{index}", *options)
        table.rows.append({"method": name, **row})
        meshes.append(mesh)
        spheres.append(sphere)
    count = len(methods)
    pictures.row(meshes, methods, view=[(35, 10)])
    pictures.row(meshes, ["nose"] * count, edges=True,
                 **close_up([points[tip]], 5, [points[tip] - points.mean(axis=0)]))  # fmt: skip
    # The vertices of all meshes are the points, in their order.
    pictures.row(spheres, ["map"] * count, view=[(35, 10)], colors=cloud.points)
    places = [vertices(sphere)[tip] for sphere in spheres]
    pictures.row(spheres, ["map of the nose"] * count, edges=True, colors=cloud.points,
                 **close_up(places, 5, places))  # fmt: skip
    title = f"Figure 8, {cloud.name}, k = 25 and 1600 iterations for each weight, and the default"
    return ["### Figure 8: three weights\n",
            Figure(pictures.save(), title, TEXT8), table]  # fmt: skip


def figure9(context):
    """The folded tail, over the iterations."""
    from .drawing import Pictures, close_up, vertices

    cloud = context.programs.scan(context.choose("bird_2000", "tweety"))
    points = vertices(cloud.points)
    tip = (points[:, 2] - 0.2 * points[:, 0]).argmax()
    table = Table("figure9", FIGURE9)
    states = [f"{count} iterations" for count in (0, 100, 200, 800)] + ["default, raw"]
    pictures = Pictures(context.out / "figure9.png")
    for weights in ("uniform", "adaptive"):
        meshes, spheres = [], []
        for index, state in enumerate(states):
            options = RAW if state == states[-1] else (*PAPER, "-max_iterations", state.split()[0])
            mesh, sphere, row = _measured(context, cloud, f"figure9_{index}", *options,
                                          "-weights", weights)  # fmt: skip
            table.rows.append({"method": f"{weights}, {state}", **row})
            meshes.append(mesh)
            spheres.append(sphere)
        pictures.row(meshes, [f"{weights}, {state}" for state in states], view=[(15, 15)])
        places = [vertices(sphere)[tip] for sphere in spheres]
        pictures.row(spheres, ["map of the tail"] * len(states), edges=True, colors=cloud.points,
                     **close_up(places, 4, places))  # fmt: skip
    title = f"Figure 9, {cloud.name}: the tail after 0, 100, 200 and 800 iterations"
    return ["### Figure 9: the folded tail\n",
            Figure(pictures.save(), title, TEXT9), table]  # fmt: skip


def figure10(context):
    """Noise of b = 0, 1, 3 mean distances to the 25 nearest neighbours."""
    from .drawing import Pictures, vertices

    name = context.choose("head_2000", "head_10000")
    noises = context.choose((0, 1), (0, 1, 3))
    pictures = Pictures(context.out / "figure10.png")
    files = {}
    truth = context.programs.scan(name)
    points = vertices(truth.points)
    nose = points[points[:, 0].argmax()]
    table = Table("figure10", FIGURE10)
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
            table.rows.append(row)
    for method, prefix, caption, options in (
        ("default", "", "b = {}", {"edges": True, "focus": [nose], "zoom": [(2.5,)]}),
        ("default", "", "b = {}, flat shaded", {}),
        ("default", "smooth_", "b = {}, 5 steps of smoothing", {}),
        ("paper's iteration", "smooth_", "b = {}, the paper's way, 5 steps", {}),
    ):
        pictures.row([files[noise, method, prefix] for noise in noises],
                     [caption.format(noise) for noise in noises], view=[(35, 10)],
                     **options)  # fmt: skip
    title = f"Figure 10, {name} with noise b = {', '.join(map(str, noises))}"
    return ["### Figure 10: noise\n",
            Figure(pictures.save(), title, TEXT10), table]  # fmt: skip


def section(context):
    parts = []
    for make in (table1, figures6_and_7, figure8, figure9, figure10):
        context.say(f"the paper: {make.__name__.replace('_', ' ')}")
        parts += make(context)
    return Section("The paper", parts)
