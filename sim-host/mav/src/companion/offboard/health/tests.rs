use super::*;
use staya_mavlink::dialect::{
    EKF_STATUS_REPORT_DATA, ESTIMATOR_STATUS_DATA, GPS_RAW_INT_DATA, GPS2_RAW_DATA, SYS_STATUS_DATA,
};

const SOUND: u16 = ESTIMATOR_ATTITUDE | ESTIMATOR_VELOCITY_HORIZ | ESTIMATOR_POS_HORIZ_ABS;

fn s(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

fn gps(fix_type: u8) -> MavMessage {
    MavMessage::GPS_RAW_INT(GPS_RAW_INT_DATA { fix_type, ..GPS_RAW_INT_DATA::DEFAULT })
}

fn second_gps(fix_type: u8) -> MavMessage {
    MavMessage::GPS2_RAW(GPS2_RAW_DATA { fix_type, ..GPS2_RAW_DATA::DEFAULT })
}

fn ekf(flags: u16, pos_horiz_variance: f32) -> MavMessage {
    MavMessage::EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA {
        flags,
        pos_horiz_variance,
        ..EKF_STATUS_REPORT_DATA::DEFAULT
    })
}

fn estimator(flags: u16, vel_ratio: f32) -> MavMessage {
    MavMessage::ESTIMATOR_STATUS(ESTIMATOR_STATUS_DATA { flags, vel_ratio, ..ESTIMATOR_STATUS_DATA::DEFAULT })
}

fn sensors(present: u32, enabled: u32, health: u32) -> MavMessage {
    MavMessage::SYS_STATUS(SYS_STATUS_DATA {
        onboard_control_sensors_present: present,
        onboard_control_sensors_enabled: enabled,
        onboard_control_sensors_health: health,
        ..SYS_STATUS_DATA::DEFAULT
    })
}

#[test]
fn an_autopilot_without_status_messages_is_trusted() {
    assert!(Health::default().is_trusted(Duration::ZERO));
    assert_eq!(Health::default().hear(&MavMessage::HEARTBEAT(Default::default()), s(1.0)), None);
}

#[test]
fn only_a_vehicle_that_had_a_fix_can_lose_it() {
    let mut health = Health::default();
    assert_eq!(health.hear(&gps(1), s(1.0)), None, "never had a fix");
    assert!(health.is_trusted(s(1.0)));
    assert_eq!(health.hear(&gps(3), s(2.0)), None);
    assert_eq!(health.hear(&gps(2), s(3.0)), Some(Doubt::Gps));
    assert_eq!(health.hear(&gps(2), s(4.0)), None, "reported once");
    assert!(!health.is_trusted(s(100.0)));
}

#[test]
fn one_of_two_receivers_is_enough_until_it_times_out() {
    let mut health = Health::default();
    for (seconds, message, doubt) in [
        (1.0, gps(3), None),
        (1.1, second_gps(3), None),
        (1.5, gps(1), None),
        (3.0, second_gps(3), None),
        (4.9, gps(1), None),
        (5.1, gps(1), Some(Doubt::Gps)),
        (5.2, second_gps(3), None),
        (11.0, second_gps(3), None),
        (11.1, gps(0), None),
        (11.2, second_gps(1), Some(Doubt::Gps)),
    ] {
        assert_eq!(health.hear(&message, s(seconds)), doubt, "{seconds} {message:?}");
    }
    let mut second = Health::default();
    assert_eq!(second.hear(&gps(0), s(0.5)), None);
    assert_eq!(second.hear(&second_gps(6), s(1.0)), None);
    assert_eq!(second.hear(&gps(0), s(1.5)), None);
    assert_eq!(second.hear(&second_gps(0), s(2.0)), Some(Doubt::Gps));
}

#[test]
fn trust_returns_after_a_time_without_problems() {
    let mut health = Health::default();
    let _ = health.hear(&gps(6), s(0.0));
    let _ = health.hear(&gps(0), s(1.0));
    let _ = health.hear(&ekf(0, 0.0), s(2.0));
    let _ = health.hear(&gps(6), s(3.0));
    assert!(!health.is_trusted(s(20.0)), "the estimator is still bad");
    let _ = health.hear(&ekf(SOUND, 0.0), s(4.0));
    assert!(!health.is_trusted(s(7.9)));
    assert!(health.is_trusted(s(8.0)));
    let _ = health.hear(&gps(0), s(21.0));
    let _ = health.hear(&gps(6), s(21.1));
    assert!(!health.is_trusted(s(21.0) + WELL_FOR - s(0.001)));
    assert!(health.is_trusted(s(21.0) + WELL_FOR));
}

#[test]
fn an_estimator_needs_position_velocity_and_small_innovations() {
    for (message, doubt) in [
        (ekf(SOUND, 0.79), None),
        (ekf(SOUND, 0.8), Some(Doubt::Estimator)),
        (ekf(SOUND & !ESTIMATOR_POS_HORIZ_ABS, 0.0), Some(Doubt::Estimator)),
        (ekf(SOUND | EKF_UNINITIALIZED, 0.0), Some(Doubt::Estimator)),
        (ekf(SOUND | EKF_GPS_GLITCHING, 0.0), Some(Doubt::Estimator)),
        (ekf(0x33F, 0.0), None),
        (ekf(0x27, 0.0), Some(Doubt::Estimator)),
        (ekf(0xA7, 0.0), Some(Doubt::Estimator)),
        (estimator(SOUND, 0.99), None),
        (estimator(SOUND, f32::NAN), None),
        (estimator(SOUND, 1.0), Some(Doubt::Estimator)),
        (estimator(SOUND | ESTIMATOR_GPS_GLITCH, 0.0), Some(Doubt::Estimator)),
        (estimator(SOUND | ESTIMATOR_CONST_POS_MODE, 0.0), Some(Doubt::Estimator)),
    ] {
        assert_eq!(Health::default().hear(&message, s(1.0)), doubt, "{message:?}");
    }
}

#[test]
fn only_present_and_enabled_sensors_count() {
    const BOTH: u32 = MAV_SYS_STATUS_SENSOR_GPS | MAV_SYS_STATUS_AHRS;
    for (message, doubt) in [
        (sensors(u32::MAX, u32::MAX, BOTH), None),
        (sensors(u32::MAX, u32::MAX, !MAV_SYS_STATUS_AHRS), Some(Doubt::Sensors)),
        (sensors(u32::MAX, u32::MAX, !MAV_SYS_STATUS_SENSOR_GPS), Some(Doubt::Sensors)),
        (sensors(u32::MAX, !MAV_SYS_STATUS_SENSOR_GPS, BOTH & !MAV_SYS_STATUS_SENSOR_GPS), None),
        (sensors(0, u32::MAX, 0), None),
    ] {
        assert_eq!(Health::default().hear(&message, s(1.0)), doubt, "{message:?}");
    }
}

#[test]
fn texts_of_problems_fit_into_a_status_text() {
    for doubt in [Doubt::Gps, Doubt::Estimator, Doubt::Sensors] {
        assert!("staya: ".len() + doubt.words().len() <= 50);
    }
}
