//! Color scales: from a number between 0 and 1 to a display color.
//!
//! Sources: Viridis, Magma, Inferno and Plasma of S. van der Walt & N. Smith (matplotlib, 2015), by
//! the crate colorous, whose tables are matplotlib's; Cividis of J. Nuñez, C. Anderton & R. Renslow
//! ("Optimizing colormaps with consideration for color vision deficiency", PLOS ONE 2018); Turbo of
//! A. Mikhailov (2019), a rainbow that is not uniform; CoolWarm of K. Moreland, "Diverging color
//! maps for scientific visualization", ISVC 2009.
//!
//! Departures: Cividis and Turbo are tables of 52 colors of theirs, since the polynomials of
//! colorous are off by up to 18 and 32 of 255; they are within 4 and 1 of matplotlib's, the others
//! within 1. Between entries colors are interpolated.

use std::f64::consts::FRAC_PI_3;

use glam::{DMat3, DVec3};

/// A color scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // They are names.
pub enum Scale {
    Viridis,
    Magma,
    Inferno,
    Plasma,
    Cividis,
    Turbo,
    CoolWarm,
}

/// Colors of Cividis from 0 to 1 in equal steps.
const CIVIDIS: [u32; 52] = [
    0x00224e, 0x002656, 0x002a5f, 0x002d68, 0x003070, 0x083370, 0x163770, 0x203a6f, 0x273e6e,
    0x2e416d, 0x34456c, 0x3a486c, 0x3f4c6c, 0x444f6c, 0x49536c, 0x4e566c, 0x535a6d, 0x575d6d,
    0x5c616e, 0x60646f, 0x656870, 0x696b71, 0x6d6f72, 0x727274, 0x767676, 0x7a7a78, 0x7e7d78,
    0x838179, 0x888578, 0x8d8878, 0x928c78, 0x969077, 0x9b9476, 0xa09875, 0xa59c74, 0xaaa073,
    0xafa471, 0xb5a86f, 0xbaac6d, 0xbfb06b, 0xc4b468, 0xc9b965, 0xcfbd62, 0xd4c15f, 0xdac65b,
    0xdfca57, 0xe5cf52, 0xead34c, 0xf0d846, 0xf6dd3f, 0xfce236, 0xfee838,
];

/// Colors of Turbo from 0 to 1 in equal steps.
const TURBO: [u32; 52] = [
    0x30123b, 0x36215f, 0x3b2f80, 0x3f3e9c, 0x424bb5, 0x4559cb, 0x4666dd, 0x4773eb, 0x4680f6,
    0x458cfd, 0x4099ff, 0x38a5fb, 0x2fb2f4, 0x27bee9, 0x1fc9dd, 0x1ad4d0, 0x18ddc2, 0x1ae4b6,
    0x22ebaa, 0x2ff19b, 0x3ff68a, 0x52fa7a, 0x65fd69, 0x79fe59, 0x8bff4b, 0x9cfe40, 0xa9fb39,
    0xb7f735, 0xc3f134, 0xd0ea34, 0xdbe236, 0xe5d938, 0xeecf3a, 0xf5c53a, 0xfaba39, 0xfdae35,
    0xfea130, 0xfe932a, 0xfc8423, 0xf9751d, 0xf46617, 0xef5811, 0xe84b0c, 0xe14109, 0xd83706,
    0xce2d04, 0xc32503, 0xb71d02, 0xa91601, 0x9b0f01, 0x8b0902, 0x7a0403,
];

/// The colors of a scale in equal steps from 0 to 1, ready to be interpolated.
#[derive(Clone, Debug)]
pub struct ColorTable(Vec<DVec3>);

impl ColorTable {
    /// The table of a scale.
    pub fn new(scale: Scale) -> Self {
        let sampled = |gradient: colorous::Gradient| {
            let color = |i| gradient.eval_rational(i, 256).as_array().map(f64::from);
            (0..256).map(|i| DVec3::from(color(i)) / 255.0).collect()
        };
        let split = |table: &[u32]| table.iter().map(|&rgb| of_bytes(rgb)).collect();
        Self(match scale {
            Scale::Viridis => sampled(colorous::VIRIDIS),
            Scale::Magma => sampled(colorous::MAGMA),
            Scale::Inferno => sampled(colorous::INFERNO),
            Scale::Plasma => sampled(colorous::PLASMA),
            Scale::Cividis => split(&CIVIDIS),
            Scale::Turbo => split(&TURBO),
            Scale::CoolWarm => (0..=256).map(|i| cool_warm(f64::from(i) / 256.0)).collect(),
        })
    }

    /// The display color at `t`; outside of 0 to 1 that of the nearer end. `t` is a number.
    pub fn color(&self, t: f64) -> DVec3 {
        let last = self.0.len() - 1;
        let at = t.clamp(0.0, 1.0) * last as f64;
        // A cast of what is not a number gives 0.
        let below = (at.floor() as usize).min(last - 1);
        self.0[below].lerp(self.0[below + 1], at - below as f64)
    }
}

