#!/usr/bin/python3
"""The launch file of ROS 2 with a stand-in for launch and launch_ros, which Debian does not have.

It shows that the file runs and connects the cloud to the node. It does not show that the real packages take its calls.
"""

import importlib.util
import pathlib
import sys
import types
import unittest

import yaml

ROS2 = pathlib.Path(__file__).resolve().parents[2] / "src/ros/ros2"


class Call:
    """A call of the launch API: its name and what it was given."""

    def __init__(self, call, *values, **options):
        self.call, self.values, self.options = call, values, options

    def __getattr__(self, name):
        return self.options[name]

    def perform(self, arguments):  # of a LaunchConfiguration
        return arguments[self.values[0]]


class StandIn(types.ModuleType):
    def __getattr__(self, name):
        return lambda *values, **options: Call(name, *values, **options)


for module in ("launch", "launch.actions", "launch.substitutions", "launch_ros", "launch_ros.actions",
               "launch_ros.descriptions"):
    sys.modules[module] = StandIn(module)


def launch(**arguments):
    """What the launch file starts, by the names of the calls."""
    spec = importlib.util.spec_from_file_location("launch_file", ROS2 / "launch/reconstruction.launch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    *declared, nodes = module.generate_launch_description().values[0]
    defaults = {argument.values[0]: argument.default_value for argument in declared}
    assert arguments.keys() <= defaults.keys(), arguments
    return {call.call: call for call in nodes.function(defaults | arguments)}


class Launch(unittest.TestCase):
    def test_a_depth_camera_goes_through_crop_and_voxels_to_the_node(self):
        limits = {f"{side}_{axis}": str(0.125 * i) for i, (side, axis) in
                  enumerate((side, axis) for side in ("min", "max") for axis in "xyz")}
        calls = launch(camera="true", cloud="/points", leaf_size="0.5", **limits)
        crop, voxels = calls["ComposableNodeContainer"].composable_node_descriptions
        node = calls["Node"]
        self.assertEqual((crop.plugin, voxels.plugin), ("pcl_ros::CropBox", "pcl_ros::VoxelGrid"))
        topics = [dict(each.remappings) for each in (crop, voxels, node)]
        self.assertEqual((topics[0]["input"], topics[1]["input"], topics[2]["~/cloud"]),
                         ("/points", topics[0]["output"], topics[1]["output"]))
        numbers = {name: float(value) for name, value in limits.items()}
        self.assertEqual(crop.parameters, [numbers])
        self.assertEqual(voxels.parameters, [{"leaf_size": 0.5, "filter_field_name": "z",
                                              "filter_limit_min": numbers["min_z"],
                                              "filter_limit_max": numbers["max_z"]}])
        self.assertEqual(node.parameters, [str(ROS2 / "config/depth_camera.yaml")])
        self.assertEqual(launch(camera="true", params="own.yaml")["Node"].parameters, ["own.yaml"])

        # What RViz shows is what these nodes publish.
        shown = yaml.safe_load((ROS2 / "config/reconstruction.rviz").read_text())["Visualization Manager"]["Displays"]
        self.assertEqual({display["Topic"]["Value"] for display in shown},
                         {"/" + topics[1]["output"], f"/{node.name}/marker"})

    def test_the_node_alone_needs_no_file_of_parameters(self):
        calls = launch(cloud="/scan")
        self.assertEqual([*calls], ["Node"])
        self.assertEqual((calls["Node"].parameters, calls["Node"].remappings), ([], [("~/cloud", "/scan")]))

    def test_parameters_are_those_of_ros_1(self):
        own, of_ros1 = (yaml.safe_load((ROS2.parent / ros / "config/depth_camera.yaml").read_text())
                        for ros in ("ros2", "ros1"))
        self.assertEqual(own, {"/**": {"ros__parameters": of_ros1}})


if __name__ == "__main__":
    unittest.main()
