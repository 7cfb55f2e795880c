//! Tone mapping per channel, before the sRGB curve.

/// An exposure and a tone curve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tone {
    /// Exposure in stops: light is multiplied by 2^exposure.
    pub exposure: f64,
    pub curve: Curve,
}

/// Tone curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Curve {
    /// Clamp to 1.
    #[default]
    Clip,
    /// x / (1 + x): Reinhard et al. 2002, equation 3.
    Reinhard,
    /// The fit of Narkowicz 2015 to the ACES film curve.
    Aces,
}

impl Curve {
    pub const ALL: [Curve; 3] = [Curve::Clip, Curve::Reinhard, Curve::Aces];

    /// The name in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            Curve::Clip => "clip",
            Curve::Reinhard => "reinhard",
            Curve::Aces => "aces",
        }
    }

    /// The number in the kernels.
    pub fn number(self) -> u32 {
        self as u32
    }
}

/// Light beyond this is white under every curve, and its square is finite in f32.
pub const WHITE: f64 = 1e15;

impl Tone {
    /// Factor of the light.
    pub fn gain(self) -> f32 {
        self.exposure.exp2() as f32
    }

    /// The displayed value of linear light, in [0, 1]; 0 for negative values and NaN.
    pub fn shown(self, linear: f64) -> f64 {
        let light = linear * f64::from(self.gain());
        let x = if light > 0.0 { light.min(WHITE) } else { 0.0 };
        let shown = match self.curve {
            Curve::Clip => x,
            Curve::Reinhard => x / (1.0 + x),
            Curve::Aces => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
        };
        shown.min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_black_to_white() {
        for curve in Curve::ALL {
            let tone = Tone { exposure: 0.0, curve };
            let lights = [f64::NEG_INFINITY, -1.0, 0.0, 1e-6, 0.01, 0.18, 0.5, 0.9, 1e3, 1e20, f64::INFINITY];
            let shown = lights.map(|x| tone.shown(x));
            assert!(shown.is_sorted(), "{curve:?}: {shown:?}");
            assert!(shown[..3] == [0.0; 3] && shown[9] > 0.999 && shown[10] <= 1.0, "{curve:?}: {shown:?}");
            assert_eq!(tone.shown(f64::NAN), 0.0);
        }
    }

    #[test]
    fn a_stop_doubles_light() {
        let [plain, brighter] = [0.0, 1.0].map(|exposure| Tone { exposure, curve: Curve::Reinhard });
        assert_eq!(brighter.shown(0.3), plain.shown(0.6));
        assert_eq!(Tone { exposure: -2.0, curve: Curve::Clip }.shown(0.8), 0.2);
        // Reinhard's middle, and points of Narkowicz's curve
        assert_eq!(plain.shown(1.0), 0.5);
        let aces = Tone { exposure: 0.0, curve: Curve::Aces };
        assert!((aces.shown(1.0) - 2.54 / 3.16).abs() < 1e-12 && (aces.shown(0.18) - 0.2669).abs() < 1e-3);
    }
}
