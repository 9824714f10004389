#!/usr/bin/python3
"""The launch files of ROS 2 with a stand-in for launch and launch_ros, which Debian does not have.

What is shown: the files run, use arguments that they declare, and connect the cloud to the node by topics that
fit. Whether the real packages take these calls is not.
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


for module in ("launch", "launch.actions", "launch.launch_description_sources", "launch.substitutions", "launch_ros",
               "launch_ros.actions", "launch_ros.descriptions", "launch_ros.parameter_descriptions",
               "launch_ros.substitutions"):
    sys.modules[module] = StandIn(module)


def launch(name, arguments):
    """The calls of a launch file by their names, and its declared arguments with their values."""
    spec = importlib.util.spec_from_file_location("launch_file", ROS2 / "launch" / name)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    calls = module.generate_launch_description().values[0]
    declared = {call.values[0]: call.default_value for call in calls if call.call == "DeclareLaunchArgument"}
    assert arguments.keys() <= declared.keys(), arguments
    declared |= arguments
    for call in [call for call in calls if call.call == "OpaqueFunction"]:
        calls += call.function(declared)
    return {call.call: call for call in calls}, declared


def resolved(value, arguments):
    """A value with the arguments that it names; whole paths below the package's share folder."""
    if not isinstance(value, Call):
        return value
    if value.call == "LaunchConfiguration":
        return resolved(value.perform(arguments), arguments)
    if value.call == "ParameterValue":
        return value.value_type(resolved(value.values[0], arguments))
    assert value.call == "PathJoinSubstitution" and value.values[0][0].values == ("pcl_spherical_param",)
    return "/".join(value.values[0][1:])


class Launch(unittest.TestCase):
    def test_depth_camera_goes_through_crop_and_voxels_to_the_node(self):
        limits = {f"{side}_{axis}": str(0.125 * i) for i, (side, axis) in
                  enumerate((side, axis) for side in ("min", "max") for axis in "xyz")}
        calls, arguments = launch("depth_camera.launch.py", {"cloud": "/points", "leaf_size": "0.5", **limits})
        crop, voxels = calls["ComposableNodeContainer"].composable_node_descriptions
        topics = [{end: resolved(topic, arguments) for end, topic in node.remappings} for node in (crop, voxels)]
        self.assertEqual((crop.plugin, voxels.plugin), ("pcl_ros::CropBox", "pcl_ros::VoxelGrid"))
        self.assertEqual(topics[0]["input"], "/points")
        self.assertEqual(topics[0]["output"], topics[1]["input"])
        values = [{name: resolved(value, arguments) for name, value in node.parameters[0].items()}
                  for node in (crop, voxels)]
        numbers = {name: float(value) for name, value in limits.items()}
        self.assertEqual(values[0], numbers)
        self.assertEqual(values[1], {"leaf_size": 0.5, "filter_field_name": "z", "filter_limit_min": numbers["min_z"],
                                     "filter_limit_max": numbers["max_z"]})

        include = calls["IncludeLaunchDescription"]
        passed = {name: resolved(value, arguments) for name, value in include.launch_arguments}
        self.assertTrue((ROS2 / passed["params"]).is_file())
        path = pathlib.PurePath(resolved(include.values[0].values[0], arguments))
        self.assertEqual(path.parent.name, "launch")
        calls, arguments = launch(path.name, passed)
        node = calls["Node"]
        self.assertEqual(node.parameters, [passed["params"]])
        self.assertEqual([resolved(topic, arguments) for _, topic in node.remappings], [topics[1]["output"]])

        # What RViz shows is what these nodes publish.
        shown = yaml.safe_load((ROS2 / "config/reconstruction.rviz").read_text())["Visualization Manager"]["Displays"]
        self.assertEqual({display["Topic"]["Value"] for display in shown},
                         {"/" + topics[1]["output"], f"/{resolved(node.name, arguments)}/marker"})

    def test_node_alone_needs_no_file_of_parameters(self):
        node = launch("reconstruction.launch.py", {"cloud": "/scan"})[0]["Node"]
        self.assertEqual(node.parameters, [])

    def test_parameters_are_those_of_ros_1(self):
        own, of_ros1 = (yaml.safe_load((ROS2.parent / ros / "config/depth_camera.yaml").read_text())
                        for ros in ("ros2", "ros1"))
        self.assertEqual(own, {"/**": {"ros__parameters": of_ros1}})


if __name__ == "__main__":
    unittest.main()