fn of_bytes(rgb: u32) -> DVec3 {
    let byte = |shift: u32| f64::from(rgb >> shift & 0xff) / 255.0;
    DVec3::new(byte(16), byte(8), byte(0))
}

/// Moreland's scale between a blue and a red of his, through a light gray.
fn cool_warm(t: f64) -> DVec3 {
    const MIDDLE: f64 = 88.0;
    let (cool, warm) = (to_msh(of_bytes(0x3b4cc0)), to_msh(of_bytes(0xb40426)));
    let (from, to, u) = if t < 0.5 {
        (cool, DVec3::new(MIDDLE, 0.0, unsaturated_hue(cool, MIDDLE)), 2.0 * t)
    } else {
        (DVec3::new(MIDDLE, 0.0, unsaturated_hue(warm, MIDDLE)), warm, 2.0 * t - 1.0)
    };
    from_msh(from.lerp(to, u))
}

/// The hue from which a color without saturation is neared, so that the hue does not seem to turn.
fn unsaturated_hue(color: DVec3, magnitude: f64) -> f64 {
    let DVec3 { x: m, y: s, z: hue } = color;
    let spin = s * (magnitude * magnitude - m * m).max(0.0).sqrt() / (m * s.sin());
    if hue > -FRAC_PI_3 { hue + spin } else { hue - spin }
}

/// The reference white of sRGB, D65.
const WHITE: DVec3 = DVec3::new(0.9505, 1.0, 1.089);

/// From linear sRGB to CIE XYZ.
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(0.4124, 0.2126, 0.0193),
    DVec3::new(0.3576, 0.7152, 0.1192),
    DVec3::new(0.1805, 0.0722, 0.9505),
);

/// The polar form of CIELAB: magnitude, saturation and hue, the angles in radians.
fn to_msh(display: DVec3) -> DVec3 {
    let linear = |c: f64| if c > 0.04045 { ((c + 0.055) / 1.055).powf(2.4) } else { c / 12.92 };
    let root = |x: f64| if x > 0.008856 { x.cbrt() } else { 7.787 * x + 16.0 / 116.0 };
    let xyz = XYZ_FROM_RGB * display.map(linear) / WHITE;
    let f = xyz.map(root);
    let (l, a, b) = (116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
    let magnitude = (l * l + a * a + b * b).sqrt();
    DVec3::new(magnitude, (l / magnitude).acos(), b.atan2(a))
}

fn from_msh(msh: DVec3) -> DVec3 {
    let DVec3 { x: m, y: s, z: hue } = msh;
    let (l, a, b) = (m * s.cos(), m * s.sin() * hue.cos(), m * s.sin() * hue.sin());
    let y = (l + 16.0) / 116.0;
    let unroot = |f: f64| if f > 0.206893 { f.powi(3) } else { (f - 16.0 / 116.0) / 7.787 };
    let xyz = DVec3::new(a / 500.0 + y, y, y - b / 200.0).map(unroot) * WHITE;
    let encoded = |c: f64| {
        if c > 0.0031308 { 1.055 * c.powf(1.0 / 2.4) - 0.055 } else { 12.92 * c }
    };
    (XYZ_FROM_RGB.inverse() * xyz).clamp(DVec3::ZERO, DVec3::ONE).map(encoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colors of matplotlib 3.11.2 at 0, 64, 128, 192 and 255 of 255.
    #[test]
    fn scales_are_those_of_matplotlib() {
        let peers: [(Scale, [u32; 5]); 7] = [
            (Scale::Viridis, [0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725]),
            (Scale::Magma, [0x000004, 0x51127c, 0xb73779, 0xfc8961, 0xfcfdbf]),
            (Scale::Inferno, [0x000004, 0x57106e, 0xbc3754, 0xf98e09, 0xfcffa4]),
            (Scale::Plasma, [0x0d0887, 0x7e03a8, 0xcc4778, 0xf89540, 0xf0f921]),
            (Scale::Cividis, [0x00224e, 0x434e6c, 0x7d7c78, 0xbcae6c, 0xfee838]),
            (Scale::Turbo, [0x30123b, 0x28bceb, 0xa4fc3c, 0xfb7e21, 0x7a0403]),
            (Scale::CoolWarm, [0x3b4cc0, 0x8db0fe, 0xdddcdc, 0xf4987a, 0xb40426]),
        ];
        for (scale, colors) in peers {
            let table = ColorTable::new(scale);
            for (at, expected) in [0.0, 64.0, 128.0, 192.0, 255.0].into_iter().zip(colors) {
                let off = 255.0 * (table.color(at / 255.0) - of_bytes(expected)).abs();
                assert!(off.max_element() < 1.001, "{scale:?} at {at}: {off}");
            }
        }
    }

    #[test]
    fn ends_hold_outside() {
        let table = ColorTable::new(Scale::Viridis);
        assert_eq!(table.color(-3.0), table.color(0.0));
        assert_eq!(table.color(f64::INFINITY), table.color(1.0));
    }
}
