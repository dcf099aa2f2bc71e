//! The presets. Each source states the number; a part without such a source has no preset.

use super::Delay::{Butterworth, Cycle, FirstOrder, Time, TimeConstant, Window};
use super::DelayLaw::{Constant, Random, UpTo};
use super::{Delay, DelayLaw, LatencyPreset};

const fn preset(
    name: &'static str,
    about: &'static str,
    delay: Delay,
    law: DelayLaw,
    source: &'static str,
) -> LatencyPreset {
    LatencyPreset { name, about, delay, law, source }
}

/// All presets: links and cycles, inertial sensors and their filters, velocities of encoders, cameras, arms.
pub const PRESETS: &[LatencyPreset] = &[
    preset(
        "usb-frame",
        "frame of full-speed USB",
        Time(1e-3),
        UpTo,
        "FTDI knowledge base, \"Setting a Custom Default Latency Timer Value\": 1 ms is the USB frame length",
    ),
    preset(
        "ftdi-latency-timer",
        "FTDI serial converter: wait before a short answer is sent",
        Time(16e-3),
        UpTo,
        "FTDI knowledge base, \"Setting a Custom Default Latency Timer Value\": default 16 ms",
    ),
    preset(
        "franka-fci",
        "cycle of the Franka Control Interface",
        Cycle(1000.0),
        UpTo,
        "libfranka documentation, overview: real-time control at 1 kHz",
    ),
    preset(
        "ur-rtde-e-series",
        "cycle of Universal Robots RTDE at 500 Hz, e-Series",
        Cycle(500.0),
        UpTo,
        "UniversalRobots/Universal_Robots_Client_Library #85: maximum frequency 125 or 500 Hz",
    ),
    preset(
        "ur-rtde-cb-series",
        "cycle of Universal Robots RTDE at 125 Hz, CB-Series",
        Cycle(125.0),
        UpTo,
        "UniversalRobots/Universal_Robots_Client_Library #85: maximum frequency 125 or 500 Hz",
    ),
    preset(
        "expresslrs-200hz",
        "ExpressLRS radio link at 200 Hz: stick to receiver",
        Time(6.5e-3),
        Constant,
        "ExpressLRS/ExpressLRS wiki, home: stick latency as low as 6.5 ms at 868/915 MHz, 200 Hz",
    ),
    preset(
        "mpu9250-184hz",
        "InvenSense MPU-9250 gyroscope, low-pass filter of 184 Hz",
        Time(2.9e-3),
        Constant,
        "libcaer, davis.h, DAVIS_CONFIG_IMU_GYRO_DLPF, value 1: delay 2.9 ms",
    ),
    preset(
        "mpu9250-92hz",
        "InvenSense MPU-9250 gyroscope, low-pass filter of 92 Hz",
        Time(3.9e-3),
        Constant,
        "libcaer, davis.h, DAVIS_CONFIG_IMU_GYRO_DLPF, value 2: delay 3.9 ms",
    ),
    preset(
        "mpu9250-41hz",
        "InvenSense MPU-9250 gyroscope, low-pass filter of 41 Hz",
        Time(5.9e-3),
        Constant,
        "libcaer, davis.h, DAVIS_CONFIG_IMU_GYRO_DLPF, value 3: delay 5.9 ms",
    ),
    preset(
        "mpu9250-20hz",
        "InvenSense MPU-9250 gyroscope, low-pass filter of 20 Hz",
        Time(9.9e-3),
        Constant,
        "libcaer, davis.h, DAVIS_CONFIG_IMU_GYRO_DLPF, value 4: delay 9.9 ms",
    ),
    preset(
        "px4-gyro",
        "PX4 gyroscope filter IMU_GYRO_CUTOFF at 30 Hz",
        Butterworth(30.0),
        Constant,
        "PX4/PX4-Autopilot, imu_gyro_parameters.c, commit 050fa47: order 2, default 30 Hz; 40 Hz in later versions",
    ),
    preset(
        "arducopter-gyro",
        "ArduCopter gyroscope filter INS_GYRO_FILTER",
        Butterworth(20.0),
        Constant,
        "ArduPilot/ardupilot, AP_InertialSensor.cpp, DEFAULT_GYRO_FILTER: 20 Hz; LowPassFilter2p.cpp: order 2",
    ),
    preset(
        "betaflight-gyro-lpf1",
        "Betaflight gyroscope low-pass 1 (PT1) at its lowest cutoff",
        FirstOrder(250.0),
        Constant,
        "betaflight/betaflight, gyro.h, GYRO_LPF1_DYN_MIN_HZ_DEFAULT: 250 Hz",
    ),
    preset(
        "betaflight-gyro-lpf2",
        "Betaflight gyroscope low-pass 2 (PT1)",
        FirstOrder(500.0),
        Constant,
        "betaflight/betaflight, gyro.h, GYRO_LPF2_HZ_DEFAULT: 500 Hz",
    ),
    preset(
        "betaflight-dterm-lpf1",
        "Betaflight derivative low-pass 1 (PT1) at its lowest cutoff",
        FirstOrder(75.0),
        Constant,
        "betaflight/betaflight, pid.h, DTERM_LPF1_DYN_MIN_HZ_DEFAULT: 75 Hz",
    ),
    preset(
        "betaflight-dterm-lpf2",
        "Betaflight derivative low-pass 2 (PT1)",
        FirstOrder(150.0),
        Constant,
        "betaflight/betaflight, pid.h, DTERM_LPF2_HZ_DEFAULT: 150 Hz",
    ),
    preset(
        "libfranka-lowpass",
        "low-pass filter of commands in libfranka",
        FirstOrder(100.0),
        Constant,
        "frankaemika/libfranka, lowpass_filter.h, kDefaultCutoffFrequency: order 1, 100 Hz",
    ),
    preset(
        "simplefoc-velocity",
        "SimpleFOC velocity filter LPF_velocity",
        TimeConstant(5e-3),
        Constant,
        "simplefoc/Arduino-FOC, defaults.h, DEF_VEL_FILTER_Tf: 0.005 s",
    ),
    preset(
        "spark-max-quadrature-velocity",
        "REV SPARK MAX velocity of a quadrature encoder",
        Window(0.1),
        Constant,
        "REVLib, SetMeasurementPeriod: change in position by change in time, default 100 ms",
    ),
    preset(
        "el5032-velocity",
        "Beckhoff EL5032 velocity of an encoder",
        Window(0.01),
        Constant,
        "Beckhoff EL5032 manual, \"Velocity measurement\": window of 10 ms by default",
    ),
    preset(
        "oak-mono-400p",
        "Luxonis OAK camera, mono 400P at 120 frames/s, USB 3: from the timestamp of the frame, after the ISP, to the host; without exposure and readout",
        Time(7.5e-3),
        Constant,
        "Luxonis documentation, \"Optimizing FPS & Latency\": 7.5 ms",
    ),
    preset(
        "oak-color-1080p",
        "Luxonis OAK camera, colour 1080P, USB 3: from the timestamp of the frame, after the ISP, to the host; without exposure and readout",
        Time(33e-3),
        Random(0.8e-3),
        "Luxonis documentation, \"Low Latency\": 33 ms, standard deviation 0.8 ms",
    ),
    preset(
        "oak-color-1080p-poe",
        "Luxonis OAK camera, colour 1080P at 25 frames/s, Ethernet: from the timestamp of the frame, after the ISP, to the host; without exposure and readout",
        Time(51e-3),
        Constant,
        "Luxonis documentation, \"Low Latency\": 51 ms",
    ),
    preset(
        "so101-arm",
        "SO-101 arm of LeRobot: joint after its commanded target",
        Time(133e-3),
        Constant,
        "pytorch/rl #4422: trails the commanded target by 4 frames, 133 ms",
    ),
];
