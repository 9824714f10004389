"""Meshes what a depth camera sees: the cloud is cropped, thinned out and meshed.
ros2 launch pcl_spherical_param depth_camera.launch.py cloud:=/camera/depth/points
Limits are in the frame of the cloud: x to the right, y down, z away from the camera."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import ComposableNodeContainer
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def number(name):
    return ParameterValue(LaunchConfiguration(name), value_type=float)


def generate_launch_description():
    share = FindPackageShare('pcl_spherical_param')
    limits = {'min_x': '-0.5', 'max_x': '0.5', 'min_y': '-0.5', 'max_y': '0.5',
              'min_z': '0.3', 'max_z': '1.2'}
    crop = ComposableNode(
        package='pcl_ros', plugin='pcl_ros::CropBox', name='spherical_param_crop',
        parameters=[{name: number(name) for name in limits}],
        remappings=[('input', LaunchConfiguration('cloud')),
                    ('output', 'spherical_param_crop/output')])
    voxels = ComposableNode(
        package='pcl_ros', plugin='pcl_ros::VoxelGrid', name='spherical_param_voxels',
        # By default it would crop as well, to z from 0 to 1.
        parameters=[{'leaf_size': number('leaf_size'), 'filter_field_name': 'z',
                     'filter_limit_min': number('min_z'), 'filter_limit_max': number('max_z')}],
        remappings=[('input', 'spherical_param_crop/output'),
                    ('output', 'spherical_param_voxels/output')])
    return LaunchDescription([
        DeclareLaunchArgument('cloud', default_value='/camera/depth/points',
                              description='topic of sensor_msgs/PointCloud2'),
        *[DeclareLaunchArgument(name, default_value=value, description='[m]')
          for name, value in limits.items()],
        DeclareLaunchArgument('leaf_size', default_value='0.01',
                              description='one point is left of each cube of this edge [m]'),
        DeclareLaunchArgument(
            'params', default_value=PathJoinSubstitution([share, 'config', 'depth_camera.yaml']),
            description='YAML file of parameters; see doc/guide.md'),
        ComposableNodeContainer(
            name='spherical_param_manager', namespace='', package='rclcpp_components',
            executable='component_container', composable_node_descriptions=[crop, voxels],
            output='screen'),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(
                PathJoinSubstitution([share, 'launch', 'reconstruction.launch.py'])),
            launch_arguments={'cloud': 'spherical_param_voxels/output',
                              'params': LaunchConfiguration('params')}.items()),
    ])
