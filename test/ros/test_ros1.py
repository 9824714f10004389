#!/usr/bin/python3
"""The nodes of ROS 1 with a real master, on a free port of this machine.

    test_ros1.py [-j FILE] [Ros1.test_name...]

The environment must have the package: setup.bash of its install space. With -j, FILE is
given the numbers of tests, and of those that did not pass.

What is asserted of a mesh is computed from the messages alone.
"""

import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


os.environ["ROS_MASTER_URI"] = f"http://localhost:{free_port()}"
os.environ["ROS_HOSTNAME"] = "localhost"
os.environ.pop("ROS_IP", None)
_folder = tempfile.TemporaryDirectory(prefix="spherical_param_ros")
os.environ["ROS_HOME"] = _folder.name

import dynamic_reconfigure.client  # noqa: E402
import rosgraph  # noqa: E402
import rospy  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from pcl_msgs.msg import PolygonMesh  # noqa: E402
from pcl_spherical_param.srv import Reconstruct  # noqa: E402
from sensor_msgs.msg import PointCloud2, PointField  # noqa: E402
from shape_msgs.msg import Mesh  # noqa: E402
from std_msgs.msg import Header  # noqa: E402
from visualization_msgs.msg import Marker  # noqa: E402

POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4"), ("rgb", "<u4")])
processes = []
TIMEOUT = 120  # of whatever should take seconds at most [s]
# A reconstruction that would take weeks.
ENDLESS = ("_embedding:=iterative", "_max_iterations:=2000000000", "_stagnation_window:=0", "_tolerance:=0.0")


def start(*command, **options):
    process = subprocess.Popen(command, start_new_session=True, stdin=subprocess.DEVNULL, **options)
    processes.append(process)
    return process


def stop(process):
    """Ends a process and all that it started."""
    for how, patience in ((signal.SIGINT, 30), (signal.SIGKILL, 5)):
        try:
            os.killpg(process.pid, how)
        except ProcessLookupError:
            break
        try:
            process.wait(patience)
        except subprocess.TimeoutExpired:
            continue
        if how == signal.SIGINT:
            continue  # what it started may have been left behind
    process.wait()
    if process in processes:
        processes.remove(process)


def wait_for(condition, what):
    end = time.monotonic() + TIMEOUT
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"waited in vain for {what}")
        time.sleep(0.05)


def node_program():
    """Where rosrun would find the node."""
    paths = subprocess.run(["catkin_find", "--first-only", "--libexec", "pcl_spherical_param",
                            "spherical_param_node"], check=True, capture_output=True, text=True)
    return paths.stdout.strip()


def nodelet_program():
    find = subprocess.run(["catkin_find", "--first-only", "--libexec", "nodelet", "nodelet"],
                          capture_output=True, text=True)
    return find.stdout.strip() or "/usr/lib/nodelet/nodelet"


