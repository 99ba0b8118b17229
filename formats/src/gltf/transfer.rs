//! Colors as files of pictures have them, and as amounts of light, which glTF has for colors of
//! vertices and factors.
//!
//! IEC 61966-2-1:1999, sRGB.

use glam::DVec3;

/// The display color of an amount of light. What 32 bits have rounded away from one of 256 steps is
/// put back, so that colors of bytes come back from a file as they were.
pub(super) fn display(light: DVec3) -> DVec3 {
    /// Above what floats of 32 bits round, and far below a step.
    const ROUNDING: f64 = 1e-6;
    let one = |x: f64| {
        let value = if x > 0.003_130_8 { 1.055 * x.powf(1.0 / 2.4) - 0.055 } else { 12.92 * x };
        let step = (value * 255.0).round() / 255.0;
        if (value - step).abs() < ROUNDING { step } else { value }
    };
    DVec3::from_array(light.to_array().map(one))
}

/// The amount of light of a display color.
pub(super) fn light(display: DVec3) -> DVec3 {
    let one = |x: f64| if x > 0.040_45 { ((x + 0.055) / 1.055).powf(2.4) } else { x / 12.92 };
    DVec3::from_array(display.to_array().map(one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_through_floats() {
        for byte in 0..=255_u8 {
            let color = DVec3::splat(f64::from(byte) / 255.0);
            assert_eq!(display(light(color).as_vec3().as_dvec3()), color);
        }
        // A quarter of the light is 137/255 of the value, as every table of sRGB has it.
        assert_eq!((display(DVec3::splat(0.25)).x * 255.0).round(), 137.0);
    }
}
