//! Pictures that move: a number of an example's scene goes there and back.

pub struct Moving {
    /// The example's name; the picture's file is OF-moving.png.
    pub of: &'static str,
    /// What is seen, and what moves.
    pub says: &'static str,
    /// The number that goes from `from` to `to` and back: how the scene changes with it, as after --set, `N` in place of the number.
    pub change: &'static str,
    pub from: f64,
    pub to: f64,
    /// Pictures, there and back.
    pub steps: u32,
}

impl Moving {
    /// The scene's change of the `k`-th picture.
    pub fn change(&self, k: u32) -> String {
        let share = 0.5 - 0.5 * (std::f64::consts::TAU * f64::from(k) / f64::from(self.steps)).cos();
        self.change.replace('N', &(self.from + share * (self.to - self.from)).to_string())
    }
}

/// That of an example.
pub fn moving(of: &str) -> Option<&'static Moving> {
    MOVING.iter().find(|m| m.of == of)
}

const MOVING: [Moving; 5] = [
    Moving {
        of: "hinge",
        says: "Nothing moves here but the angle between two cameras (`camera.angle`).",
        change: "camera.angle=N",
        from: -12.0,
        to: 70.0,
        steps: 24,
    },
    Moving {
        of: "tracked",
        says: "One ball that rolls along behind two towers. The rays lead around the nearer side, and pass from one side to the other smoothly (`smooth`).",
        change: "mesh=[{builtin='plane',size=60,color=[0.42,0.38,0.32]},\
                 {builtin='box',scale=[4,9,4],translate=[-5.5,4.5,4],color=[0.45,0.55,0.75]},\
                 {builtin='box',scale=[3,13,3],translate=[4,6.5,5],color=[0.75,0.68,0.5]},\
                 {builtin='icosphere',level=4,scale=0.9,translate=[N,0.9,-3],color=[0.9,0.05,0.05]}] \
                 camera={kind='track',eye=[0,8,30],target=[0,3.5,0],vfov=36,targets=[{at=[N,0.9,-3],radius=1}],smooth=0.03}",
        from: -11.0,
        to: 8.0,
        steps: 30,
    },
    Moving {
        of: "rolling-shutter",
        says: "The rows are read ever more slowly (`camera.line_time`).",
        change: "camera.line_time=N",
        from: 0.0,
        to: 0.001_666_7,
        steps: 24,
    },
    Moving {
        of: "hidden-mirror",
        says: "The rays bend more and more around the pillar (`camera.eye.distortion`).",
        change: "camera.eye.distortion=[0,N]",
        from: 0.0,
        to: 0.16,
        steps: 16,
    },
    Moving {
        of: "smoke",
        says: "The rays bend more and more (`camera.bend`).",
        change: "camera.bend=[N,0.1]",
        from: 0.0,
        to: 0.35,
        steps: 12,
    },
];