def record_array(count, seed):
    """A star-shaped surface with bumps, sampled at random, with a colour and a number each."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    wave = random.normal(size=3)
    radius = 1.0 + 0.2 * np.sin(2.0 * directions @ wave)
    points = np.zeros(count, POINT)
    for axis, scale in zip("xyz", (1.0, 0.8, 0.6)):
        points[axis] = scale * radius * directions[:, "xyz".index(axis)]
    points["intensity"] = np.arange(count)
    points["rgb"] = random.integers(0, 1 << 24, count)
    return points


def message_of(points, stamp=None, frame="scanner"):
    cloud = PointCloud2()
    cloud.header = Header(stamp=stamp or rospy.Time(12, 345678901), frame_id=frame)
    cloud.fields = [PointField(name, POINT.fields[name][1], PointField.FLOAT32, 1)
                    for name in POINT.names]
    cloud.width, cloud.height = len(points), 1
    cloud.point_step = POINT.itemsize
    cloud.row_step = POINT.itemsize * len(points)
    cloud.data = points.tobytes()
    return cloud


def vertices_of(points):
    """The records that should be vertices: the first at each finite position."""
    finite = points[np.isfinite(points["x"]) & np.isfinite(points["y"]) & np.isfinite(points["z"])]
    positions = np.stack([finite[axis] for axis in "xyz"], axis=1)
    _, first = np.unique(positions, axis=0, return_index=True)
    return finite[np.sort(first)]


def assert_sphere(test, triangles, vertices):
    """Closed, consistently oriented, in one piece, of genus 0, all vertices used: with one piece
    across edges V - E + F is 2 for a sphere alone, and less where a vertex is a pinch."""
    half_edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    keys = half_edges[:, 0].astype(np.int64) * vertices + half_edges[:, 1]
    opposite = half_edges[:, 1].astype(np.int64) * vertices + half_edges[:, 0]
    order = np.argsort(keys)
    test.assertEqual(len(np.unique(keys)), len(keys), "an edge twice in one direction")
    place = np.searchsorted(keys, opposite, sorter=order)
    test.assertTrue((place < len(keys)).all(), "not closed")
    partner = order[place]
    test.assertTrue((keys[partner] == opposite).all(), "not closed")
    test.assertTrue((np.bincount(triangles.ravel(), minlength=vertices) > 0).all())
    test.assertEqual(vertices - len(keys) // 2 + len(triangles), 2, "Euler characteristic")
    # Spreads the least number of a triangle to its neighbours.
    label = np.arange(len(triangles))
    across = (partner % len(triangles)).reshape(3, -1)
    while True:
        least = np.minimum(label, label[across].min(axis=0))
        least = least[least]
        if (least == label).all():
            break
        label = least
    test.assertTrue((label == 0).all(), "several pieces")


def assert_mesh(test, mesh, cloud, points):
    """The mesh is a sphere through all distinct points; header and all fields are kept."""
    expected = vertices_of(points)
    test.assertEqual(mesh.header.stamp, cloud.header.stamp)
    test.assertEqual(mesh.header.frame_id, cloud.header.frame_id)
    test.assertEqual(mesh.cloud.header.frame_id, cloud.header.frame_id)
    test.assertEqual(mesh.cloud.fields, cloud.fields)
    test.assertEqual(np.frombuffer(mesh.cloud.data, POINT).tobytes(), expected.tobytes())
    triangles = np.array([polygon.vertices for polygon in mesh.polygons])
    assert_sphere(test, triangles, len(expected))


def bad_clouds():
    """Clouds that cannot be meshed, and a word of the cause."""
    plane = record_array(100, 1)
    plane["z"] = 1.0
    nothing = record_array(50, 1)
    nothing["y"] = np.nan
    without_z = message_of(record_array(50, 1))
    del without_z.fields[2]
    short = message_of(record_array(50, 1))
    short.data = short.data[:-1]
    huge = message_of(record_array(50, 1))
    huge.width = huge.height = 60000
    return [(PointCloud2(), "empty"), (message_of(record_array(3, 1)), "4 distinct"),
            (message_of(plane), "plane"), (message_of(nothing), "not finite"),
            (without_z, "'z'"), (short, "bytes"), (huge, "max_points")]


def resident(process):
    """Memory of a process [bytes]."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        return 1024 * int(re.search(r"VmRSS:\s+(\d+) kB", status.read()).group(1))


class Watch:
    """The last messages of some topics."""

    def __init__(self, **topics):
        self.messages = {name: [] for name in topics}
        self.lock = threading.Lock()
        self.subscribers = [
            rospy.Subscriber(topic, kind, lambda message, name=name: self.take(name, message))
            for name, (topic, kind) in topics.items()]

    def take(self, name, message):
        with self.lock:
            self.messages[name].append(message)

    def all(self, name):
        with self.lock:
            return list(self.messages[name])

    def close(self):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def diagnostics(self):
        """The last diagnosis of the node, as level, summary and a dictionary."""
        for message in reversed(self.all("diagnostics")):
            for status in message.status:
                if "reconstruction" in status.name:
                    return status.level, status.message, {v.key: v.value for v in status.values}
        return None, None, {}


