"""Meshes the clouds of a topic:
ros2 launch pcl_spherical_param reconstruction.launch.py cloud:=/scan/points
With camera:=true, clouds of a depth camera are cropped and thinned out first. The limits are in the frame of the cloud:
x to the right, y down, z away from the camera."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode

LIMITS = {'min_x': '-0.5', 'max_x': '0.5', 'min_y': '-0.5', 'max_y': '0.5', 'min_z': '0.3', 'max_z': '1.2'}
ARGUMENTS = {
    'cloud': ('cloud', 'topic of sensor_msgs/PointCloud2'),
    'name': ('spherical_param', 'name of the node'),
    'camera': ('false', 'true: crop and thin out the clouds of a depth camera'),
    'params': ('', 'YAML file of parameters; see doc/guide.md'),
    **{name: (value, '[m]') for name, value in LIMITS.items()},
    'leaf_size': ('0.01', 'one point is left of each cube of this edge [m]'),
}


def filters(given):
    crop = ComposableNode(
        package='pcl_ros', plugin='pcl_ros::CropBox', name='spherical_param_crop',
        parameters=[{name: float(given[name]) for name in LIMITS}],
        remappings=[('input', given['cloud']), ('output', 'spherical_param_crop/output')])
    voxels = ComposableNode(
        package='pcl_ros', plugin='pcl_ros::VoxelGrid', name='spherical_param_voxels',
        # By default it would crop as well, to z from 0 to 1.
        parameters=[{'leaf_size': float(given['leaf_size']), 'filter_field_name': 'z',
                     'filter_limit_min': float(given['min_z']), 'filter_limit_max': float(given['max_z'])}],
        remappings=[('input', 'spherical_param_crop/output'), ('output', 'spherical_param_voxels/output')])
    return ComposableNodeContainer(
        name='spherical_param_manager', namespace='', package='rclcpp_components', executable='component_container',
        composable_node_descriptions=[crop, voxels], output='screen')


def nodes(context):
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    is_camera = given['camera'].lower() == 'true'
    cloud, params = given['cloud'], given['params']
    if is_camera:
        cloud = 'spherical_param_voxels/output'
        params = params or str(Path(__file__).parents[1] / 'config' / 'depth_camera.yaml')
    node = Node(package='pcl_spherical_param', executable='spherical_param_node', name=given['name'], output='screen',
                parameters=[params] if params else [], remappings=[('~/cloud', cloud)])
    return [filters(given), node] if is_camera else [node]


def generate_launch_description():
    arguments = [DeclareLaunchArgument(name, default_value=value, description=description)
                 for name, (value, description) in ARGUMENTS.items()]
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
