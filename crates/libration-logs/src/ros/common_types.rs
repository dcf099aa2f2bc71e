//! Definitions of messages of common packages of ROS 2, for bags without definitions.
//!
//! Those of Humble; the types are the same in the distributions since Foxy.

/// Types of which only the header is known, for the stamps.
const WITH_HEADER: [&str; 16] = [
    "control_msgs/msg/JointTrajectoryControllerState",
    "diagnostic_msgs/msg/DiagnosticArray",
    "nav_msgs/msg/GridCells",
    "nav_msgs/msg/OccupancyGrid",
    "nav_msgs/msg/Path",
    "sensor_msgs/msg/BatteryState",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/MultiEchoLaserScan",
    "sensor_msgs/msg/NavSatFix",
    "sensor_msgs/msg/PointCloud",
    "sensor_msgs/msg/PointCloud2",
    "sensor_msgs/msg/Range",
    "trajectory_msgs/msg/JointTrajectory",
    "visualization_msgs/msg/Marker",
];

/// The text with the definition of a type, or with that of its header only; none if it is not known.
///
/// By the convention of ROS, a type whose name ends with `Stamped` begins with a header.
pub(super) fn definition(name: &str) -> Option<&'static str> {
    let short = super::definition::short(name);
    let is_known = TYPES.lines().any(|line| line.strip_prefix("MSG: ") == Some(&short));
    match is_known {
        true => Some(TYPES),
        false if name.ends_with("Stamped") || WITH_HEADER.contains(&name) => {
            Some("std_msgs/Header header")
        }
        false => None,
    }
}

const TYPES: &str = "\
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
MSG: std_msgs/Bool
bool data
MSG: std_msgs/Float32
float32 data
MSG: std_msgs/Float64
float64 data
MSG: std_msgs/Int32
int32 data
MSG: std_msgs/Int64
int64 data
MSG: std_msgs/UInt32
uint32 data
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
MSG: std_msgs/MultiArrayLayout
MultiArrayDimension[] dim
uint32 data_offset
MSG: std_msgs/Float32MultiArray
MultiArrayLayout layout
float32[] data
MSG: std_msgs/Float64MultiArray
MultiArrayLayout layout
float64[] data
MSG: rosgraph_msgs/Clock
builtin_interfaces/Time clock
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
MSG: geometry_msgs/Pose
Point position
Quaternion orientation
MSG: geometry_msgs/PoseWithCovariance
Pose pose
float64[36] covariance
MSG: geometry_msgs/Transform
Vector3 translation
Quaternion rotation
MSG: geometry_msgs/Twist
Vector3 linear
Vector3 angular
MSG: geometry_msgs/TwistWithCovariance
Twist twist
float64[36] covariance
MSG: geometry_msgs/Accel
Vector3 linear
Vector3 angular
MSG: geometry_msgs/Wrench
Vector3 force
Vector3 torque
MSG: geometry_msgs/Vector3Stamped
std_msgs/Header header
Vector3 vector
MSG: geometry_msgs/PointStamped
std_msgs/Header header
Point point
MSG: geometry_msgs/PoseStamped
std_msgs/Header header
Pose pose
MSG: geometry_msgs/PoseWithCovarianceStamped
std_msgs/Header header
PoseWithCovariance pose
MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
Transform transform
MSG: geometry_msgs/TwistStamped
std_msgs/Header header
Twist twist
MSG: geometry_msgs/TwistWithCovarianceStamped
std_msgs/Header header
TwistWithCovariance twist
MSG: geometry_msgs/AccelStamped
std_msgs/Header header
Accel accel
MSG: geometry_msgs/WrenchStamped
std_msgs/Header header
Wrench wrench
MSG: nav_msgs/Odometry
std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
MSG: sensor_msgs/JointState
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
MSG: sensor_msgs/Imu
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
MSG: sensor_msgs/MagneticField
std_msgs/Header header
geometry_msgs/Vector3 magnetic_field
float64[9] magnetic_field_covariance
MSG: sensor_msgs/Temperature
std_msgs/Header header
float64 temperature
float64 variance
MSG: sensor_msgs/Joy
std_msgs/Header header
float32[] axes
int32[] buttons
MSG: sensor_msgs/LaserScan
std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
MSG: control_msgs/InterfaceValue
string[] interface_names
float64[] values
MSG: control_msgs/DynamicJointState
std_msgs/Header header
string[] joint_names
InterfaceValue[] interface_values
";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::RosDecoder;

    #[test]
    fn all_common_types_have_decoders() {
        let names = TYPES.lines().filter_map(|line| line.strip_prefix("MSG: "));
        for name in names.chain(WITH_HEADER).chain(["my_msgs/msg/LoadStamped"]) {
            assert!(RosDecoder::of_common_type(name).is_some(), "{name}");
        }
        assert!(RosDecoder::of_common_type("my_msgs/msg/Load").is_none());
    }
}