def watch_all(name="/spherical_param"):
    return Watch(mesh=(f"{name}/mesh", PolygonMesh), shape=(f"{name}/shape", Mesh),
                 marker=(f"{name}/marker", Marker), diagnostics=("/diagnostics", DiagnosticArray))


def idle(watch, received):
    """Waits until so many clouds arrived and nothing is left to do; the counts of all."""
    def counts():
        return {key.split()[0]: int(value) for key, value in watch.diagnostics()[2].items()
                if key.endswith(("clouds", "requests"))}

    wait_for(lambda: counts().get("received") == received and counts()["waiting"] == 0
             and watch.diagnostics()[2]["state"] == "idle", f"{received} clouds to be worked on")
    return counts()


class Ros1(unittest.TestCase):
    def setUp(self):
        begin = time.monotonic()
        self.addCleanup(lambda: print(f"[{time.monotonic() - begin:.1f} s]", end=" "))
        # The master keeps parameters longer than a node lives.
        for name in ("/spherical_param", "/meshes"):
            if rospy.has_param(name):
                rospy.delete_param(name)
        self.addCleanup(lambda: [stop(process) for process in list(processes)])

    def run_node(self, *arguments, **options):
        return start(node_program(), "__name:=spherical_param", *arguments, **options)

    def service(self, name="/spherical_param"):
        rospy.wait_for_service(f"{name}/reconstruct", TIMEOUT)
        return rospy.ServiceProxy(f"{name}/reconstruct", Reconstruct, persistent=True)

    def call_service(self, callers):
        """Calls it from so many threads, with a cloud that takes weeks, and returns when the first
        is worked on; their answers as they come, and the diagnostics."""
        watch = self.watch()
        answers = []
        cloud = message_of(record_array(3000, 1))

        def call(reconstruct):
            try:
                answers.append(reconstruct(cloud))
            except rospy.ServiceException:
                pass  # the node ended

        for number in range(callers):
            thread = threading.Thread(target=call, args=(self.service(),), daemon=True)
            thread.start()
            if number == 0:
                wait_for(lambda: watch.diagnostics()[2].get("state") == "working", "work")
        return answers, watch

    def publisher(self, name="/spherical_param/cloud", queue_size=1000):
        publisher = rospy.Publisher(name, PointCloud2, queue_size=queue_size)
        self.addCleanup(publisher.unregister)
        wait_for(lambda: publisher.get_num_connections() == 1, f"a subscriber of {name}")
        return publisher

    def watch(self, name="/spherical_param"):
        watch = watch_all(name)
        self.addCleanup(watch.close)
        return watch

    def test_service_answers_200_clouds_in_flat_memory(self):
        # Each thread that answers requests would have an arena of its own, and these fill up one by
        # one.
        node = self.run_node(env=dict(os.environ, MALLOC_ARENA_MAX="1"))
        reconstruct = self.service()
        bad = bad_clouds()
        random = np.random.default_rng(4)
        # The same sizes five times, so that memory after each pass can be compared.
        sizes = (4 * 5000.0 ** (random.uniform(size=33) ** 1.5)).astype(int)
        sizes[0], sizes[1] = 4, 20000
        memory, sent = [], []
        for turn in range(5):
            peak = 0
            total = 0
            for number, size in enumerate(sizes):
                points = record_array(size, 1000 * turn + number)
                if size > 20 and number % 3 == 0:
                    points["x"][3] = np.nan
                    points[7:9] = points[5]
                cloud = message_of(points, rospy.Time(turn, number))
                answer = reconstruct(cloud)
                self.assertTrue(answer.success, answer.message)
                assert_mesh(self, answer.mesh, cloud, points)
                peak = max(peak, resident(node))
                total += len(cloud.data) + len(answer.mesh.cloud.data)
                total += 12 * len(answer.mesh.polygons)
            for cloud, cause in bad:
                answer = reconstruct(cloud)
                self.assertFalse(answer.success)
                self.assertIn(cause, answer.message)
                self.assertIn("; ", answer.message)
                self.assertFalse(answer.mesh.polygons or answer.mesh.cloud.data)
            memory.append(peak)
            sent.append(total)
        self.assertIsNone(node.poll())
        print("clouds:", 5 * (len(sizes) + len(bad)), "memory by turn [MB]:",
              [round(peak / 1e6, 1) for peak in memory])
        # The first two turns are the warm-up. Had each cloud of the others left itself and its mesh
        # behind, it were twice as much; the rest is for the allocator.
        self.assertLess(memory[-1] - memory[1], sum(sent[2:]) / 2)

    def test_topic_drops_the_oldest_and_always_meshes_the_last(self):
        node = self.run_node()
        watch = self.watch()
        publisher = self.publisher()
        sent = 200
        random = np.random.default_rng(5)
        sizes = (4 * 5000.0 ** random.uniform(size=sent)).astype(int)
        bad = bad_clouds()
        largest_queue = 0
        for number, size in enumerate(sizes):
            if number % 10 == 9 and number < sent - 1:
                publisher.publish(bad[number % len(bad)][0])
            else:
                points = record_array(size, number)
                cloud = message_of(points, rospy.Time(100, number))
                publisher.publish(cloud)
            # Faster than they can be meshed, but not than they can be sent.
            time.sleep(0.02)
            waiting = watch.diagnostics()[2].get("waiting clouds")
            largest_queue = max(largest_queue, int(waiting or 0))
        counts = idle(watch, sent)
        print(counts)
        self.assertEqual(counts["received"], counts["done"] + counts["failed"] + counts["dropped"]
                         + counts["cancelled"])
        self.assertGreater(counts["dropped"] + counts["cancelled"], 0)
        self.assertGreater(counts["done"], 1)
        self.assertLessEqual(largest_queue, 1)
        wait_for(lambda: len(watch.all("mesh")) == counts["done"], "all meshes")
        last = watch.all("mesh")[-1]
        assert_mesh(self, last, cloud, points)
        # Meshes come in the order of the clouds.
        stamps = [mesh.header.stamp.to_nsec() for mesh in watch.all("mesh")]
        self.assertEqual(stamps, sorted(stamps))
        for mesh in watch.all("mesh"):
            triangles = np.array([polygon.vertices for polygon in mesh.polygons])
            assert_sphere(self, triangles, mesh.cloud.width)
        self.assertIsNone(node.poll())

    def test_long_queue_without_cancellation_loses_nothing(self):
        self.run_node("_queue_depth:=100", "_cancel_running:=false")
        watch = self.watch()
        publisher = self.publisher()
        for number in range(30):
            publisher.publish(message_of(record_array(500, number), rospy.Time(1, number)))
            time.sleep(0.01)
        self.assertEqual(idle(watch, 30)["done"], 30)

    def test_mesh_shape_and_marker_agree(self):
        self.run_node()
        watch = self.watch()
        points = record_array(1000, 3)
        cloud = message_of(points)
        self.publisher().publish(cloud)
        wait_for(lambda: all(watch.all(name) for name in ("mesh", "shape", "marker")), "messages")
        mesh, shape, marker = (watch.all(name)[-1] for name in ("mesh", "shape", "marker"))
        assert_mesh(self, mesh, cloud, points)
        triangles = np.array([polygon.vertices for polygon in mesh.polygons])
        shape_triangles = np.array([list(t.vertex_indices) for t in shape.triangles])
        np.testing.assert_array_equal(shape_triangles, triangles)
        corners = np.array([[p.x, p.y, p.z] for p in shape.vertices])
        expected = np.stack([points[axis] for axis in "xyz"], axis=1).astype(float)
        np.testing.assert_array_equal(corners, expected)
        self.assertEqual(marker.header.frame_id, "scanner")
        self.assertEqual(marker.header.stamp, cloud.header.stamp)
        self.assertEqual((marker.type, marker.action), (Marker.TRIANGLE_LIST, Marker.ADD))
        self.assertEqual((marker.scale.x, marker.pose.orientation.w), (1.0, 1.0))
        drawn = np.array([[p.x, p.y, p.z] for p in marker.points])
        np.testing.assert_array_equal(drawn, expected[triangles.ravel()])
        colors = np.array([[c.r, c.g, c.b, c.a] for c in marker.colors])
        rgb = points["rgb"][triangles.ravel()]
        wanted = np.stack([rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255, rgb * 0 + 255], axis=1) / 255
        np.testing.assert_allclose(colors, wanted, atol=1e-6)  # single precision
        # Outward: by the volume that the triangles enclose.
        a, b, c = (drawn[i::3] for i in range(3))
        self.assertGreater(np.einsum("ij,ij->i", a, np.cross(b, c)).sum(), 0.0)

    def test_parameters_change_while_it_runs(self):
        self.run_node("_smoothing:=3", "_exponent:=4")
        reconstruct = self.service()
        client = dynamic_reconfigure.client.Client("/spherical_param", timeout=TIMEOUT)
        self.addCleanup(client.close)
        configuration = client.get_configuration(TIMEOUT)
        self.assertEqual(configuration["smoothing"], 3)
        self.assertEqual(configuration["exponent"], 4.0)
        points = record_array(500, 6)
        cloud = message_of(points)
        smoothed = np.frombuffer(reconstruct(cloud).mesh.cloud.data, POINT)
        self.assertTrue((smoothed["x"] != points["x"]).any())
        np.testing.assert_array_equal(smoothed["rgb"], points["rgb"])
        client.update_configuration({"smoothing": 0})
        assert_mesh(self, reconstruct(cloud).mesh, cloud, points)
        for change in ({"embedding": "simplex"}, {"exponent": 2.0}, {"k": 2}):  # refused
            self.assertNotEqual(client.update_configuration(change), None)
            name, value = next(iter(change.items()))
            self.assertNotEqual(client.get_configuration(TIMEOUT)[name], value)
        client.update_configuration({"max_points": 100})
        answer = reconstruct(cloud)
        self.assertFalse(answer.success)
        self.assertIn("max_points", answer.message)

    def test_wrong_parameters_end_the_node_with_cause_and_remedy(self):
        for argument in ("_embedding:=simplex", "_damping:=0.0", "_k:=2", "_threads:=many"):
            node = self.run_node(argument, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            out = node.communicate(timeout=TIMEOUT)[0].decode()
            self.assertEqual(node.returncode, 1, out)
            self.assertIn(argument[1:].split(":")[0] + " = ", out)
            self.assertIn("; use ", out)
            rospy.delete_param("/spherical_param")

    def test_diagnostics_tell_state_result_time_and_drops(self):
        self.run_node()
        watch = self.watch()
        reconstruct = self.service()
        self.assertTrue(reconstruct(message_of(record_array(2000, 1))).success)
        idle(watch, 1)
        level, _, values = watch.diagnostics()
        self.assertEqual(int.from_bytes(level, "little") if isinstance(level, bytes) else level, 0)
        self.assertEqual(values["last result"], "done")
        self.assertEqual(values["last cloud [points]"], "2000")
        self.assertGreater(float(values["last time [s]"]), 0.0)
        self.assertFalse(reconstruct(bad_clouds()[2][0]).success)
        idle(watch, 2)
        level, summary, values = watch.diagnostics()
        self.assertEqual(int.from_bytes(level, "little") if isinstance(level, bytes) else level, 1)
        self.assertIn("could not be meshed", summary)
        self.assertEqual(values["last result"], "failed")
        self.assertIn("plane", values["last message"])
        self.assertEqual(values["dropped clouds"], "0")

    def test_diagnostics_go_on_while_simulated_time_stands_still(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        self.run_node()
        watch = self.watch()
        self.assertTrue(self.service()(message_of(record_array(300, 1))).success)
        wait_for(lambda: watch.diagnostics()[2].get("done clouds") == "1", "diagnostics")

    def test_requests_beyond_those_that_may_wait_are_refused_at_once(self):
        self.run_node(*ENDLESS)
        answers, watch = self.call_service(20)
        # One is worked on, and eight wait.
        wait_for(lambda: watch.diagnostics()[2].get("refused requests") == "11", "refusals")
        wait_for(lambda: len(answers) == 11, "answers")
        self.assertEqual(watch.diagnostics()[2]["waiting clouds"], "8")
        for answer in answers:
            self.assertFalse(answer.success)
            self.assertIn("too many requests wait; ask again later", answer.message)

    def test_nodelet_works_in_a_manager(self):
        program = nodelet_program()
        manager = start(program, "manager", "__name:=manager")
        loader = start(program, "load", "pcl_spherical_param/ReconstructionNodelet", "manager",
                       "__name:=meshes")
        reconstruct = self.service("/meshes")
        points = record_array(800, 2)
        cloud = message_of(points)
        assert_mesh(self, reconstruct(cloud).mesh, cloud, points)
        watch = self.watch("/meshes")
        self.publisher("/meshes/cloud").publish(cloud)
        wait_for(lambda: watch.all("marker"), "a marker")
        # Its loader ends, and with it the nodelet; the manager stays.
        stop(loader)
        master = rosgraph.Master("/test_ros1")
        wait_for(lambda: "/meshes/reconstruct" not in dict(master.getSystemState()[2]),
                 "the nodelet to be unloaded")
        self.assertIsNone(manager.poll())

    def test_launch_file_starts_the_node(self):
        parameters = os.path.join(_folder.name, "parameters.yaml")
        with open(parameters, "w", encoding="ascii") as file:
            file.write("optimization: flips\nqueue_depth: 4\n")
        start("roslaunch", "pcl_spherical_param", "reconstruction.launch", "cloud:=/scan/points",
              f"params:={parameters}")
        watch = self.watch()
        points = record_array(300, 2)
        cloud = message_of(points)
        self.publisher("/scan/points").publish(cloud)
        wait_for(lambda: watch.all("mesh"), "a mesh")
        assert_mesh(self, watch.all("mesh")[-1], cloud, points)
        self.assertEqual(rospy.get_param("/spherical_param/optimization"), "flips")
        self.assertEqual(rospy.get_param("/spherical_param/queue_depth"), 4)

    def test_launch_file_starts_the_nodelet(self):
        start("roslaunch", "pcl_spherical_param", "reconstruction.launch", "nodelet:=true")
        points = record_array(300, 2)
        cloud = message_of(points)
        assert_mesh(self, self.service()(cloud).mesh, cloud, points)

    def test_ends_at_once_while_it_works(self):
        node = self.run_node(*ENDLESS)
        watch = self.watch()
        self.publisher().publish(message_of(record_array(3000, 1)))
        wait_for(lambda: watch.diagnostics()[2].get("state") == "working", "work")
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(TIMEOUT), 0)

    def test_ends_at_once_while_services_are_called(self):
        node = self.run_node(*ENDLESS)
        self.call_service(3)
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(TIMEOUT), 0)

    def test_nodelet_ends_at_once_while_services_are_called(self):
        manager = start(nodelet_program(), "standalone", "pcl_spherical_param/ReconstructionNodelet",
                        "__name:=spherical_param", *ENDLESS)
        self.call_service(3)
        manager.send_signal(signal.SIGINT)
        self.assertEqual(manager.wait(TIMEOUT), 0)


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    port = os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]
    master = start("roscore", "-p", port, stdout=subprocess.DEVNULL)
    # Not one of those that end with a test.
    processes.remove(master)
    try:
        wait_for(rosgraph.is_master_online, "the master")
        rospy.init_node("test_ros1", disable_signals=True)
        counts = sys.argv.index("-j") if "-j" in sys.argv else None
        counts_file = sys.argv.pop(counts + 1) if counts else None
        if counts:
            sys.argv.pop(counts)
        result = unittest.main(verbosity=2, exit=False, warnings="ignore").result
        bad = len(result.failures) + len(result.errors) + len(result.skipped)
        if counts_file:
            with open(counts_file, "w", encoding="ascii") as file:
                file.write(f"{result.testsRun} {bad}\n")
        return 0 if bad == 0 and result.testsRun > 0 else 1
    finally:
        for process in list(processes):
            stop(process)
        rospy.signal_shutdown("done")
        stop(master)
        _folder.cleanup()


if __name__ == "__main__":
    sys.exit(main())
